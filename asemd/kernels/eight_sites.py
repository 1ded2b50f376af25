"""Kernels of many-body pair styles on eight sites at a time, one in each place of vectors (`asemd.kernels.vectors8`).

The work space `b` of a thread is flat. A row of it has ROW numbers: eights for the first, second, ... neighbours of the eight sites. Rows 0
to 2 are the vectors to the neighbours, 3 the squared distances, 4 to 6 the derivatives of the energy by the neighbours' positions; row 7
begins with how many neighbours of each site are there with a pair that counts as the site's own, and the rows of the style follow. A site
with fewer neighbours than another has some that are far away, so that formulas need no conditions for them.

Constants: ENERGY, UNIFORM (one cutoff for all pairs of types), ALIKE (all atoms have the same coefficients). Unless ALIKE, `types` has a
row too, after its first PLACES numbers: PLACE times the number of the pair of types. The style may use the eight from FREE on, and two
more rows of `types` behind. It calls `coefficients8` for what stands in such a table.
"""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.kernels import functions8
from asemd.kernels.generate import Builder, plain_source
from asemd.kernels.vector_math import OPTIONS
from asemd.kernels.vectors8 import all8, load8, rows8, store8, sum8

ENERGY = UNIFORM = ALIKE = False
ROW = 0
FREE = 16
PLACE = PLACES = 24
EIGHT = 8
place = np.uint64
site = None
VECTORS = "all8 below8 inverse_root8 larger8 load8 madd8 rows8 smaller8 store8 sum8"


def coefficients8(table, types, at, first):
    """Four coefficients, from the `first` on, of the neighbours whose places in the table are in ``types[at:]``."""
    if ALIKE:
        return all8(table[first]), all8(table[first + 1]), all8(table[first + 2]), all8(table[first + 3])
    return rows8(table, types, at, first)


def bend8(x, e, slope, ir, along, ux, uy, uz, vx, vy, vz):
    """Derivative of a triple's energy e by the position of its neighbour in direction u: `slope` is that by the cosine x, and -e times
    `along` that by the distance, whose inverse is `ir`."""
    t = slope * ir
    s = e * along + t * x
    return t * vx - s * ux, t * vy - s * uy, t * vz - s * uz


def gather_lane(i, begin, end, n, lane, x, type_of, neighbors, codes, shifts, cut2, b, types, slots):
    """Neighbours of site i within the cutoff, to place `lane` of the eights from the `n`-th on; returns the number then."""
    xi = x[0, i]
    yi = x[1, i]
    zi = x[2, i]
    ti = type_of[i]
    limit = cut2[1, 1]
    for m in range(begin, end):
        j = np.uint32(neighbors[place(m)])
        c = np.uint32(codes[place(m)])
        dx = x[0, j] + shifts[c, 0] - xi
        dy = x[1, j] + shifts[c, 1] - yi
        dz = x[2, j] + shifts[c, 2] - zi
        r2 = dx * dx + dy * dy + dz * dz
        k = EIGHT * n + lane
        b[place(k)] = dx
        b[place(ROW + k)] = dy
        b[place(2 * ROW + k)] = dz
        b[place(3 * ROW + k)] = r2
        slots[place(k)] = j
        if not ALIKE:
            types[place(PLACES + k)] = PLACE * (ti * cut2.shape[1] + type_of[j])
        if UNIFORM:
            n += r2 < limit
        else:
            n += r2 < cut2[ti, type_of[j]]
    return n


def fill(n, lane, most, b, types):
    """Far neighbours for a site with n where another has `most`."""
    for k in range(EIGHT * n + lane, EIGHT * most, EIGHT):
        b[place(k)] = 1e10
        b[place(ROW + k)] = 0.0
        b[place(2 * ROW + k)] = 0.0
        b[place(3 * ROW + k)] = 1e20
        if not ALIKE:
            types[place(PLACES + k)] = 0


