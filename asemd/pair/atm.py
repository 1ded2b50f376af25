r"""Axilrod-Teller-Muto energy of triples: what the dispersion of three atoms adds to that of their pairs.

$$E=\sum_{i<j<k}\nu_{ijk}\frac{1+3\cos\gamma_i\cos\gamma_j\cos\gamma_k}{r_{ij}^3r_{jk}^3r_{ik}^3}$$

over triples whose three distances are below `cut` and whose product of distances is below the cube of `cut_triple`. It is added to a
potential of pairs with hybrid/overlay. ``pair_coeff I J K nu`` is for triples of types with I <= J <= K in any order; K may be a range.
"""
from __future__ import annotations

import math
from itertools import permutations

import numpy as np

from asemd import words as read
from asemd.errors import InputError
from asemd.kernels.manybody import PER_ATOM, share_triple
from asemd.manybody import ManyBody
from asemd.pairstyle import PairStyle, PairTables
from asemd.style import register


def atm(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    """Triples of the site and two neighbours; each is met from its atom in the lowest slot, or from each of its images."""
    nu, slots = arrays[0], shares[4]
    cut2, limit = constants[0], constants[1]
    energy = 0.0
    for j in range(n - 1):
        if slots[j] < i:
            continue
        ax, ay, az, a2 = near[0, j], near[1, j], near[2, j], near[3, j]
        for k in range(j + 1, n):
            strength = nu[ti, types[j], types[k]]
            if slots[k] < i or strength == 0.0:
                continue
            bx, by, bz, b2 = near[0, k], near[1, k], near[2, k], near[3, k]
            cx, cy, cz = bx - ax, by - ay, bz - az
            c2 = cx * cx + cy * cy + cz * cz
            product = a2 * b2 * c2
            if c2 >= cut2 or product > limit:
                continue
            strength /= 1.0 + (slots[j] == i) + (slots[k] == i)
            ab = ax * bx + ay * by + az * bz
            ac = ax * cx + ay * cy + az * cz
            bc = bx * cx + by * cy + bz * cz
            w = strength / (product * math.sqrt(product))
            v = -3.0 * ab * ac * bc * w / product
            e = w + v
            energy += e
            # by the squares of the three distances, which the products of vectors are sums of
            s = -1.5 * w - 2.5 * v
            t = -1.5 * w / product
            da = s / a2 + t * (ac * bc - ab * bc - ab * ac)
            db = s / b2 + t * (ac * bc + ab * bc + ab * ac)
            dc = s / c2 + t * (ab * ac - ac * bc - ab * bc)
            gjx, gjy, gjz = 2.0 * (da * ax - dc * cx), 2.0 * (da * ay - dc * cy), 2.0 * (da * az - dc * cz)
            gkx, gky, gkz = 2.0 * (db * bx + dc * cx), 2.0 * (db * by + dc * cy), 2.0 * (db * bz + dc * cz)
            grad[0, j] += gjx
            grad[1, j] += gjy
            grad[2, j] += gjz
            grad[0, k] += gkx
            grad[1, k] += gky
            grad[2, k] += gkz
            if PER_ATOM:
                share_triple(shares, j, k, e, gjx, gjy, gjz, gkx, gky, gkz)
    return energy


class ATM(ManyBody):
    """Coefficients by triples of types: of each pair of types those given for ranges of the third, in turn."""

    needs_newton = restarts = True

    def parse_coeff(self, words, settings):
        third, nu = read.exactly(words, 2, f"pair_coeff {self.name}: K and nu")
        if not all(w.isdigit() for w in third.split("*", 1) if w) or not third:
            raise InputError(f"pair_coeff {self.name}: the third type must be a number or a range, got {third!r}")
        return {"third": ((third, read.number(nu, f"pair_coeff {self.name}: nu")),)}

    def read(self, file, elements, settings):
        """Nothing: it has no file."""
        return {}

    def join(self, old, new):
        return {"third": tuple((k, v) for k, v in old.get("third", ()) if k != new["third"][0][0]) + new["third"]}

    def coeff_lines(self, coeff):
        return [[third, repr(nu)] for third, nu in coeff["third"]]

    def reach(self, coeff, settings):
        return settings["cut"]

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        return PairStyle.filled(self, coeffs, settings, ntypes, rule, only)

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        n = ntypes + 1
        rows, nu = np.zeros((1, n, n)), np.zeros((n, n, n))
        for (i, j), c in filled.items():
            rows[0, i, j] = rows[0, j, i] = settings["cut"] ** 2
            for third, value in c["third"]:
                first, star, last = third.partition("*")
                low = int(first or 1)
                high = int(last or ntypes) if star else low
                if not 1 <= low <= high <= ntypes:
                    raise InputError(f"pair_coeff {self.name}: the third type is {third}, but types go from 1 to {ntypes}")
                for k in range(max(j, low), high + 1):
                    for three in permutations((i, j, k)):
                        nu[three] = value
        return PairTables(rows, np.array([settings["cut"] ** 2, settings["cut_triple"] ** 6]), (nu,))


register(ATM("atm", site=atm, elements=False, settings="cut cut_triple", coeff="third nu", settings_example="4.5 2.5", example="* 0.072",
             units={"cut_triple": "distance", "third": "word", "nu": "energy*distance^9"},
             see="B. M. Axilrod and E. Teller, J. Chem. Phys. 11, 299 (1943); Y. Muto, Proc. Phys.-Math. Soc. Japan 17, 629 (1943)"))
