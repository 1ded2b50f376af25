r"""Rigid bodies at constant energy, by a symplectic splitting of their rotation.

The orientation q and the momentum P conjugate to it (with :math:`P = 2 S(q) L` of the angular momentum L in the body's frame) follow the
Hamiltonian

.. math:: H = \sum_{k=1}^{3} \frac{[P \cdot S_k(q)]^2}{8 I_k}

whose terms, rotations about one principal axis, are solved exactly, one after the other: axes 3 2 1 2 3, for halves of the step but for
axis 1. Half steps of the torque come before and after. No energy is lost in the long run, unlike with the iteration of ``fix rigid``.
The error of the splitting depends on the axes. Those of symmetric bodies are a matter of rounding each time a run takes the bodies anew
from their atoms: second runs differ by as much as this error, from LAMMPS's and from one long run, unless ``reinit no`` is given.

Source: T. F. Miller et al., J. Chem. Phys. 116, 8649 (2002); LAMMPS manual, fix rigid/nve. Output: as fix rigid.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import hook
from asemd.fix.rigid import LEVEL, Rigid
from asemd.kernels.rigid import (
    angular_velocity,
    follow_box,
    gather_forces,
    kick_conjugate,
    momentum_of,
    place_moved,
    turn_about,
    turn_axes,
    turn_symplectic,
)
from asemd.kernels.threads import barrier

MOVE = [*LEVEL, turn_about, turn_symplectic]


class RigidNVE(Rigid):
    """Rigid bodies; see `asemd.fix.rigid.Rigid` for the arguments."""

    style = "rigid/nve"
    symplectic = True

    def setup(self, loop) -> None:
        """Conjugate momenta of the orientations, besides."""
        super().setup(loop)
        b = self.kept
        x, y, z = np.einsum("nka,na->kn", b.axes, b.momentum)
        q = b.q.T
        b.p[:] = 2.0 * np.stack([-q[1] * x - q[2] * y - q[3] * z, q[0] * x + q[2] * z - q[3] * y, q[0] * y + q[3] * x - q[1] * z,
                                 q[0] * z + q[1] * y - q[2] * x], axis=1)

    @hook(uses=MOVE)
    def initial_integrate(th, s, p, b):
        barrier(th)
        half, count = 0.5 * th.dt * p[10], b.mass.shape[0]
        for k in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
            if p[2] != 0.0:
                follow_box(s, b, k)
            if p[3] == 2.0:
                gather_forces(s, p, b, k, 0.0)
            for d in range(3):
                b.v[k, d] += half / b.mass[k] * b.force[k, d] * b.moves[k, d]
                b.x[k, d] += th.dt * b.v[k, d]
                b.torque[k, d] *= b.moves[k, 3 + d]
            kick_conjugate(b.p[k], b.q[k], b.axes[k], b.torque[k], 2.0 * half)
            turn_symplectic(b.p[k], b.q[k], b.moments[k], th.dt)
            turn_axes(b.q[k], b.axes[k])
            momentum_of(b.p[k], b.q[k], b.axes[k], b.momentum[k])
            angular_velocity(b.momentum[k], b.axes[k], b.moments[k], b.omega[k])
            place_moved(th, s, p, b, k)
        barrier(th)
