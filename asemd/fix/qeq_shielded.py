r"""Charges for which the electronegativity of all atoms is the same, shielded at short distances and tapered to zero at the cutoff.

.. math:: J(r) = \frac{14.4\, T(r / r_c)}{\left( r^3 + (\gamma_i \gamma_j)^{-3/2} \right)^{1/3}}, \qquad
          T(x) = 1 - 35 x^4 + 84 x^5 - 70 x^6 + 20 x^7

for parameters in eV and Angstrom. A line of the file is ``type chi eta gamma zeta qcore``, the last two do not count. Otherwise as fix
qeq/point. Source: LAMMPS manual, fix qeq/shielded.
"""
from __future__ import annotations

import numpy as np

from asemd.fix.qeq_point import QEqPoint

COULOMB = 14.4


class QEqShielded(QEqPoint):
    """Charges from their energy, shielded."""

    style = "qeq/shielded"

    def wrong(self, numbers):
        return super().wrong(numbers) or ("" if numbers["gamma"] > 0.0 else "gamma must be positive")

    def elements(self, loop, i, j, r, numbers):
        x, third = r / self.cutoff, numbers["gamma"] ** -1.5
        taper = 1.0 + (x * x) ** 2 * (-35.0 + x * (84.0 + x * (-70.0 + 20.0 * x)))
        return COULOMB * taper / np.cbrt(r * r * r + third[i] * third[j]), numbers["chi"].copy(), numbers["eta"]
