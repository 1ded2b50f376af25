"""Vashishta's potential on eight sites at a time; formulas as in `asemd.pair.vashishta`."""
from __future__ import annotations

import numpy as np

from asemd.kernels.eight_sites import ALIKE, EIGHT, FREE, PLACES, ROW, bend8, coefficients8
from asemd.kernels.functions8 import exp8, log8
from asemd.kernels.vectors8 import all8, below8, inverse_root8, load8, rows8, smaller8, store8

place = np.uint64


def pick_near(lane, end, square, b, types):
    """Neighbours of the site in `lane` of the eights that triples may reach, closer than the root of `square`: vectors and squared
    distances to rows 8 to 11, coefficients to the second row of `types`, where the neighbour is to the third. Returns how many."""
    n = 0
    for k in range(lane, end, EIGHT):
        if b[place(3 * ROW + k)] < square:
            a = EIGHT * n + lane
            for d in range(4):
                b[place((8 + d) * ROW + a)] = b[place(d * ROW + k)]
            if not ALIKE:
                types[place(PLACES + ROW + a)] = types[place(PLACES + k)]
            types[place(PLACES + 2 * ROW + a)] = k
            n += 1
    return n


def vashishta_eight(end, b, types, arrays, constants):
    """Rows of the work space: 8 to 10 unit vectors to the neighbours in triples, 11 their inverse distances, 12 the exponential, 13 the
    slope of its logarithm, 14 to 16 derivatives of the energy by their positions. Tables: see `asemd.pair.vashishta.for_eights`."""
    table, of_triples, kinds = arrays[1], arrays[2], arrays[0].shape[0]
    own = load8(b, 7 * ROW)
    energy = all8(0.0)
    pairs = 0
    for lane in range(EIGHT):
        pairs = max(pairs, EIGHT * int(b[place(7 * ROW + lane)]))
    for k in range(0, min(pairs, end), EIGHT):
        rc, _, h, eta = coefficients8(table, types, PLACES + k, 0)
        zz, k1, d, k4 = coefficients8(table, types, PLACES + k, 4)
        w, edge, slope, _ = coefficients8(table, types, PLACES + k, 8)
        r2 = load8(b, 3 * ROW + k)
        ir = inverse_root8(r2)
        r = r2 * ir
        i2 = ir * ir
        p = h * exp8(eta * log8(ir))
        q = zz * exp8(-1.0 * k1 * r) * ir
        s = d * exp8(-1.0 * k4 * r) * (i2 * i2)
        v = w * (i2 * i2 * i2)
        e = p + q - s - v - edge - (r - rc) * slope
        f = s * (4.0 * ir + k4) + 6.0 * (v * ir) - eta * p * ir - q * (ir + k1) - slope
        mine = below8(0.125 * k, own, below8(r, rc, all8(1.0), 0.0), 0.0)
        energy = energy + mine * e
        f = mine * f * ir
        for c in range(3):
            store8(b, (4 + c) * ROW + k, f * load8(b, c * ROW + k))
    most = 0
    for lane in range(EIGHT):
        n = pick_near(lane, end, constants[1], b, types)
        b[place(14 * ROW + lane)] = n
        most = max(most, n)
    for lane in range(EIGHT):
        for a in range(EIGHT * int(b[place(14 * ROW + lane)]) + lane, EIGHT * most, EIGHT):
            b[place(8 * ROW + a)] = 1e10
            b[place(9 * ROW + a)] = 0.0
            b[place(10 * ROW + a)] = 0.0
            b[place(11 * ROW + a)] = 1e20
            types[place(PLACES + ROW + a)] = 0
            types[place(PLACES + 2 * ROW + a)] = -1
    for a in range(0, EIGHT * most, EIGHT):
        ir = inverse_root8(load8(b, 11 * ROW + a))
        _, r0, _, _ = coefficients8(table, types, PLACES + ROW + a, 0)
        _, _, _, gamma = coefficients8(table, types, PLACES + ROW + a, 8)
        s = 1.0 / smaller8(load8(b, 11 * ROW + a) * ir - r0, -1e-12 * r0)      # beyond r0 the exponential becomes 0
        g = gamma * s
        store8(b, 12 * ROW + a, below8(load8(b, 11 * ROW + a) * ir, r0, exp8(g), 0.0))
        store8(b, 13 * ROW + a, g * s)
        store8(b, 11 * ROW + a, ir)
        for c in range(3):
            store8(b, (8 + c) * ROW + a, load8(b, (8 + c) * ROW + a) * ir)
            store8(b, (14 + c) * ROW + a, all8(0.0))
    depth, bend, c0, _ = coefficients8(of_triples, types, PLACES, 0)
    for j in range(0, EIGHT * most, EIGHT):
        ux, uy, uz = load8(b, 8 * ROW + j), load8(b, 9 * ROW + j), load8(b, 10 * ROW + j)
        ij, gj, h = load8(b, 11 * ROW + j), load8(b, 13 * ROW + j), load8(b, 12 * ROW + j)
        sx, sy, sz = load8(b, 14 * ROW + j), load8(b, 15 * ROW + j), load8(b, 16 * ROW + j)
        for k in range(j + EIGHT, EIGHT * most, EIGHT):
            vx, vy, vz = load8(b, 8 * ROW + k), load8(b, 9 * ROW + k), load8(b, 10 * ROW + k)
            x = ux * vx + uy * vy + uz * vz
            if not ALIKE:
                store8(types, FREE, load8(types, PLACES + ROW + j) * all8(kinds) + load8(types, PLACES + ROW + k))
                depth, bend, c0, _ = rows8(of_triples, types, FREE, 0)
            d = x - c0
            w = depth * h * load8(b, 12 * ROW + k)
            q = 1.0 / (bend * (d * d) + 1.0)
            e = w * (d * d) * q
            energy = energy + e
            slope = 2.0 * w * d * (q * q)
            gx, gy, gz = bend8(x, e, slope, ij, gj, ux, uy, uz, vx, vy, vz)
            sx, sy, sz = sx + gx, sy + gy, sz + gz
            gx, gy, gz = bend8(x, e, slope, load8(b, 11 * ROW + k), load8(b, 13 * ROW + k), vx, vy, vz, ux, uy, uz)
            store8(b, 14 * ROW + k, load8(b, 14 * ROW + k) + gx)
            store8(b, 15 * ROW + k, load8(b, 15 * ROW + k) + gy)
            store8(b, 16 * ROW + k, load8(b, 16 * ROW + k) + gz)
        store8(b, 14 * ROW + j, sx)
        store8(b, 15 * ROW + j, sy)
        store8(b, 16 * ROW + j, sz)
    for a in range(EIGHT * most):
        k = types[place(PLACES + 2 * ROW + a)]
        if k >= 0:
            for c in range(3):
                b[place((4 + c) * ROW + k)] += b[place((14 + c) * ROW + a)]
    return energy
