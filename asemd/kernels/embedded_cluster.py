"""Embedded-atom potentials over the cluster list: the fast way.

Three passes: densities, embedding functions, forces. A cluster's neighbours are packed relative to its first atom, in double precision as
rows and in single precision as vectors. For each atom of the cluster `near16` finds those that may be within the cutoff; the vectors of
eight pairs that come of it (`kept`, and which atom of the cluster they belong to, `owner`) are then worked off in two loops, distances
first and functions next: neither waits for long chains of results, nor for guesses how many neighbours an atom has. The third pass finds
the pairs of the first one in memory.

Constants of the generated module: ENERGY (and virial), VARYING (more than one block of tables), OUTDATED (the list may be, see
`asemd.kernels.pair_cluster`). Tables are those of `asemd.embedded`, flat, a block for each ordered pair of classes of atom types.
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels import pair_sums
from asemd.kernels.embedded import embedding
from asemd.kernels.gather import fetch8, give8, take8
from asemd.kernels.generate import Builder
from asemd.kernels.pair_sums import add
from asemd.kernels.threads import barrier
from asemd.kernels.vectors8 import (
    add_at8,
    add_row,
    all8,
    below8,
    inverse_root8,
    larger8,
    load8,
    lookup8,
    madd8,
    near16,
    oppose8,
    pack8,
    real8,
    rows8,
    smaller8,
    store8,
    sum8,
    whole8,
)

CLUSTER = 8
SLOT_BITS = 0x3FFFFFF
ENERGY = False
VARYING = OUTDATED = True
place = np.uint64
single = np.float32
VECTORS = ('add_at8 add_row all8 below8 inverse_root8 larger8 load8 lookup8 madd8 near16 oppose8 pack8 real8 rows8 smaller8 store8 sum8 '
           'whole8')


def pack(ci, full, row, near, entries, f0, unshifted, shifts, b, local):
    """The neighbours of cluster `ci` in `local` and `b`; an atom far away behind them."""
    s = place(ci * CLUSTER)
    ox, oy, oz = near[s, 0], near[s, 1], near[s, 2]
    if unshifted[ci]:
        for k in range(0, full, 8):
            pack8(b, k, row, local, near, entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, False)
    else:
        for k in range(0, full, 8):
            pack8(b, k, row, local, near, entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, True)
    local[place(4 * full)] = 1e9
    local[place(4 * full + 3)] = 0.0


def find(ci, f0, full, mine, row, span, type_of, cut, reach, local, b, kept, n, owner, hide, moved, rest):
    """Pairs of the atoms of cluster `ci` that may be within the cutoff, from ``kept[n]`` on; returns where they end.

    Each atom's fill vectors of eight; what is left over is the atom far away. Single precision does not lose a pair.
    """
    extent = 0.0
    for a in range(CLUSTER):
        if type_of[place(ci * CLUSTER + a)] > 0:
            for d in range(3):
                extent = max(extent, abs(local[place(4 * (mine + a) + d)]))
        b[place(mine + a + 3 * row)] = single(a)
    for k in range(full, full + 16):
        b[place(k + 3 * row)] = single(-1)
    limit = cut + 5e-7 * (2.0 * extent + 2.0 * reach)
    close = single(limit * limit)
    for a in range(CLUSTER):
        if type_of[place(ci * CLUSTER + a)] == 0:
            break
        base, end = np.int64(span[ci, a - a % 2]), np.int64(span[ci, a - a % 2 + 1])
        me = mine + a
        x, y, z = b[place(me)], b[place(me + row)], b[place(me + 2 * row)]
        begin = n
        for k in range(base, end, 16):
            n = near16(b, k, row, x, y, z, single(a), close, kept, n)
        if OUTDATED:
            if rest <= 0.0 or moved[place(ci * CLUSTER + a)] > rest * rest:
                m = begin
                for q in range(begin, n):
                    kept[place(m)] = kept[place(q)]
                    m += ((np.int64(hide[place(f0 + (kept[place(q)] >> 2))]) >> a) & 1) ^ 1
                n = m
        store8(kept, n, all8(4 * full))
        v = begin // 8
        n = (n + 7) // 8 * 8
        store8(owner, v, all8(4 * me))
        for k in range(v + 8, n // 8):
            owner[place(k)] = 4 * me
    for a in range(CLUSTER):
        b[place(mine + a + 3 * row)] = single(99)
    for k in range(full, full + 16):
        b[place(k + 3 * row)] = single(99)
    return n


def blocks(ci, cj, m8, v, classes, size, there, back):
    """Where the functions of eight pairs begin: of an atom of class `ci` with neighbours of classes `cj` in `there`, the other way round in
    `back`."""
    store8(there, v, m8 + whole8(madd8(cj, all8(size), all8(ci * classes * size))))
    store8(back, v, m8 + whole8(madd8(cj, all8(classes * size), all8(ci * size))))


def slopes(i, types, functions, function_of, constants, slope, lanes):
    """Slopes of the embedding energies of slots i to i + 7, whose densities are in ``slope[i:]``; False, and nothing done, if one of them
    is beyond its table or no atom."""
    p = (load8(slope, i) - all8(constants[6])) * all8(constants[3])
    start = lookup8(function_of, types, i)
    within = below8(p, all8(constants[4]), all8(1.0), all8(0.0)) * below8(p, all8(constants[5]), all8(0.0), all8(1.0))
    if sum8(within * below8(real8(start), all8(0.0), all8(0.0), all8(1.0))) < 8.0:
        return False
    m = whole8(p)
    t = p - real8(m)
    store8(lanes, 0, (start + m) * all8(4))
    c3, c4, c5, c6 = rows8(functions, lanes, 0, 0)
    store8(slope, i, madd8(madd8(c3 * all8(3.0), t, c4 * all8(2.0)), t, c5) * all8(constants[3]))
    return True


def embed(c0, c1, rho, type_of, functions, flat, function_of, share, constants, slope, lanes, acc, bad):
    """Embedding energies of clusters c0..c1-1, and their slopes."""
    for i in range(c0 * CLUSTER, c1 * CLUSTER, 8):
        total = load8(rho[0], i)
        for t in range(1, rho.shape[0]):
            total = total + load8(rho[t], i)
        store8(slope, i, total)
        if not ENERGY:
            if slopes(i, type_of, flat, function_of, constants, slope, lanes):
                if VARYING:
                    for j in range(i, i + 8):
                        slope[j] *= share[type_of[j]]
                else:
                    store8(slope, i, load8(slope, i) * all8(share[type_of[i]]))
                continue
        for j in range(i, i + 8):
            k = function_of[type_of[j]]
            e, d = embedding(slope[j], functions, k, constants) if k >= 0 else (0.0, 0.0)
            if not abs(slope[j]) < math.inf and bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, j, slope[j]
            slope[j] = share[type_of[j]] * d
            if ENERGY:
                acc[0] += share[type_of[j]] * e


def embedded_clusters(x, f, type_of, first, entries, own, span, unshifted, shifts, clusters, constants, table, classes, class_of, cut,
                      reach, functions, flat, function_of, share, rho, slope, b, row, local, sums, kinds, kept, owner, ends, work, there,
                      back, lanes, near, push, acc, hide, skin, moved, farthest, ahead, tid, meeting, bad):
    """Forces of `clusters (2,)`, from the first one to before the second, added to `f (3, cap)`; energy and virial to `acc (8,)`.

    `class_of (cap,)` is each slot's class of `classes`, as a double; `flat` is `functions (n, 4)` as one row. `rho (threads, cap)` and
    `slope (cap,)` are of all threads; `b`, `local`, `sums`, `kinds`, `work`, `there` and `back` room for the neighbours of one cluster,
    `kept`, `owner` and `ends` for all of them. `ahead (1,)`: slots whose rows of `near` and `push` are brought into the cache beforehand.
    """
    c0, c1 = clusters[0], clusters[1]
    cap = x.shape[1]
    stage = np.int64(there.shape[0])
    rdr = all8(constants[0])
    cut2 = all8(cut * cut)
    beyond = all8(constants[2])
    last = all8(np.int64(constants[1]))
    nothing = all8(np.int64(constants[2]))
    one, two, three, zero = all8(1.0), all8(2.0), all8(3.0), all8(0.0)
    eight = all8(8)
    size = 8.0 * (constants[2] + 1.0)
    mine_rho = rho[tid]
    spill = work[stage:]
    for k in range(cap):
        mine_rho[k] = 0.0
    for k in range(c0 * CLUSTER, cap, 8):      # no neighbour stands before its cluster
        take8(near, k, x, class_of)
    rest = 0.999999 * skin - math.sqrt(farthest[0]) if OUTDATED else 0.0
    n = np.int64(0)
    for ci in range(c0, c1):
        f0 = np.int64(first[ci])
        full = ((np.int64(first[ci + 1]) - f0) // 8) * 8
        mine = np.int64(own[ci])
        pack(ci, full, row, near, entries, f0, unshifted, shifts, b, local)
        fetch8(near, ci * CLUSTER + ahead[0], False)
        for k in range(0, 4 * full + 4, 8):
            store8(sums, k, zero)
        begin = n
        n = find(ci, f0, full, mine, row, span, type_of, cut, reach, local, b, kept, n, owner, hide, moved, rest)
        ends[place(ci)] = n
        for v in range(0, n - begin, 8):
            me = np.int64(owner[place((begin + v) >> 3)])
            xj, yj, zj, cj = rows8(local, kept, begin + v, 0)
            dx = all8(local[place(me)]) - xj
            dy = all8(local[place(me + 1)]) - yj
            dz = all8(local[place(me + 2)]) - zj
            r2 = madd8(dx, dx, madd8(dy, dy, dz * dz))
            p = larger8(below8(r2, cut2, r2 * inverse_root8(r2) * rdr, beyond), zero)
            m = whole8(p)
            inside = smaller8(m, last)
            store8(work, v, smaller8(p - real8(inside), one))
            m8 = below8(r2, cut2, inside, nothing) * eight
            if VARYING:
                blocks(local[place(me + 3)], cj, m8, v, classes, size, there, back)
            else:
                store8(there, v, m8)
        for v in range(0, n - begin, 8):
            me = np.int64(owner[place((begin + v) >> 3)])
            t = load8(work, v)
            c3, c4, c5, c6 = rows8(table, there, v, 0)
            density = madd8(madd8(madd8(c3, t, c4), t, c5), t, c6)
            sums[place(me)] += sum8(density)
            if VARYING:
                c3, c4, c5, c6 = rows8(table, back, v, 0)
                density = madd8(madd8(madd8(c3, t, c4), t, c5), t, c6)
            store8(spill, 0, density)
            add_at8(sums, kept, begin + v, spill)
        for k in range(full):
            mine_rho[np.uint32(entries[place(f0 + k)] & np.int32(SLOT_BITS))] += sums[place(4 * k)]
    barrier(meeting)
    embed(c0, c1, rho, type_of, functions, flat, function_of, share, constants, slope, lanes, acc, bad)
    barrier(meeting)
    for k in range(c0 * CLUSTER, cap, 8):
        take8(near, k, x, slope)
    n = np.int64(0)
    sum_e, sum_xx, sum_yy, sum_zz, sum_xy, sum_xz, sum_yz = zero, zero, zero, zero, zero, zero, zero
    for ci in range(c0, c1):
        f0 = np.int64(first[ci])
        full = ((np.int64(first[ci + 1]) - f0) // 8) * 8
        pack(ci, full, row, near, entries, f0, unshifted, shifts, b, local)
        fetch8(near, ci * CLUSTER + ahead[0], False)
        fetch8(push, ci * CLUSTER + ahead[0], True)
        for k in range(0, 4 * full + 4, 8):
            store8(sums, k, zero)
        if VARYING:
            for k in range(full):
                kinds[place(4 * k)] = np.int32(class_of[np.uint32(entries[place(f0 + k)] & np.int32(SLOT_BITS))])
            kinds[place(4 * full)] = 0
        begin = n
        n = ends[place(ci)]
        for v in range(0, n - begin, 8):
            me = np.int64(owner[place((begin + v) >> 3)])
            xj, yj, zj, fj = rows8(local, kept, begin + v, 0)
            dx = all8(local[place(me)]) - xj
            dy = all8(local[place(me + 1)]) - yj
            dz = all8(local[place(me + 2)]) - zj
            r2 = madd8(dx, dx, madd8(dy, dy, dz * dz))
            ir = inverse_root8(r2)
            p = larger8(below8(r2, cut2, r2 * ir * rdr, beyond), zero)
            m = whole8(p)
            inside = smaller8(m, last)
            m8 = below8(r2, cut2, inside, nothing) * eight
            store8(work, v, smaller8(p - real8(inside), one))
            store8(work, v + stage, ir)
            store8(work, v + 2 * stage, dx)
            store8(work, v + 3 * stage, dy)
            store8(work, v + 4 * stage, dz)
            if VARYING:
                store8(work, v + 5 * stage, fj)
                cj = real8(lookup8(kinds, kept, begin + v))
                blocks(np.float64(kinds[place(me)]), cj, m8, v, classes, size, there, back)
            else:
                store8(work, v + 5 * stage, fj + all8(local[place(me + 3)]))
                store8(there, v, m8)
        for v in range(0, n - begin, 8):
            me = np.int64(owner[place((begin + v) >> 3)])
            t = load8(work, v)
            ir = load8(work, v + stage)
            c3, c4, c5, c6 = rows8(table, there, v, 0)
            d3, d4, d5, d6 = rows8(table, there, v, 4)
            dense = madd8(madd8(c3 * three, t, c4 * two), t, c5)
            if VARYING:
                c3, c4, c5, c6 = rows8(table, back, v, 0)
                dense = dense * all8(local[place(me + 3)])
                dense = madd8(load8(work, v + 5 * stage), madd8(madd8(c3 * three, t, c4 * two), t, c5), dense)
            else:
                dense = load8(work, v + 5 * stage) * dense
            z = madd8(madd8(madd8(d3, t, d4), t, d5), t, d6)
            slope_z = madd8(madd8(d3 * three, t, d4 * two), t, d5)
            force = (z * ir * ir - madd8(slope_z, ir, dense) * rdr) * ir
            dx = load8(work, v + 2 * stage)
            dy = load8(work, v + 3 * stage)
            dz = load8(work, v + 4 * stage)
            gx = dx * force
            gy = dy * force
            gz = dz * force
            oppose8(sums, kept, begin + v, me, gx, gy, gz)
            if ENERGY:
                sum_e = madd8(z, ir, sum_e)
                sum_xx = madd8(dx, gx, sum_xx)
                sum_yy = madd8(dy, gy, sum_yy)
                sum_zz = madd8(dz, gz, sum_zz)
                sum_xy = madd8(dx, gy, sum_xy)
                sum_xz = madd8(dx, gz, sum_xz)
                sum_yz = madd8(dy, gz, sum_yz)
        for k in range(full):
            add_row(push, np.int64(entries[place(f0 + k)] & np.int32(SLOT_BITS)), sums, 4 * k)
        give8(push, ci * CLUSTER, f)        # no later cluster has these atoms in its row
    if ENERGY:
        add(acc, (sum8(sum_e), 0.0, sum8(sum_xx), sum8(sum_yy), sum8(sum_zz), sum8(sum_xy), sum8(sum_xz), sum8(sum_yz)))
    for k in range(c1 * CLUSTER, cap, 8):
        give8(push, k, f)


@cache
def kernel(*, energy: bool, varying: bool, outdated: bool):
    """The compiled `embedded_clusters`."""
    b = Builder("embedded atoms: cluster list")
    b.line("from asemd.kernels.threads import barrier")
    b.line("from asemd.kernels.gather import fetch8, give8, take8")
    b.line(f"from asemd.kernels.vectors8 import {', '.join(VECTORS.split())}")
    b.line("place, single = np.uint64, np.float32")
    for name, value in dict(CLUSTER=CLUSTER, SLOT_BITS=SLOT_BITS, ENERGY=energy, VARYING=varying, OUTDATED=outdated).items():
        b.constant(name, value)
    pair_sums.use(b, "add", fast=True)
    for f in (embedding, pack, find, blocks, slopes, embed, embedded_clusters):
        b.function(f, fast=True)
    return b.build().embedded_clusters
