"""Compiled steps of a neighbour-list rebuild that are not the list itself: atom data into slots, special pairs, displacement checks."""
from __future__ import annotations

import numpy as np


def gather(i0, i1, row, slot_of, varies, type_row, mass_row, inverse_row, q_row, mask_row, type_s, mass_s, inverse_s, q_s, mask_s, x, held):
    """Per-atom constants of slots i0..i1-1, the inverse of `row`, and the positions from which displacements count.

    `varies (4,)`: whether types, masses, charges, masks differ between atoms; what does not is not looked up atom by atom.
    """
    i1 = min(i1, row.shape[0])
    for i in range(i0, i1):
        r = row[i]
        if r >= 0:
            slot_of[r] = i
            type_s[i] = type_row[0]
            mass_s[i] = mass_row[0]
            inverse_s[i] = inverse_row[0]
            q_s[i] = q_row[0]
            mask_s[i] = mask_row[0]
        else:
            type_s[i] = 0
            mass_s[i] = 1.0
            inverse_s[i] = 0.0
            q_s[i] = 0.0
            mask_s[i] = 0
    if varies[0]:
        for i in range(i0, i1):
            type_s[i] = type_row[row[i]] if row[i] >= 0 else 0
    if varies[1]:
        for i in range(i0, i1):
            mass_s[i] = mass_row[row[i]] if row[i] >= 0 else 1.0
            inverse_s[i] = inverse_row[row[i]] if row[i] >= 0 else 0.0
    if varies[2]:
        for i in range(i0, i1):
            q_s[i] = q_row[row[i]] if row[i] >= 0 else 0.0
    if varies[3]:
        for i in range(i0, i1):
            mask_s[i] = mask_row[row[i]] if row[i] >= 0 else 0
    for d in range(3):
        for i in range(i0, i1):
            held[d, i] = x[d, i]


def to_slots(row, ns, start, items, types, slot_of, out, out_types, order):
    """Topology items (atom rows, sorted by their first atom) as slots, in the order of the first atom's slot: neighbours in memory too.

    `start (n+1,)`: first item of each atom row; `order`: which item each one is.
    """
    m = 0
    for i in range(ns):
        r = row[i]
        if r < 0:
            continue
        for q in range(start[r], start[r + 1]):
            for k in range(items.shape[1]):
                out[m, k] = slot_of[np.uint32(items[q, k])]
            out_types[m] = types[q]
            order[m] = q
            m += 1


def load(xr, vr, offset, x, v, row, ns, origin_shift):
    """Atom arrays (n, 3) into slots, `offset (n, 3)` subtracted if `origin_shift`."""
    for i in range(ns):
        r = row[i]
        if r >= 0:
            for d in range(3):
                x[d, i] = xr[r, d] - offset[r, d] if origin_shift else xr[r, d]
                v[d, i] = vr[r, d]


def store(x, v, f, row, ns, xr, vr, fr):
    """Slots back into atom arrays (n, 3)."""
    for i in range(ns):
        r = row[i]
        if r >= 0:
            for d in range(3):
                xr[r, d] = x[d, i]
                vr[r, d] = v[d, i]
                fr[r, d] = f[d, i]


def moved(x, held, ns):
    """Largest squared displacement since the list was built; NaN if a position is not a number."""
    m = 0.0
    for i in range(ns):
        a = x[0, i] - held[0, i]
        b = x[1, i] - held[1, i]
        c = x[2, i] - held[2, i]
        d = a * a + b * b + c * c
        m = d if not d <= m else m
        if m != m:
            return m
    return m


def displacements(x, held, ns, out):
    """Squared displacement of each slot since the list was built into `out`; returns the largest."""
    m = 0.0
    for i in range(ns):
        a = x[0, i] - held[0, i]
        b = x[1, i] - held[1, i]
        c = x[2, i] - held[2, i]
        out[i] = a * a + b * b + c * c
        m = max(m, out[i])
    return m


def add_buffers(buffers, ns):
    """Sum the threads' forces, and torques if there are any, into the first."""
    for t in range(1, buffers.shape[0]):
        for d in range(buffers.shape[1]):
            for i in range(ns):
                buffers[0, d, i] += buffers[t, d, i]


