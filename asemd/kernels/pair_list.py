"""Pair forces over a plain list of pairs: the smallest systems, cells below the cutoff, special pairs with a weight, per-atom energies.

An entry is slot i, slot j, and a code: image (row of `shifts`) * 4 + kind, kind 0 for ordinary pairs and 1, 2, 3 for 1-2, 1-3, 1-4
partners. Strict arithmetic, differences taken directly: nothing is lost at short distances or far from the origin.

Constants of the generated module: WANTED (energies, or shares of atoms if the thread says so), CHARGED, CHECK, FACTOR, SIZED (the last of
`arrays` are the radii of the slots, which `pair_energy_one` takes as its last two arguments). From the style: `pair_energy_one(r2, qq, lj,
coul, whole, rows, constants, arrays, ti, tj)` -> force/r, E_vdwl, E_coul; for rows of atoms `furthest` (squared) and `pair_of` -> the same
(coefficients from tuple or table, as `uniform` says).
"""
from __future__ import annotations

import numpy as np

from asemd.kernels.pair_sums import add, eight, halve

ENERGY = WANTED = CHARGED = CHECK = FACTOR = SIZED = False
ROOM, AT_ONCE = 264, 64
place = np.uint64        # an index that is surely not negative: no wrap-around test, so that loops vectorise
pair_energy_one = furthest = pair_of = None


def list_forces(th, x, f, q, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays, qqr2e, acc,
                atom_energy, atom_virial, bad):
    """Pairs lo..hi-1: forces added to `f`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and `atom_virial (6, cap)`.

    `bad (4,)`: 1, the first pair whose energy is not finite, its distance. If FACTOR, `arrays` ends with a factor for each atom, by which
    the force on it is multiplied. Such forces have no energy, and those on the two atoms of a pair are not opposite; their virial is that
    of the mean force, which does not depend on where the origin is, and no atom's in particular.
    """
    for m in range(lo, hi):
        i = np.uint32(pair_i[np.uint64(m)])
        j = np.uint32(pair_j[np.uint64(m)])
        kind = np.uint32(code[np.uint64(m)] & 3)
        image = np.uint32(code[np.uint64(m)] >> 2)
        dx = x[0, i] - x[0, j] - shifts[image, 0]
        dy = x[1, i] - x[1, j] - shifts[image, 1]
        dz = x[2, i] - x[2, j] - shifts[image, 2]
        r2 = dx * dx + dy * dy + dz * dz
        ti = np.uint32(type_of[i])
        tj = np.uint32(type_of[j])
        qq = 0.0
        if CHARGED:
            qq = qqr2e * q[i] * q[j]
        if SIZED:
            fp, ev, ec = pair_energy_one(r2, qq, weight_lj[kind], weight_coul[kind], weight_coul[0], rows, constants, arrays,
                                         ti, tj, arrays[-1][i], arrays[-1][j])
        else:
            fp, ev, ec = pair_energy_one(r2, qq, weight_lj[kind], weight_coul[kind], weight_coul[0], rows, constants, arrays,
                                         ti, tj)
        if FACTOR or not WANTED:       # energies that nobody asks for: the compiler leaves them out
            ev = ec = 0.0
        if not abs(ev + ec) < np.inf or not abs(fp) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = m
                bad[2] = np.sqrt(r2)
            continue
        gx = dx * fp
        gy = dy * fp
        gz = dz * fp
        a = arrays[-1][i] if FACTOR else 1.0
        b = arrays[-1][j] if FACTOR else 1.0
        f[0, i] += a * gx
        f[1, i] += a * gy
        f[2, i] += a * gz
        f[0, j] -= b * gx
        f[1, j] -= b * gy
        f[2, j] -= b * gz
        if WANTED:
            mean = 0.5 * (a + b)
            add(acc, eight(ev, ec, dx, dy, dz, mean * gx, mean * gy, mean * gz))
        if WANTED and not FACTOR and th.level > 1:
            halve(atom_energy, atom_virial, i, j, ev + ec, dx, dy, dz, gx, gy, gz)


def row_forces(x, f, q, type_of, start, owners, neighbors, shifts, slots, p, rows, arrays, qqr2e, acc, bad, b, who):
    """`slots (2,)`, from the first one to before the second, against the atoms of their rows (entries: slot + shift code << 26; `owners`
    says whose row each is in): sparse systems, tables.

    Which pairs are in reach is hard for a processor to guess, and so is how long a row is: differences of all pairs of all rows are written
    to the work space ``b (7 * ROOM,)``, their slots to ``who (2, ROOM)``, and the place moves on for those in reach. When it is full,
    forces follow, for all at once.
    `bad (4,)` if CHECK: 1, the slots of the first pair whose energy or force is not finite as i + j << 26, its distance.
    """
    n = 0
    end = np.int64(start[slots[1]])
    for first in range(start[slots[0]], end, AT_ONCE):
        if n > ROOM - AT_ONCE:
            pairs_at_once(n, f, q, type_of, p, rows, arrays, qqr2e, acc, bad, b, who)
            n = 0
        for m in range(first, min(end, first + AT_ONCE)):
            i = np.uint32(owners[place(m)])
            entry = neighbors[place(m)]
            j = np.uint32(entry & np.int32(0x3FFFFFF))
            c = np.uint32(entry >> 26)
            dx = x[0, i] - x[0, j] - shifts[c, 0]
            dy = x[1, i] - x[1, j] - shifts[c, 1]
            dz = x[2, i] - x[2, j] - shifts[c, 2]
            r2 = dx * dx + dy * dy + dz * dz
            b[place(n)] = dx
            b[place(n + ROOM)] = dy
            b[place(n + 2 * ROOM)] = dz
            b[place(n + 3 * ROOM)] = r2
            who[0, place(n)] = i
            who[1, place(n)] = j
            n += r2 < furthest(p, rows, type_of[i], type_of[j])
    pairs_at_once(n, f, q, type_of, p, rows, arrays, qqr2e, acc, bad, b, who)


