"""Kernels of many-body pair styles, and the rows of neighbours they run over.

A row holds all neighbours of one slot, images included, so that each pair stands in two rows (an atom near its own image twice in one).
Entries ``first[i]..middle[i]-1`` are the pairs that count as those of slot i, ``middle[i]..last[i]-1`` those that count as the neighbour's:
the first parts alone are a half list. ``codes`` names the row of `shifts` that leads to the image: d = x[j] + shift - x[i].

The generated module of a style (`kernel`) has `gather_near`, `share_pair`, `share_triple` and `add_virial`, for the whole kernels of
styles that are no sums of sites too. Constants: PER_ATOM, ENERGY, ROOMS, UNIFORM (one cutoff for all pairs of types), ALONE (an atom
without neighbours has an energy).
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.generate import Builder

ENERGY = PER_ATOM = UNIFORM = ALONE = False
site = None


def listed(m, pair_i, pair_j, code, x, shifts, type_of, row, ids, reach2):
    """Slots and image of pair m, whether it is closer than its reach, and whether it is the first slot's."""
    i = pair_i[m]
    j = pair_j[m]
    image = code[m] >> 2
    dx = x[0, i] - x[0, j] - shifts[image, 0]
    dy = x[1, i] - x[1, j] - shifts[image, 1]
    dz = x[2, i] - x[2, j] - shifts[image, 2]
    a = ids[row[i]]
    b = ids[row[j]]
    return i, j, image, dx * dx + dy * dy + dz * dz < reach2[type_of[i], type_of[j]], (a > b) == ((a + b) % 2 == 1)


def fill_rows(ns, pair_i, pair_j, code, opposite, x, shifts, type_of, row, ids, reach2, first, middle, last, neighbors, codes):
    """Rows of pairs closer than ``reach2[ti, tj]``; `first` and the others are (ns,), returns the number of entries.

    `pair_i, pair_j, code` are a half list (image * 4 + kind), ``opposite[image]`` is the image the other way. If `neighbors` is too small
    nothing is written to it. Whose pair it is depends on the ids as in LAMMPS: it matters where a file has other numbers for the elements
    A B than for B A.
    """
    for i in range(ns):
        middle[i] = 0
        last[i] = 0
    for m in range(pair_i.shape[0]):
        i, j, image, within, own = listed(m, pair_i, pair_j, code, x, shifts, type_of, row, ids, reach2)
        if within:
            middle[i if own else j] += 1
            last[j if own else i] += 1
    n = 0
    for i in range(ns):
        first[i] = n
        own_ones = middle[i]
        others = last[i]
        middle[i] = n
        last[i] = n + own_ones      # where to write next, of both kinds
        n += own_ones + others
    if n > neighbors.shape[0]:
        return n
    for m in range(pair_i.shape[0]):
        i, j, image, within, own = listed(m, pair_i, pair_j, code, x, shifts, type_of, row, ids, reach2)
        if within:
            at = middle if own else last
            neighbors[at[i]] = j
            codes[at[i]] = image
            at[i] += 1
            at = last if own else middle
            neighbors[at[j]] = i
            codes[at[j]] = opposite[image]
            at[j] += 1
    return n


def gather_near(i, begin, end, n, x, type_of, neighbors, codes, shifts, cut2, near, types, slots):
    """Neighbours within the cutoff from place `n` on in `near (4, cap)` (dx dy dz r^2), `types` and `slots`; returns the number then."""
    xi = x[0, i]
    yi = x[1, i]
    zi = x[2, i]
    ti = type_of[i]
    limit = cut2[1, 1]
    for m in range(begin, end):
        j = np.uint32(neighbors[np.uint64(m)])
        c = np.uint32(codes[np.uint64(m)])
        dx = x[0, j] + shifts[c, 0] - xi
        dy = x[1, j] + shifts[c, 1] - yi
        dz = x[2, j] + shifts[c, 2] - zi
        r2 = dx * dx + dy * dy + dz * dz
        tj = type_of[j]
        k = np.uint64(n)
        near[0, k] = dx
        near[1, k] = dy
        near[2, k] = dz
        near[3, k] = r2
        types[k] = tj
        slots[k] = j
        if UNIFORM:
            n += r2 < limit
        else:
            n += r2 < cut2[ti, tj]
    return n


def share_pair(shares, j, e, gx, gy, gz):
    """Half of a pair energy and its virial to the site and to its neighbour `j`; g is the derivative by the neighbour's position."""
    energies, virials, i, near, slots = shares
    dx = near[0, j]
    dy = near[1, j]
    dz = near[2, j]
    for s in (i, slots[j]):
        energies[s] += 0.5 * e
        virials[0, s] -= 0.5 * dx * gx
        virials[1, s] -= 0.5 * dy * gy
        virials[2, s] -= 0.5 * dz * gz
        virials[3, s] -= 0.5 * dx * gy
        virials[4, s] -= 0.5 * dx * gz
        virials[5, s] -= 0.5 * dy * gz


def share_triple(shares, j, k, e, gjx, gjy, gjz, gkx, gky, gkz):
    """A third of a triple's energy and virial to the site and to its neighbours `j` and `k`."""
    energies, virials, i, near, slots = shares
    third = 1.0 / 3.0
    ax = near[0, j]
    ay = near[1, j]
    az = near[2, j]
    bx = near[0, k]
    by = near[1, k]
    bz = near[2, k]
    for s in (i, slots[j], slots[k]):
        energies[s] += third * e
        virials[0, s] -= third * (ax * gjx + bx * gkx)
        virials[1, s] -= third * (ay * gjy + by * gky)
        virials[2, s] -= third * (az * gjz + bz * gkz)
        virials[3, s] -= third * (ax * gjy + bx * gky)
        virials[4, s] -= third * (ax * gjz + bx * gkz)
        virials[5, s] -= third * (ay * gjz + by * gkz)


