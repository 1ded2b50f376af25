"""EDIP of one kind of atoms on eight sites at a time; formulas as in `asemd.pair.edip_multi`."""
from __future__ import annotations

from asemd.kernels.eight_sites import ROW, bend8
from asemd.kernels.functions8 import exp8, log8
from asemd.kernels.vectors8 import all8, below8, inverse_root8, larger8, load8, smaller8, store8


def edip_eight(end, b, types, arrays, constants):
    """Rows of the work space: 8 to 10 unit vectors, 11 inverse distances, 12 the slope of the coordination, 13 factors of triples, 14
    slopes of their logarithms, 15 factors of pairs, 16 (r - a)^-2."""
    p = arrays[0][1, 1, 1]
    a, c, alpha, big_a, big_b, beta, rho, sigma = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    gamma, lam, eta, mu, q0, u1, u2, u3, u4 = p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15], p[16]
    width = 1.0 / (a - c)
    z = all8(0.0)
    for k in range(0, end, 8):
        r2 = load8(b, 3 * ROW + k)
        ir = inverse_root8(r2)
        r = r2 * ir
        for n in range(3):
            store8(b, (8 + n) * ROW + k, load8(b, n * ROW + k) * ir)
        store8(b, 11 * ROW + k, ir)
        x = larger8(0.0, smaller8(1.0, (r - c) * width))
        x3 = x * x * x
        q = 1.0 / smaller8(x3 - 1.0, -1e-12)
        f = below8(r, a, exp8(alpha * (x3 * q)), 0.0)
        z = z + f
        store8(b, 12 * ROW + k, (-3.0 * alpha * width) * f * (x * x) * (q * q))
        s = 1.0 / smaller8(r - a, -1e-12 * a)      # where it ends, and for far neighbours, exponentials become 0
        store8(b, 13 * ROW + k, exp8(gamma * s))
        store8(b, 14 * ROW + k, gamma * (s * s))
        store8(b, 15 * ROW + k, big_a * exp8(sigma * s))
        store8(b, 16 * ROW + k, s * s)
    w = exp8(-u4 * z)
    tau, dtau = u1 + u2 * (u3 * w - w * w), (u2 * u4) * (2.0 * w * w - u3 * w)
    q, o = q0 * exp8(-mu * z), exp8(-beta * (z * z))
    energy = all8(0.0)
    dz = all8(0.0)       # derivative of the energy by the coordination
    for k in range(0, end, 8):
        ir, x = load8(b, 11 * ROW + k), load8(b, 15 * ROW + k)
        power = exp8(rho * log8(big_b * ir))
        e = x * (power - o)
        energy = energy + e
        dz = dz + (2.0 * beta) * (z * o * x)
        d = 0.0 - rho * (x * power * ir) - sigma * (e * load8(b, 16 * ROW + k))
        for n in range(3):
            store8(b, (4 + n) * ROW + k, d * load8(b, (8 + n) * ROW + k))
    for j in range(0, end, 8):
        ux, uy, uz = load8(b, 8 * ROW + j), load8(b, 9 * ROW + j), load8(b, 10 * ROW + j)
        ij, gj, h = load8(b, 11 * ROW + j), load8(b, 14 * ROW + j), lam * load8(b, 13 * ROW + j)
        sx, sy, sz = load8(b, 4 * ROW + j), load8(b, 5 * ROW + j), load8(b, 6 * ROW + j)
        for k in range(j + 8, end, 8):
            vx, vy, vz = load8(b, 8 * ROW + k), load8(b, 9 * ROW + k), load8(b, 10 * ROW + k)
            x = ux * vx + uy * vy + uz * vz
            t = x + tau
            qt2 = q * t * t
            g = exp8(0.0 - qt2)
            w = h * load8(b, 13 * ROW + k)
            e = w * (1.0 - g + eta * qt2)
            energy = energy + e
            w = w * (g + eta)
            slope = 2.0 * w * (q * t)
            dz = dz + (slope * dtau - mu * (qt2 * w))
            gx, gy, gz = bend8(x, e, slope, ij, gj, ux, uy, uz, vx, vy, vz)
            sx, sy, sz = sx + gx, sy + gy, sz + gz
            gx, gy, gz = bend8(x, e, slope, load8(b, 11 * ROW + k), load8(b, 14 * ROW + k), vx, vy, vz, ux, uy, uz)
            store8(b, 4 * ROW + k, load8(b, 4 * ROW + k) + gx)
            store8(b, 5 * ROW + k, load8(b, 5 * ROW + k) + gy)
            store8(b, 6 * ROW + k, load8(b, 6 * ROW + k) + gz)
        store8(b, 4 * ROW + j, sx)
        store8(b, 5 * ROW + j, sy)
        store8(b, 6 * ROW + j, sz)
    for k in range(0, end, 8):
        d = dz * load8(b, 12 * ROW + k)
        for n in range(3):
            store8(b, (4 + n) * ROW + k, load8(b, (4 + n) * ROW + k) + d * load8(b, (8 + n) * ROW + k))
    return energy
