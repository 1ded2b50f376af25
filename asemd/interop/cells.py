"""The same crystal in another cell, with its bonded items."""
from __future__ import annotations

from collections import Counter

import numpy as np
from scipy.sparse import coo_matrix, csgraph
from scipy.spatial import cKDTree

from asemd.atoms import Atoms
from asemd.box import Box
from asemd.errors import InputError
from asemd.topology import Topology, cells_apart

GRID = 100000       # parts of a cell vector by which lattice points are told apart
OFF_GRID = 0.2928932        # no fraction of small whole numbers falls between two parts
BOTH_WAYS = ("bond", "angle", "dihedral")       # read from either end


def folded(s: np.ndarray) -> np.ndarray:
    """Fractional coordinates in [0, 1)."""
    s = s - np.floor(s)
    return np.where(s >= 1.0, 0.0, s)


class Places:
    """Points of a periodic cell that can be looked up.

    Parameters
    ----------
    s : (m, 3) array
        Fractional coordinates.
    cell : (3, 3) array
    """

    def __init__(self, s: np.ndarray, cell: np.ndarray):
        self.s, self.cell = s, cell
        self.shortest = np.linalg.svd(cell, compute_uv=False)[-1]
        self.tree = cKDTree(folded(s), boxsize=1.0)

    def nearest(self, s: np.ndarray, distance: float) -> np.ndarray:
        """For each of `s` (k, 3) the row of the nearest point, -1 if it is farther than `distance`."""
        _, row = self.tree.query(folded(s), distance_upper_bound=2.0 * distance / self.shortest + 1e-12)
        found = np.flatnonzero(row < len(self.s))
        d = s[found] - self.s[row[found]]
        near = np.linalg.norm((d - np.rint(d)) @ self.cell, axis=1) <= distance
        out = np.full(len(s), -1)
        out[found[near]] = row[found[near]]
        return out


def recell(atoms: Atoms, cell: np.ndarray, tolerance: float) -> Atoms:
    """The crystal of `atoms` in another cell, whose lattice must be one of translations that leave the crystal as it is.

    Parameters
    ----------
    atoms : Atoms
        Periodic in three directions.
    cell : (3, 3) array
        New cell vectors, Angstrom.
    tolerance : float
        Atoms nearer than this are one and the same, Angstrom.

    Returns
    -------
    Atoms
        Nothing is turned or shifted; ids count from 1, molecules are numbered anew from the bonds.

    Raises
    ------
    InputError
        The cell is no cell of the crystal, or so small that bonds would connect other images than they do.
    """
    if atoms.topology.frozen is not None:
        raise InputError("bonds that were broken or turned off still count for special_bonds: another cell cannot keep that")
    old, corner, n = atoms.cell.array, np.ravel(atoms.get_celldisp()), len(atoms)
    inverse = np.linalg.inv(cell)
    shifts = _cosets(old @ inverse)
    s = ((atoms.positions - corner)[None] + (shifts @ old)[:, None]) @ inverse                 # (cosets, n, 3)
    ratio = abs(np.linalg.det(cell) / np.linalg.det(old))
    first, number = groups(s.reshape(-1, 3), cell, tolerance)
    if abs(n * ratio - len(first)) > 1e-3:
        raise InputError(f"this is no cell of the crystal: it would hold {n * ratio:g} atoms, but {len(first)} have places in it")
    made = atoms[first % n]
    made.set_constraint()
    made.set_cell(cell)
    places = folded(s.reshape(-1, 3)[first])
    made.positions[:] = places @ cell + corner
    for name in ("momenta", "image", "id"):
        if name in made.arrays:
            del made.arrays[name]
    made.topology = _Items(atoms, shifts, s, places, number.reshape(len(shifts), n), cell, ratio).topology()
    if "id" in atoms.arrays:
        made.set_array("id", np.arange(1, len(made) + 1))
    if "mol-id" in made.arrays and len(made.topology.bonds):
        made.arrays["mol-id"][:] = _molecules(made)
    return made


def codes(s: np.ndarray) -> np.ndarray:
    """One whole number for each place (..., 3) in a cell."""
    part = np.floor(s * GRID + OFF_GRID).astype(np.int64) % GRID
    return (part[..., 0] * GRID + part[..., 1]) * GRID + part[..., 2]


def _cosets(steps: np.ndarray) -> np.ndarray:
    """Whole numbers of old cell vectors, one row for each place they lead to in the new cell; `steps` are those vectors in new ones."""
    found, queue = {int(codes(np.zeros(3))): np.zeros(3, int)}, [np.zeros(3, int)]
    for here in queue:
        for k in range(3):
            there = here + np.eye(3, dtype=int)[k]
            code = int(codes(there @ steps))
            if code not in found:
                found[code] = there
                queue.append(there)
        if len(found) > GRID:
            raise InputError("this is no cell of the crystal: its vectors are not made of the crystal's")
    return np.array(list(found.values()))


