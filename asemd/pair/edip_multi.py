r"""Environment-dependent interatomic potential (EDIP) of several elements: pairs and angles that depend on the coordination of an atom.

$$E_i=\sum_{j\ne i}A\Big[\Big(\frac Br\Big)^\rho-e^{-\beta Z_i^2}\Big]e^{\sigma/(r-a)}+
\sum_{j<k}e^{\gamma/(r_{ij}-a)+\gamma/(r_{ik}-a)}\lambda\big[1-e^{-Q(\cos\theta+\tau)^2}+\eta Q(\cos\theta+\tau)^2\big]$$

with the coordination $Z_i=\sum_jf(r_{ij})$, $f=1$ below c and $e^{\alpha/(1-x^{-3})}$, $x=(r-c)/(a-c)$, up to a;
$Q=Q_0e^{-\mu Z}$, $\tau=u_1+u_2(u_3e^{-u_4Z}-e^{-2u_4Z})$.
"""
from __future__ import annotations

import math
from types import MappingProxyType

from asemd.kernels.manybody import add_bend, add_stretch, directions
from asemd.pair.edip_eight import edip_eight
from asemd.style import register
from asemd.triples import TripleStyle

TABLED = False      # functions of distance and coordination are those of LAMMPS's tables for `edip`
COLUMNS = "a c alpha A B beta rho sigma gamma lambda eta mu Q0 u1 u2 u3 u4".split()


def coordination(r, p):
    """f and its derivative."""
    if r < p[1]:
        return 1.0, 0.0
    if r >= p[0]:
        return 0.0, 0.0
    w = 1.0 / (p[0] - p[1])
    x = (r - p[1]) * w
    x3 = x * x * x
    if x3 < 1e-30:
        return 1.0, 0.0
    q = 1.0 / (x3 - 1.0)
    f = math.exp(p[2] * x3 * q)
    return f, -3.0 * p[2] * f * x * x * w * q * q


def radial(r, p):
    """Of a distance below a: f and its derivative, the factors of triples and of pairs that end at a, and the power of B / r."""
    if r >= p[0]:
        return 0.0, 0.0, 0.0, 0.0, math.pow(p[4] / r, p[6])
    f, df = coordination(r, p)
    s = 1.0 / (r - p[0])
    return f, df, math.exp(p[8] * s), p[3] * math.exp(p[7] * s), math.pow(p[4] / r, p[6])


def surrounded(z, p):
    """Of a coordination: exp(-beta Z^2), Q, tau and its derivative."""
    a = math.exp(-p[16] * z)
    return (math.exp(-p[5] * z * z), p[12] * math.exp(-p[11] * z), p[13] + p[14] * (p[15] * a - a * a),
            p[14] * p[16] * (2.0 * a * a - p[15] * a))


def between(low, high, w):
    """A part `w` of the way from one to the other."""
    return low + (high - low) * w


def at_distance(r, p):
    """`radial`, or what LAMMPS's tables have for it."""
    if not TABLED:
        return radial(r, p)
    k = math.floor((r - 0.1) * 8000.0)
    w = (r - 0.1) * 8000.0 - k
    f0, d0, g0, x0, b0 = radial(0.1 + k / 8000.0, p)
    f1, d1, g1, x1, b1 = radial(0.1 + (k + 1) / 8000.0, p)
    return between(f0, f1, w), between(d0, d1, w), between(g0, g1, w), between(x0, x1, w), between(b0, b1, w)


def at_coordination(z, p):
    """`surrounded`, or what LAMMPS's tables have for it."""
    if not TABLED:
        return surrounded(z, p)
    k = math.floor(z * 8000.0)
    w = z * 8000.0 - k
    o0, q0, t0, d0 = surrounded(k / 8000.0, p)
    o1, q1, t1, d1 = surrounded((k + 1) / 8000.0, p)
    return between(o0, o1, w), between(q0, q1, w), between(t0, t1, w), between(d0, d1, w)


def edip(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    three = arrays[0]
    energy, z = 0.0, 0.0
    directions(n, near, room)
    for k in range(n):
        p = three[ti, types[k], types[k]]
        r = math.sqrt(near[3, k])
        room[4, k], room[5, k], room[6, k] = 0.0, 0.0, 0.0
        if r < p[0]:
            f, room[4, k], room[5, k], room[7, k], room[8, k] = at_distance(r, p)
            z += f
            s = 1.0 / (r - p[0])
            room[6, k] = p[8] * s * s
    dz = 0.0       # derivative of the energy by the coordination
    for k in range(n):
        p = three[ti, types[k], types[k]]
        if room[6, k] == 0.0:
            continue
        s = 1.0 / (1.0 / room[3, k] - p[0])
        o, q, tau, dtau = at_coordination(z, p)
        x, b = room[7, k], room[8, k]
        e = x * (b - o)
        d = -x * p[6] * b * room[3, k] - e * p[7] * s * s
        energy += e
        dz += 2.0 * p[5] * z * o * x
        add_stretch(k, e, d, room, grad, shares)
    for j in range(n - 1):
        if room[6, j] == 0.0:
            continue
        for k in range(j + 1, n):
            if room[6, k] == 0.0:
                continue
            p = three[ti, types[j], types[k]]
            c = room[0, j] * room[0, k] + room[1, j] * room[1, k] + room[2, j] * room[2, k]
            o, q, tau, dtau = at_coordination(z, p)
            t = c + tau
            g = math.exp(-q * t * t)
            w = p[9] * room[5, j] * room[5, k]
            e = w * (1.0 - g + p[10] * q * t * t)
            slope = 2.0 * w * q * t * (g + p[10])
            energy += e
            dz += slope * dtau - p[11] * q * w * t * t * (g + p[10])
            add_bend(j, k, c, e, slope, -e * room[6, j], -e * room[6, k], room, grad, shares)
    for k in range(n):
        add_stretch(k, 0.0, dz * room[4, k], room, grad, shares)
    return energy


HELPERS = coordination, radial, surrounded, between, at_distance, at_coordination


class EDIP(TripleStyle):
    kernel_constants = MappingProxyType({"TABLED": False})
    names = "A B a c alpha beta eta gamma lambda mu rho sigma Q0 u1 u2 u3 u4"
    columns = COLUMNS
    energies = ("A", "lambda")
    positive = "A B a c alpha beta eta gamma lambda mu rho sigma"

    def fits(self, tables):
        rows = tables.arrays[0][1:, 1:, 1:].reshape(-1, len(COLUMNS))
        return not self.kernel_constants["TABLED"] and bool((rows == rows[0]).all())

    def check_entry(self, p, error):
        super().check_entry(p, error)
        if p["c"] >= p["a"]:
            raise error(f"cutoffC, {p['c']:g}, must be less than cutoffA, {p['a']:g}")


register(EDIP("edip/multi", site=edip, eight=edip_eight, eight_rows=17, helpers=HELPERS, rooms=9, converts=False, example="SiC.edip Si",
              see="M. Z. Bazant, E. Kaxiras, J. F. Justo, Phys. Rev. B 56, 8542 (1997); C. Jiang et al., ibid. 86, 144118 (2012)"))
