"""Tersoff's potential of one kind of atoms in vector code, on eight neighbours at a time; formulas as in `asemd.pair.tersoff`."""
from __future__ import annotations

import math

from asemd.kernels.manybody import ROW, place


def copy_rows(b, origin, target, full):
    """Three rows, for vector code wants to know where its numbers are."""
    for k in range(full):
        b[place(target + k)] = b[place(origin + k)]
    for k in range(full):
        b[place(target + ROW + k)] = b[place(origin + ROW + k)]
    for k in range(full):
        b[place(target + 2 * ROW + k)] = b[place(origin + 2 * ROW + k)]


def tersoff_block(i, n, m, full, b, constants):
    """Rows of the work space: 7 to 9 unit vectors, 10 inverse distances, 11 distances, 12 and 13 the cutoff function and its slope,
    14 zeta, 15 its slope by r_ij, 16 the derivative of the energy by zeta, 17 that by r_ij, 18 to 20 what each k does to a zeta, then the
    same three for each of sixteen neighbours j."""
    reach, inner, middle, width = constants[1], constants[2], constants[3], constants[4]
    ca, l1, cb, l2, l3 = constants[5], constants[6], constants[7], constants[8], constants[9]
    cubic = constants[10] == 3.0
    gamma, c2, d2, h = constants[11], constants[12] * constants[12], constants[13] * constants[13], constants[14]
    nn, beta = constants[15], constants[16]
    g0 = gamma * (1.0 + c2 / d2)
    for k in range(full):
        r = math.sqrt(b[place(3 * ROW + k)])
        ir = 1.0 / r
        b[place(7 * ROW + k)] = b[place(k)] * ir
        b[place(8 * ROW + k)] = b[place(ROW + k)] * ir
        b[place(9 * ROW + k)] = b[place(2 * ROW + k)] * ir
        b[place(10 * ROW + k)] = ir
        r += constants[0]
        b[place(11 * ROW + k)] = r
        b[place(12 * ROW + k)] = 1.0 if r < reach else 0.0
        b[place(13 * ROW + k)] = 0.0
    for k in range(n):
        r = b[place(11 * ROW + k)]
        if r > inner and r < reach:
            a = 1.5707963267948966 / width * (r - middle)
            b[place(12 * ROW + k)] = 0.5 - 0.5 * math.sin(a)
            b[place(13 * ROW + k)] = -0.7853981633974483 / width * math.cos(a)
    energy = 0.0
    for start in range(0, n, 16):
        end = min(start + 16, n)
        for j in range(start, end):
            ux = b[place(7 * ROW + j)]
            uy = b[place(8 * ROW + j)]
            uz = b[place(9 * ROW + j)]
            rj = b[place(11 * ROW + j)]
            zeta, zj = 0.0, 0.0
            for k in range(full):
                x = ux * b[place(7 * ROW + k)] + uy * b[place(8 * ROW + k)] + uz * b[place(9 * ROW + k)]
                u = h - x
                w = 1.0 / (d2 + u * u)
                g = g0 - gamma * c2 * w
                dg = -2.0 * gamma * c2 * u * w * w
                t = l3 * (rj - b[place(11 * ROW + k)])
                a = t * t * t if cubic else t
                slope = 3.0 * l3 * t * t if cubic else l3
                ex = math.exp(a)
                ex = 1e30 if a > 69.0776 else ex
                ex = 0.0 if a < -69.0776 else ex
                dex = slope * ex if ex > 0.0 else 0.0
                fc = b[place(12 * ROW + k)]
                dfc = b[place(13 * ROW + k)]
                fc = fc if k != j else 0.0
                dfc = dfc if k != j else 0.0
                zeta += fc * g * ex
                zj += fc * g * dex
                b[place(18 * ROW + k)] = fc * dg * ex
                b[place(19 * ROW + k)] = g * (dfc * ex - fc * dex)
                b[place(20 * ROW + k)] = x
            copy_rows(b, 18 * ROW, (21 + 3 * (j - start)) * ROW, full)
            b[place(14 * ROW + j)] = zeta
            b[place(15 * ROW + j)] = zj
        for j in range(end, (end + 7) & -8):
            b[place(14 * ROW + j)] = 0.0
            b[place(15 * ROW + j)] = 0.0
        for j in range(start, (end + 7) & -8):
            z = max(b[place(14 * ROW + j)], 1e-290)
            y = nn * math.log(max(beta * z, 1e-300))
            tn = math.exp(min(y, 50.0))
            big = y > 40.0
            bij = math.exp(-0.5 / nn * (y if big else math.log(1.0 + tn)))
            db = -0.5 * bij * (1.0 if big else tn / (1.0 + tn)) / z
            r = b[place(11 * ROW + j)]
            fc = b[place(12 * ROW + j)]
            dfc = b[place(13 * ROW + j)]
            fa = -cb * math.exp(-l2 * r)
            fr = ca * math.exp(-l1 * r) if j < m else 0.0
            energy += (0.5 * fa * bij + fr) * fc
            w = 0.5 * fa * fc * db
            b[place(16 * ROW + j)] = w
            b[place(17 * ROW + j)] = 0.5 * bij * fa * (dfc - l2 * fc) + w * b[place(15 * ROW + j)] + fr * (dfc - l1 * fc)
        for j in range(start, end):
            ux = b[place(7 * ROW + j)]
            uy = b[place(8 * ROW + j)]
            uz = b[place(9 * ROW + j)]
            ij = b[place(10 * ROW + j)]
            w = b[place(16 * ROW + j)]
            s = b[place(17 * ROW + j)]
            copy_rows(b, (21 + 3 * (j - start)) * ROW, 18 * ROW, full)
            sx, sy, sz = 0.0, 0.0, 0.0
            for k in range(full):
                a = w * b[place(18 * ROW + k)]
                x = b[place(20 * ROW + k)]
                vx = b[place(7 * ROW + k)]
                vy = b[place(8 * ROW + k)]
                vz = b[place(9 * ROW + k)]
                c = a * b[place(10 * ROW + k)]
                d = w * b[place(19 * ROW + k)] - c * x
                b[place(4 * ROW + k)] += c * ux + d * vx
                b[place(5 * ROW + k)] += c * uy + d * vy
                b[place(6 * ROW + k)] += c * uz + d * vz
                a *= ij
                sx += a * (vx - x * ux)
                sy += a * (vy - x * uy)
                sz += a * (vz - x * uz)
            b[place(4 * ROW + j)] += s * ux + sx
            b[place(5 * ROW + j)] += s * uy + sy
            b[place(6 * ROW + j)] += s * uz + sz
    return energy
