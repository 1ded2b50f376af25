"""Neighbour lists: the cluster list for ordinary systems, a plain pair list for the smallest ones and for narrow cells."""
from __future__ import annotations

import itertools
import math
from functools import cache

import numpy as np

from asemd.errors import InputError
from asemd.kernels import cluster, cluster_rows, columns, gaps, pair_list, rebuild, relist, sieve, sort
from asemd.kernels.cluster import CLUSTER
from asemd.kernels.generate import Builder
from asemd.kernels.state import Cell
from asemd.kernels.target import vector

SMALL = 32             # below this many atoms a plain list: clusters would save some 15 microseconds a step and take 5 s more to compile
MOST_IMAGES = 10**6    # a plain list beyond these limits is a mistake in the cutoff, and would fill the memory
MOST_PAIRS = 2e9
WORTH = 0.5            # of the space: what may be left for empty stretches to be left out
APART = 2.0            # times reach: what is left of an empty stretch
SLENDER = 0.87         # width of columns in cubes that hold a cluster (dense, double precision): atoms need shorter parts of longer rows
VOID = 1.5             # times reach: an empty stretch of a column that no cluster extends over; less than what is left of one
EVERYWHERE = np.zeros((3, 0))
IMAGES = np.array(list(itertools.product((-1, 0, 1), repeat=3)), float)      # number 13 is "no shift"


SORTING = cluster.drop, cluster.arrange, cluster.append, *sieve.PIECES      # ways to do it
PIECES = columns.column, columns.stands, cluster.reached, *SORTING, gaps.squeeze
ABOUT_CELLS = *PIECES, sort.bin_atoms, sort.leave_empty, sort.assign, sort.move, columns.near_columns, cluster.build


def _builder(ortho: bool, mark: bool, order: bool, squeezed: bool) -> Builder:
    """With the functions that depend on cells."""
    b = Builder("squeezed neighbour lists" if squeezed else "neighbour lists")
    b.line("from asemd.kernels.candidates import copy8")
    for name, value in dict(CLUSTER=CLUSTER, FEW=cluster_rows.FEW, STRIP=columns.STRIP, ORTHO=ortho, MARK=mark, TRACK=False, SORTED=order,
                            SQUEEZED=squeezed, SLOT_BITS=cluster.SLOT_BITS, SIEVE=sieve.WIDE and order).items():
        b.constant(name, value)
    sorting = sieve.named(b) if sieve.WIDE and order else (cluster.drop, cluster.arrange if order else cluster.append)
    _add(b, *sorting, *(f for f in ABOUT_CELLS if f not in SORTING))
    return b


def _add(b: Builder, *functions) -> None:
    for f in functions:
        b.function(f, fast=f in (columns.near_columns, *PIECES, cluster.build, cluster_rows.rows, cluster_rows.find), inline=f in PIECES)


@cache
def kernels(ortho: bool, mark: bool = False, order: bool = True):
    """The compiled list module for axis-aligned (`ortho`) or general cells; `mark`: lists with `hide`, `order`: sorted rows, see
    `cluster.build`."""
    b = _builder(ortho, mark, order, False)
    _add(b, sort.wrap, cluster_rows.find, cluster_rows.previous, cluster_rows.exclude, cluster_rows.count, cluster_rows.expand,
         cluster_rows.rows, pair_list._cell, pair_list.ghosts, pair_list.pairs, rebuild.gather, rebuild.to_slots, rebuild.load,
         rebuild.store, rebuild.moved, rebuild.displacements, rebuild.add_buffers, rebuild.clear, rebuild.closest, rebuild.mark_special,
         rebuild.forbidden, rebuild.drop_excluded, rebuild.special_pairs, relist.split, relist.balance)
    return b.build()


@cache
def squeezed_kernels(ortho: bool, mark: bool, order: bool):
    """Those of them that depend on cells, for atoms with empty space between, see `asemd.kernels.gaps`."""
    b = _builder(ortho, mark, order, True)
    _add(b, gaps.find_gaps)
    return b.build()


