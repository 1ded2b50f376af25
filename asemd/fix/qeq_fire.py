r"""Charges for which the electronegativity of all atoms is the same, of point charges, by the fast inertial relaxation engine FIRE.

Charges move with the forces of fix qeq/dynamic, and their velocities are turned towards these forces; where they are against them charges
stop and steps become half as long. No charge changes by more than 0.1 in a step. It ends when the mean of the forces is below the
tolerance. Keyword ``qstep`` (0.2): the first step is half of it; ``qdamp`` is read, but has no effect, in LAMMPS neither. Otherwise as fix
qeq/dynamic. LAMMPS computes the forces between periodic images with the charges of the iteration before the last.
E. Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006). Source: LAMMPS manual, fix qeq/fire.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.fix.qeq_dynamic import QEqDynamic

TURN = 0.8          # how far velocities are turned towards forces
FURTHEST = 0.1      # that a charge moves in a step


class QEqFire(QEqDynamic):
    """Charges from their energy, by FIRE. Parameters and errors as of `asemd.fix.qeq_dynamic.QEqDynamic`."""

    style = "qeq/fire"
    damping, step = 0.2, 0.2

    def find(self, loop, rows, matrix, chi, numbers):
        q, v, g = loop.system.q[rows].copy(), np.zeros(len(rows)), np.zeros(len(rows))
        dt, error = self.qstep, 0.0
        for _ in range(self.maxiter):
            self.slope(matrix, chi, q, g)
            if v @ g > 0.0:
                size = g @ g
                v = (1.0 - TURN) * v + (TURN * math.sqrt((v @ v) / size) * g if size else 0.0)
            else:
                v[:] = 0.0
                dt *= 0.5
            fastest = np.abs(v).max()
            now = FURTHEST / fastest if dt * fastest > FURTHEST else dt
            q += now * v
            v += now * g
            error = float(np.abs(g).mean())
            if error < self.tolerance:
                return q
        self.too_many(loop, error)
        return q
