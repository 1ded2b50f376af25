r"""Tersoff potential of Kumagai: another angular term and a smoother cutoff, fitted to elastic constants and the melting point of silicon.

$$b_{ij}=(1+(\beta_t\zeta_{ij})^\eta)^{-1/2n},\quad
\zeta_{ij}=\sum_{k\ne i,j}f_C(r_{ik})\,g(\theta)\,e^{\alpha^\beta(r_{ij}-r_{ik})^\beta},\quad
g=c_1+\frac{c_2(h-\cos\theta)^2}{c_3+(h-\cos\theta)^2}\big[1+c_4e^{-c_5(h-\cos\theta)^2}\big]$$

The rest is as in `pair tersoff`; beta is 1 or 3, and beta_t, ``beta_ters`` of the file, is 1 in potentials that were published.
"""
from __future__ import annotations

import math

from asemd.kernels.eight_sites import coefficients8
from asemd.kernels.functions8 import exp8, log8, sine8
from asemd.kernels.vectors8 import all8, below8, larger8, smaller8, sum8
from asemd.pair.tersoff import OPTIONS, Tersoff, attraction, longer, repulsion, tersoff
from asemd.pair.tersoff_eight import pair8
from asemd.style import register


def taper(r, p):
    """Cutoff function, whose second derivative has no step, and its derivative."""
    if r < p[1]:
        return 1.0, 0.0
    if r >= p[0]:
        return 0.0, 0.0
    w = 1.5707963267948966 / p[3]
    a = w * (r - p[2])
    return 0.5 - 0.5625 * math.sin(a) - 0.0625 * math.sin(3.0 * a), -w * (0.5625 * math.cos(a) + 0.1875 * math.cos(3.0 * a))


def angular(x, p):
    """g and its derivative by the cosine."""
    u = p[13] - x
    u2 = u * u
    w = 1.0 / (p[17] + u2)
    go = p[16] * u2 * w
    f = p[18] * math.exp(-p[19] * u2)
    return p[11] + go * (1.0 + f), -2.0 * u * (p[16] * p[17] * w * w * (1.0 + f) - go * p[19] * f)


def order(zeta, p):
    """Bond order and its derivative by zeta."""
    z = p[20] * zeta
    if z <= 0.0:
        return 1.0, 0.0
    t = math.pow(z, p[15])
    if not t < 1e300:
        b = math.pow(z, -0.5 * p[15] / p[14])
        return b, -0.5 * p[15] / p[14] * b / zeta
    b = math.pow(1.0 + t, -0.5 / p[14])
    return b, -0.5 * p[15] / p[14] * b * t / ((1.0 + t) * zeta)


def taper8(r, reach, inner, middle, width):
    """The cutoff function of eight distances: with the sine s and the cosine c it is (2 - 3 s + s^3) / 4, and its derivative -3/4 w c^3."""
    f = below8(r, reach, all8(1.0), 0.0)
    slope = all8(0.0)
    if sum8(below8(inner, r, f, 0.0)) > 0.0:
        w = 1.5707963267948966 / width
        a = smaller8(1.5707963267948966, larger8(-1.5707963267948966, w * (r - middle)))
        s, c = sine8(a), sine8(1.5707963267948966 - larger8(a, 0.0 - a))
        switched = below8(inner, r, f, 0.0)
        f = f - switched * (0.5 + 0.25 * s * (3.0 - s * s))
        slope = switched * (-0.75 * w) * (c * c * c)
    return f, slope


def angular8(u, c1, c2, c3, c4, c5):
    """g and its derivative by the cosine, of eight angles."""
    u2 = u * u
    w = 1.0 / (c3 + u2)
    go = c2 * u2 * w
    f = c4 * exp8(-1.0 * c5 * u2)
    return c1 + go * (f + 1.0), -2.0 * u * (c2 * c3 * (w * w) * (f + 1.0) - go * c5 * f)


def order8(zeta, n, eta, table, types, at):
    """Bond order and its derivative by zeta, of eight bonds."""
    beta, _, _, _ = coefficients8(table, types, at, 20)
    z = larger8(zeta, 1e-290)
    y = eta * log8(larger8(beta * z, 1e-300))
    t = exp8(smaller8(y, 50.0))
    b = exp8(-0.5 / n * below8(40.0, y, y, log8(t + 1.0)))
    return b, -0.5 * eta / n * b * below8(40.0, y, 1.0, t / (t + 1.0)) / z


class TersoffMod(Tersoff):
    names = "m alpha h eta beta_ters lambda2 B R D lambda1 A n c1 c2 c3 c4 c5"
    columns = "reach inner R D A lambda1 B lambda2 alpha m c3 c1 c4 h n eta c2 c3 c4 c5 beta_ters".split()
    positive = "eta beta_ters lambda2 B R D lambda1 A n"
    logarithms = ("beta_ters",)

    def numbers_of_eights(self, p):
        return [*(p[name] for name in "reach inner R D A lambda1 B lambda2 n eta alpha h c1 c2 c3 c4 c5".split()), 0.0, 0.0, 0.0,
                p["beta_ters"], p.get("c0", 0.0), 0.0, 0.0]


HELPERS = (taper, repulsion, attraction, angular, order, longer)
register(TersoffMod("tersoff/mod", site=tersoff, helpers=HELPERS, eight_helpers=(taper8, angular8, order8, pair8),
                    example="Si.tersoff.mod Si", doc=__doc__,
                    see="T. Kumagai, S. Izumi, S. Hara, S. Sakai, Comput. Mater. Sci. 39, 457 (2007)", **OPTIONS))