def scatter_lane(i, n, lane, f, b, slots):
    """Forces of one site: what its neighbours feel, and the site itself."""
    fx, fy, fz = 0.0, 0.0, 0.0
    for k in range(lane, EIGHT * n, EIGHT):
        j = np.uint32(slots[place(k)])
        gx = b[place(4 * ROW + k)]
        gy = b[place(5 * ROW + k)]
        gz = b[place(6 * ROW + k)]
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        fx += gx
        fy += gy
        fz += gz
    f[0, i] += fx
    f[1, i] += fy
    f[2, i] += fz


def add_virial(acc, end, b):
    """Add the virial of the forces on all neighbours to the accumulators."""
    for c in range(6):
        p, q = (c, c) if c < 3 else (0, c - 2) if c < 5 else (1, 2)
        total = 0.0
        for k in range(0, end, EIGHT):
            total += sum8(load8(b, p * ROW + k) * load8(b, (4 + q) * ROW + k))
        acc[2 + c] -= total


def site_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots, grad,
                b, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Sites lo..hi-1; arguments as in `asemd.kernels.manybody.site_forces`. The first eight of `types` are the sites of an eight here, the
    next how many neighbours they have; `slots` has a row of eights."""
    i = lo
    while i < hi:
        sites, most = 0, 0
        while i < hi and sites < EIGHT:
            m = gather_lane(i, first[i], middle[i], 0, sites, x, type_of, neighbors, codes, shifts, cut2, b, types, slots)
            n = gather_lane(i, middle[i], last[i], m, sites, x, type_of, neighbors, codes, shifts, cut2, b, types, slots)
            if n > 0:
                types[sites] = i
                types[EIGHT + sites] = n
                b[place(7 * ROW + sites)] = m
                most = max(most, n)
                sites += 1
            i += 1
        for lane in range(EIGHT):
            fill(types[EIGHT + lane] if lane < sites else 0, lane, most, b, types)
        for k in range(EIGHT * most):
            b[place(4 * ROW + k)] = 0.0
            b[place(5 * ROW + k)] = 0.0
            b[place(6 * ROW + k)] = 0.0
        e = site(EIGHT * most, b, types, arrays, constants)
        total = sum8(e)
        if not abs(total) < np.inf:
            store8(b, 7 * ROW, e)
            for lane in range(sites):
                if bad[0] == 0.0 and not abs(b[place(7 * ROW + lane)]) < np.inf:
                    bad[0] = 1.0
                    bad[1] = types[lane]
                    bad[2] = b[place(7 * ROW + lane)]
            continue
        for lane in range(sites):
            scatter_lane(types[lane], types[EIGHT + lane], lane, f, b, slots)
        if ENERGY:
            acc[0] += total
            add_virial(acc, EIGHT * most, b)


@cache
def kernel(style, *, energy: bool, uniform: bool, alike: bool, width: int):
    """The compiled kernel of a style whose `eight` is a function of eight sites; `width`: places for neighbours."""
    b = Builder(f"pair {style.name}: eight sites at a time")
    b.line("place = np.uint64")
    b.line(f"from asemd.kernels.vectors8 import {', '.join(VECTORS.split())}")
    b.line(f"from asemd.kernels.functions8 import {', '.join(functions8.NAMES)}")
    constants = dict(ENERGY=energy, UNIFORM=uniform, ALIKE=alike, EIGHT=EIGHT, ROW=EIGHT * width, PLACES=PLACES, PLACE=PLACE, FREE=FREE)
    for name, value in constants.items():
        b.constant(name, value)
    for f in functions8.FUNCTIONS:
        b.text(plain_source(f), OPTIONS)
    for f in (gather_lane, fill, scatter_lane, add_virial):
        b.function(f, fast=True)
    for f in (coefficients8, bend8, *style.eight_helpers):
        b.function(f, fast=True, inline=True)
    b.function(style.eight, "site", fast=True)
    b.function(site_forces, fast=True)
    return b.build().site_forces
