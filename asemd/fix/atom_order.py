"""The order in which LAMMPS, on one processor, keeps atoms and finds their neighbours; Monte Carlo moves depend on it."""
from __future__ import annotations

import numpy as np

from asemd.fix import NEVER
from asemd.kernels.half_list import bins_of
from asemd.kernels.rows import of_ids

SPREAD = 64     # the largest id over the number of atoms


class AtomOrder:
    """The order in which LAMMPS stores atoms: as they were made, sorted by place now and then.

    Parameters
    ----------
    every : int
        Steps between two sorts of the atoms (``atom_modify sort``), 0: they are not sorted.
    width : float
        Of the bins of that sort, distance units; 0: half the reach of the list.
    order : sequence of int, optional
        Atom IDs as a data file has them; atoms of other systems begin in the order of their rows.

    Attributes
    ----------
    ids : (n,) int array
        Atom IDs in this order.
    due : int
        The step from which on a list build sorts.
    """

    def __init__(self, every: int = 1000, width: float = 0.0, order=None):
        self.every, self.width, self.due = every, width, 0
        self.ids = np.zeros(0, np.int64) if order is None else np.array(order, np.int64)

    def rows(self, system) -> np.ndarray:
        """Rows of the atoms in this order; atoms that came otherwise are the last ones, and those that went have left their places."""
        largest = max(int(system.id.max(initial=0)), int(self.ids.max(initial=0)))
        if largest > SPREAD * (system.n + 1000):        # a table by id would be too long
            self.remove(self.ids[~np.isin(self.ids, system.id)])
            self.ids = np.concatenate([self.ids, system.id[~np.isin(system.id, self.ids)]])
            return system.index_of(self.ids) if len(self.ids) else np.zeros(0, np.int64)
        row_of, rows = np.full(largest + 1, -1), np.empty(len(self.ids), np.int64)
        if of_ids(system.id, self.ids, row_of, rows) < len(rows):
            self.remove(self.ids[rows < 0])
            rows = row_of[self.ids]
        if len(rows) < system.n:
            new = np.ones(system.n, bool)
            new[rows] = False
            self.ids, rows = np.concatenate([self.ids, system.id[new]]), np.concatenate([rows, np.flatnonzero(new)])
        return rows

    def remove(self, gone) -> None:
        """Atoms of these IDs leave; the last ones take their places, as in LAMMPS."""
        gone = np.atleast_1d(gone)
        places = np.flatnonzero(self.ids == gone[0] if len(gone) == 1 else np.isin(self.ids, gone))
        ids, n = self.ids.copy(), len(self.ids)
        for k in places[::-1].tolist():
            n -= 1
            ids[k] = ids[n]
        self.ids = ids[:n]

    def sort(self, loop, x: np.ndarray | None = None) -> None:
        """Sort by bins of the box, those of x first; within a bin the order stays.

        Parameters
        ----------
        loop : asemd.loop.Loop
        x : (n, 3) float array, optional
            Positions within the box, by row; those of the system if not given.
        """
        system, e = loop.system, loop.engine
        # also of pair style zero, which needs no list
        cutoff = max(loop.interactions.cutoff(system.counts["ntypes"], e.units), e.reach - e.settings.skin)
        if not self.every or not cutoff > 0.0:
            self.due = NEVER
            return
        self.due = (loop.step // self.every + 1) * self.every
        if x is None:
            x = system.x.copy()
            system.box.wrap(x, system.image.copy())
        rows, (low, high) = self.rows(system), bounds(system.box)
        count = bin_counts(high - low, self.width or 0.5 * (cutoff + e.settings.skin), system.dimension)
        bins = np.clip(((x[rows] - low) * (count / (high - low))).astype(np.int64), 0, count - 1)
        self.ids = self.ids[np.argsort((bins[:, 2] * count[1] + bins[:, 1]) * count[0] + bins[:, 0], kind="stable")]


def storage_of(loop, own: AtomOrder) -> AtomOrder:
    """The one that all fixes of a run share."""
    return next((f.storage for f in loop.fixes if type(getattr(f, "storage", None)) is AtomOrder), own)


def sort_if_due(loop, storage: AtomOrder, fix) -> None:
    """Called by each fix before a list build, after it has acted: the last one of those that share an order sorts it."""
    if storage.due <= loop.step and fix is next(f for f in reversed(loop.fixes) if getattr(f, "storage", None) is storage):
        loop.sync_out()
        storage.sort(loop)


def bin_counts(length: np.ndarray, width: float, dimension: int) -> np.ndarray:
    """How many bins at least that wide fit along each direction."""
    count = np.maximum((length * (1.0 / width)).astype(np.int64), 1)
    if dimension == 2:
        count[2] = 1
    return count


class ListOrder(AtomOrder):
    """Where LAMMPS would keep each atom, and in which order its half neighbour list names pairs.

    Parameters
    ----------
    every, width, order
        As those of `AtomOrder`.
    bins : bool
        Whether lists come from bins (``neighbor ... bin``).
    newton : bool
        As ``newton``, for pairs.

    Attributes
    ----------
    place : (n,) int array
        Place of each atom row.
    stored : (n,) int array
        The row at each place.
    """

    def __init__(self, every: int = 1000, width: float = 0.0, bins: bool = True, newton: bool = True, order=None):
        super().__init__(every, width, order)
        self.bins, self.newton = bins, newton
        self.place = self.stored = np.zeros(0, np.int64)

    def begin(self, loop) -> None:
        """A run begins."""
        self.due = loop.step
        self.listed(loop)

    def listed(self, loop) -> None:
        """A list was built: it is of these positions; sort the atoms if it is time to."""
        e = loop.engine
        self.x = np.ascontiguousarray(e.held[:, e.slot_of].T)
        self.low, self.high = bounds(loop.system.box)
        self.made = None
        if loop.step >= self.due:
            self.sort(loop, self.x)
        self.stored = self.rows(loop.system)
        self.place = np.empty(len(self.stored), np.int64)
        self.place[self.stored] = np.arange(len(self.stored))

    def _bin(self, loop, width: float, x: np.ndarray | None = None) -> np.ndarray:
        """(n, 3) bin of each atom, or of other places, also beyond the box."""
        length = self.high - self.low
        count = bin_counts(length, width, loop.system.dimension)
        if x is None:
            return np.clip(((self.x - self.low) * (1.0 / (length / count))).astype(np.int64), 0, count - 1)
        at = bins_of(x, self.low, self.high, count)
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


def bounds(box) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the smallest box along the axes that holds a box."""
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell + box.origin
    return corners.min(axis=0), corners.max(axis=0)


__all__ = ["AtomOrder", "ListOrder"]
