r"""Constant energy with a limit on how far an atom may move in one step, to relax overlaps.

Velocity Verlet as in fix nve, but after each half kick a velocity longer than :math:`x_{max} / \Delta t` is shortened to that length.

Source: LAMMPS manual, fix nve/limit. Units: ``xmax`` in distance units. Output: the scalar counts the shortenings of this run.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix, hook
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import number


def kick_within(th, s, p):
    """A half kick, then the limit; adds to the count in ``p[2]``."""
    bit = np.int32(np.int64(p[0]))
    half = 0.5 * th.dt
    longest = p[1] * p[1]
    limited = 0
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            vsq = 0.0
            for d in range(3):
                s.v[d, i] += half * s.inverse_mass[i] * s.f[d, i]
                vsq += s.v[d, i] * s.v[d, i]
            if vsq > longest:
                limited += 1
                scale = math.sqrt(longest / vsq)
                for d in range(3):
                    s.v[d, i] *= scale
    limited = reduce_sum(th, float(limited))
    if th.tid == 0:
        p[2] += limited
    barrier(th)


class NVELimit(Fix):
    """Time integration with a limited displacement per step.

    Parameters
    ----------
    group : str
        The atoms it moves.
    xmax : float
        Longest displacement in one step, in distance units.

    Raises
    ------
    InputError
        `xmax` is not positive.
    """

    style = "nve/limit"
    integrates = True
    levels = "every"

    def __init__(self, group: str = "all", xmax: float = 0.1):
        super().__init__(group)
        if not xmax > 0.0:
            raise InputError(f"fix nve/limit: xmax must be positive, got {xmax:g}")
        self.xmax = xmax
        self.p = np.zeros(3)

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) != 1:
            raise InputError(f"fix nve/limit needs one value, xmax, got {len(words)}")
        return cls(group, number(words[0], "fix nve/limit xmax"))

    def to_lammps(self) -> list[str]:
        return [repr(self.xmax)]

    def parameters(self, loop) -> np.ndarray:
        self.p = np.array([float(loop.group_bit(self.group)), self.xmax / loop.dt if loop.dt else np.inf, 0.0])
        return self.p

    @hook(uses=[kick_within])
    def initial_integrate(th, s, p, a):
        kick_within(th, s, p)
        bit = np.int32(np.int64(p[0]))
        for d in range(3):
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    s.x[d, i] += th.dt * s.v[d, i]

    @hook(uses=[kick_within])
    def final_integrate(th, s, p, a):
        kick_within(th, s, p)

    def scalar(self) -> float:
        """How often a velocity was shortened in this run."""
        return float(self.p[2])
