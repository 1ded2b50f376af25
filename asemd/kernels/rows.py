"""Between slots and atom rows: shares that kernels gathered, added up over threads and set to zero for the next time; members of groups."""
from __future__ import annotations

import numpy as np

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def of_slots(slot_of, values, out):
    """Vectors ``(3, slots)`` of atoms as `out (n, 3)`."""
    for r in range(len(slot_of)):
        s = np.uint64(slot_of[r])
        out[r, 0], out[r, 1], out[r, 2] = values[0, s], values[1, s], values[2, s]


@njit(cache=True, nogil=True)
def of_rows(values, rows, out):
    """Some rows of `values (n, 3)` as `out (3, at least as many)`."""
    for i in range(len(rows)):
        r, to = np.uint64(rows[i]), np.uint64(i)
        out[0, to], out[1, to], out[2, to] = values[r, 0], values[r, 1], values[r, 2]


@njit(cache=True, nogil=True)
def of_ids(there, ids, table, rows):
    """`rows` of `ids` among the ids `there`, -1 for those that are not; returns how many are. `table` has -1 for each id there may be."""
    found = 0
    for r in range(len(there)):
        table[np.uint64(there[r])] = r
    for k in range(len(ids)):
        rows[k] = table[np.uint64(ids[k])]
        found += rows[k] >= 0
    return found


@njit(cache=True, nogil=True)
def of_items(x, atoms, out):
    """Positions ``x (n, 3)`` of the atoms of items ``atoms (m, k)``, one item after the other, as `out (3, m k)`."""
    k = atoms.shape[1]
    for i in range(len(atoms)):
        for j in range(k):
            r, to = np.uint64(atoms[i, j]), np.uint64(i * k + j)
            out[0, to], out[1, to], out[2, to] = x[r, 0], x[r, 1], x[r, 2]


@njit(cache=True, nogil=True)
def span(x, row, ns, origin, inverse, out):
    """Smallest and largest fractional coordinates of atoms ``x (3, slots)`` into `out (2, 3)`."""
    for a in range(3):
        i0, i1, i2 = inverse[0, a], inverse[1, a], inverse[2, a]
        low, high = np.inf, -np.inf
        for i in range(ns):
            if row[i] >= 0:
                s = (x[0, i] - origin[0]) * i0 + (x[1, i] - origin[1]) * i1 + (x[2, i] - origin[2]) * i2
                low, high = min(low, s), max(high, s)
        out[0, a], out[1, a] = low, high


def extent(x: np.ndarray, row: np.ndarray, ns: int, origin: np.ndarray, inverse: np.ndarray) -> np.ndarray:
    """Smallest and largest fractional coordinates (2, 3) of atoms ``x (3, slots)``."""
    out = np.empty((2, 3))
    span(x, row, ns, origin, inverse, out)
    return out


@njit(cache=True, nogil=True)
def of_tables(slot_of, front, back, scale, column, virials, energy, virial):
    """Add `scale` times tables ``(threads, slots, 4)``, xx yy zz and xy xz yz, to `virial (n, 6)`, by atom row, and that column of the
    first one to `energy (n,)`, unless it is below 0."""
    for t in range(front.shape[0]):
        for r in range(len(slot_of)):
            s = np.uint64(slot_of[r])
            if column >= 0:
                energy[r] += scale * front[t, s, column]
            if virials:
                for c in range(3):
                    virial[r, c] += scale * front[t, s, c]
                    virial[r, 3 + c] += scale * back[t, s, c]
                    back[t, s, c] = 0.0
            for c in range(4):
                front[t, s, c] = 0.0


@njit(cache=True, nogil=True)
def of_columns(slot_of, atom_energy, atom_virial, scale, energy, virial):
    """Add `scale` times ``atom_energy (threads, slots)`` and ``atom_virial (threads, 6, slots)`` to `energy (n,)` and `virial (n, 6)`, by
    atom row; to those of them that are not empty."""
    for t in range(atom_energy.shape[0]):
        for r in range(len(slot_of)):
            s = np.uint64(slot_of[r])
            if len(energy):
                energy[r] += scale * atom_energy[t, s]
            atom_energy[t, s] = 0.0
            for c in range(6):
                if len(virial):
                    virial[r, c] += scale * atom_virial[t, c, s]
                atom_virial[t, c, s] = 0.0


@njit(cache=True, nogil=True)
def regroup(row, chosen, parent, bit, mask_row, slot_mask, members):
    """A group has other members: those of `parent (n,)` whose slot is `chosen (slots,)`. Sets its bit by row and by slot, and `members`.

    Returns whether not all atoms have the same bits.
    """
    for i in range(len(chosen)):
        r = row[i]
        if r >= 0:
            members[r] = chosen[i] and parent[r]
            mask_row[r] = mask_row[r] | bit if members[r] else mask_row[r] & ~bit
            slot_mask[i] = mask_row[r]
    for r in range(len(mask_row)):
        if mask_row[r] != mask_row[0]:
            return True
    return False
