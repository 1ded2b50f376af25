"""Voronoi cell of each atom: volume and number of faces; surfaces, histograms of edges and lists of neighbours too.

Cells are those of ``scipy.spatial.Voronoi`` with copies of the atoms around the box; faces that are not periodic end the cells. In two
dimensions the box is one layer, whose copies give every cell two faces more. With ``radius v_name``, an atom-style variable, a place
belongs to the atom with the smallest distance squared minus radius squared (a power diagram): large atoms have larger cells, and a small
one among them may have none. Source: LAMMPS manual, compute voronoi/atom. Units: volume, area.
"""
from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from asemd.compute import Compute
from asemd.compute._inputs import Input
from asemd.compute._power_diagram import Diagram, power_diagram
from asemd.errors import InputError, nearest
from asemd.words import number, take, whole, yes_no

KEYWORDS = ("only_group", "occupation", "surface", "radius", "edge_histo", "edge_threshold", "face_threshold", "neighbors", "peratom")
CLOSED = 1e-9       # edges shorter than this, relative to the largest cell width, are points


class Cells(NamedTuple):
    """Cells of m atoms and their k faces, those of an atom together."""

    row: np.ndarray         # (m,) of the atom
    volume: np.ndarray      # (m,)
    owner: np.ndarray       # (k,) row of the atom whose cell it is
    other: np.ndarray       # (k,) row of the neighbour; -1 is a wall
    area: np.ndarray        # (k,)
    edges: np.ndarray       # (k,) how many


