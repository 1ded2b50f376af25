"""A list build inside the compiled time loop: what `asemd.engine.Engine.rebuild` does, by all threads of the loop together.

Arrays do not grow here and no error is raised: where something is out of the ordinary, `live` says so and Python makes the list
(`docs/decisions/0015-lists-built-in-the-loop.md`). EXCLUDE and ROWS are constants of the generated module: special pairs are left out of
the cluster list; rows of single atoms are made of it.
"""
from __future__ import annotations

from functools import cache
from types import ModuleType
from typing import NamedTuple

import numpy as np

from asemd.kernels.cluster import CLUSTER
from asemd.kernels.generate import Builder, plain_source
from asemd.kernels.hooks import INNER
from asemd.kernels.threads import barrier

NS, WANTED, FINE = range(3)     # places in `live`: slots in use, whether the loop is to build a list, whether all went well
EXCLUDE = ROWS = True
wrap = bin_atoms = assign = move = gather = build = exclude = rows = to_slots = special_pairs = None


class Atoms(NamedTuple):
    """Data of atoms by slot and by row, as `asemd.kernels.rebuild.gather` takes them."""

    x: np.ndarray
    v: np.ndarray
    image: np.ndarray
    row: np.ndarray
    slot_of: np.ndarray
    varies: np.ndarray
    type_row: np.ndarray
    mass_row: np.ndarray
    inverse_row: np.ndarray
    q_row: np.ndarray
    mask_row: np.ndarray
    type: np.ndarray
    mass: np.ndarray
    inverse_mass: np.ndarray
    q: np.ndarray
    mask: np.ndarray
    held: np.ndarray
    moved: np.ndarray


class Space(NamedTuple):
    """The cell, the bins that cover it, and image shifts."""

    origin: np.ndarray
    vectors: np.ndarray
    inverse: np.ndarray
    periodic: np.ndarray
    bin_origin: np.ndarray
    bin_inverse: np.ndarray
    bin_widths: np.ndarray
    far: np.ndarray
    places: np.ndarray
    shifts: np.ndarray
    reduced: np.ndarray
    nx: int
    ny: int
    nz: int
    void: int
    width: int
    close: int
    reach: float


class Arrays(NamedTuple):
    """The list and its work space, see `asemd.neighbor.ClusterList`."""

    x2: np.ndarray
    v2: np.ndarray
    row2: np.ndarray
    counts: np.ndarray
    cell_start: np.ndarray
    column_start: np.ndarray
    column_of: np.ndarray
    key: np.ndarray
    first: np.ndarray
    entries: np.ndarray
    own: np.ndarray
    span: np.ndarray
    unshifted: np.ndarray
    work: np.ndarray
    codes: np.ndarray
    longest: np.ndarray
    hide: np.ndarray
    excluded_first: np.ndarray
    excluded: np.ndarray
    where: np.ndarray
    earlier: np.ndarray
    marks: np.ndarray
    bits: np.ndarray
    sorting: np.ndarray
    bounds: np.ndarray
    shares: np.ndarray
    lengths: np.ndarray


class Special(NamedTuple):
    """Pairs that are left out, and the rows of atoms, see `asemd.kernels.cluster_rows.rows`."""

    partner_start: np.ndarray
    partners: np.ndarray
    mask_row: np.ndarray
    molecule_row: np.ndarray
    rules: np.ndarray
    start: np.ndarray
    owners: np.ndarray
    neighbors: np.ndarray
    edges: np.ndarray


def split(shares, bounds, clusters):
    """`bounds (nth+1,)`: the first of so many clusters for each thread."""
    for t in range(bounds.shape[0]):
        bounds[t] = np.int64(np.rint(shares[t] * clusters))


def balance(shares, bounds, lengths):
    """`shares (nth+1,)` of the clusters for the next build, so that each thread gets as many entries; of this one `lengths (nth,)`."""
    nth, clusters = lengths.shape[0], max(bounds[-1], 1)
    if nth == 1:
        return
    # an entry costs about as much as the own-cluster work of a sixteenth of a cluster
    whole = 0.0
    for t in range(nth):
        whole += lengths[t] + 16.0 * (bounds[t + 1] - bounds[t])
    k, before, here = 0, 0.0, lengths[0] + 16.0 * (bounds[1] - bounds[0])
    for t in range(1, nth):         # thread k's part holds what the new thread t begins with
        wanted = whole * t / nth
        while k < nth - 1 and before + here < wanted:
            before += here
            k += 1
            here = lengths[k] + 16.0 * (bounds[k + 1] - bounds[k])
        inside = (wanted - before) / here if here > 0.0 else 0.0
        shares[t] = (bounds[k] + inside * (bounds[k + 1] - bounds[k])) / clusters
    shares[0], shares[nth] = 0.0, bounds[nth] / clusters


