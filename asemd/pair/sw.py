r"""Stillinger-Weber potential of silicon and of other materials of tetrahedra.

$$E=\sum_i\sum_{j>i}A\epsilon\Big[B\Big(\frac{\sigma}{r_{ij}}\Big)^p-\Big(\frac{\sigma}{r_{ij}}\Big)^q\Big]e^{\sigma/(r_{ij}-a\sigma)}+
\sum_i\sum_{j<k}\lambda\epsilon(\cos\theta_{jik}-\cos\theta_0)^2e^{\gamma\sigma/(r_{ij}-a\sigma)+\gamma\sigma/(r_{ik}-a\sigma)}$$

An entry of the file is a triple of elements, the one in the middle first; pairs take theirs from the entry i j j. ``threebody off`` leaves
the triples out. A tolerance in the file that is not 0 ends the interaction where its exponential falls below it.
"""
from __future__ import annotations

import math

import numpy as np

from asemd import words as read
from asemd.errors import InputError
from asemd.kernels.eight_sites import ALIKE, FREE, PLACE, PLACES, ROW, bend8, coefficients8
from asemd.kernels.functions8 import exp8
from asemd.kernels.manybody import add_bend, add_stretch, directions
from asemd.kernels.vectors8 import all8, below8, inverse_root8, load8, rows8, smaller8, store8
from asemd.manybody import element_of
from asemd.pairstyle import PairTables
from asemd.style import register
from asemd.triples import TripleStyle

NAMES = "epsilon sigma a lambda gamma costheta A B p q tol"


def power(x, n):
    """x^n, with whole exponents as products."""
    if n == 4.0:
        return (x * x) * (x * x)
    if n == 0.0:
        return 1.0
    if n == 2.0:
        return x * x
    return math.pow(x, n)


def bend(delta, constants):
    """What counts of the deviation of a cosine, and the derivative."""
    return delta, 1.0


def neighbours(n, m, ti, near, types, room, grad, two, shares):
    """Pair energies of the first `m` of n neighbours; what triples need of each goes to `room`: its unit vector, 1/r, the exponential and
    minus its logarithm's derivative."""
    energy = 0.0
    directions(n, near, room)
    for k in range(n):
        t = types[k]
        ir = room[3, k]
        r = near[3, k] * ir
        s = 1.0 / (r - two[ti, t, 1])
        gs = two[ti, t, 2] * s
        room[4, k] = math.exp(gs)
        room[5, k] = gs * s
        if k < m:
            x = two[ti, t, 0] * ir
            e = math.exp(two[ti, t, 0] * s)
            b = two[ti, t, 4] * power(x, two[ti, t, 5])
            c = two[ti, t, 7] * power(x, two[ti, t, 6])
            u = (b - c) * e
            d = -((two[ti, t, 5] * b - two[ti, t, 6] * c) * ir + (b - c) * two[ti, t, 0] * s * s) * e
            energy += u
            add_stretch(k, u, d, room, grad, shares)
    return energy