def pairs_at_once(n, f, q, type_of, p, rows, arrays, qqr2e, acc, bad, b, who):
    """The first `n` pairs of the work space of `row_forces`."""
    for k in range(n):
        i, j = np.uint32(who[0, place(k)]), np.uint32(who[1, place(k)])
        qq = qqr2e * q[i] * q[j] if CHARGED else 0.0
        fp, ev, ec = pair_of(b[place(k + 3 * ROOM)], qq, p, rows, arrays, type_of[i], type_of[j])
        b[place(k + 4 * ROOM)] = fp
        if ENERGY:
            b[place(k + 5 * ROOM)] = ev
            b[place(k + 6 * ROOM)] = ec
    for k in range(n):
        i, j = np.uint32(who[0, place(k)]), np.uint32(who[1, place(k)])
        dx, dy, dz, fp = b[place(k)], b[place(k + ROOM)], b[place(k + 2 * ROOM)], b[place(k + 4 * ROOM)]
        if CHECK:
            if not abs(fp) < np.inf or (ENERGY and not abs(b[place(k + 5 * ROOM)] + b[place(k + 6 * ROOM)]) < np.inf):
                if bad[0] == 0.0:
                    bad[0] = 1.0
                    bad[1] = np.int64(i) + np.int64(j) * 2.0**26
                    bad[2] = np.sqrt(b[place(k + 3 * ROOM)])
                continue
        gx = dx * fp
        gy = dy * fp
        gz = dz * fp
        f[0, i] += gx
        f[1, i] += gy
        f[2, i] += gz
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        if ENERGY:
            add(acc, eight(b[place(k + 5 * ROOM)], b[place(k + 6 * ROOM)], dx, dy, dz, gx, gy, gz))


def ghosts(x, ns, origin, inverse, widths, shifts, reach, out_slot, out_image, out_x):
    """Copies of atoms that stand within `reach` of the cell, for every shift but the first (which is none); returns the number or -1."""
    n = 0
    for s in range(1, shifts.shape[0]):
        for i in range(ns):
            px = x[0, i] + shifts[s, 0]
            py = x[1, i] + shifts[s, 1]
            pz = x[2, i] + shifts[s, 2]
            near = True
            for a in range(3):
                u = ((px - origin[0]) * inverse[0, a] + (py - origin[1]) * inverse[1, a] + (pz - origin[2]) * inverse[2, a]) * widths[a]
                if u < -reach or u > widths[a] + reach:
                    near = False
            if near:
                if n >= out_slot.shape[0]:
                    return -1
                out_slot[n] = i
                out_image[n] = s
                out_x[0, n] = px
                out_x[1, n] = py
                out_x[2, n] = pz
                n += 1
    return n


def pairs(x, ns, gx, g_slot, g_image, ng, opposite, cell_n, cell_low, cell_width, head, following, reach, pair_i, pair_j, code):
    """All pairs within `reach`, each once, from linked cells over atoms (0..ns-1) and their copies (ns..); returns the number or -1.

    A pair of an atom with a copy is kept for i < j, and for copies of the atom itself for the first of two opposite shifts.
    """
    n = 0
    r2 = reach * reach
    for c in range(head.shape[0]):
        head[c] = -1
    for t in range(ns + ng):
        a0 = _cell(gx[0, t], cell_low[0], cell_width[0], cell_n[0])
        a1 = _cell(gx[1, t], cell_low[1], cell_width[1], cell_n[1])
        a2 = _cell(gx[2, t], cell_low[2], cell_width[2], cell_n[2])
        c = (a0 * cell_n[1] + a1) * cell_n[2] + a2
        following[t] = head[c]
        head[c] = t
    for i in range(ns):
        a0 = _cell(x[0, i], cell_low[0], cell_width[0], cell_n[0])
        a1 = _cell(x[1, i], cell_low[1], cell_width[1], cell_n[1])
        a2 = _cell(x[2, i], cell_low[2], cell_width[2], cell_n[2])
        for b0 in range(max(a0 - 1, 0), min(a0 + 2, cell_n[0])):
            for b1 in range(max(a1 - 1, 0), min(a1 + 2, cell_n[1])):
                for b2 in range(max(a2 - 1, 0), min(a2 + 2, cell_n[2])):
                    t = head[(b0 * cell_n[1] + b1) * cell_n[2] + b2]
                    while t >= 0:
                        j = t if t < ns else g_slot[t - ns]
                        s = 0 if t < ns else g_image[t - ns]
                        if j > i or (j == i and s < opposite[s]):
                            dx = x[0, i] - gx[0, t]
                            dy = x[1, i] - gx[1, t]
                            dz = x[2, i] - gx[2, t]
                            if dx * dx + dy * dy + dz * dz < r2:
                                if n >= pair_i.shape[0]:
                                    return -1
                                pair_i[n] = i
                                pair_j[n] = j
                                code[n] = s * 4
                                n += 1
                        t = following[t]
    return n


def _cell(u, low, width, count):
    """Cell number along one axis, clamped."""
    return min(max(int((u - low) / width), 0), count - 1)