class VoronoiAtom(Compute):
    """Voronoi cells.

    Parameters
    ----------
    group : str
        The atoms it reports.
    only_group : bool
        As if there were no atoms outside the group.
    surface : str, optional
        The area of the faces towards atoms of this group becomes a third column.
    edge_histo : int, optional
        Count faces by their number of edges up to this one, as a global vector; the last element has those with more.
    edge_threshold, face_threshold : float
        Shorter edges and smaller faces are not counted (in the histogram all faces are).
    neighbors : bool
        Local rows: ID of an atom, of its neighbour, area of their face; 0 stands for a wall.
    occupation : bool
        Cells stay as on the first evaluation; per atom: how many atoms are now in the cell that was its own, and in the one where it is.
    radius : Input, optional
        Radii of the atoms, distance units.

    Raises
    ------
    InputError
        Negative thresholds; a radius that is not a number.
    """

    style = "voronoi/atom"

    def __init__(self, group: str = "all", only_group: bool = False, surface: str | None = None, edge_histo: int | None = None,
                 edge_threshold: float = 0.0, face_threshold: float = 0.0, neighbors: bool = False, peratom: bool = True,
                 occupation: bool = False, radius: Input | None = None):
        super().__init__(group)
        if occupation and (surface or edge_histo is not None):
            raise InputError("compute voronoi/atom: occupation cannot be used with surface or edge_histo")
        if edge_threshold < 0.0 or face_threshold < 0.0 or (edge_histo is not None and edge_histo < 1):
            raise InputError("compute voronoi/atom: thresholds must not be negative, and edge_histo must be positive")
        self.only_group, self.surface, self.edge_histo, self.neighbors, self.peratom = only_group, surface, edge_histo, neighbors, peratom
        self.edge_threshold, self.face_threshold = edge_threshold, face_threshold
        self.occupation, self.sites = occupation, None       # box, ids, positions and radii of the first evaluation
        self.radius = radius
        self._last: tuple = (None, None)

    def __getstate__(self):
        return {**self.__dict__, "_last": (None, None)}

    @classmethod
    def from_lammps(cls, group, words, session):
        rest, given, what = list(words), {}, "compute voronoi/atom"
        while rest:
            word = rest.pop(0)
            if word not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
            if word in ("only_group", "occupation"):
                given[word] = True
                continue
            value = take(rest, 1, f"{what} {word}")[0]
            rest.pop(0)
            if word == "surface":
                session.scene.groups.mask(value, what)
                given[word] = value
            elif word == "radius":
                if not value.startswith("v_"):
                    raise InputError(f"{what} radius: needs an atom-style variable v_name, got {value}")
                given[word] = Input(value, f"{what} radius", session)
                given[word].must_give("per_atom")
            elif word == "edge_histo":
                given[word] = whole(value, f"{what} {word}")
            elif word in ("neighbors", "peratom"):
                given[word] = yes_no(value, f"{what} {word}")
            else:
                given[word] = number(value, f"{what} {word}")
        return cls(group, **given)

    def to_lammps(self) -> list[str]:
        out = ["only_group"] * self.only_group + ["occupation"] * self.occupation + (["surface", self.surface] if self.surface else [])
        out += ["radius", str(self.radius)] if self.radius else []
        out += ["edge_histo", str(self.edge_histo)] if self.edge_histo else []
        out += ["edge_threshold", repr(self.edge_threshold), "face_threshold", repr(self.face_threshold)]
        return [*out, "neighbors", "yes" if self.neighbors else "no", "peratom", "yes" if self.peratom else "no"]

    def per_atom_columns(self) -> int:
        return 2 + (self.surface is not None)

    def local_columns(self):
        return 3 if self.neighbors else None

    @property
    def needs(self) -> frozenset[str]:
        return self.radius.needs if self.radius else frozenset()

    def _radii(self, state, rows: np.ndarray) -> np.ndarray | None:
        """The radii of some atoms."""
        if self.radius is None:
            return None
        radius = self.radius.per_atom(state)[rows]
        if not np.isfinite(radius).all():
            bad = rows[np.argmin(np.isfinite(radius))]
            raise InputError(f"compute {self.id} (voronoi/atom): the radius of atom {state.system.id[bad]} is not a number")
        return radius

    def cells(self, state) -> Cells:
        """The cells of the atoms of the group."""
        if self._last[0] is state:
            return self._last[1]
        mask = state.mask(self.group)
        rows = np.flatnonzero(mask) if self.only_group else np.arange(state.system.n)
        none, count = np.zeros(0), np.zeros(0, int)
        out = _cells(state.system, rows, mask[rows], self.edge_threshold, self._radii(state, rows)) if len(rows) \
            else Cells(count, none, count, count, none, count)
        self._last = (state, out)
        return out

    def per_atom(self, state) -> np.ndarray:
        """(n, 2 or 3) volume, number of faces, area towards the other group; zero outside the group."""
        if not self.peratom:
            return super().per_atom(state)
        if self.occupation:
            return self._occupied(state)
        n, cells = state.system.n, self.cells(state)
        out = np.zeros((n, self.per_atom_columns()))
        out[cells.row, 0] = cells.volume
        out[:, 1] = np.bincount(cells.owner[cells.area > self.face_threshold], minlength=n)
        if self.surface:
            at = (cells.area >= self.face_threshold) & ((cells.other < 0) | state.mask(self.surface)[cells.other])
            out[:, 2] = np.bincount(cells.owner[at], cells.area[at], minlength=n)
        return out

    def _occupied(self, state) -> np.ndarray:
        """(n, 2) how many atoms are in the cell that was an atom's own on the first evaluation, and in the one where it is now."""
        system = state.system
        if self.sites is None:
            rows = np.flatnonzero(state.mask(self.group)) if self.only_group else np.arange(system.n)
            self.sites = system.box, system.id[rows].copy(), system.x[rows].copy(), self._radii(state, rows)
        box, ids, places, radius = self.sites
        out = np.zeros((system.n, 2))
        if not len(ids):
            return out
        at = _nearest(box, system.dimension, places, system.x, radius)
        count = np.bincount(at[at >= 0], minlength=len(ids))
        order = np.argsort(ids)
        mine = order[np.minimum(np.searchsorted(ids[order], system.id), len(ids) - 1)]
        out[:, 0] = np.where(ids[mine] == system.id, count[mine], 0)
        out[:, 1] = np.where(at >= 0, count[at], 0)
        return out

    @property
    def size(self) -> int | None:
        """Elements of the vector, None without one."""
        return None if self.edge_histo is None else self.edge_histo + 1

    def vector(self, state) -> np.ndarray:
        """(edge_histo + 1,) faces by their number of edges."""
        if self.edge_histo is None:
            return super().vector(state)
        edges = self.cells(state).edges
        return np.bincount(np.minimum(edges[edges > 0], self.edge_histo + 1) - 1, minlength=self.edge_histo + 1).astype(float)

    def local(self, state) -> np.ndarray:
        """(m, 3) ID of an atom, of its neighbour, area of the face."""
        if not self.neighbors:
            return super().local(state)
        ids, cells = state.system.id, self.cells(state)
        rows = np.column_stack([ids[cells.owner], np.where(cells.other < 0, 0, ids[cells.other]), cells.area])
        return rows[cells.area > self.face_threshold]


def _cells(system, rows: np.ndarray, wanted: np.ndarray, shortest: float, radius: np.ndarray | None = None) -> Cells:
    """Cells among the atoms `rows` of those that are `wanted`."""
    from scipy.spatial import Voronoi
    box, periodic = system.box, np.array(system.box.periodic, bool)
    x, image = system.x[rows].copy(), np.zeros((len(rows), 3), np.int32)
    if system.dimension == 2:
        periodic[2] = True
    box.wrap(x, image)
    s, weight = (x - box.origin) @ box.inverse, np.zeros(len(rows)) if radius is None else radius**2
    widths = 1.0 / np.linalg.norm(box.inverse, axis=0)
    reach = 2.5 * (box.volume / len(rows)) ** (1 / 3)
    while True:
        points, owner = _surrounded(s, periodic, reach / widths)
        places = points @ box.cell + box.origin
        found = Voronoi(places) if radius is None else power_diagram(places, radius[_original(owner)])
        needed = _reach(found, np.flatnonzero(wanted), weight)
        if needed <= reach:      # no atom beyond can cut a cell
            break
        reach = 1.05 * needed if np.isfinite(needed) else 2.0 * reach
    mine = np.zeros(len(points), bool)
    mine[:len(rows)] = wanted
    faces = np.flatnonzero(mine[found.ridge_points].any(axis=1))
    area, edges = _polygons(found.vertices, [found.ridge_vertices[k] for k in faces], max(CLOSED * float(widths.max()), shortest))
    one = found.ridge_points[faces].ravel()             # each face twice, seen from both sides
    other = found.ridge_points[faces][:, ::-1].ravel()
    face = np.repeat(np.arange(len(faces)), 2)[mine[one]]
    one, other = one[mine[one]], other[mine[one]]
    apart = np.linalg.norm(found.points[one] - found.points[other], axis=1)
    height = 0.5 * (apart + (weight[one] - weight[_original(owner[other])]) / apart)
    volume = np.bincount(one, area[face] * height / 3.0, minlength=len(rows))[wanted]
    order = np.argsort(one, kind="stable")
    order = order[area[face[order]] > (CLOSED * float(widths.max())) ** 2]
    other = owner[other[order]]
    return Cells(rows[wanted], volume, rows[one[order]], np.where(other < 0, -1, rows[other]), area[face[order]], edges[face[order]])


