"""Pair forces over the cluster list: the hot loop.

For each cluster the neighbours are packed, relative to the cluster's first atom, into one flat buffer whose rows are `ROW` apart (a
constant, so that the compiler sees no aliasing): x y z, force x y z, charge, and with ROOT of two atoms i squares of distances and their
inverse roots. Coefficients stand in a second buffer, in the same order: NROWS rows for each of up to SETS types of the atoms i of the
cluster. Two atoms i at a time (PAIRED), or one, run over the buffers; forces on j gather in the buffer and are scattered once. Atoms done
and excluded partners are moved far away instead of being masked.

A list that may be outdated (``neigh_modify check no``, or a delay) still has LAMMPS's meaning: pairs that were beyond its reach when it was
built do not interact. Two atoms of a cluster meet such pairs only once they and others have moved by more than the skin together; from
then on they look at a mask of the row (`hide`, bit a for atom a of the cluster).

The virial (VIRIAL) is the sum over the places of the buffer of position times force: six products for a place instead of six for a pair.
In single precision, where that would cost digits, energies come with a virial summed over pairs.

Constants of the generated module: CLUSTER, ROW, WIDTH (vector width), NROWS (coefficient rows), SETS, ENERGY, VIRIAL, CHARGED, VARYING
(some coefficient differs between type pairs), EXCLUDE, PAIRED, SHARE (one division for two pairs), ROOT (formulas take 1/r), ROUGH (and
mend rough estimates of it), OUTDATED (the list may be), PRUNED (the list is a part of another, and made here); `real` is the working
precision; `pair_force`, `pair_energy` and `fill_rows` are made from the style.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.fuse import madd, rough_roots
from asemd.kernels.gather import fetch8, gather8, give8, scatter8, take8
from asemd.kernels.pair_sums import add, eight, plus

CLUSTER = 8
ROWS, ROW = 11, 1048
WIDTH = 8
NROWS, SETS = 0, 4
ENERGY = VIRIAL = CHARGED = VARYING = SHARE = ROOT = ROUGH = False
EXCLUDE = OUTDATED = HIDE = PRUNED = PAIRED = True
SLOT_BITS = 0x3FFFFFF
CHARGE_ROW = 0           # where charges stand in the buffer, 0 for nowhere
real = np.float64
place = np.uint64        # an index that is surely not negative: no wrap-around test, so that loops vectorise
pair_force = pair_energy = fill_rows = two_hidden = one_hidden = vector_root = renew = None


def inner_two(b, o, n, xa, ya, za, qa, xb, yb, zb, qb, p, hide, h, a0, c, ca, cb):
    """Two atoms a, b against `n` packed ones from place `o` on, whose forces in the buffer it adds to; their coefficients are in ``c[ca:]``
    and ``c[cb:]``.

    With HIDE the bits `a0` and `a0 + 1` of ``hide[h + k]`` say which of the two must not meet place k. Returns the forces on a and b,
    energies and virial.
    """
    if ROUGH:
        rough_roots()
    if HIDE:
        bit_a = np.uint8(1 << a0)
        bit_b = np.uint8(2 << a0)
    meet_a = meet_b = True
    zero = real(0)
    fxa, fya, fza, fxb, fyb, fzb = zero, zero, zero, zero, zero, zero
    ev, ec, v0, v1, v2, v3, v4, v5 = zero, zero, zero, zero, zero, zero, zero, zero
    if ROOT:      # in a loop of their own (decision 27): in a longer one all the rest of a round waits for this chain of operations
        for k in range(o, o + n):
            xk, yk, zk = b[place(k)], b[place(k + ROW)], b[place(k + 2 * ROW)]
            dxa, dya, dza = xa - xk, ya - yk, za - zk
            dxb, dyb, dzb = xb - xk, yb - yk, zb - zk
            ra = madd(dxa, dxa, madd(dya, dya, dza * dza))
            rb = madd(dxb, dxb, madd(dyb, dyb, dzb * dzb))
            b[place(k + 7 * ROW)], b[place(k + 8 * ROW)] = ra, rb
            b[place(k + 9 * ROW)], b[place(k + 10 * ROW)] = vector_root(ra), vector_root(rb)
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
        if ROOT:
            ra, rb = b[place(k + 7 * ROW)], b[place(k + 8 * ROW)]
        else:
            ra = madd(dxa, dxa, madd(dya, dya, dza * dza))
            rb = madd(dxb, dxb, madd(dyb, dyb, dzb * dzb))
        if HIDE:
            hidden = hide[place(h + k)]
            meet_a = (hidden & bit_a) == 0
            meet_b = (hidden & bit_b) == 0
        if ROOT:
            wa, wb = b[place(k + 9 * ROW)], b[place(k + 10 * ROW)]
            ia = wa * wa
            ib = wb * wb
        elif SHARE:
            inverse = real(1) / (ra * rb)     # one division for two pairs
            ia = inverse * rb
            ib = inverse * ra
            wa = wb = zero
        else:
            ia = real(1) / ra
            ib = real(1) / rb
            wa = math.sqrt(ia)
            wb = math.sqrt(ib)
        if CHARGED:
            qk = b[place(k + 6 * ROW)]
            qka = qa * qk
            qkb = qb * qk
        else:
            qka = zero
            qkb = zero
        if ENERGY:
            pa, eva, eca = pair_energy(ra, ia, wa, qka, p, c, ca + k, meet_a)
            pb, evb, ecb = pair_energy(rb, ib, wb, qkb, p, c, cb + k, meet_b)
            ev += eva + evb
            ec += eca + ecb
            if not VIRIAL:
                v0 = madd(dxa * dxa, pa, madd(dxb * dxb, pb, v0))
                v1 = madd(dya * dya, pa, madd(dyb * dyb, pb, v1))
                v2 = madd(dza * dza, pa, madd(dzb * dzb, pb, v2))
                v3 = madd(dxa * dya, pa, madd(dxb * dyb, pb, v3))
                v4 = madd(dxa * dza, pa, madd(dxb * dzb, pb, v4))
                v5 = madd(dya * dza, pa, madd(dyb * dzb, pb, v5))
        else:
            pa = pair_force(ra, ia, wa, qka, p, c, ca + k, meet_a)
            pb = pair_force(rb, ib, wb, qkb, p, c, cb + k, meet_b)
        fxa = madd(dxa, pa, fxa)
        fya = madd(dya, pa, fya)
        fza = madd(dza, pa, fza)
        fxb = madd(dxb, pb, fxb)
        fyb = madd(dyb, pb, fyb)
        fzb = madd(dzb, pb, fzb)
        b[place(k + 3 * ROW)] = madd(-dxa, pa, madd(-dxb, pb, b[place(k + 3 * ROW)]))
        b[place(k + 4 * ROW)] = madd(-dya, pa, madd(-dyb, pb, b[place(k + 4 * ROW)]))
        b[place(k + 5 * ROW)] = madd(-dza, pa, madd(-dzb, pb, b[place(k + 5 * ROW)]))
    return fxa, fya, fza, fxb, fyb, fzb, (ev, ec, v0, v1, v2, v3, v4, v5)


def inner_one(b, o, n, x, y, z, q, p, hide, h, a, c, ca):
    """As `inner_two` for one atom, whose bit of `hide` is `a`: half as many numbers at hand, for formulas without roots and processors
    with few vector registers."""
    if HIDE:
        bit = np.uint8(1 << a)
    meet = True
    zero = real(0)
    fx, fy, fz = zero, zero, zero
    ev, ec, v0, v1, v2, v3, v4, v5 = zero, zero, zero, zero, zero, zero, zero, zero
    for m in range(n):
        k = o + m
        dx = x - b[place(k)]
        dy = y - b[place(k + ROW)]
        dz = z - b[place(k + 2 * ROW)]
        r2 = madd(dx, dx, madd(dy, dy, dz * dz))
        if HIDE:
            meet = (hide[place(h + k)] & bit) == 0
        i2 = real(1) / r2
        w = math.sqrt(i2)
        qq = q * b[place(k + 6 * ROW)] if CHARGED else zero
        if ENERGY:
            fp, one_v, one_c = pair_energy(r2, i2, w, qq, p, c, ca + k, meet)
            ev += one_v
            ec += one_c
            if not VIRIAL:
                v0 = madd(dx * dx, fp, v0)
                v1 = madd(dy * dy, fp, v1)
                v2 = madd(dz * dz, fp, v2)
                v3 = madd(dx * dy, fp, v3)
                v4 = madd(dx * dz, fp, v4)
                v5 = madd(dy * dz, fp, v5)
        else:
            fp = pair_force(r2, i2, w, qq, p, c, ca + k, meet)
        fx = madd(dx, fp, fx)
        fy = madd(dy, fp, fy)
        fz = madd(dz, fp, fz)
        b[place(k + 3 * ROW)] = madd(-dx, fp, b[place(k + 3 * ROW)])
        b[place(k + 4 * ROW)] = madd(-dy, fp, b[place(k + 4 * ROW)])
        b[place(k + 5 * ROW)] = madd(-dz, fp, b[place(k + 5 * ROW)])
    return fx, fy, fz, (ev, ec, v0, v1, v2, v3, v4, v5)


def one_pair(b, k, x, y, z, qi, p, c, row):
    """One atom, with coefficients in ``c[row:]``, against place `k` of the buffer: force on the atom, energies and virial; the opposite
    force goes into the buffer."""
    dx = x - b[place(k)]
    dy = y - b[place(k + ROW)]
    dz = z - b[place(k + 2 * ROW)]
    r2 = dx * dx + dy * dy + dz * dz
    qq = qi * b[place(k + 6 * ROW)] if CHARGED else real(0)
    if ENERGY:
        fp, ev, ec = pair_energy(r2, real(1) / r2, real(1) / math.sqrt(r2), qq, p, c, row + k, True)
    else:
        fp, ev, ec = pair_force(r2, real(1) / r2, real(1) / math.sqrt(r2), qq, p, c, row + k, True), real(0), real(0)
    fx = dx * fp
    fy = dy * fp
    fz = dz * fp
    b[place(k + 3 * ROW)] -= fx
    b[place(k + 4 * ROW)] -= fy
    b[place(k + 5 * ROW)] -= fz
    if VIRIAL:
        dx, dy, dz = real(0), real(0), real(0)      # which is summed elsewhere
    return fx, fy, fz, eight(ev, ec, dx, dy, dz, fx, fy, fz)


def coefficients(c, full, rows, t, types, held, filled, other):
    """Where in `c` the coefficients of an atom of type `t` with its cluster's neighbours stand, and how often rows were filled.

    `held (SETS,)`: types whose rows are there; those of the place `other` stay.
    """
    for k in range(min(filled, SETS)):
        if held[k] == t:
            return k * NROWS * ROW, filled
    k = filled % SETS
    if k * NROWS * ROW == other:
        filled += 1
        k = filled % SETS
    held[k] = t
    fill_rows(c, full, rows, t, types, k * NROWS * ROW)
    return k * NROWS * ROW, filled + 1


def cluster_forces(x, f, q, type_of, first, entries, own, span, unshifted, shifts, excluded_first, excluded, clusters, p, rows, far_,
                   qqr2e, b, c, held, types, saved, near, push, acc, hide, skin, moved, farthest, ahead, whole):
    """Forces of `clusters (2,)`, from the first one to before the second, added to `f (3, cap)`; energy and virial to `acc (8,)` (vdwl,
    coul, xx yy zz xy xz yz).

    `ahead (1,)`: slots whose rows of the tables are brought into the cache beforehand. `whole` is for PRUNED: what the list is made of, see
    `asemd.kernels.prune`. `hide`, `skin`, `moved` and `farthest` are for OUTDATED: the mask of the
    entries, squared displacements of the slots since the list was built, and `farthest (1,)`, the largest of them.
    """
    c0, c1 = clusters[0], clusters[1]
    far = real(far_)
    late = False
    ca = cb = np.int64(0)
    given = c if VARYING else None      # an array without a use would be seven numbers for each call
    cap = x.shape[1]
    for k in range(c0 * CLUSTER, cap, 8):      # no neighbour stands before its cluster
        take8(near, k, x, q)
    if PRUNED:
        renew(near, x, shifts, whole, unshifted, c0, c1, first, entries, own, span, excluded_first, excluded, hide)
    if OUTDATED:
        rest = 0.999999 * skin - math.sqrt(farthest[0])      # how far another atom may have moved
    done = real(2) * far      # atoms of the cluster that have had their turn
    for ci in range(c0, c1):
        s = ci * CLUSTER
        ox = x[0, s]
        oy = x[1, s]
        oz = x[2, s]
        f0 = np.int64(first[ci])
        full = ((np.int64(first[ci + 1]) - f0) // WIDTH) * WIDTH     # rows are padded: whole vectors
        mine = np.int64(own[ci])
        if unshifted[ci]:
            for k in range(0, full, 8):
                gather8(b, k, ROW, near, entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, False, CHARGE_ROW)
        else:
            for k in range(0, full, 8):
                gather8(b, k, ROW, near, entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, True, CHARGE_ROW)
        fetch8(near, s + ahead[0], False)
        fetch8(push, s + ahead[0], True)
        for k in range(full):
            b[k + 3 * ROW] = real(0)
            b[k + 4 * ROW] = real(0)
            b[k + 5 * ROW] = real(0)
        if VARYING:
            for k in range(full):
                types[k] = type_of[np.uint32(entries[place(f0 + k)] & np.int32(SLOT_BITS))]
            filled = np.int64(0)        # not a literal: functions called with one are compiled for it, too
        if EXCLUDE:
            xp = excluded_first[ci]
            xe = excluded_first[ci + 1]
        if PAIRED:
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
                    ca, filled = coefficients(c, full, rows, types[place(mine + a0)], types, held, filled, np.int64(-1))
                    cb, filled = coefficients(c, full, rows, types[place(mine + a0 + 1)], types, held, filled, ca)
                b[place(mine + a0)] = done
                b[place(mine + a0 + 1)] = done
                together = True
                if EXCLUDE:
                    # what either atom must not meet is hidden from both, and met one by one by the other atom
                    x0 = xp
                    while xp < xe and (excluded[xp] >> 16) <= a0 + 1:
                        k = np.uint32(excluded[xp] & np.int32(0xFFFF))
                        saved[xp - x0] = b[k]
                        b[k] = far
                        xp += 1
                if OUTDATED and late:
                    fxa, fya, fza, fxb, fyb, fzb, sums = two_hidden(
                        b, base, count, xa, ya, za, qa, xb, yb, zb, qb, p, hide, f0, a0, given, ca, cb)
                else:
                    fxa, fya, fza, fxb, fyb, fzb, sums = inner_two(
                        b, base, count, xa, ya, za, qa, xb, yb, zb, qb, p, None, f0, a0, given, ca, cb)
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
                            gx, gy, gz, one = one_pair(b, k, xb, yb, zb, qb, p, c, cb)
                            fxb += gx
                            fyb += gy
                            fzb += gz
                        else:
                            gx, gy, gz, one = one_pair(b, k, xa, ya, za, qa, p, c, ca)
                            fxa += gx
                            fya += gy
                            fza += gz
                        if ENERGY:
                            sums = plus(sums, one)
                if OUTDATED and late:
                    together = together and ((hide[place(f0 + mine + a0 + 1)] >> a0) & 1) == 0
                if together:
                    # b was hidden from a, too, lest they met twice
                    b[place(mine + a0 + 1)] = xb
                    gx, gy, gz, one = one_pair(b, mine + a0 + 1, xa, ya, za, qa, p, c, ca)
                    b[place(mine + a0 + 1)] = done
                    fxa += gx
                    fya += gy
                    fza += gz
                    if ENERGY:
                        sums = plus(sums, one)
                b[place(mine + a0 + 3 * ROW)] += fxa
                b[place(mine + a0 + 4 * ROW)] += fya
                b[place(mine + a0 + 5 * ROW)] += fza
                b[place(mine + a0 + 1 + 3 * ROW)] += fxb
                b[place(mine + a0 + 1 + 4 * ROW)] += fyb
                b[place(mine + a0 + 1 + 5 * ROW)] += fzb
                if ENERGY:
                    add(acc, sums)
        else:
            for a in range(CLUSTER):
                base = np.int64(span[ci, a // 2 * 2])
                count = np.int64(span[ci, a // 2 * 2 + 1]) - base
                xa, ya, za = b[place(mine + a)], b[place(mine + a + ROW)], b[place(mine + a + 2 * ROW)]
                if OUTDATED:
                    late = rest <= 0.0 or moved[place(s + a)] > rest * rest
                qa = b[place(mine + a + 6 * ROW)] * real(qqr2e) if CHARGED else real(0)
                if VARYING:
                    ca, filled = coefficients(c, full, rows, types[place(mine + a)], types, held, filled, np.int64(-1))
                b[place(mine + a)] = done
                x0 = 0
                if EXCLUDE:
                    x0 = xp
                    while xp < xe and (excluded[xp] >> 16) <= a:
                        k = np.uint32(excluded[xp] & np.int32(0xFFFF))
                        saved[xp - x0] = b[k]
                        b[k] = far
                        xp += 1
                if OUTDATED and late:
                    fxa, fya, fza, sums = one_hidden(b, base, count, xa, ya, za, qa, p, hide, f0, a, given, ca)
                else:
                    fxa, fya, fza, sums = inner_one(b, base, count, xa, ya, za, qa, p, None, f0, a, given, ca)
                if EXCLUDE:
                    for y in range(xp - 1, x0 - 1, -1):
                        b[np.uint32(excluded[y] & np.int32(0xFFFF))] = saved[y - x0]
                b[place(mine + a + 3 * ROW)] += fxa
                b[place(mine + a + 4 * ROW)] += fya
                b[place(mine + a + 5 * ROW)] += fza
                if ENERGY:
                    add(acc, sums)
        if VIRIAL:
            for a in range(CLUSTER):
                b[place(mine + a)] = real(x[0, place(s + a)] - ox)
            v0, v1, v2, v3, v4, v5 = real(0), real(0), real(0), real(0), real(0), real(0)
            for k in range(full):
                xk, yk, zk = b[place(k)], b[place(k + ROW)], b[place(k + 2 * ROW)]
                fx, fy, fz = b[place(k + 3 * ROW)], b[place(k + 4 * ROW)], b[place(k + 5 * ROW)]
                v0 = madd(xk, fx, v0)
                v1 = madd(yk, fy, v1)
                v2 = madd(zk, fz, v2)
                v3 = madd(xk, fy, v3)
                v4 = madd(xk, fz, v4)
                v5 = madd(yk, fz, v5)
            add(acc, (real(0), real(0), v0, v1, v2, v3, v4, v5))
        for k in range(0, full, 8):
            scatter8(b, k + 3 * ROW, ROW, push, entries, f0 + k, SLOT_BITS, 3)
        give8(push, s, f)       # no later cluster has these atoms in its row
    for k in range(c1 * CLUSTER, cap, 8):
        give8(push, k, f)