def _counters() -> np.ndarray:
    """For the bits of the atoms of a cluster that reach a candidate: what counts it, (3, 256).

    Candidates are sorted by the number of the first pair of atoms in need plus the last's. The counters are fields of 16 bits, those of
    sums 0 to 3 in one number and the others in a second: ones to add to the two, and where the field stands.
    """
    table = np.zeros((3, 256), np.uint64)
    for bits in range(1, 256):
        pairs = [p for p in range(4) if (bits >> 2 * p) & 3]
        number, field = divmod(pairs[0] + pairs[-1], 4)
        table[number, bits] = 1 << 16 * field
        table[2, bits] = 16 * field
    return table


COUNTERS = _counters()


class BinCell:
    """The cell that bins cover: the periodic cell, and along other directions the extent of the atoms.

    Parameters
    ----------
    vectors (3, 3), origin (3,), inverse (3, 3), periodic (3,)
        The cell.
    extent : (2, 3)
        Smallest and largest fractional coordinates of the atoms; those along open directions count.
    """

    def __init__(self, vectors: np.ndarray, origin: np.ndarray, inverse: np.ndarray, periodic: np.ndarray, extent: np.ndarray):
        first, size = np.zeros(3), np.ones(3)
        for a, (low, high) in enumerate(extent.T.tolist()):
            if not periodic[a]:
                low, high = (low, high) if low <= high else (0.0, 1.0)
                margin = max(1e-3 * (high - low), 1e-9, 1e-6 / max(math.hypot(*vectors[a].tolist()), 1e-300))
                first[a], size[a] = low - margin, high - low + 2 * margin
        self.vectors, self.origin, self.inverse = vectors * size[:, None], origin + first @ vectors, inverse / size
        (a, b, c), (d, e, f), (g, h, i) = self.vectors.tolist()
        self.volume = abs(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))
        self.widths = 1.0 / np.sqrt((self.inverse * self.inverse).sum(axis=0))
        self.far = self.origin + (self.vectors + np.abs(self.vectors)).sum(axis=0)      # no atom is near
        self.places, self.k = EVERYWHERE, None

    def squeeze(self, state, ns: int, n: int, reach: float, ortho: bool, mark: bool, order: bool) -> None:
        """Leave out empty stretches where few atoms (`n`) are in much space, so that cells are small where the atoms are."""
        if reach == 0.0 or CLUSTER * self.volume <= n * reach * reach * reach:
            return
        k, low, high, places = squeezed_kernels(ortho, mark, order), np.empty(2 * n), np.empty(2 * n), np.empty((3, 2 * n + 2))
        k.find_gaps(state.x, state.row, ns, self.origin, self.inverse, APART * reach / self.widths, low, high, places)
        left = 1.0 / places[:, 1]
        if left.prod() < WORTH:
            self.places, self.k, self.widths, self.volume = places, k, self.widths * left, self.volume * float(left.prod())


