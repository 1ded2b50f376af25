r"""Hooks of ``fix langevin ... gjf``, the discretisation of Gronbech-Jensen and Farago: positions have the right distribution.

With :math:`c = \Delta t / 2 \tau`, :math:`b = 1 / (1 + c)` and one Gaussian impulse :math:`\beta` of variance
:math:`2 k_B T \Delta t / (m \tau)` for each component and step:

.. math:: w = b \left( v + \tfrac{\Delta t}{2} \tfrac{F}{m} + \tfrac{\beta}{2} \right), \quad x \leftarrow x + \Delta t\, w, \quad
          \text{new } F, \quad v \leftarrow (1 - c)\, w + \tfrac{\beta}{2} + \tfrac{\Delta t}{2} \tfrac{F}{m}

The moves and the kicks are those of fix nve, which comes after this fix; here velocities are changed before the first and before the second
kick. The columns of ``a``: what friction and noise added in this step (3), the on-site velocity (3), the half-step velocity that took its
place (3), whether a step is under way, the square root of the target temperature of a variable.

Source: N. Gronbech-Jensen, O. Farago, Mol. Phys. 111, 983 (2013); half-step velocity: L. F. G. Jensen, N. Gronbech-Jensen, Mol. Phys. 117,
2511 (2019).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.kernels.random import normal
from asemd.kernels.threads import reduce_sum

NONE = 1e300        # in the place of a half-step velocity: there is none
COLUMNS = 11
VELOCITIES = ("vhalf", "vfull")


def check_order(fix, fixes) -> None:
    """The hooks need fix nve after them, and nobody else who moves the atoms.

    Raises
    ------
    InputError
        Says what is in the way.
    """
    at = next((k for k, f in enumerate(fixes) if f is fix), 0)
    for k, other in enumerate(fixes):
        if other.integrates and other.style != "nve":
            raise InputError(f"fix {fix.id} (langevin gjf) works with fix nve, not with fix {other.id} (style {other.style})")
        if other.integrates and k < at:
            raise InputError(f"fix {fix.id} (langevin gjf) must come before fix {other.id} (style nve)")


class Hooks:
    """What `asemd.fix.langevin.Langevin` does with ``gjf``."""

    @hook
    def initial_integrate(th, s, p, a):
        bit, seed = np.int32(np.int64(p[0])), np.int64(p[1])
        done = 0.0
        if th.end != th.begin:
            done = (th.step - th.begin) / (th.end - th.begin)
        root = math.sqrt(p[5] + done * (p[6] - p[5]))
        size = math.sqrt(2.0 * th.dt * p[7] * p[8])
        total = np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                warm = a[row, 10] if p[4] != 0.0 else root
                spread = size * warm / math.sqrt(p[16 + s.type[i]] * s.mass[i])
                for d in range(3):
                    a[row, d] = spread * normal(seed, th.step, row, d)
                    total[d] += s.mass[i] * a[row, d]
        for d in range(3):
            mean = reduce_sum(th, total[d]) / p[9] if p[3] != 0.0 else 0.0
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    row = s.row[i]
                    a[row, d] -= mean / s.mass[i]
                    a[row, 9] = 1.0
                    v = a[row, 3 + d] if s.v[d, i] == a[row, 6 + d] else s.v[d, i]
                    a[row, 3 + d] = v
                    kick = 0.5 * th.dt * s.inverse_mass[i] * s.f[d, i]
                    b = 1.0 / (1.0 + 0.5 * th.dt * p[7] / p[16 + s.type[i]])
                    s.v[d, i] = b * (v + kick + 0.5 * a[row, d]) - kick

    @hook
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0 and a[s.row[i], 9] != 0.0:      # not on the forces before the first step
                row = s.row[i]
                c = 0.5 * th.dt * p[7] / p[16 + s.type[i]]
                a[row, 9] = 0.0
                for d in range(3):
                    w = s.v[d, i]
                    a[row, d] -= 2.0 * c * w
                    if p[15] != 0.0:
                        a[row, 6 + d] = w * math.sqrt(1.0 + c)
                    s.v[d, i] += 0.5 * a[row, d]

    @hook
    def end_of_step(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        work = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                for d in range(3):
                    v = s.v[d, i]
                    work += 0.5 * s.mass[i] * a[row, d] * (a[row, 3 + d] + v)
                    if p[15] != 0.0:
                        a[row, 3 + d] = v
                        s.v[d, i] = a[row, 6 + d]
        work = reduce_sum(th, work)
        if th.tid == 0:
            p[11] += p[14] * work
