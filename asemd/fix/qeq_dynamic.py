r"""Charges for which the electronegativity of all atoms is the same, of point charges, by damped motion of the charges from where they are.

.. math:: g_i = \langle \mu \rangle - \mu_i, \qquad \mu_i = \chi_i + \eta_i q_i + \sum_j q_j / r_{ij}

Charges, of mass 0.016, move with the forces g, damped by ``qdamp`` (0.1), in steps of ``qstep`` (0.02), until the mean of all \|g\| is
below the tolerance and none above a hundred times it. The sum of charges stays what it is. Arguments and file as of fix qeq/point; only
chi and eta count. S. W. Rick, S. J. Stuart, B. J. Berne, J. Chem. Phys. 101, 6141 (1994). Source: LAMMPS manual, fix qeq/dynamic.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix.charge_equilibration import ChargeEquilibration

MASS = 0.016        # of charges, as in LAMMPS

class QEqDynamic(ChargeEquilibration):
    """Charges from their energy, by damped motion.

    Parameters
    ----------
    qdamp, qstep : float
        Damping and step of the charges.
    """

    style = "qeq/dynamic"
    options = {"warn": 1, "qdamp": 1, "qstep": 1}
    damping, step = 0.1, 0.02

    def __init__(self, *arguments, qdamp: float | None = None, qstep: float | None = None, **keywords):
        super().__init__(*arguments, **keywords)
        self.qdamp, self.qstep = self.damping if qdamp is None else qdamp, self.step if qstep is None else qstep
        if not (self.qdamp >= 0.0 and self.qstep > 0.0):
            raise InputError(f"fix {self.style}: qdamp must not be negative and qstep positive, got {self.qdamp:g} and {self.qstep:g}")

    def slope(self, matrix, chi, q, out) -> None:
        """The mean electronegativity less that of each atom: ``out (m,)``."""
        from asemd.kernels.charges import times
        times(*matrix, q, out)
        out += chi
        np.subtract(out.mean(), out, out=out)

    def find(self, loop, rows, matrix, chi, numbers):
        q, v, g = loop.system.q[rows].copy(), np.zeros(len(rows)), np.zeros(len(rows))
        half = 0.5 * self.qstep * self.qstep / MASS
        for _ in range(self.maxiter):
            v += g * half - self.qdamp * v
            q += v
            self.slope(matrix, chi, q, g)
            size = np.abs(g)
            if size.mean() <= self.tolerance and size.max() <= 100.0 * self.tolerance:
                return q
            v += g * half - self.qdamp * v
        self.too_many(loop, float(np.abs(g).mean()))
        return q
