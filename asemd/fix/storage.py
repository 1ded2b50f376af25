"""The order in which LAMMPS, on one processor, keeps atoms and finds their neighbours; Monte Carlo moves depend on it."""
from __future__ import annotations

import numpy as np


class Storage:
    """Where LAMMPS would keep each atom, and in which order its half neighbour list names pairs.

    Parameters
    ----------
    every : int
        Steps between two sorts of the atoms (``atom_modify sort``), 0: they are not sorted.
    width : float
        Of the bins of that sort, distance units; 0: half the reach of the list.
    bins : bool
        Whether lists come from bins (``neighbor ... bin``).
    newton : bool
        As ``newton``, for pairs.
    order : sequence of int, optional
        Atom IDs as a data file has them; atoms of other systems begin in the order of their IDs.

    Attributes
    ----------
    place : (n,) int array
        Place of each atom row.
    """

    def __init__(self, every: int = 1000, width: float = 0.0, bins: bool = True, newton: bool = True, order=None):
        self.every, self.width, self.bins, self.newton, self.order = every, width, bins, newton, order
        self.place = np.zeros(0, np.int64)
        self.due = 0

    def begin(self, loop) -> None:
        """A run begins, or atoms left or joined."""
        if len(self.place) != loop.system.n:
            ids = loop.system.id
            self.place = np.arange(len(ids))
            if self.order is not None and np.array_equal(np.sort(self.order), np.sort(ids)):
                self.place[np.argsort(ids)] = np.argsort(self.order)
        self.due = loop.step
        self.listed(loop)

    def listed(self, loop) -> None:
        """A list was built: it is of these positions; sort the atoms if it is time to."""
        e = loop.engine
        self.x = np.ascontiguousarray(e.held[:, e.slot_of].T)
        self.low, self.high = _bounds(loop.system.box)
        self.made = None
        # also of pair style zero, which needs no list
        cutoff = max(loop.interactions.cutoff(loop.system.counts["ntypes"], e.units), e.reach - e.settings.skin)
        if self.every and loop.step >= self.due and cutoff > 0.0:
            self.due = loop.step // self.every * self.every + self.every
            at = self._bin(loop, self.width or 0.5 * (cutoff + e.settings.skin))
            width = at.max(axis=0) + 1
            key = (at[:, 2] * width[1] + at[:, 1]) * width[0] + at[:, 0]
            order = np.lexsort((self.place, key))
            self.place = np.empty(len(order), np.int64)
            self.place[order] = np.arange(len(order))

    def _bin(self, loop, width: float, x: np.ndarray | None = None) -> np.ndarray:
        """(n, 3) bin of each atom, or of other places, also beyond the box."""
        length = self.high - self.low
        count = np.maximum((length * (1.0 / width)).astype(np.int64), 1)
        if loop.system.dimension == 2:
            count[2] = 1
        if x is None:
            return np.clip(((self.x - self.low) * (count / length)).astype(np.int64), 0, count - 1)
        at = np.floor((x - self.low) * (count / length)).astype(np.int64)
        beyond = ((x - self.high) * (count / length)).astype(np.int64) + count
        at = np.where(x >= self.high, beyond, np.minimum(at, count - 1))
        if loop.system.dimension == 2:
            at[:, 2] = 0
        return at

    def pairs(self, loop, reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The half list, in its order.

        Parameters
        ----------
        reach : (ntypes+1, ntypes+1) float
            How far the list goes, by type.

        Returns
        -------
        first : (n+1,) int
            Where the neighbours of each atom row begin.
        neighbours : (m,) int
            Their rows; -1 for periodic images, which LAMMPS keeps as atoms of their own, behind the others.
        """
        if self.made is None:
            i, row, x = self._near(loop)
            n = loop.system.n
            kind, tag = loop.system.type, loop.system.id
            image, j = row >= n, row % n
            close = ((self.x[i] - x) ** 2).sum(axis=1) <= reach[kind[i], kind[j]] ** 2
            step = self._bin(loop, 0.5 * loop.engine.reach, x) - self._bin(loop, 0.5 * loop.engine.reach)[i]
            step *= self.bins
            above = _above(x - self.x[i])
            halved = self.bins and self.newton and not loop.system.box.triclinic     # of the bins around an atom one half counts
            if halved:
                same = ~step.any(axis=1)
                mine = np.where(same, np.where(image, above, self.place[j] > self.place[i]), _above(step))
            else:
                odd = (tag[i] + tag[j]) % 2 == 1
                shared = np.where(tag[i] == tag[j], above, (tag[i] > tag[j]) == odd) if self.newton else True
                mine = np.where(image, shared, self.place[j] > self.place[i])
            keep = close & mine & ~self._barred(loop, i, j, x)
            i, j, step, image = i[keep], j[keep], step[keep], image[keep]
            other = step.any(axis=1) & halved       # the bin of the atom itself comes first
            order = np.lexsort((self.place[j], image, step[:, 0], step[:, 1], step[:, 2], other, i))
            self.made = np.searchsorted(i[order], np.arange(n + 1)), np.where(image, -1, j)[order]
        return self.made

    def _near(self, loop) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows of atoms, of what is within reach of them (n and more: periodic images) and where that is."""
        from scipy.spatial import cKDTree
        box, n, reach = loop.system.box, len(self.x), loop.engine.reach * (1.0 + 1e-12)
        x, row = [self.x], [np.arange(n)]
        periodic = np.array(box.periodic, bool) & (np.arange(3) < loop.system.dimension)
        widths = 1.0 / np.linalg.norm(box.inverse, axis=0)
        most = np.where(periodic, np.ceil(reach / widths), 0).astype(int)
        for shift in np.ndindex(*(2 * most + 1)):
            shift = np.array(shift) - most
            if shift.any():
                moved = self.x + shift @ box.cell
                near = ((moved >= self.x.min(axis=0) - reach) & (moved <= self.x.max(axis=0) + reach)).all(axis=1)
                x.append(moved[near])
                row.append(np.flatnonzero(near) + n)
        x, row = np.concatenate(x), np.concatenate(row)
        found = cKDTree(self.x).sparse_distance_matrix(cKDTree(x), reach, output_type="coo_matrix")
        other = found.row != found.col
        return found.row[other], row[found.col[other]], x[found.col[other]]

    def _barred(self, loop, i, j, x) -> np.ndarray:
        """Pairs that are not in the list: bonded ones, as closest images, and those of ``neigh_modify exclude``."""
        system, n = loop.system, loop.system.n
        bonds = np.sort(system.topology.bonds, axis=1).astype(np.int64)
        low, high = np.minimum(i, j).astype(np.int64), np.maximum(i, j)
        out = np.isin(low * n + high, bonds[:, 0] * n + bonds[:, 1])
        d = self.x[i] - x
        out &= (np.abs(system.box.minimum_image(d)[1]).max(axis=1, initial=0) == 0)
        mask, molecule, rules = loop.engine.exclusions.rule_arrays
        for kind, one, two in rules.tolist():
            a, b = (mask & one) != 0, (mask & two) != 0
            same = molecule[i] == molecule[j]
            out |= (a[i] & b[j] | a[j] & b[i]) if kind == 0 else a[i] & a[j] & (same if kind == 1 else ~same)
        return out


def _above(d: np.ndarray) -> np.ndarray:
    """Whether vectors (m, 3) point up; of those that lie flat, back; of those along x, to the right."""
    x, y, z = d.T
    return (z > 0) | ((z == 0) & ((y > 0) | ((y == 0) & (x > 0))))


def _bounds(box) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the smallest box along the axes that holds a box."""
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell + box.origin
    return corners.min(axis=0), corners.max(axis=0)


__all__ = ["Storage"]
