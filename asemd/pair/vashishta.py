r"""Vashishta potential of ceramics and glasses: steric, screened Coulomb, charge-dipole and van der Waals pairs, and bond angles.

$$U_2=\frac H{r^\eta}+\frac{Z_iZ_j}re^{-r/\lambda_1}-\frac D{r^4}e^{-r/\lambda_4}-\frac W{r^6},\quad
U_3=B\frac{(\cos\theta-\cos\theta_0)^2}{1+C(\cos\theta-\cos\theta_0)^2}e^{\gamma/(r_{ij}-r_0)+\gamma/(r_{ik}-r_0)}$$

Energy and force of pairs are shifted to zero at the cutoff rc; triples end at r0. Pairs take their numbers from the entry i j j.
"""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asemd import units as unit_styles
from asemd.kernels.eight_sites import PLACE
from asemd.kernels.manybody import add_bend, add_stretch
from asemd.kernels.whole_power import whole_power
from asemd.pair.vashishta_eight import pick_near, vashishta_eight
from asemd.style import register
from asemd.triples import TripleStyle

COLUMNS = "rc r0 H eta zz k1 D k4 W edge slope gamma B C costheta".split()


def two_body(r, h, eta, zz, k1, d, k4, w):
    """Energy of a pair before it is shifted, and the derivative."""
    ir = 1.0 / r
    i2 = ir * ir
    n = int(eta) if 0.0 <= eta <= 64.0 else 0
    a = h * (whole_power(ir, n) if n == eta else math.pow(r, -eta))
    b = zz * math.exp(-r * k1) * ir
    c = d * math.exp(-r * k4) * i2 * i2
    v = w * i2 * i2 * i2
    return a + b - c - v, -eta * a * ir - b * (ir + k1) + c * (4.0 * ir + k4) + 6.0 * v * ir


def pairs(n, m, ti, near, types, room, grad, three, constants, arrays, shares):
    """Energy of the first `m` pairs."""
    energy = 0.0
    for k in range(m):
        p = three[ti, types[k], types[k]]
        r = room[4, k]
        if r >= p[0]:
            continue
        e, d = two_body(r, p[2], p[3], p[4], p[5], p[6], p[7], p[8])
        e -= p[9] + (r - p[0]) * p[10]
        d -= p[10]
        energy += e
        add_stretch(k, e, d, room, grad, shares)
    return energy


def vashishta(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    three = arrays[0]
    inside = 0
    for k in range(n):
        p = three[ti, types[k], types[k]]
        r = math.sqrt(near[3, k])
        if k >= m and r >= p[1]:
            continue
        ir = 1.0 / r
        room[0, k], room[1, k], room[2, k], room[3, k], room[4, k] = near[0, k] * ir, near[1, k] * ir, near[2, k] * ir, ir, r
        if r < p[1]:
            s = 1.0 / (r - p[1])
            room[5, inside] = math.exp(p[11] * s)
            room[6, inside] = p[11] * s * s
            room[7, inside] = k
            inside += 1
    energy = pairs(n, m, ti, near, types, room, grad, three, constants, arrays, shares)
    for a in range(inside - 1):
        j = int(room[7, a])
        for b in range(a + 1, inside):
            k = int(room[7, b])
            p = three[ti, types[j], types[k]]
            if p[12] == 0.0:
                continue
            x = room[0, j] * room[0, k] + room[1, j] * room[1, k] + room[2, j] * room[2, k]
            d = x - p[14]
            w = p[12] * room[5, a] * room[5, b]
            q = 1.0 / (1.0 + p[13] * d * d)
            e = w * d * d * q
            slope = 2.0 * w * d * q * q
            energy += e
            add_bend(j, k, x, e, slope, -e * room[6, a], -e * room[6, b], room, grad, shares)
    return energy


def for_eights(served, three) -> tuple[np.ndarray, ...]:
    """Tables of `vashishta_eight`: PLACE numbers for each pair of types, those of the triple with this neighbour twice, and B, C and the
    cosine for each triple, with number kinds (kinds i + j) + kinds i + k."""
    kinds, n = len(three), np.arange(len(three))
    of_pairs, of_triples = np.zeros((kinds, kinds, PLACE)), np.zeros((kinds * kinds * (kinds + 1), PLACE))
    of_pairs[..., :12] = three[:, n, n][..., :12]
    of_pairs[..., 1] = np.maximum(of_pairs[..., 1], 1e-6)      # no triples: nobody is that near
    of_pairs[~served] = of_pairs[tuple(np.argwhere(served)[0])]      # what a far neighbour has, and types that never meet
    i, j, k = np.indices(three.shape[:3])
    of_triples[kinds * (kinds * i + j) + kinds * i + k, :3] = three[..., 12:]
    return of_pairs.ravel(), of_triples.ravel()


class Vashishta(TripleStyle):
    names = "H eta Z_i Z_j lambda1 D lambda4 W rc B gamma r0 C costheta"
    columns = COLUMNS
    energies = ("H", "D", "W", "B")
    positive = "B gamma r0 rc C lambda1 D lambda4 W H eta"

    def row(self, p, units):
        coulomb = (units or unit_styles.get("metal")).qqr2e
        out = {"zz": p["Z_i"] * p["Z_j"] * coulomb, "k1": 1.0 / p["lambda1"] if p["lambda1"] > 0.0 else 0.0,
               "k4": 1.0 / p["lambda4"] if p["lambda4"] > 0.0 else 0.0, "edge": 0.0, "slope": 0.0}
        if p["rc"] > 0.0:
            numbers = p["H"], p["eta"], out["zz"], out["k1"], p["D"], out["k4"], p["W"]
            out["edge"], out["slope"] = two_body(p["rc"], *numbers)
        return out

    def fits(self, tables):
        return len(tables.arrays) > 2

    def alike(self, tables):
        three = tables.arrays[0][1:, 1:, 1:].reshape(-1, len(COLUMNS))
        return bool((tables.rows[0][1:, 1:] > 0.0).all() and (three == three[0]).all())

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, shift)
        if self.eight is None or not tables.rows[0].any():
            return tables
        three = tables.arrays[0]
        more = for_eights(tables.rows[0] > 0.0, three)
        return replace(tables, constants=np.array([0.0, three[..., 1].max() ** 2]), arrays=(three, *more))


register(Vashishta("vashishta", site=vashishta, eight=vashishta_eight, eight_rows=17, eight_helpers=(pick_near,),
                   helpers=(whole_power, two_body, pairs), rooms=8, example="SiC.vashishta Si",
                   see="P. Vashishta, R. K. Kalia, J. P. Rino, I. Ebbsjo, Phys. Rev. B 41, 12197 (1990)"))
