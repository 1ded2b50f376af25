"""Coordination number of each atom: neighbours within a cutoff, by type; or neighbours with the same local orientation.

Partners that ``special_bonds`` takes out of the neighbour list are not counted. Source: LAMMPS manual, compute coord/atom.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import half, in_slots, limits, within_force_cutoff
from asemd.errors import InputError, nearest
from asemd.kernels import surroundings as loops
from asemd.words import bounds, choice, exactly, number, take


class CoordAtom(Compute):
    """Coordination numbers.

    Parameters
    ----------
    group : str
        The atoms it reports.
    cutoff : float, optional
        Distance up to which neighbours count; not with `orientation`.
    types : sequence of (type or range)
        One number for each of them, such as ``["1", "2*4"]``; none: all types.
    neighbors : str
        Only atoms of this group count as neighbours.
    orientation : asemd.compute.orientorder_atom.OrientOrderAtom, optional
        Neighbours within its cutoff count whose harmonics agree: their product with those of the atom is at least `threshold`.
    threshold : float

    Raises
    ------
    InputError
        No cutoff, or an orientation whose harmonics are not kept (``components``), or a threshold beyond -1 to 1.
    """

    style = "coord/atom"

    def __init__(self, group: str = "all", cutoff: float | None = None, types=(), neighbors: str = "all", orientation=None,
                 threshold: float = 0.0):
        super().__init__(group)
        if orientation is None and (cutoff is None or cutoff < 0.0):
            raise InputError("compute coord/atom needs a cutoff that is not negative")
        if orientation is not None and (orientation.style != "orientorder/atom" or orientation.components is None):
            raise InputError("compute coord/atom orientorder needs a compute orientorder/atom with the keyword components")
        if not -1.0 < threshold < 1.0:
            raise InputError(f"compute coord/atom orientorder: the threshold must lie between -1 and 1, got {threshold:g}")
        self.cutoff, self.types, self.neighbors = cutoff, [str(t) for t in types], neighbors
        self.orientation, self.threshold = orientation, threshold

    @classmethod
    def from_lammps(cls, group, words, session):
        scene = session.scene
        kind = choice(take(words, 1, "compute coord/atom")[0], ("cutoff", "orientorder"), "compute coord/atom")
        if kind == "orientorder":
            id, threshold = exactly(words[1:], 2, "compute coord/atom orientorder")
            if id not in scene.computes:
                raise InputError(f"compute coord/atom: there is no compute {id}{nearest(id, scene.computes)}")
            return cls(group, orientation=scene.computes[id], threshold=number(threshold, "compute coord/atom orientorder: threshold"))
        rest, partners = list(words[1:]), "all"
        cutoff = number(take(rest, 1, "compute coord/atom cutoff")[0], "compute coord/atom cutoff")
        rest = rest[1:]
        if rest[:1] == ["group"]:
            partners, rest = take(rest[1:], 1, "compute coord/atom group")[0], rest[2:]
            scene.groups.mask(partners, "compute coord/atom")
        out = cls(group, cutoff, rest, partners)
        out._ranges(scene.need_system("compute coord/atom"))
        return out

    def to_lammps(self) -> list[str]:
        if self.orientation is not None:
            return ["orientorder", self.orientation.id, repr(self.threshold)]
        return ["cutoff", repr(self.cutoff), *(["group", self.neighbors] if self.neighbors != "all" else []), *self.types]

    def per_atom_columns(self) -> int:
        return len(self.types) if len(self.types) > 1 else 0

    def _ranges(self, system) -> list[tuple[int, int]]:
        n, labels = system.counts["ntypes"], system.labels.get("atom")
        return [bounds(w, 1, n, "compute coord/atom: type", labels) for w in self.types or ["*"]]

    def per_atom(self, state) -> np.ndarray:
        """(n,), or (n, k) for several types; zero outside the group."""
        n, mask = state.system.n, state.mask(self.group)
        if self.orientation is not None:
            pairs = half(state, self.orientation.reach(state))
            q = self.orientation.unit_harmonics(state)
            same = np.einsum("ma,ma->m", q[pairs.i], q[pairs.j].conj()).real > self.threshold
            out = np.bincount(pairs.i[same], minlength=n) + np.bincount(pairs.j[same], minlength=n)
            return np.where(mask, out, 0).astype(float)
        cutoff, other = within_force_cutoff(state, self.cutoff, "compute coord/atom"), state.mask(self.neighbors)
        ranges, out = np.array(self._ranges(state.system)), np.zeros((n, max(1, len(self.types))))
        if limits(state, cutoff, False) is None:
            f = in_slots(state, cutoff)
            loops.coordination(f.x, f.row, f.i, f.j, f.code, f.shifts, cutoff * cutoff, state.system.type, other, ranges, out)
        else:
            pairs = half(state, cutoff)
            centre, around = np.concatenate([pairs.i, pairs.j]), np.concatenate([pairs.j, pairs.i])
            t = state.system.type[around]
            for k, (low, high) in enumerate(ranges):
                out[:, k] = np.bincount(centre[(low <= t) & (t <= high) & other[around]], minlength=n)
        out[~mask] = 0.0
        return out[:, 0] if out.shape[1] == 1 else out