def directions(n, near, room):
    """Unit vectors to the n neighbours and inverse distances, the first four rows of `room`."""
    for k in range(n):
        ir = 1.0 / math.sqrt(near[3, k])
        room[0, k] = near[0, k] * ir
        room[1, k] = near[1, k] * ir
        room[2, k] = near[2, k] * ir
        room[3, k] = ir


def add_stretch(k, e, slope, room, grad, shares):
    """A pair energy with neighbour k, and its derivative by the distance."""
    gx = slope * room[0, k]
    gy = slope * room[1, k]
    gz = slope * room[2, k]
    grad[0, k] += gx
    grad[1, k] += gy
    grad[2, k] += gz
    if PER_ATOM:
        share_pair(shares, k, e, gx, gy, gz)


def add_bend(j, k, cosine, e, slope, along_j, along_k, room, grad, shares):
    """A triple's energy with its derivatives by the cosine at the site and by the distances of j and k."""
    ux = room[0, j]
    uy = room[1, j]
    uz = room[2, j]
    vx = room[0, k]
    vy = room[1, k]
    vz = room[2, k]
    b = slope * room[3, j]
    a = along_j - b * cosine
    gjx = a * ux + b * vx
    gjy = a * uy + b * vy
    gjz = a * uz + b * vz
    b = slope * room[3, k]
    a = along_k - b * cosine
    gkx = a * vx + b * ux
    gky = a * vy + b * uy
    gkz = a * vz + b * uz
    grad[0, j] += gjx
    grad[1, j] += gjy
    grad[2, j] += gjz
    grad[0, k] += gkx
    grad[1, k] += gky
    grad[2, k] += gkz
    if PER_ATOM:
        share_triple(shares, j, k, e, gjx, gjy, gjz, gkx, gky, gkz)


def add_virial(acc, n, near, grad):
    """Add the virial of the forces on the first `n` neighbours to the accumulators."""
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        gx = grad[0, k]
        gy = grad[1, k]
        gz = grad[2, k]
        xx += near[0, k] * gx
        yy += near[1, k] * gy
        zz += near[2, k] * gz
        xy += near[0, k] * gy
        xz += near[0, k] * gz
        yz += near[1, k] * gz
    acc[2] -= xx
    acc[3] -= yy
    acc[4] -= zz
    acc[5] -= xy
    acc[6] -= xz
    acc[7] -= yz


def scatter(i, n, f, grad, slots):
    """Forces of one site: what its neighbours feel, and the site itself."""
    fx, fy, fz = 0.0, 0.0, 0.0
    for k in range(n):
        j = slots[k]
        gx = grad[0, k]
        gy = grad[1, k]
        gz = grad[2, k]
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        fx += gx
        fy += gy
        fz += gz
    f[0, i] += fx
    f[1, i] += fy
    f[2, i] += fz


def site_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots, grad,
                room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Sites lo..hi-1: forces added to `f`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and `atom_virial (6, cap)`.

    `cut2` are squared cutoffs by pair of types, `constants` and `arrays` the style's; `near (4, w)`, `types (w,)`, `slots (w,)`,
    `grad (3, w)` and `room (rooms, w)` work space of the thread for the longest row, `shared (shares, cap)` of all threads.
    `bad (4,)`: 1, the first slot whose energy or force is not finite, its energy.
    """
    for i in range(lo, hi):
        if last[i] == first[i] and not ALONE:
            continue
        m = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        n = gather_near(i, middle[i], last[i], m, x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        if n == 0 and not (ALONE and cut2[type_of[i], type_of[i]] > 0.0):      # types of other styles, and empty slots, have no cutoff
            continue
        for k in range(n):
            grad[0, k] = 0.0
            grad[1, k] = 0.0
            grad[2, k] = 0.0
        e = site(i, type_of[i], n, m, near, types, room, grad, constants, arrays, (atom_energy, atom_virial, np.int32(i), near, slots))
        if not abs(e) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = i
                bad[2] = e
            continue
        scatter(i, n, f, grad, slots)
        if ENERGY:
            acc[0] += e
            add_virial(acc, n, near, grad)


@cache
def rows_module():
    """The compiled `fill_rows`."""
    b = Builder("rows of neighbours")
    b.function(listed)
    b.function(fill_rows)
    return b.build()


@cache
def kernel(style, *, energy: bool, per_atom: bool, uniform: bool):
    """The compiled kernel of a many-body style."""
    b = Builder(f"pair {style.name}: rows of neighbours")
    b.line("from asemd.kernels.threads import barrier")
    for name, value in {"ENERGY": energy, "PER_ATOM": per_atom, "UNIFORM": uniform, "ALONE": False, **style.kernel_constants}.items():
        b.constant(name, value)
    for f in (gather_near, add_virial, scatter, share_pair, share_triple, directions, add_stretch, add_bend, *style.helpers):
        b.function(f, fast=True)
    if style.forces is not None:
        b.function(style.forces, "forces", fast=True)
        return b.build().forces
    b.function(style.site, "site", fast=True)
    b.function(site_forces, fast=True)
    return b.build().site_forces
