r"""A torque on a group of atoms, as if it were a rigid body.

.. math:: F_i \leftarrow F_i + m_i\, \dot\omega \times d_i + m_i\, \omega \times (\omega \times d_i), \qquad
          I \dot\omega = T - \sum_i m_i (\omega \cdot d_i)\, d_i \times \omega

with the distance :math:`d_i` from the centre of mass, the inertia tensor I and the angular velocity :math:`\omega` of the group.

Source: LAMMPS manual, fix addtorque. Units: torque (energy). Output: a scalar, the energy :math:`-\sum_i F_i \cdot d_i` of the forces;
a vector of 3, the torque on the group before.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing, centre_of_mass, unwrapped
from asemd.kernels.threads import reduce_sum
from asemd.words import exactly


def turned(inertia, angular):
    """The angular velocity (or its rate) from the angular momentum (or the torque); none about the axis of a line of atoms."""
    xx, yy, zz, xy, xz, yz = inertia[0], inertia[1], inertia[2], inertia[3], inertia[4], inertia[5]
    lx, ly, lz = angular[0], angular[1], angular[2]
    cxx, cyy, czz = yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy
    cxy, cxz, cyz = xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - yz * xx
    determinant = xx * cxx + xy * cxy + xz * cxz
    mean = (xx + yy + zz) / 3.0
    if determinant > 1e-12 * mean * mean * mean:
        return ((cxx * lx + cxy * ly + cxz * lz) / determinant, (cxy * lx + cyy * ly + cyz * lz) / determinant,
                (cxz * lx + cyz * ly + czz * lz) / determinant)
    moment = 1.5 * mean         # I = moment (1 - n n)
    if not moment > 0.0:
        return 0.0, 0.0, 0.0
    return lx / moment, ly / moment, lz / moment


class AddTorque(Forcing):
    """Add a torque.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    torque : sequence of 3 of float or callable
        Components in torque units of the scene; a function of the loop returns a number.
    """

    style = "addtorque"
    minimizes = False
    told, size, first = 4, 3, 4
    modifies = ("energy",)

    def __init__(self, group: str = "all", torque=(0.0, 0.0, 0.0)):
        super().__init__(group, torque)
        if len(self.values) != 3:
            raise InputError(f"fix addtorque: a torque has 3 components, got {len(self.values)}")

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, cls.read_values(exactly(words, 3, "fix addtorque Tx Ty Tz"), "Tx Ty Tz", session))

    def to_lammps(self) -> list[str]:
        return self.value_words()

    def numbers(self, loop) -> list[float]:
        return [loop.units.mvv2e]

    @hook(uses=[unwrapped, centre_of_mass, turned])
    def post_force(th, s, p, a):
        bit, mvv2e = np.int32(np.int64(p[0])), p[10]
        mass, cx, cy, cz = centre_of_mass(th, s, bit)
        inertia, momentum, before, rest = np.zeros(6), np.zeros(3), np.zeros(3), np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                m = s.mass[i]
                x, y, z = unwrapped(s, i, 0) - cx, unwrapped(s, i, 1) - cy, unwrapped(s, i, 2) - cz
                inertia[0] += m * (y * y + z * z)
                inertia[1] += m * (x * x + z * z)
                inertia[2] += m * (x * x + y * y)
                inertia[3] -= m * x * y
                inertia[4] -= m * x * z
                inertia[5] -= m * y * z
                momentum[0] += m * (y * s.v[2, i] - z * s.v[1, i])
                momentum[1] += m * (z * s.v[0, i] - x * s.v[2, i])
                momentum[2] += m * (x * s.v[1, i] - y * s.v[0, i])
                before[0] += y * s.f[2, i] - z * s.f[1, i]
                before[1] += z * s.f[0, i] - x * s.f[2, i]
                before[2] += x * s.f[1, i] - y * s.f[0, i]
        for k in range(6):
            inertia[k] = reduce_sum(th, inertia[k])
        for k in range(3):
            momentum[k] = reduce_sum(th, momentum[k])
            before[k] = reduce_sum(th, before[k])
        wx, wy, wz = turned(inertia, momentum)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                x, y, z = unwrapped(s, i, 0) - cx, unwrapped(s, i, 1) - cy, unwrapped(s, i, 2) - cz
                along = s.mass[i] * (wx * x + wy * y + wz * z)
                rest[0] += along * (y * wz - z * wy)
                rest[1] += along * (z * wx - x * wz)
                rest[2] += along * (x * wy - y * wx)
        for k in range(3):
            rest[k] = p[7 + k] - mvv2e * reduce_sum(th, rest[k])
        rx, ry, rz = turned(inertia, rest)
        energy = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                m = s.mass[i]
                x, y, z = unwrapped(s, i, 0) - cx, unwrapped(s, i, 1) - cy, unwrapped(s, i, 2) - cz
                ux, uy, uz = mvv2e * (wy * z - wz * y), mvv2e * (wz * x - wx * z), mvv2e * (wx * y - wy * x)
                fx = m * (ry * z - rz * y + wy * uz - wz * uy)
                fy = m * (rz * x - rx * z + wz * ux - wx * uz)
                fz = m * (rx * y - ry * x + wx * uy - wy * ux)
                s.f[0, i] += fx
                s.f[1, i] += fy
                s.f[2, i] += fz
                energy -= fx * s.x[0, i] + fy * s.x[1, i] + fz * s.x[2, i]
        energy = reduce_sum(th, energy)
        if th.tid == 0:
            p[3] = energy
            for k in range(3):
                p[4 + k] = before[k]

    def scalar(self) -> float:
        """Energy of the added forces, energy units."""
        return float(self.p[3])
