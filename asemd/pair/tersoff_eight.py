"""Tersoff's potential and its relatives on eight sites at a time; formulas as in `asemd.pair.tersoff`.

Relatives have their own ``taper8(r, reach, inner, middle, width)``, ``angular8(u, p0 ... p4)`` of u = h - x, ``order8(zeta, n, beta, table,
types, at)`` or ``pair8(r, fc, dfc, table, types, at)``.
"""
from __future__ import annotations

from asemd.kernels.eight_sites import ALIKE, FREE, PLACES, ROW, coefficients8
from asemd.kernels.functions8 import exp8, log8, sine8
from asemd.kernels.vectors8 import all8, below8, inverse_root8, larger8, load8, rows8, smaller8, store8, sum8


def taper8(r, reach, inner, middle, width):
    """Cutoff function and its derivative."""
    f = below8(r, reach, all8(1.0), 0.0)
    slope = all8(0.0)
    if sum8(below8(inner, r, f, 0.0)) > 0.0:
        w = 1.5707963267948966 / width
        a = smaller8(1.5707963267948966, larger8(-1.5707963267948966, w * (r - middle)))
        switched = below8(inner, r, f, 0.0)
        f = f - switched * (0.5 + 0.5 * sine8(a))
        slope = switched * (-0.5 * w) * sine8(1.5707963267948966 - larger8(a, 0.0 - a))
    return f, slope


def angular8(u, d2, gamma, steep, p3, p4):
    """g and its derivative by the cosine."""
    w = 1.0 / (u * u + d2)
    return gamma + steep * (u * u * w), -2.0 * steep * (u * w) * (d2 * w)


def order8(zeta, n, beta, table, types, at):
    """Bond order and its derivative by zeta."""
    z = larger8(zeta, 1e-290)
    y = n * log8(larger8(beta * z, 1e-300))
    t = exp8(smaller8(y, 50.0))
    b = exp8(-0.5 / n * below8(40.0, y, y, log8(t + 1.0)))
    return b, -0.5 * b * below8(40.0, y, 1.0, t / (t + 1.0)) / z


def pair8(r, fc, dfc, table, types, at):
    """Repulsion and attraction, with their derivatives."""
    ca, l1, cb, l2 = coefficients8(table, types, at, 4)
    fr, fa = ca * exp8(-1.0 * l1 * r), -1.0 * cb * exp8(-1.0 * l2 * r)
    return fr * fc, fr * (dfc - l1 * fc), fa * fc, fa * (dfc - l2 * fc)


