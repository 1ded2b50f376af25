r"""$$E = -k_B T \ln \sum_{i=1}^n \frac{A_i}{w_i \sqrt{\pi/2}} \exp\left( -\frac{2 (r - r_i)^2}{w_i^2} \right)$$

Free energy of a bond whose length is distributed as a sum of Gaussians; ``A_i w_i r_i`` are given n times.
Source: Milano, Goudeau and Mueller-Plathe, J. Polym. Sci. B 43, 871 (2005); LAMMPS manual, bond_style gaussian.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.style import Packed, Parameter, Style, bond


class Gaussians(Style):
    """The number of coefficients follows from the second one."""

    def terms(self, n: int) -> tuple[Parameter, ...]:
        return (*self.coeff[:2], *(Parameter(f"{c}_{i}", "distance") for i in range(1, n + 1) for c in "Awr"))

    def parse_coeff(self, words, settings):
        if len(words) < 2:
            raise InputError(f"bond_coeff gaussian needs T n and A w r of each term, got {len(words)} value{'s' * (len(words) != 1)}")
        n = self.coeff[1].read(words[1], "bond_coeff gaussian")
        if n < 1:
            raise InputError(f"bond_coeff gaussian: n must be 1 or more, got {n}")
        if len(words) != 2 + 3 * n:
            raise InputError(f"bond_coeff gaussian needs T n and A w r of each of the {n} terms, {2 + 3 * n} values, got {len(words)}")
        values = self._read(words, self.terms(n), "bond_coeff")
        for i in range(1, n + 1):
            for c, good, text in (("A", values[f"A_{i}"] > 0.0, "> 0"), ("w", values[f"w_{i}"] > 0.0, "> 0"),
                                  ("r", values[f"r_{i}"] >= 0.0, "0 or more")):
                if not good:
                    raise InputError(f"bond_coeff gaussian: {c}_{i} must be {text}, got {values[f'{c}_{i}']:g}")
        return values

    def format_coeff(self, coeff):
        return [p.write(coeff[p.name]) for p in self.terms(coeff["n"])]

    def pack(self, settings, coeffs, ntypes, units):
        out, rows = np.zeros((3, ntypes + 1)), []
        for t, c in coeffs.items():
            out[:, t] = units.boltz * c["T"], len(rows), len(rows) + c["n"]
            rows += [(c[f"A_{i}"] / (c[f"w_{i}"] * math.sqrt(0.5 * math.pi)), c[f"w_{i}"], c[f"r_{i}"]) for i in range(1, c["n"] + 1)]
        return Packed(out, (np.array(rows).reshape(-1, 3),))


COEFF = (Parameter("T", "temperature"), Parameter("n", "integer"), Parameter("A_1", "distance"), Parameter("w_1", "distance"),
         Parameter("r_1", "distance"))


def gaussian_d2(r, kT, first, last, terms):
    least = math.inf
    for k in range(int(first), int(last)):
        y = (r - terms[k, 2]) / terms[k, 1]
        least = min(least, y * y)
    total = pull = bend = 0.0
    for k in range(int(first), int(last)):
        w = terms[k, 1]
        y = (r - terms[k, 2]) / w
        weight = terms[k, 0] * math.exp(2.0 * (least - y * y))
        total += weight
        pull += weight * y / w
        bend += weight * (1.0 - 4.0 * y * y) / (w * w)
    pull /= total
    return 4.0 * kT * (bend / total + 4.0 * pull * pull)


@bond("gaussian", cls=Gaussians, coeff=COEFF, example="300.0 2 0.0128 0.375 1.37 0.0730 0.148 1.63", equilibrium="r_1", d2=gaussian_d2)
def gaussian(r, kT: "energy", first, last, terms: "array"):
    # the largest exponential is taken out of the sum, so that it cannot underflow
    least = math.inf
    for k in range(int(first), int(last)):
        y = (r - terms[k, 2]) / terms[k, 1]
        least = min(least, y * y)
    total = pull = 0.0
    for k in range(int(first), int(last)):
        y = (r - terms[k, 2]) / terms[k, 1]
        weight = terms[k, 0] * math.exp(2.0 * (least - y * y))
        total += weight
        pull += weight * y / terms[k, 1]
    return kT * (2.0 * least - math.log(total)), 4.0 * kT * pull / total