def clear(buffer, ns):
    """Zero forces (3, cap), or forces and torques (6, cap)."""
    for d in range(buffer.shape[0]):
        for i in range(ns):
            buffer[d, i] = 0.0


def closest(dx, dy, dz, reduced):
    """Whether no other image of an atom is closer than the one from which the difference goes; `reduced` are the cell vectors, reduced."""
    r2 = (dx * dx + dy * dy + dz * dz) * (1.0 - 1e-12)
    for a in range(-1, 2):
        for b in range(-1, 2):
            for c in range(-1, 2):
                ux = dx + a * reduced[0, 0] + b * reduced[1, 0] + c * reduced[2, 0]
                uy = dy + a * reduced[0, 1] + b * reduced[1, 1] + c * reduced[2, 1]
                uz = dz + a * reduced[0, 2] + b * reduced[1, 2] + c * reduced[2, 2]
                if ux * ux + uy * uy + uz * uz < r2:
                    return False
    return True


def mark_special(x, row, pair_i, pair_j, code, n, shifts, start, partner, kind, keep, reduced, reduced_inverse):
    """Write the kind of special pairs into `code`; pairs whose weights are all zero (`keep[kind]` false) leave the list.

    Returns its length. Only the closest image of a partner is special (larger images interact fully), as in LAMMPS.
    """
    m = 0
    for p in range(n):
        i = pair_i[p]
        j = pair_j[p]
        ri = row[i]
        rj = row[j]
        found = 0
        for q in range(start[ri], start[ri + 1]):
            if partner[q] == rj:
                found = kind[q]
        if found != 0:
            s = code[p] >> 2
            dx = x[0, i] - x[0, j] - shifts[s, 0]
            dy = x[1, i] - x[1, j] - shifts[s, 1]
            dz = x[2, i] - x[2, j] - shifts[s, 2]
            if not closest(dx, dy, dz, reduced):        # an ordinary neighbour
                found = 0
            if found != 0 and not keep[found]:
                continue
        pair_i[m] = i
        pair_j[m] = j
        code[m] = (code[p] & ~3) | found
        m += 1
    return m


def forbidden(ri, rj, mask_row, molecule_row, rules):
    """Whether ``neigh_modify exclude`` forbids two atoms.

    `rules (k, 3)`: kind and two group bits; kind 0 group-group, 1 same molecule in a group, 2 different molecules in a group.
    """
    mi = mask_row[ri]
    mj = mask_row[rj]
    out = False
    for k in range(rules.shape[0]):
        a = rules[k, 1]
        b = rules[k, 2]
        if rules[k, 0] == 0:
            out = out or ((mi & a) != 0 and (mj & b) != 0) or ((mi & b) != 0 and (mj & a) != 0)
        elif (mi & a) != 0 and (mj & a) != 0:
            same = molecule_row[ri] == molecule_row[rj]
            out = out or (same if rules[k, 0] == 1 else not same)
    return out


def drop_excluded(row, pair_i, pair_j, code, n, mask_row, molecule_row, rules):
    """Take out pairs that are `forbidden`; returns how many stay."""
    m = 0
    for p in range(n):
        if not forbidden(row[pair_i[p]], row[pair_j[p]], mask_row, molecule_row, rules):
            pair_i[m] = pair_i[p]
            pair_j[m] = pair_j[p]
            code[m] = code[p]
            m += 1
    return m


def special_pairs(pairs, kinds, slot_of, x, shifts, periodic_shifts, out_i, out_j, out_code):
    """Special pairs that keep a weight, as a plain list with the closest image; returns the number."""
    for p in range(pairs.shape[0]):
        i = slot_of[pairs[p, 0]]
        j = slot_of[pairs[p, 1]]
        best = 1e300
        at = 0
        for s in range(shifts.shape[0]):
            if not periodic_shifts[s]:
                continue
            dx = x[0, i] - x[0, j] - shifts[s, 0]
            dy = x[1, i] - x[1, j] - shifts[s, 1]
            dz = x[2, i] - x[2, j] - shifts[s, 2]
            d = dx * dx + dy * dy + dz * dz
            if d < best:
                best = d
                at = s
        out_i[p] = i
        out_j[p] = j
        out_code[p] = at * 4 + kinds[p]
    return pairs.shape[0]