def groups(s: np.ndarray, cell: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Fractional coordinates (m, 3) of points, those in one place together: the first of each group, and the group of each point."""
    if not len(s):
        return np.zeros(0, int), np.zeros(0, int)
    reach = 2.0 * tolerance / np.linalg.svd(cell, compute_uv=False)[-1] + 1e-12
    tree, number, first = cKDTree(folded(s), boxsize=1.0), np.full(len(s), -1), []
    for k in range(len(s)):
        if number[k] < 0:
            number[tree.query_ball_point(tree.data[k], reach)] = len(first)
            first.append(k)
    return np.array(first), number


class _Items:
    """The bonded items of a crystal in a new cell: each as often as it was, and between the same images."""

    def __init__(self, atoms: Atoms, shifts, s, places, number, cell, ratio):
        self.atoms, self.shifts, self.s, self.places, self.number, self.cell = atoms, shifts, s, places, number, cell
        self.steps = atoms.cell.array @ np.linalg.inv(cell)
        here = codes(shifts @ self.steps)
        self.sorted = np.argsort(here)
        self.codes = here[self.sorted]
        self.copies = len(shifts) / ratio       # how often each item of the new cell is met

    def topology(self) -> Topology:
        """The items of all kinds."""
        box, parts = Box(np.zeros(3), self.atoms.cell.array), {}
        for kind, items, types in self.atoms.topology.every():
            if len(items):
                apart = cells_apart(kind, items, box, self.atoms.positions)
                rows, kept = self._of_kind(kind, items, types, apart)
                parts |= {f"{kind}s": rows, f"{kind}_types": kept}
        return Topology(**parts)

    def _of_kind(self, kind: str, items, types, apart) -> tuple[np.ndarray, np.ndarray]:
        met, listed = Counter(), {}
        for shift in self.shifts:
            total = apart + shift
            rows = self.number[self.sorted[np.searchsorted(self.codes, codes(total @ self.steps))], items]
            cells = np.rint(self.s[0][items] + total @ self.steps - self.places[rows]).astype(int)
            for row, cell, t in zip(rows.tolist(), cells.tolist(), types.tolist()):
                key = _named(row, cell, t)
                if kind in BOTH_WAYS:
                    key = min(key, _named(row[::-1], cell[::-1], t))
                met[key] += 1
                listed.setdefault(key, (row, [[a - b for a, b in zip(c, cell[0])] for c in cell], t))
        times = {key: count / self.copies for key, count in met.items()}
        wrong = next((key for key, count in times.items() if abs(count - round(count)) > 1e-6), None)
        if wrong is not None:
            atoms = " ".join(map(str, listed[wrong][0]))
            raise InputError(f"{kind}s of atoms {atoms} of the new cell are not listed alike in all its copies")
        chosen = [listed[key] for key, count in times.items() for _ in range(round(count))]
        rows, between = np.array([c[0] for c in chosen]), np.array([c[1] for c in chosen])
        self._check(kind, rows, between)
        return rows, np.array([c[2] for c in chosen])

    def _check(self, kind: str, rows, between) -> None:
        """Bonds are told by their atoms and go to the nearest image: in a cell that is too small that would be another one."""
        near = cells_apart(kind, rows, Box(np.zeros(3), self.cell), self.places @ self.cell)
        twice = np.any([rows[:, a] == rows[:, b] for a in range(rows.shape[1]) for b in range(a)], axis=0)
        bad = np.flatnonzero(twice | (near - near[:, :1] != between).any(axis=(1, 2)))
        if len(bad):
            atoms = " ".join(map(str, rows[bad[0]]))
            raise InputError(f"the cell is too small for its {kind}s: that of atoms {atoms} goes to an image that is not the nearest, or "
                             "to the atom itself; take a larger cell")


def _named(rows: list[int], cells: list[list[int]], t: int) -> tuple:
    """What an item is, wherever in the crystal it is met."""
    return (*rows, *(a - b for cell in cells for a, b in zip(cell, cells[0])), t)


def _molecules(atoms: Atoms) -> np.ndarray:
    """Molecule ids by the bonds, in order of atoms; atoms without bonds have one of their own, or 0 if they had 0."""
    bonds, n = atoms.topology.bonds, len(atoms)
    _, piece = csgraph.connected_components(coo_matrix((np.ones(len(bonds)), bonds.T), shape=(n, n)), directed=False)
    none = (atoms.arrays["mol-id"] == 0) & ~np.isin(np.arange(n), bonds)
    _, first, number = np.unique(np.where(none, -1, piece), return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(np.where(none[first], -1, first)))
    return rank[number] + (0 if none.any() else 1)