def image_shifts(vectors: np.ndarray, periodic: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """All image shifts that may bring an atom within `reach`: vectors (m, 3), no shift first, and the index of each one's opposite."""
    widths = 1.0 / np.linalg.norm(np.linalg.inv(vectors), axis=0)
    counts = [int(min(reach / w, MOST_IMAGES)) + 1 if p else 0 for w, p in zip(widths, periodic)]
    if math.prod(2 * c + 1 for c in counts) > MOST_IMAGES:
        raise InputError(f"cutoff plus skin, {reach:g}, is {reach / widths[periodic].min():.3g} times the width of the periodic cell: "
                         f"more than {MOST_IMAGES} images of each atom are in reach; is the cutoff in the units of the scene?")
    cells = sorted(itertools.product(*(range(-c, c + 1) for c in counts)), key=lambda s: (s != (0, 0, 0), s))
    at = {s: k for k, s in enumerate(cells)}
    opposite = np.array([at[tuple(-u for u in s)] for s in cells], np.int32)
    return np.array(cells, float) @ vectors, opposite


def close_images(reduced: np.ndarray, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Images (m, 3), in numbers of the reduced cell vectors, one of which brings an atom of the cell closest to another one; and shifts.

    27 of them, more where the cell is tilted so far that its vectors are not the reduced ones.
    """
    spread = np.abs(np.rint(vectors @ np.linalg.inv(reduced))).sum(axis=0)      # a difference of positions is within one cell vector each
    ranges = [range(-int(k), int(k) + 1) for k in np.maximum(spread, 1.0)]
    images = np.array(list(itertools.product(*ranges)), float)
    return images, images @ reduced


class Rows:
    """Neighbours of single atoms, made of a cluster list.

    Attributes
    ----------
    start (nth, nslots+1), owners (nth, m), neighbors (nth, m)
        See `asemd.kernels.cluster_rows.rows`.
    edges (nth+1,), ranges
        Slots of each thread; of the first thread, of the second and so on, where they begin and end.
    """

    def __init__(self, threads: int):
        self.start, self.owners, self.neighbors = (np.zeros((threads, 0), np.int32) for _ in range(3))
        self.edges = np.zeros(threads + 1, np.int64)
        self.ranges = [self.edges[t:t + 2] for t in range(threads)]

    @property
    def entries(self) -> int:
        """Pairs in the rows."""
        return sum(int(start[end]) for start, end in zip(self.start, self.edges[1:]))


class ClusterList:
    """Half list of single atoms near clusters of `CLUSTER` consecutive atoms, built by several threads.

    Attributes
    ----------
    first (nth, ncluster+1), entries (nth, m), unshifted (ncluster,), shifts (27, 3), bounds (nth+1,)
        See `asemd.kernels.cluster`.
    hide (nth, m)
        If `marked`: bits of the atoms of its cluster that each entry is out of reach of, for lists that may be outdated and for `rows`.
    """

    def __init__(self, threads: int, reach: float, width: int = 8, marked: bool = False):
        self.threads, self.reach, self.width, self.marked = threads, reach, width, marked
        self.hide = np.zeros((threads, 1), np.uint8)
        self.capacity, self.gaps = 0, True      # whether to look for empty stretches before the next list
        self.slots = 0      # that are needed at least
        self.bounds, self.lengths = np.zeros(threads + 1, np.int64), np.zeros(threads, np.int64)
        self.ranges = [self.bounds[t:t + 2] for t in range(threads)]      # where the clusters of each thread begin and end
        self.nx = self.ny = self.nz = 0
        self.ahead = np.zeros(1, np.int64)
        self.entries = np.zeros((threads, 0), np.int32)
        self.excluded = np.zeros((threads, 64), np.int32)
        self.candidates = 2048
        self.shares = None
        self.row_length = np.zeros((threads, 1), np.int64)
        self.bins, self.n, self.cell = None, -1, None
        self._cells = self._counts = self.column_start = np.zeros(0, np.int32)

    def _grid(self) -> tuple[int, int, int]:
        """Numbers of cells along each direction that suit the bins and the number of atoms."""
        n, (wa, wb, wc) = self.n, self.bins.widths.tolist()
        share = CLUSTER / max(n, 1)
        # edge of the cube that holds one cluster; in layers and rows that are thinner than that, of the square or the line
        h = max((share * self.bins.volume) ** (1 / 3), *((share * u * v) ** 0.5 for u, v in ((wa, wb), (wb, wc), (wc, wa))),
                share * max(wa, wb, wc))
        if self.bins.k is not None:     # no column has atoms of both sides of what has been left out
            h = min(h, 0.65 * APART * self.reach)
        d = SLENDER * h if h < 0.8 * self.reach and self.width == vector(False) else h
        nx, ny = max(1, round(wa / d)), max(1, round(wb / d))
        nz = max(1, int(wc / (0.166 * h)))
        while nx * ny * nz > 16 * n + 4096:
            nx, ny, nz = max(1, nx * 3 // 4), max(1, ny * 3 // 4), max(1, nz * 3 // 4)
        return nx, ny, nz

    def shape(self, bins: BinCell, n: int, grid: tuple[int, int, int] | None = None) -> bool:
        """Choose the grid, unless it is given; True if arrays had to be made anew (their slots' arrays too)."""
        self.bins, self.n = bins, n
        self.nx, self.ny, self.nz = nx, ny, nz = grid or self._grid()
        # from an atom to the last of its neighbours in the strip, in slots; where that is most of all, they are in the caches anyway
        beyond = (int(self.reach * nx / bins.widths[0]) + 1) * min(columns.STRIP, ny) + int(self.reach * ny / bins.widths[1]) + 2
        self.ahead[0] = beyond * n // (nx * ny) if 4 * beyond < nx * ny else 0
        self.void = int(min(VOID * self.reach * nz / max(bins.widths[2], 1e-300), nz))
        count, slots = nx * ny, max(n + min(nx * ny, n) * CLUSTER + 2 * CLUSTER, self.slots)
        if len(self._cells) < count * (nz + 1):
            self._cells = np.zeros(count * (nz + 1) * 9 // 8, np.int32)
            self._counts = np.zeros(self.threads * len(self._cells), np.int32)
        if len(self.column_start) < count + 1:
            self.column_start = np.zeros((count + 1) * 9 // 8, np.int32)
        self.cell_start = self._cells[:count * (nz + 1)].reshape(count, nz + 1)
        self.counts = self._counts[:self.threads * count * nz].reshape(self.threads, count * nz)
        if self.capacity >= slots:
            return False
        self.capacity = slots + n // 32         # some atoms and columns more need no other arrays
        ncl = self.capacity // CLUSTER + 2
        self.column_of = np.zeros(ncl, np.int32)
        self.key = np.zeros(self.capacity, np.int32)
        self.x2, self.v2 = np.zeros((3, self.capacity)), np.zeros((3, self.capacity))
        self.row2 = np.zeros(self.capacity, np.int32)
        self.first = np.zeros((self.threads, ncl), np.int32)
        self.excluded_first = np.zeros((self.threads, ncl), np.int32)
        self.unshifted = np.zeros(ncl, np.bool_)
        self.own, self.span = np.zeros(ncl, np.int32), np.zeros((ncl, CLUSTER), np.int32)
        self.where = np.zeros((self.threads, self.capacity), np.int32)
        self.marks = np.zeros((self.threads, self.capacity), np.uint8)
        self._room()
        self.shares = None
        if not self.entries.shape[1]:
            # in reach of an atom: a ball, in flat cells a disc, in thin ones a rod
            thin, middle = sorted(bins.widths)[:2]
            r = self.reach
            around = min(float(n), min(4.2 * r**3, 3.2 * r * r * thin, 2.0 * r * thin * middle) * n / max(bins.volume, 1e-300))
            self.entries = np.zeros((self.threads, int(self.capacity / CLUSTER * (1.5 * around + 64) / self.threads) + 1024), np.int32)
        return True

    def _room(self) -> None:
        """Work space for the candidates of one cluster."""
        self.work = np.zeros((self.threads, 3, self.candidates))
        self.work_codes = np.zeros((self.threads, self.candidates), np.int64)
        self.earlier = np.zeros((self.threads, self.candidates + 64), np.int32)
        self.bits = np.zeros((self.threads, self.candidates + 64), np.uint8)

    def sort(self, k, state, ns: int, bins: BinCell, parallel) -> int:
        """Sort the slots; returns their number, or a negative one if there are too few: `shape` then makes more."""
        k, self.far, s = bins.k or k, bins.far + 10 * self.reach, state
        grid, copies = (self.nx, self.ny, self.nz), (self.x2, self.v2, self.row2)
        edges = [ns * t // self.threads for t in range(self.threads + 1)]
        parallel(lambda t: k.bin_atoms(s.x, s.v, s.row, *edges[t:t + 2], bins.origin, bins.inverse, *grid, *copies, self.counts[t],
                                       self.key, bins.places))
        found = k.assign(self.counts, s.x, s.v, s.row, ns, *grid, *copies, self.cell_start, self.column_start, self.column_of, self.far,
                         4 * self.reach, self.void)
        if found >= 0:
            parallel(lambda t: k.move(*edges[t:t + 2], *copies, self.key, self.counts[t], s.x, s.v, s.row))
        self.slots = max(self.slots, -found * 17 // 16)
        return found

    def see(self, cell: Cell, periodic: np.ndarray) -> None:
        """Take the images of a cell, unless they are known."""
        if cell is not self.cell:
            self.cell, widths2 = cell, 1.0 / (np.linalg.inv(cell.vectors)[:, periodic] ** 2).sum(axis=0)
            self.near = cell.reduced * periodic[:, None], bool((widths2 < 4.0 * self.reach**2).any())
            self.shifts = IMAGES @ cell.vectors
            self.shifts4 = np.column_stack([self.shifts, np.zeros(len(self.shifts))])

    def build(self, k, state, ns: int, cell: Cell, periodic: np.ndarray, partners, slot_of, parallel) -> None:
        """Build the list and its exclusions in the sorted slots."""
        ncl, self.parallel = ns // CLUSTER, parallel
        self.see(cell, periodic)
        again, cells = self.shares is None and self.threads > 1, self.bins.k or k
        while True:
            if self.marked and self.hide.shape[1] < self.entries.shape[1]:
                self.hide = np.zeros(self.entries.shape, np.uint8)
            shares = self.shares if self.shares is not None else np.arange(self.threads + 1) / self.threads
            k.split(shares, self.bounds, ncl)
            results = [0] * self.threads

            def work(t, results=results):
                c0, c1 = int(self.bounds[t]), int(self.bounds[t + 1])
                results[t] = cells.build(state.x, state.row, self.cell_start, self.column_start, self.column_of, self.bins.origin,
                                     self.bins.inverse, self.bins.widths, periodic, self.shifts, self.nx, self.ny, self.nz, self.reach,
                                     c0, c1, self.first[t], self.entries[t], self.own, self.span, self.unshifted, self.work[t],
                                     self.work_codes[t], self.width, ns, self.row_length[t], COUNTERS, self.hide[t], self.bins.places)
                if results[t] >= 0 and partners is not None:
                    done = k.exclude(slot_of, state.row, partners[0], partners[1], c0, c1, self.first[t], self.entries[t], self.own,
                                     self.excluded_first[t], self.excluded[t], self.where[t], self.earlier[t], state.x, self.shifts,
                                     *self.near)
                    results[t] = -3 if done < 0 else results[t]
            parallel(work)
            if -1 in results:
                self.entries = np.zeros((self.threads, int(self.entries.shape[1] * 1.5) + 1024), np.int32)
            elif -2 in results:
                self.candidates *= 2
                self._room()
            elif -4 in results:
                raise InputError(f"more than 65,000 atoms within cutoff plus skin, {self.reach:g}, of a group of {CLUSTER} neighbours: "
                                 "is the cutoff in the units of the scene?")
            elif -3 in results:
                self.excluded = np.zeros((self.threads, 2 * self.excluded.shape[1]), np.int32)
            else:
                self.lengths[:], self.shares = results, shares
                k.balance(shares, self.bounds, self.lengths)
                if not again:
                    return
                again = False

    def fill(self, rows: Rows, k, state, ns: int, slot_of, partners, rules, parallel) -> None:
        """The list as rows of single atoms without the special pairs.

        `partners` and `rules` are what `asemd.exclusions.Exclusions` says, as arrays.
        """
        rows.edges[:] = CLUSTER * self.bounds
        if rows.start.shape[1] <= state.x.shape[1]:      # lists that the time loop builds may have more slots than this one
            rows.start = np.zeros((self.threads, state.x.shape[1] + 1), np.int32)
        results = [0] * self.threads

        def work(t):
            c0, c1 = int(self.bounds[t]), int(self.bounds[t + 1])
            results[t] = k.rows(state.row, slot_of, self.first[t], self.entries[t], self.hide[t], self.own, c0, c1, *partners, *rules,
                                self.marks[t], self.bits[t], rows.start[t], rows.owners[t], rows.neighbors[t])
        while True:
            parallel(work)
            if -1 not in results:
                return
            rows.owners, rows.neighbors = np.zeros((2, self.threads, 2 * rows.neighbors.shape[1] + 16 * ns), np.int32)

    def longest(self) -> int:
        """Most neighbours of one cluster."""
        return int(self.row_length.max())

    def count(self, k, state, held: np.ndarray, partners) -> int:
        """Pairs in the list, without the special ones `partners` (start, partner) that are left out."""
        return sum(int(k.count(held, state.row, self.first[t], self.entries[t], int(self.bounds[t]), int(self.bounds[t + 1]), self.shifts,
                               self.reach**2, *partners, *self.near)) for t in range(self.threads))

    def expand(self, k, state, reach: float):
        """The same pairs as plain arrays (i, j, code), closer than `reach`."""
        parts = [[]] * self.threads

        def work(t):
            n, size, edges = -1, 2 * int(self.first[t, self.bounds[t + 1]]) + 512, self.bounds[t:t + 2]
            while n < 0:
                size *= 2
                out = [np.empty(size, np.int32) for _ in range(3)]
                n = k.expand(state.x, state.row, self.first[t], self.entries[t], *edges, self.shifts, reach * reach, *out)
            parts[t] = [a[:n] for a in out]
        self.parallel(work)
        return [np.concatenate([p[a] for p in parts]) for a in range(3)] if self.threads > 1 else parts[0]


class PlainList:
    """All pairs within reach, each with its image, found in linked cells over atoms and copies. Any cell, any size."""

    def __init__(self, reach: float):
        self.reach = reach
        self.size, self.copies = 1024, 1024

    def build(self, k, state, ns: int, bins: BinCell, cell_vectors: np.ndarray, periodic: np.ndarray):
        """Returns (pair_i, pair_j, code) and keeps `shifts (m, 3)` and `opposite (m,)`, the image the other way."""
        self.shifts, self.opposite = image_shifts(cell_vectors, periodic, self.reach)
        pairs = 2.1 * self.reach**3 * ns**2 / abs(np.linalg.det(cell_vectors)) if periodic.all() else 0.0
        if pairs > MOST_PAIRS:
            raise InputError(f"cutoff plus skin, {self.reach:g}: about {pairs:.2g} pairs of atoms are in reach, too many to list")
        while True:
            slot, image = np.empty(self.copies, np.int32), np.empty(self.copies, np.int32)
            copies = np.empty((3, self.copies))
            ng = k.ghosts(state.x, ns, bins.origin, bins.inverse, bins.widths, self.shifts, self.reach, slot, image, copies)
            if ng >= 0:
                break
            self.copies *= 2
        everything = np.concatenate([state.x[:, :ns], copies[:, :ng]], axis=1)
        low = everything.min(axis=1) if ns else np.zeros(3)
        span = everything.max(axis=1) - low if ns else np.zeros(3)
        counts = np.maximum(1, np.minimum((span / self.reach).astype(np.int64), 64))
        width = np.maximum(span / counts, self.reach)
        head, following = np.empty(int(counts.prod()), np.int32), np.empty(ns + ng, np.int32)
        while True:
            out = [np.empty(self.size, np.int32) for _ in range(3)]
            n = k.pairs(state.x, ns, everything, slot, image, ng, self.opposite, counts, low, width, head, following, self.reach, *out)
            if n >= 0:
                return [a[:n] for a in out]
            self.size *= 2
