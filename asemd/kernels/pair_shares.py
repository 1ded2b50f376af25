"""Each atom's share of the energy and the virial of pairs: half of each pair, over the cluster list and over rows of single atoms.

The walk over clusters is that of `asemd.kernels.pair_cluster`, see there; instead of forces it gathers shares, in rows of the buffer from
SHARE on: xx yy zz, the energy, xy xz yz. Which of them, ENERGIES and VIRIALS say. They end in two tables of slots, `front (cap, 4)` (xx yy
zz energy; without VIRIALS the energy first) and `back (cap, 4)` (xy xz yz).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.fuse import madd
from asemd.kernels.gather import gather8, scatter8, take8

CLUSTER = 8
ROW = 1048
WIDTH = 8
NROWS = 0
SHARE = 7
CHARGE_ROW = 0
ENERGIES = VIRIALS = CHARGED = VARYING = False
EXCLUDE = OUTDATED = HIDE = True
SLOT_BITS = 0x3FFFFFF
real = np.float64
place = np.uint64
pair_energy = fill_rows = shares_hidden = furthest = pair_of = None


def shares_two(b, o, n, xa, ya, za, qa, xb, yb, zb, qb, p, hide, h, a0):
    """Two atoms a, b against `n` packed ones from place `o` on, as ``inner_two``: shares of a and of b, seven numbers each."""
    if HIDE:
        bit_a = np.uint8(1 << a0)
        bit_b = np.uint8(2 << a0)
    meet_a = meet_b = True
    zero = real(0)
    a1, a2, a3, a4, a5, a6, a7 = zero, zero, zero, zero, zero, zero, zero
    b1, b2, b3, b4, b5, b6, b7 = zero, zero, zero, zero, zero, zero, zero
    for m in range(n):
        k = o + m
        xk = b[place(k)]
        yk = b[place(k + ROW)]
        zk = b[place(k + 2 * ROW)]
        dxa = xa - xk
        dya = ya - yk
        dza = za - zk
        dxb = xb - xk
        dyb = yb - yk
        dzb = zb - zk
        ra = madd(dxa, dxa, madd(dya, dya, dza * dza))
        rb = madd(dxb, dxb, madd(dyb, dyb, dzb * dzb))
        if HIDE:
            hidden = hide[place(h + k)]
            meet_a = (hidden & bit_a) == 0
            meet_b = (hidden & bit_b) == 0
        inverse = real(1) / (ra * rb)     # one division for two pairs
        if CHARGED:
            qk = b[place(k + 6 * ROW)]
            qka = qa * qk
            qkb = qb * qk
        else:
            qka = zero
            qkb = zero
        ia = inverse * rb
        ib = inverse * ra
        pa, eva, eca = pair_energy(ra, ia, math.sqrt(ia), qka, p, b, k + 7 * ROW, meet_a)
        pb, evb, ecb = pair_energy(rb, ib, math.sqrt(ib), qkb, p, b, k + (7 + NROWS) * ROW, meet_b)
        if VIRIALS:
            fa = dxa * pa
            fb = dxb * pb
            s = dxa * fa
            t = dxb * fb
            a1 += s
            b1 += t
            b[place(k + SHARE * ROW)] += s + t
            s = dya * fa
            t = dyb * fb
            a5 += s
            b5 += t
            b[place(k + (SHARE + 4) * ROW)] += s + t
            s = dza * fa
            t = dzb * fb
            a6 += s
            b6 += t
            b[place(k + (SHARE + 5) * ROW)] += s + t
            fa = dya * pa
            fb = dyb * pb
            s = dya * fa
            t = dyb * fb
            a2 += s
            b2 += t
            b[place(k + (SHARE + 1) * ROW)] += s + t
            s = dza * fa
            t = dzb * fb
            a7 += s
            b7 += t
            b[place(k + (SHARE + 6) * ROW)] += s + t
            s = dza * dza * pa
            t = dzb * dzb * pb
            a3 += s
            b3 += t
            b[place(k + (SHARE + 2) * ROW)] += s + t
        if ENERGIES:
            s = eva + eca
            t = evb + ecb
            a4 += s
            b4 += t
            b[place(k + (SHARE + 3) * ROW)] += s + t
    return (a1, a2, a3, a4, a5, a6, a7), (b1, b2, b3, b4, b5, b6, b7)


def share_pair(b, k, x, y, z, qi, p, rows):
    """One atom against place `k` of the buffer: the shares of the atom; those of the other one are the same and go into the buffer."""
    dx = x - b[place(k)]
    dy = y - b[place(k + ROW)]
    dz = z - b[place(k + 2 * ROW)]
    r2 = dx * dx + dy * dy + dz * dz
    qq = qi * b[place(k + 6 * ROW)] if CHARGED else real(0)
    fp, ev, ec = pair_energy(r2, real(1) / r2, real(1) / math.sqrt(r2), qq, p, b, k + rows, True)
    fx, fy, fz = dx * fp, dy * fp, dz * fp
    one = dx * fx, dy * fy, dz * fz, ev + ec, dx * fy, dx * fz, dy * fz
    give(b, k, one)
    return one


def both(u, v):
    return u[0] + v[0], u[1] + v[1], u[2] + v[2], u[3] + v[3], u[4] + v[4], u[5] + v[5], u[6] + v[6]


def give(b, k, one):
    """Shares of the atom at place `k`."""
    if VIRIALS:
        b[place(k + SHARE * ROW)] += one[0]
        b[place(k + (SHARE + 1) * ROW)] += one[1]
        b[place(k + (SHARE + 2) * ROW)] += one[2]
        b[place(k + (SHARE + 4) * ROW)] += one[4]
        b[place(k + (SHARE + 5) * ROW)] += one[5]
        b[place(k + (SHARE + 6) * ROW)] += one[6]
    if ENERGIES:
        b[place(k + (SHARE + 3) * ROW)] += one[3]


def cluster_shares(x, q, type_of, first, entries, own, span, unshifted, shifts, excluded_first, excluded, c0, c1, p, rows, far_, qqr2e, b,
                   types, saved, near, hide, skin, moved, farthest, front, back):
    """Shares of clusters c0..c1-1, twice as large as they are, added to `front` and `back`; arguments as of ``cluster_forces``."""
    far = real(far_)
    late = False
    for k in range(0, x.shape[1], 8):
        take8(near, k, x, q)
    if OUTDATED:
        rest = 0.999999 * skin - math.sqrt(farthest[0])
    done = real(2) * far
    for ci in range(c0, c1):
        s = ci * CLUSTER
        ox = x[0, s]
        oy = x[1, s]
        oz = x[2, s]
        f0 = np.int64(first[ci])
        full = ((np.int64(first[ci + 1]) - f0) // WIDTH) * WIDTH
        mine = np.int64(own[ci])
        if unshifted[ci]:
            for k in range(0, full, 8):
                gather8(b, k, ROW, near, entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, False, CHARGE_ROW)
        else:
            for k in range(0, full, 8):
                gather8(b, k, ROW, near, entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, True, CHARGE_ROW)
        if VIRIALS:
            for c in range(7):
                for k in range(full):
                    b[place(k + (SHARE + c) * ROW)] = real(0)
        else:
            for k in range(full):
                b[place(k + (SHARE + 3) * ROW)] = real(0)
        if VARYING:
            for k in range(full):
                types[k] = type_of[np.uint32(entries[place(f0 + k)] & np.int32(SLOT_BITS))]
            last0 = np.uint32(1 << 30)
            last1 = np.uint32(1 << 30)
        if EXCLUDE:
            xp = excluded_first[ci]
            xe = excluded_first[ci + 1]
        for a0 in range(0, CLUSTER, 2):
            base = np.int64(span[ci, a0])
            count = np.int64(span[ci, a0 + 1]) - base
            xa, ya, za = b[place(mine + a0)], b[place(mine + a0 + ROW)], b[place(mine + a0 + 2 * ROW)]
            xb, yb, zb = b[place(mine + a0 + 1)], b[place(mine + a0 + 1 + ROW)], b[place(mine + a0 + 1 + 2 * ROW)]
            if OUTDATED:
                late = rest <= 0.0 or max(moved[place(s + a0)], moved[place(s + a0 + 1)]) > rest * rest
            qa = real(0)
            qb = real(0)
            if CHARGED:
                qa = b[place(mine + a0 + 6 * ROW)] * real(qqr2e)
                qb = b[place(mine + a0 + 1 + 6 * ROW)] * real(qqr2e)
            if VARYING:
                t0 = types[place(mine + a0)]
                t1 = types[place(mine + a0 + 1)]
                if t0 != last0:
                    last0 = t0
                    fill_rows(b, full, rows, t0, types, 7 * ROW)
                if t1 != last1:
                    last1 = t1
                    fill_rows(b, full, rows, t1, types, (7 + NROWS) * ROW)
            b[place(mine + a0)] = done
            b[place(mine + a0 + 1)] = done
            together = True
            if EXCLUDE:
                x0 = xp
                while xp < xe and (excluded[xp] >> 16) <= a0 + 1:
                    k = np.uint32(excluded[xp] & np.int32(0xFFFF))
                    saved[xp - x0] = b[k]
                    b[k] = far
                    xp += 1
            if OUTDATED and late:
                of_a, of_b = shares_hidden(b, base, count, xa, ya, za, qa, xb, yb, zb, qb, p, hide, f0, a0)
            else:
                of_a, of_b = shares_two(b, base, count, xa, ya, za, qa, xb, yb, zb, qb, p, hide, f0, a0)
            if EXCLUDE:
                for y in range(xp - 1, x0 - 1, -1):
                    b[np.uint32(excluded[y] & np.int32(0xFFFF))] = saved[y - x0]
                for y in range(x0, xp):
                    k = np.int64(excluded[y] & np.int32(0xFFFF))
                    if k == mine + a0 + 1:
                        together = False
                        continue
                    twin = False
                    for z in range(x0, xp):
                        twin = twin or (z != y and (excluded[z] & np.int32(0xFFFF)) == k)
                    if twin:
                        continue
                    if OUTDATED and late:
                        if (hide[place(f0 + k)] >> (a0 + ((excluded[y] >> 16) == a0))) & 1:
                            continue
                    if (excluded[y] >> 16) == a0:
                        of_b = both(of_b, share_pair(b, k, xb, yb, zb, qb, p, (7 + NROWS) * ROW))
                    else:
                        of_a = both(of_a, share_pair(b, k, xa, ya, za, qa, p, 7 * ROW))
            if OUTDATED and late:
                together = together and ((hide[place(f0 + mine + a0 + 1)] >> a0) & 1) == 0
            if together:
                b[place(mine + a0 + 1)] = xb
                of_a = both(of_a, share_pair(b, mine + a0 + 1, xa, ya, za, qa, p, 7 * ROW))
                b[place(mine + a0 + 1)] = done
            give(b, mine + a0, of_a)
            give(b, mine + a0 + 1, of_b)
        if VIRIALS:
            for k in range(0, full, 8):
                scatter8(b, k + SHARE * ROW, ROW, front, entries, f0 + k, SLOT_BITS, 4)
                scatter8(b, k + (SHARE + 4) * ROW, ROW, back, entries, f0 + k, SLOT_BITS, 3)
        else:
            for k in range(0, full, 8):
                scatter8(b, k + (SHARE + 3) * ROW, ROW, front, entries, f0 + k, SLOT_BITS, 1)


def row_shares(x, q, type_of, start, neighbors, shifts, lo, hi, p, rows, arrays, qqr2e, front, back):
    """Shares of slots lo..hi-1 and the atoms of their rows, twice as large as they are, added to `front` and `back`; arguments as of
    ``row_forces``."""
    for i in range(lo, hi):
        ti = type_of[i]
        for m in range(start[i], start[i + 1]):
            entry = neighbors[np.uint64(m)]
            j = np.uint32(entry & np.int32(0x3FFFFFF))
            c = np.uint32(entry >> 26)
            dx = x[0, i] - x[0, j] - shifts[c, 0]
            dy = x[1, i] - x[1, j] - shifts[c, 1]
            dz = x[2, i] - x[2, j] - shifts[c, 2]
            r2 = dx * dx + dy * dy + dz * dz
            if r2 < furthest(p, rows, ti, type_of[j]):
                qq = qqr2e * q[i] * q[j] if CHARGED else 0.0
                fp, ev, ec = pair_of(r2, qq, p, rows, arrays, ti, type_of[j])
                for s in (i, np.int64(j)):
                    front[s, 0] += dx * dx * fp
                    front[s, 1] += dy * dy * fp
                    front[s, 2] += dz * dz * fp
                    front[s, 3] += ev + ec
                    back[s, 0] += dx * dy * fp
                    back[s, 1] += dx * dz * fp
                    back[s, 2] += dy * dz * fp
