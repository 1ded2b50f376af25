r"""Charges for which the electronegativity of all atoms is the same, of ions with clouds of charge: those of pair style coul/streitz.

.. math:: J(r) = C \left[ \frac{\mathrm{erfc}(\alpha r)}{r} + f_{ij}(r) \right], \qquad
          \chi_i \leftarrow \chi_i + C \sum_j Z_j (a_i - f_{ij}), \qquad
          \eta_i \leftarrow \eta_i - C \left( \frac{\mathrm{erfc}(\alpha r_c)}{r_c} + \frac{2 \alpha}{\sqrt\pi} \right)

with a and f as in pair style coul/streitz. A line of the file is ``type chi eta gamma zeta qcore``, gamma does not count, qcore is Z; or
the word ``coul/streitz`` stands in its place, and the parameters are those of that pair style. Keyword ``alpha`` (0.2, 1/distance).
Otherwise as fix qeq/point. Source: LAMMPS manual, fix qeq/slater.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix.qeq_point import QEqPoint
from asemd.manybody import element_of


class QEqSlater(QEqPoint):
    """Charges from their energy, of ions with clouds of charge.

    Parameters
    ----------
    alpha : float
        Damping of 1/r, 1/distance.
    """

    style = "qeq/slater"
    options = {"warn": 1, "alpha": 1}

    def __init__(self, *arguments, alpha: float = 0.2, **keywords):
        super().__init__(*arguments, **keywords)
        if alpha < 0.0:
            raise InputError(f"fix qeq/slater: alpha must not be negative, got {alpha:g}")
        self.alpha = alpha

    def from_pair_style(self, interactions):
        if self.parameters_of != "coul/streitz":
            return None
        for use in interactions.uses["pair"]:
            if use.style.name == "coul/streitz" and use.coeff:
                ntypes = max(max(pair) for pair in use.coeff)
                data = next(iter(use.coeff.values()))["data"]
                return {t: {**data[name], "qcore": data[name]["Z"]} for t, name in enumerate(element_of(use.coeff, ntypes))
                        if name is not None}
        raise InputError("fix qeq/slater coul/streitz needs pair_style coul/streitz and its pair_coeff before it")

    def wrong(self, numbers):
        return super().wrong(numbers) or ("" if numbers["zeta"] > 0.0 else "zeta must be positive")

    def elements(self, loop, i, j, r, numbers):
        from asemd.kernels.charges import slater
        c, h, field = loop.engine.units.qqr2e, np.zeros(len(r)), np.zeros(len(numbers["chi"]))
        slater(i, j, r, numbers["zeta"], numbers["qcore"], self.alpha, h, field)
        own = math.erfc(self.alpha * self.cutoff) / self.cutoff + 2.0 * self.alpha / math.sqrt(math.pi)
        return c * h, numbers["chi"] + c * field, numbers["eta"] - c * own
