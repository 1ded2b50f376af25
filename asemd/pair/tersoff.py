r"""Tersoff's bond-order potential of covalent materials.

$$E=\tfrac12\sum_i\sum_{j\ne i}f_C(r_{ij})\big[A e^{-\lambda_1r_{ij}}-b_{ij}Be^{-\lambda_2r_{ij}}\big],\quad
b_{ij}=(1+\beta^n\zeta_{ij}^n)^{-1/2n}$$
$$\zeta_{ij}=\sum_{k\ne i,j}f_C(r_{ik})\,g(\theta_{ijk})\,e^{\lambda_3^m(r_{ij}-r_{ik})^m},\quad
g=\gamma_{ijk}\Big[1+\frac{c^2}{d^2}-\frac{c^2}{d^2+(\cos\theta-\cos\theta_0)^2}\Big]$$

The cutoff function goes from 1 at R - D to 0 at R + D as half a sine. Entries of the file are triples: the atom i, the neighbour j it is
bonded to, the neighbour k that weakens the bond; pairs take theirs from the entry i j j. ``shift d`` adds d to all distances.
"""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asemd import words as read
from asemd.errors import InputError
from asemd.kernels.eight_sites import PLACE
from asemd.kernels.manybody import PER_ATOM, add_stretch, directions, share_pair, share_triple
from asemd.pair.tersoff_eight import angular8, order8, pair8, taper8, tersoff_eight
from asemd.style import register
from asemd.triples import TripleStyle

# columns of the table of triples; variants have more of them after these
COLUMNS = "reach inner R D A lambda1 B lambda2 lambda3 m gamma c d h n beta".split()


def taper(r, p):
    """Cutoff function and its derivative."""
    if r < p[1]:
        return 1.0, 0.0
    if r >= p[0]:
        return 0.0, 0.0
    w = 1.5707963267948966 / p[3]
    a = w * (r - p[2])
    return 0.5 - 0.5 * math.sin(a), -0.5 * w * math.cos(a)


def repulsion(r, p):
    fc, slope = taper(r, p)
    e = p[4] * math.exp(-p[5] * r)
    return fc * e, (slope - fc * p[5]) * e


def attraction(r, p):
    fc, slope = taper(r, p)
    e = -p[6] * math.exp(-p[7] * r)
    return fc * e, (slope - fc * p[7]) * e


def angular(x, p):
    """g and its derivative by the cosine; the difference of its large terms is written out, which else takes six digits in some files."""
    u = p[13] - x
    d2 = p[12] * p[12]
    w = 1.0 / (d2 + u * u)
    steep = p[10] * (p[11] / p[12]) ** 2
    return p[10] + steep * (u * u * w), -2.0 * steep * (u * w) * (d2 * w)


def order(zeta, p):
    """Bond order and its derivative by zeta."""
    n = p[14]
    t = p[15] * zeta
    if t <= 0.0:
        return 1.0, 0.0
    tn = math.pow(t, n)
    if not tn < 1e300:
        return 1.0 / math.sqrt(t), -0.5 / (math.sqrt(t) * zeta)
    b = math.pow(1.0 + tn, -0.5 / n)
    return b, -0.5 * b * tn / ((1.0 + tn) * zeta)


def longer(d, p):
    """exp(lambda3^m (rij - rik)^m) and its derivative by the difference."""
    if p[8] == 0.0:
        return 1.0, 0.0
    x = p[8] * d
    a = x * x * x if p[9] == 3.0 else x
    slope = 3.0 * p[8] * x * x if p[9] == 3.0 else p[8]
    if a > 69.0776:
        return 1e30, slope * 1e30
    if a < -69.0776:
        return 0.0, 0.0
    e = math.exp(a)
    return e, slope * e