def sw(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    two, three = arrays[0], arrays[1]
    energy = neighbours(n, m, ti, near, types, room, grad, two, shares)
    for j in range(n - 1):
        for k in range(j + 1, n):
            c = room[0, j] * room[0, k] + room[1, j] * room[1, k] + room[2, j] * room[2, k]
            delta, slope = bend(c - three[ti, types[j], types[k], 1], constants)
            w = three[ti, types[j], types[k], 0] * delta * room[4, j] * room[4, k]
            e = w * delta
            energy += e
            add_bend(j, k, c, e, 2.0 * w * slope, -e * room[5, j], -e * room[5, k], room, grad, shares)
    return energy


def sw_eight(end, b, types, arrays, constants):
    """The same for p = 4 and q = 0, eight sites at a time (`asemd.kernels.eight_sites`), with the tables of `for_eights`. Rows of the work
    space: 8 to 10 unit vectors, 11 inverse distances, 12 the exponential of triples, 13 its logarithm's slope."""
    pair_table, triple_table, kinds = arrays[2], arrays[3], arrays[0].shape[0]
    flat, triples, c0, _ = coefficients8(pair_table, types, PLACES, 4)
    own = load8(b, 7 * ROW)
    energy = all8(0.0)
    for k in range(0, end, 8):
        sigma, cut, width, pairs = coefficients8(pair_table, types, PLACES + k, 0)
        if not ALIKE:
            flat, _, _, _ = rows8(pair_table, types, PLACES + k, 4)
        r2 = load8(b, 3 * ROW + k)
        ir = inverse_root8(r2)
        ux, uy, uz = load8(b, k) * ir, load8(b, ROW + k) * ir, load8(b, 2 * ROW + k) * ir
        s = 1.0 / smaller8(r2 * ir - cut, -1e-12 * cut)      # where it ends, and for far neighbours, exponentials become 0
        g = width * s
        store8(b, 8 * ROW + k, ux)
        store8(b, 9 * ROW + k, uy)
        store8(b, 10 * ROW + k, uz)
        store8(b, 11 * ROW + k, ir)
        store8(b, 12 * ROW + k, exp8(g))
        store8(b, 13 * ROW + k, g * s)
        x = sigma * ir
        x2 = x * x
        a = pairs * (x2 * x2)
        e = below8(0.125 * k, own, exp8(sigma * s), 0.0)
        energy = energy + (a - flat) * e
        d = (0.0 - (4.0 * a * ir + (a - flat) * sigma * (s * s))) * e
        store8(b, 4 * ROW + k, d * ux)
        store8(b, 5 * ROW + k, d * uy)
        store8(b, 6 * ROW + k, d * uz)
    for j in range(0, end, 8):
        ux, uy, uz = load8(b, 8 * ROW + j), load8(b, 9 * ROW + j), load8(b, 10 * ROW + j)
        ij, gj, h = load8(b, 11 * ROW + j), load8(b, 13 * ROW + j), load8(b, 12 * ROW + j)
        sx, sy, sz = load8(b, 4 * ROW + j), load8(b, 5 * ROW + j), load8(b, 6 * ROW + j)
        for k in range(j + 8, end, 8):
            vx, vy, vz = load8(b, 8 * ROW + k), load8(b, 9 * ROW + k), load8(b, 10 * ROW + k)
            c = ux * vx + uy * vy + uz * vz
            if not ALIKE:
                store8(types, FREE, load8(types, PLACES + j) * all8(kinds) + load8(types, PLACES + k))
                triples, c0, _, _ = rows8(triple_table, types, FREE, 0)
            delta = c - c0
            w = triples * h * load8(b, 12 * ROW + k) * delta
            e = w * delta
            energy = energy + e
            w = w + w
            gx, gy, gz = bend8(c, e, w, ij, gj, ux, uy, uz, vx, vy, vz)
            sx, sy, sz = sx + gx, sy + gy, sz + gz
            gx, gy, gz = bend8(c, e, w, load8(b, 11 * ROW + k), load8(b, 13 * ROW + k), vx, vy, vz, ux, uy, uz)
            store8(b, 4 * ROW + k, load8(b, 4 * ROW + k) + gx)
            store8(b, 5 * ROW + k, load8(b, 5 * ROW + k) + gy)
            store8(b, 6 * ROW + k, load8(b, 6 * ROW + k) + gz)
        store8(b, 4 * ROW + j, sx)
        store8(b, 5 * ROW + j, sy)
        store8(b, 6 * ROW + j, sz)
    return energy


class SW(TripleStyle):
    """Tables by atom type from the triples of the file: of pairs and of triples."""

    names, positive = NAMES, "epsilon sigma a lambda gamma A B p q tol"

    def fits(self, tables):
        return len(tables.arrays) > 2

    def alike(self, tables):
        table = tables.arrays[2].reshape(-1, PLACE)
        return bool((tables.rows[0][1:, 1:] > 0.0).all() and (table == table[0]).all()
                    and (tables.arrays[1][1:, 1:, 1:] == tables.arrays[1][1, 1, 1]).all())

    def parse_settings(self, words):
        what = f"pair_style {self.name}"
        values = {"threebody": "on"}
        for name, value in zip(words[::2], words[1::2]):
            if name != "threebody":
                raise InputError(f"{what}: unknown keyword {name!r}, expected threebody")
            values["threebody"] = "on" if read.yes_no(value, f"{what} threebody") else "off"
        if len(words) % 2:
            raise InputError(f"{what}: a value is missing after {words[-1]}")
        return values

    def format_settings(self, settings):
        return ["threebody", "off"] if settings["threebody"] == "off" else []

    def for_some_types(self, settings):
        return settings["threebody"] == "off"

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element = element_of(filled, ntypes)
        n = ntypes + 1
        rows, two, three = np.zeros((1, n, n)), np.zeros((n, n, 8)), np.zeros((n, n, n, 2))
        for (a, b), c in filled.items():
            unit = self.unit_factor(c, units)
            for i, j in {(a, b), (b, a)}:
                p = c["data"][element[i], element[j], element[j]]
                sigma, cut, epsilon = p["sigma"], p["sigma"] * p["a"], p["epsilon"] * unit
                rows[0, i, j] = ends_at(p) ** 2
                two[i, j] = [sigma, cut, p["gamma"] * sigma, 0.0, p["A"] * epsilon * p["B"], p["p"], p["q"], p["A"] * epsilon]
                for k in range(1, n):
                    if element[k] is not None and settings["threebody"] == "on":
                        q = c["data"][element[i], element[j], element[k]]
                        three[i, j, k] = [q["lambda"] * q["epsilon"] * unit, q["costheta"]]
        more = for_eights(rows[0] > 0.0, two, three) if self.eight else ()
        return PairTables(rows, np.array(self.numbers(settings)), (two, three, *more))

    def numbers(self, settings):
        """Constants of `bend`."""
        return [0.0]


def for_eights(served, two, three) -> tuple[np.ndarray, ...]:
    """Tables of `sw_eight`, if p = 4 and q = 0 in all pairs that are `served`: PLACE numbers for each pair of types, the last ones of the
    triple with this neighbour twice, and as many for each triple, with number kinds (kinds i + j) + kinds i + k."""
    pairs = two[served]
    if len(pairs) == 0 or (pairs[:, 5] != 4.0).any() or (pairs[:, 6] != 0.0).any():
        return ()
    kinds = len(two)
    first = tuple(np.argwhere(served)[0])
    of_pairs = np.zeros((kinds, kinds, PLACE))
    same = three[:, np.arange(kinds), np.arange(kinds)]
    of_pairs[..., :5], of_pairs[..., 5:7] = two[..., [0, 1, 2, 4, 7]], same
    of_pairs[~served] = of_pairs[first]      # what a far neighbour has, and types that never meet
    of_triples = np.zeros((kinds * kinds * (kinds + 1), PLACE))
    i, j, k = np.indices(three.shape[:3])
    of_triples[kinds * (kinds * i + j) + kinds * i + k, :2] = three
    return of_pairs.ravel(), of_triples.ravel()


def ends_at(p) -> float:
    """Where a pair ends: at a sigma, or before, where the exponential falls below the tolerance."""
    tol = min(p["tol"], 0.01)
    width = p["gamma"] * p["sigma"] if p["gamma"] < 1.0 else p["sigma"]
    return p["sigma"] * p["a"] + (width / math.log(tol) if tol > 0.0 else 0.0)


register(SW("sw", site=sw, eight=sw_eight, eight_rows=14, helpers=(power, bend, neighbours), rooms=6,
            settings="[threebody] [on|off]", units={"threebody": "word", "on|off": "word"}, example="Si.sw Si",
            see="F. H. Stillinger and T. A. Weber, Phys. Rev. B 31, 5262 (1985)"))