def _polygons(vertices: np.ndarray, corners: list, tiny: float) -> tuple[np.ndarray, np.ndarray]:
    """Areas of flat polygons, given by their corners in turn, and how many of their edges are not `tiny`; those of a size at once."""
    size = np.array([len(c) for c in corners], int)
    area, edges = np.empty(len(corners)), np.empty(len(corners), int)
    for n in np.unique(size):
        some = np.flatnonzero(size == n)
        v = vertices[np.array([corners[k] for k in some])]
        area[some] = 0.5 * np.linalg.norm(np.cross(v[:, 1:-1] - v[:, :1], v[:, 2:] - v[:, :1]).sum(axis=1), axis=1)
        edges[some] = (np.linalg.norm(v - np.roll(v, 1, axis=1), axis=2) > tiny).sum(axis=1)
    return area, edges


def _nearest(box, dimension: int, places: np.ndarray, x: np.ndarray, radius: np.ndarray | None) -> np.ndarray:
    """(n,) which of some places is nearest to each position, whose cell it is in; below 0 beyond a wall."""
    from scipy.spatial import cKDTree
    periodic, at = np.array(box.periodic, bool), []
    if dimension == 2:
        periodic[2] = False
    for part in (places, x):
        part = part.copy()
        box.wrap(part, np.zeros((len(part), 3), np.int32))
        at.append((part - box.origin) @ box.inverse)
    widths = 1.0 / np.linalg.norm(box.inverse, axis=0)
    reach = 2.5 * (box.volume / len(places)) ** (1 / 3)
    aside = np.zeros(len(places)) if radius is None else np.sqrt((radius**2).max() - radius**2)     # a distance in a fourth direction
    while True:
        points, owner = _surrounded(at[0], periodic, reach / widths)
        tree = cKDTree(np.column_stack([points @ box.cell, aside[_original(owner)]]))
        distance, k = tree.query(np.column_stack([at[1] @ box.cell, np.zeros(len(at[1]))]))
        if distance.max(initial=0.0) <= reach:
            return owner[k]
        reach = 2.0 * float(distance.max())


def _original(owner):
    """Of which atom a point is a copy or a mirror image."""
    return np.where(owner < 0, ~owner, owner)


def _surrounded(s: np.ndarray, periodic: np.ndarray, margin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fractional positions with copies as far as `margin` around the box, and whose copies they are.

    Walls are mirrors: the cells of an atom and its mirror image meet in the wall; such images belong to nobody (below 0: ``~k`` for that
    of atom `k`).
    """
    points, owner = s, np.arange(len(s))
    for a in range(3):
        copies, owners = [points], [owner]
        if periodic[a]:
            for k in itertools.chain(range(-int(np.ceil(margin[a])), 0), range(1, int(np.ceil(margin[a])) + 1)):
                copies.append(points + k * np.eye(3)[a])
                owners.append(owner)
        else:
            for wall in (0.0, 1.0):
                mirrored = points.copy()
                mirrored[:, a] = 2.0 * wall - points[:, a]
                copies.append(mirrored)
                owners.append(~_original(owner))
        points, owner = np.concatenate(copies), np.concatenate(owners)
        near = (points[:, a] > -margin[a]) & (points[:, a] < 1.0 + margin[a])
        near[:len(s)] = True
        points, owner = points[near], owner[near]
    return points, owner


def _reach(found, atoms: np.ndarray, weight: np.ndarray) -> float:
    """How far away an atom may be that cuts a cell: where a corner's power is still larger than that of an atom with the largest weight."""
    ours = isinstance(found, Diagram)
    regions = [found.regions[k] for k in (atoms if ours else found.point_region[atoms])]
    size = np.array([len(region) for region in regions], int)
    corner, atom = np.fromiter(itertools.chain.from_iterable(regions), int, size.sum()), np.repeat(atoms, size)
    if (corner < 0).any() or not (ours or size.all()):      # an empty cell; only those of power diagrams are
        return np.inf
    far = np.linalg.norm(found.vertices[corner] - found.points[atom], axis=1)
    return float((far + np.sqrt(np.maximum(far * far + weight.max() - weight[atom], 0.0))).max(initial=0.0))