def tersoff_eight(end, b, types, arrays, constants):
    """Rows of the work space: 8 to 10 unit vectors, 11 inverse distances, 12 distances, 13 and 14 the cutoff function and its slope, 15
    zeta, 16 its slope by r_ij; from 17 on for each of eight neighbours j what k does to zeta: by the cosine, by r_ik, and the cosine; from
    41 on the coefficients of k that g and the exponential take.

    ``arrays[1:]``: see `asemd.pair.tersoff.for_eights`.
    """
    table, of_triples, kinds = arrays[1], arrays[2], arrays[0].shape[0]
    cubic = constants[1] == 3.0
    longer = constants[2] != 0.0
    _, _, l3, h = coefficients8(table, types, PLACES, 8)
    p0, p1, p2, p3 = coefficients8(table, types, PLACES, 12)
    p4, _, _, _ = coefficients8(table, types, PLACES, 16)
    for k in range(0, end, 8):
        reach, inner, middle, width = coefficients8(table, types, PLACES + k, 0)
        if not ALIKE:
            _, _, l3, h = rows8(table, types, PLACES + k, 8)
            p0, p1, p2, p3 = rows8(table, types, PLACES + k, 12)
            p4, _, _, _ = rows8(table, types, PLACES + k, 16)
            store8(b, 41 * ROW + k, l3)
            store8(b, 42 * ROW + k, h)
            store8(b, 43 * ROW + k, p0)
            store8(b, 44 * ROW + k, p1)
            store8(b, 45 * ROW + k, p2)
            store8(b, 46 * ROW + k, p3)
            store8(b, 47 * ROW + k, p4)
        r2 = load8(b, 3 * ROW + k)
        ir = inverse_root8(r2)
        r = r2 * ir + constants[0]
        for d in range(3):
            store8(b, (8 + d) * ROW + k, load8(b, d * ROW + k) * ir)
        store8(b, 11 * ROW + k, ir)
        store8(b, 12 * ROW + k, r)
        fc, slope = taper8(r, reach, inner, middle, width)
        store8(b, 13 * ROW + k, fc)
        store8(b, 14 * ROW + k, slope)
    own = load8(b, 7 * ROW)
    energy = all8(0.0)
    for start in range(0, end, 64):
        stop = min(start + 64, end)
        for j in range(start, stop, 8):
            row = (17 + 3 * ((j - start) // 8)) * ROW
            ux, uy, uz, rj = load8(b, 8 * ROW + j), load8(b, 9 * ROW + j), load8(b, 10 * ROW + j), load8(b, 12 * ROW + j)
            zeta = all8(0.0)
            zj = all8(0.0)
            for k in range(0, end, 8):
                if k == j:
                    continue
                x = ux * load8(b, 8 * ROW + k) + uy * load8(b, 9 * ROW + k) + uz * load8(b, 10 * ROW + k)
                fc, dfc = load8(b, 13 * ROW + k), load8(b, 14 * ROW + k)
                if not ALIKE:
                    if of_triples.shape[0] > 0:
                        store8(types, FREE, load8(types, PLACES + j) * all8(kinds) + load8(types, PLACES + k))
                        reach, inner, middle, width = rows8(of_triples, types, FREE, 0)
                        _, _, l3, h = rows8(of_triples, types, FREE, 8)
                        p0, p1, p2, p3 = rows8(of_triples, types, FREE, 12)
                        p4, _, _, _ = rows8(of_triples, types, FREE, 16)
                        fc, dfc = taper8(load8(b, 12 * ROW + k), reach, inner, middle, width)
                    else:
                        l3, h, p0, p1 = load8(b, 41 * ROW + k), load8(b, 42 * ROW + k), load8(b, 43 * ROW + k), load8(b, 44 * ROW + k)
                        p2, p3, p4 = load8(b, 45 * ROW + k), load8(b, 46 * ROW + k), load8(b, 47 * ROW + k)
                g, dg = angular8(h - x, p0, p1, p2, p3, p4)
                if longer:
                    t = l3 * (rj - load8(b, 12 * ROW + k))
                    a = t * t * t if cubic else t
                    slope = 3.0 * l3 * (t * t) if cubic else l3
                    ex = below8(a, -69.0776, 0.0, below8(69.0776, a, 1e30, exp8(a)))
                    dex = below8(0.0, ex, slope * ex, 0.0)
                    dfc = dfc * ex - fc * dex
                    zj = zj + fc * g * dex
                    fc = fc * ex
                zeta = zeta + fc * g
                store8(b, row + k, fc * dg)
                store8(b, row + ROW + k, g * dfc)
                store8(b, row + 2 * ROW + k, x)
            store8(b, 15 * ROW + j, zeta)
            store8(b, 16 * ROW + j, zj)
        for j in range(start, stop, 8):
            n, beta, _, _ = coefficients8(table, types, PLACES + j, 8)
            bond, db = order8(load8(b, 15 * ROW + j), n, beta, table, types, PLACES + j)
            fr, dfr, fa, dfa = pair8(load8(b, 12 * ROW + j), load8(b, 13 * ROW + j), load8(b, 14 * ROW + j), table, types, PLACES + j)
            energy = energy + 0.5 * fa * bond + below8(0.125 * j, own, fr, 0.0)
            w = 0.5 * fa * db
            store8(b, 15 * ROW + j, w)
            store8(b, 16 * ROW + j, 0.5 * bond * dfa + w * load8(b, 16 * ROW + j) + below8(0.125 * j, own, dfr, 0.0))
        for j in range(start, stop, 8):
            row = (17 + 3 * ((j - start) // 8)) * ROW
            ux, uy, uz, ij = load8(b, 8 * ROW + j), load8(b, 9 * ROW + j), load8(b, 10 * ROW + j), load8(b, 11 * ROW + j)
            w, s = load8(b, 15 * ROW + j), load8(b, 16 * ROW + j)
            sx, sy, sz = s * ux, s * uy, s * uz
            for k in range(0, end, 8):
                if k == j:
                    continue
                vx, vy, vz = load8(b, 8 * ROW + k), load8(b, 9 * ROW + k), load8(b, 10 * ROW + k)
                x = load8(b, row + 2 * ROW + k)
                a = w * load8(b, row + k)
                c = a * load8(b, 11 * ROW + k)
                d = w * load8(b, row + ROW + k) - c * x
                store8(b, 4 * ROW + k, load8(b, 4 * ROW + k) + (c * ux + d * vx))
                store8(b, 5 * ROW + k, load8(b, 5 * ROW + k) + (c * uy + d * vy))
                store8(b, 6 * ROW + k, load8(b, 6 * ROW + k) + (c * uz + d * vz))
                a = a * ij
                sx = sx + a * (vx - x * ux)
                sy = sy + a * (vy - x * uy)
                sz = sz + a * (vz - x * uz)
            store8(b, 4 * ROW + j, load8(b, 4 * ROW + j) + sx)
            store8(b, 5 * ROW + j, load8(b, 5 * ROW + j) + sy)
            store8(b, 6 * ROW + j, load8(b, 6 * ROW + j) + sz)
    return energy
