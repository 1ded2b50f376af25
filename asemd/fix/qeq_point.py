r"""Charges for which the electronegativity of all atoms is the same, of point charges: :math:`J(r) = 1/r` within the cutoff.

.. math:: (\eta + J)\, s = -\chi, \qquad (\eta + J)\, t = -1, \qquad q = s - t \sum_i s_i / \sum_i t_i

Both by conjugate gradients, from guesses by the last charges; charges add up to 0. Chi, eta and 1/r are in the same units, those of the
file: as in LAMMPS there is no constant of energy. A line of the file is ``type chi eta gamma zeta qcore``, the last three do not count.

Arguments: Nevery cutoff tolerance maxiter qfile, keyword ``warn yes|no``. The cutoff must not be beyond that of the pair style, whose
neighbour list is used. See `asemd.fix.charge_equilibration`. Source: LAMMPS manual, fix qeq/point.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.fix.charge_equilibration import ChargeEquilibration


class QEqPoint(ChargeEquilibration):
    """Charges from their energy, by a system of linear equations.

    Parameters and errors as of `asemd.fix.charge_equilibration.ChargeEquilibration`.
    """

    style = "qeq/point"

    def find(self, loop, rows, matrix, chi, numbers):
        old = self.history[rows]
        s = 4.0 * (old[:, 0] + old[:, 2]) - (6.0 * old[:, 1] + old[:, 3])
        t = old[:, 6] + 3.0 * (old[:, 4] - old[:, 5])
        inverse = 1.0 / numbers["eta"][rows]
        self.solve(loop, matrix, inverse, -chi, s)
        self.solve(loop, matrix, inverse, np.full(len(rows), -1.0), t)
        self.history[rows] = np.column_stack([s, old[:, :3], t, old[:, 4:7]])
        return s - s.sum() / t.sum() * t

    def solve(self, loop, matrix, inverse: np.ndarray, b: np.ndarray, x: np.ndarray) -> None:
        """Conjugate gradients from x (m,), in place; `inverse` multiplies residuals."""
        from asemd.kernels.charges import times
        product = np.zeros(len(x))
        times(*matrix, x, product)
        residual = b - product
        d = residual * inverse
        size, norm = float(residual @ d), math.sqrt(b @ b)
        if norm == 0.0:
            x[:] = 0.0
            return
        for _ in range(1, self.maxiter):
            if math.sqrt(size) / norm <= self.tolerance:
                return
            times(*matrix, d, product)
            step = size / float(d @ product)
            x += step * d
            residual -= step * product
            p = residual * inverse
            before, size = size, float(residual @ p)
            d = p + size / before * d
        self.too_many(loop, math.sqrt(size) / norm)