def relist(th, live, a, g, c, p):
    """Wrap, sort and list, as `live (3,)` says for how many slots; all threads call it, and it is done after their next barrier."""
    t, before = th.tid, live[NS]
    i0, i1 = before * t // th.nth, before * (t + 1) // th.nth
    th.scratch[t, 2] = wrap(a.x, a.image, a.row, i0, i1, g.origin, g.vectors, g.inverse, g.periodic)
    if th.scratch[t, 2] < 0.0:
        bin_atoms(a.x, a.v, a.row, i0, i1, g.bin_origin, g.bin_inverse, g.nx, g.ny, g.nz, c.x2, c.v2, c.row2, c.counts[t], c.key, g.places)
    barrier(th)
    if t == 0:
        live[FINE] = 1
        for k in range(th.nth):
            if th.scratch[k, 2] >= 0.0:
                live[FINE] = 0
        if live[FINE] != 0:
            found = assign(c.counts, a.x, a.v, a.row, before, g.nx, g.ny, g.nz, c.x2, c.v2, c.row2, c.cell_start, c.column_start,
                           c.column_of, g.far, 4.0 * g.reach, g.void)
            live[FINE] = found >= 0
        if live[FINE] != 0:
            live[NS] = found
            split(c.shares, c.bounds, found // CLUSTER)
    barrier(th)
    if live[FINE] == 0:
        return
    move(i0, i1, c.x2, c.v2, c.row2, c.key, c.counts[t], a.x, a.v, a.row)
    barrier(th)
    c0, c1 = c.bounds[t], c.bounds[t + 1]
    gather(CLUSTER * c0, CLUSTER * (c1 + 1 if t == th.nth - 1 else c1), a.row, a.slot_of, a.varies, a.type_row, a.mass_row, a.inverse_row,
           a.q_row, a.mask_row, a.type, a.mass, a.inverse_mass, a.q, a.mask, a.x, a.held)
    barrier(th)
    c.lengths[t] = build(a.x, a.row, c.cell_start, c.column_start, c.column_of, g.bin_origin, g.bin_inverse, g.bin_widths, g.periodic,
                         g.shifts, g.nx, g.ny, g.nz, g.reach, c0, c1, c.first[t], c.entries[t], c.own, c.span, c.unshifted, c.work[t],
                         c.codes[t], g.width, live[NS], c.longest[t], c.sorting, c.hide[t], g.places)
    done = c.lengths[t]
    if EXCLUDE:
        if done >= 0:
            done = exclude(a.slot_of, a.row, p.partner_start, p.partners, c0, c1, c.first[t], c.entries[t], c.own, c.excluded_first[t],
                           c.excluded[t], c.where[t], c.earlier[t], a.x, g.shifts, g.reduced, g.close != 0)
    if ROWS:
        if done >= 0:
            done = rows(a.row, a.slot_of, c.first[t], c.entries[t], c.hide[t], c.own, c0, c1, p.partner_start, p.partners, p.mask_row,
                        p.molecule_row, p.rules, c.marks[t], c.bits[t], p.start[t], p.owners[t], p.neighbors[t])
    for i in range(CLUSTER * c0, CLUSTER * c1):
        a.moved[np.uint64(i)] = 0.0
    th.scratch[t, 2] = done
    barrier(th)
    if t == 0:
        for k in range(th.nth):
            if th.scratch[k, 2] < 0.0:
                live[FINE] = 0
        if ROWS:
            for k in range(th.nth + 1):
                p.edges[k] = CLUSTER * c.bounds[k]
        if live[FINE] != 0:
            balance(c.shares, c.bounds, c.lengths)


def place_items(live, row, start, items, types, slot_of, out, out_types, order):
    """`asemd.kernels.rebuild.to_slots` for a list built in the loop."""
    to_slots(row, live[NS], start, items, types, slot_of, out, out_types, order)


def place_pairs(live, pairs, kinds, slot_of, x, shifts, periodic_shifts, out_i, out_j, out_code):
    """`asemd.kernels.rebuild.special_pairs` for a list built in the loop."""
    special_pairs(pairs, kinds, slot_of, x, shifts, periodic_shifts, out_i, out_j, out_code)


def look_at_rows(live, longest, most):
    """Python is needed where a row of the cluster list is longer than the buffers of a term."""
    for t in range(longest.shape[0]):
        if longest[t, 0] > most:
            live[FINE] = 0


def look_at_pairs(live, bounds, first, most):
    """Python is needed where the pairs of a thread's clusters might not fit into the arrays of `asemd.embedded_term`."""
    for t in range(first.shape[0]):
        if 8 * first[t, bounds[t + 1]] + 64 * (bounds[t + 1] - bounds[t]) > most:
            live[FINE] = 0


def place_classes(live, type_s, class_of_type, class_of):
    """The class of each slot's type."""
    for i in range(class_of.shape[0]):
        class_of[i] = class_of_type[type_s[i]]


@cache
def module(lists: ModuleType, excludes: bool, has_rows: bool) -> ModuleType:
    """The compiled functions; `lists` are those of `asemd.neighbor.kernels`."""
    b = Builder("list build inside the loop")
    b.line("from asemd.kernels.threads import barrier")
    for name in ("wrap", "bin_atoms", "assign", "move", "gather", "build", "exclude", "rows", "to_slots", "special_pairs", "split",
                 "balance"):
        b.use(lists, name)
    for name, value in dict(CLUSTER=CLUSTER, NS=NS, FINE=FINE, EXCLUDE=excludes, ROWS=has_rows).items():
        b.constant(name, value)
    for function in (relist, place_items, place_pairs, look_at_rows, look_at_pairs, place_classes):
        b.text(plain_source(function, constants=b.constants), INNER)
    return b.build()