def tersoff(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    three = arrays[0]
    energy = 0.0
    directions(n, near, room)
    for k in range(n):
        room[4, k] = math.sqrt(near[3, k]) + constants[0]
    for j in range(n):
        p = three[ti, types[j], types[j]]
        rj = room[4, j]
        if rj >= p[0]:
            continue
        ux, uy, uz, ij = room[0, j], room[1, j], room[2, j], room[3, j]
        if j < m:
            e, d = repulsion(rj, p)
            energy += e
            add_stretch(j, e, d, room, grad, shares)
        zeta, zj = 0.0, 0.0
        for k in range(n):
            room[5, k] = 0.0
            room[6, k] = 0.0
            q = three[ti, types[j], types[k]]
            rk = room[4, k]
            if k == j or rk >= q[0]:
                continue
            x = ux * room[0, k] + uy * room[1, k] + uz * room[2, k]
            fc, slope = taper(rk, q)
            g, dg = angular(x, q)
            ex, dex = longer(rj - rk, q)
            zeta += fc * g * ex
            zj += fc * g * dex
            room[5, k] = fc * dg * ex                    # by the cosine
            room[6, k] = g * (slope * ex - fc * dex)     # by r_ik
            room[7, k] = x
            if PER_ATOM:
                room[8, k] = fc * g * dex
        fa, dfa = attraction(rj, p)
        b, db = order(zeta, p)
        e = 0.5 * fa * b
        energy += e
        w = 0.5 * fa * db
        s = 0.5 * b * dfa + w * zj
        if PER_ATOM:
            d = 0.5 * b * dfa
            share_pair(shares, j, e, d * ux, d * uy, d * uz)
        sx, sy, sz = s * ux, s * uy, s * uz
        for k in range(n):
            if room[5, k] == 0.0 and room[6, k] == 0.0:
                continue
            x, vx, vy, vz = room[7, k], room[0, k], room[1, k], room[2, k]
            a = w * room[5, k] * ij
            c = w * room[5, k] * room[3, k]
            d = w * room[6, k] - c * x
            gjx = a * (vx - x * ux)
            gjy = a * (vy - x * uy)
            gjz = a * (vz - x * uz)
            gkx = c * ux + d * vx
            gky = c * uy + d * vy
            gkz = c * uz + d * vz
            sx += gjx
            sy += gjy
            sz += gjz
            grad[0, k] += gkx
            grad[1, k] += gky
            grad[2, k] += gkz
            if PER_ATOM:
                d = w * room[8, k]
                share_triple(shares, j, k, 0.0, gjx + d * ux, gjy + d * uy, gjz + d * uz, gkx, gky, gkz)
        grad[0, j] += sx
        grad[1, j] += sy
        grad[2, j] += sz
    return energy


def for_eights(style, three):
    """What `tersoff_eight` needs of the table of triples, or None where it cannot: m differs, a number is not positive whose logarithm is
    taken, or one is infinite. PLACE numbers for each pair of types, those of the triple with this neighbour twice; as many for each triple,
    with number kinds (kinds i + j) + kinds i + k, or none at all if what a triple takes does not depend on j; and m."""
    kinds = len(three)
    served = np.flatnonzero(three[..., 0].any(axis=(1, 2)))
    rows = three[np.ix_(served, served, served)]
    p = dict(zip(style.columns, np.moveaxis(rows, -1, 0)))
    n = np.arange(len(served))
    if len(served) == 0 or np.ptp(p["m"]) != 0.0 or min(p[name][:, n, n].min() for name in style.logarithms) <= 0.0:
        return None
    numbers = np.stack(np.broadcast_arrays(*style.numbers_of_eights(p)), axis=-1)
    if not np.isfinite(numbers).all():
        return None
    twice = numbers[:, n, n]
    of_pairs, of_triples = np.empty((kinds, kinds, PLACE)), np.zeros((0, PLACE))
    of_pairs[...] = numbers[0, 0, 0]      # what a far neighbour has, and types that never meet
    of_pairs[np.ix_(served, served)] = twice
    of_k = [*range(4), *range(10, 17)]
    if (numbers[..., of_k] != twice[:, None][..., of_k]).any():
        of_triples = np.empty((kinds * kinds * (kinds + 1), PLACE))
        of_triples[...] = numbers[0, 0, 0]
        i, j, k = np.meshgrid(served, served, served, indexing="ij")
        of_triples[kinds * (kinds * i + j) + kinds * i + k] = numbers
    return of_pairs.ravel(), of_triples.ravel(), p["m"].flat[0]


class Tersoff(TripleStyle):
    """Tersoff's entries and the shift of distances."""

    names = "m gamma lambda3 c d h n beta lambda2 B R D lambda1 A"
    columns = COLUMNS
    positive = "c d n beta lambda2 B R D lambda1 A gamma"
    energies = ("A", "B")
    logarithms: tuple[str, ...] = ("beta",)      # numbers of pairs whose logarithm `eight` takes

    def parse_settings(self, words):
        what = f"pair_style {self.name}"
        values = {"shift": 0.0}
        for name, value in zip(words[::2], words[1::2]):
            if name != "shift":
                raise InputError(f"{what}: unknown keyword {name!r}, expected shift")
            values["shift"] = read.number(value, f"{what} shift")
        if len(words) % 2:
            raise InputError(f"{what}: a value is missing after {words[-1]}")
        return values

    def format_settings(self, settings):
        return ["shift", repr(settings["shift"])] if settings["shift"] else []

    def check_entry(self, p, error):
        super().check_entry(p, error)
        if p["D"] > p["R"]:
            raise error(f"D, {p['D']:g}, is larger than R, {p['R']:g}")
        self.check_power(p, error)

    def check_power(self, p, error) -> None:
        if p["m"] not in (1.0, 3.0):
            raise error(f"m must be 1 or 3, got {p['m']:g}")

    def row(self, p, units) -> dict[str, float]:
        """Columns that are not numbers of the file."""
        return {"reach": p["R"] + p["D"], "inner": p["R"] - p["D"]}

    def numbers_of_eights(self, p):
        """PLACE columns of the tables of `tersoff_eight`: cutoff, pair, order with lambda3 and h, what g takes, and eight more of which the
        first is for g too."""
        return [*(p[name] for name in "reach inner R D A lambda1 B lambda2 n beta lambda3 h".split()),
                p["d"]**2, p["gamma"],
                p["gamma"] * np.divide(p["c"], p["d"], out=np.full_like(p["c"], np.inf), where=p["d"] > 0.0)**2, *[0.0] * 9]

    def fits(self, tables):
        return len(tables.arrays) > 1

    def alike(self, tables):
        rows = tables.arrays[1].reshape(-1, PLACE)
        return bool((tables.rows[0][1:, 1:] > 0.0).all() and (rows == rows[0]).all()) and len(tables.arrays[2]) == 0

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, shift)
        found = for_eights(self, tables.arrays[0]) if self.eight else None
        if found is None:
            return tables
        of_pairs, of_triples, power = found
        constants = np.array([settings["shift"], power, max(np.abs(t[10::PLACE]).max(initial=0.0) for t in (of_pairs, of_triples))])
        return replace(tables, arrays=(*tables.arrays, of_pairs, of_triples), constants=constants)

    def shortened(self, settings):
        return settings["shift"]

    def numbers(self, settings):
        return [settings["shift"]]


OPTIONS = dict(settings="[shift] [delta]", units={"shift": "word", "delta": "distance"}, rooms=9, eight=tersoff_eight, eight_rows=48)
register(Tersoff("tersoff", site=tersoff, eight_helpers=(taper8, angular8, order8, pair8),
                 helpers=(taper, repulsion, attraction, angular, order, longer), example="Si.tersoff Si",
                 see="J. Tersoff, Phys. Rev. B 37, 6991 (1988); 39, 5566 (1989)", **OPTIONS))
