"""Formulas of the manual for two-body styles at their example coefficients, as functions of a distance in `mpmath` numbers."""
from __future__ import annotations

import mpmath as m


def number(text: str):
    return m.mpf(text)


def lj(r, epsilon="1", sigma="1.1", n=12, k=6):
    s = number(sigma) / r
    return 4 * number(epsilon) * (s**n - s**k)


def switched(energy, inner, outer):
    """The function with the switch of GROMACS."""
    def of(r):
        a, b = number(inner), number(outer)
        w, e, d, d2 = b - a, energy(b), m.diff(energy, b), m.diff(energy, b, 2)
        first, second = (w * d2 - 3 * d) / w**2, (2 * d - w * d2) / w**3
        out = energy(r) - e + w * d / 2 - w**2 * d2 / 12
        return out + (first * (r - a)**3 / 3 + second * (r - a)**4 / 4 if r > a else 0)
    return of


def smoothed(energy, inner, outer):
    """The function whose force goes to zero as a cubic polynomial."""
    def of(r):
        a, w = number(inner), number(outer) - number(inner)
        f, g = -m.diff(energy, a), -m.diff(energy, a, 2)
        c = (f, g, -(3 * f + 2 * g * w) / w**2, (2 * f + g * w) / w**3)
        t = r - a
        return energy(r) if r <= a else energy(a) - sum(x * t**(k + 1) / (k + 1) for k, x in enumerate(c))
    return of


def linear(energy, cut):
    """The function with shifted force."""
    return lambda r: energy(r) - energy(number(cut)) - (r - number(cut)) * m.diff(energy, number(cut))


def soft(r, lam="0.6", core="0.5", sigma="1.1"):
    return number(core) * (1 - number(lam))**2 + (r / number(sigma))**6


def mie(r):
    n, k, s = m.mpf(14), number("6.5"), number("1.1") / r
    return n / (n - k) * (n / k)**(k / (n - k)) * (s**n - s**k)


FORMULAS = {
    "lj/class2": lambda r: 2 * (number("1.1") / r)**9 - 3 * (number("1.1") / r)**6,
    "lj/expand": lambda r: lj(r + number("0.2")),
    "lj/gromacs": switched(lj, "1.9", "2.4"),
    "lj/smooth": smoothed(lj, "1.9", "2.4"),
    "lj/smooth/linear": linear(lj, "2.4"),
    "lj/sf": linear(lj, "2.4"),
    "mie/cut": mie,
    "nm/cut": lambda r: (6 * (number("1.2") / r)**8 - 8 * (number("1.2") / r)**6) / 2,
    "born": lambda r: number("6.08") * m.exp((number("1.34") - r) / number("0.317")) - number("2.18") / r**6 + number("1.51") / r**8,
    "yukawa": lambda r: 10 * m.exp(-2 * r) / r,
    "lj/cut/soft": lambda r: 4 * number("0.6")**2 * (soft(r)**-2 - 1 / soft(r)),
    "lj/class2/soft": lambda r: number("0.6")**2 * (2 * soft(r)**number("-1.5") - 3 / soft(r)),
}
TERMS = {
    "morse/soft": lambda r: m.exp(4 * (number("1.2") - r)) + 2 * m.exp(2 * (number("1.2") - r)),
    "colloid": lambda r: 30 / r**2,
    "lj/gromacs": lambda r: 4 * ((number("1.1") / r)**12 + (number("1.1") / r)**6),
    "morse/smooth/linear": lambda r: m.exp(4 * (number("1.2") - r)) + 2 * m.exp(2 * (number("1.2") - r)),
    "zbl": lambda r: 196 * m.exp(-2 * r) / r,
}
