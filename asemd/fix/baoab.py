r"""Langevin dynamics whose positions stay right at large steps and any friction: the splitting BAOAB. A fix of asemd's own, not of LAMMPS.

.. math:: \begin{aligned}
          B:&\; v \leftarrow v + \tfrac{\Delta t}{2} \tfrac{F}{m} &\quad A:&\; x \leftarrow x + \tfrac{\Delta t}{2} v \\
          O:&\; v \leftarrow e^{-\Delta t / \tau} v + \sqrt{\left(1 - e^{-2 \Delta t / \tau}\right) \tfrac{k_B T_0}{m}}\; R &\quad
          A:&\; x \leftarrow x + \tfrac{\Delta t}{2} v, \quad \text{new } F, \quad B \end{aligned}

with Gaussian numbers R that depend on seed, step and atom only. It moves the atoms itself: no fix nve besides. For harmonic forces of
frequency :math:`\omega` the positions have exactly the temperature :math:`T_0` for every :math:`\Delta t / \tau` and every stable step,
:math:`\omega \Delta t < 2`; the velocities are colder by :math:`(\omega \Delta t / 2)^2`, which is an error of the velocities alone. For
other forces the error of averages over positions is of fourth order in the step at high friction. The scalar of this fix (thermo keywords
ecouple, econserve) is the energy given to the heat bath in the steps O, so that econserve shows the error of the other ones.

Source: B. Leimkuhler, C. Matthews, Appl. Math. Res. Express 2013, 34 (2013); J. Chem. Phys. 138, 174102 (2013). Arguments: Tstart Tstop
damp seed, as in fix langevin; Tstart may be a variable. Units: temperature, time. For a script that LAMMPS has to run: fix langevin with
the keyword gjf, and fix nve.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.formula import write
from asemd.fix.nve import NVE
from asemd.fix.thermostat import Thermostat
from asemd.kernels.random import normal
from asemd.kernels.threads import reduce_sum
from asemd.words import number, whole


class BAOAB(Thermostat):
    """Time integration with friction and noise.

    Parameters
    ----------
    group : str
        The atoms it moves.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units of the scene; a function of the loop may return one
        number or one per atom.
    damping : float
        Relaxation time m / friction coefficient, in time units of the scene.
    seed : int
        A positive number.

    Raises
    ------
    InputError
        A negative temperature, a damping time or a seed that is not positive.

    Examples
    --------
    >>> BAOAB(temperature=300.0, damping=100.0, seed=4711)
    """

    style = "baoab"
    integrates = True

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, seed: int = 1):
        super().__init__(group, temperature, damping)
        if seed <= 0:
            raise InputError(f"fix baoab: seed must be a positive whole number, got {seed}")
        self.seed = seed
        self.p, self.a = np.zeros(9), np.zeros((1, 1))
        if callable(self.start):
            self.pre_force = self._follow_variable

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) != 4:
            raise InputError(f"fix baoab needs Tstart Tstop damp seed, got {len(words)} values")
        return cls(group, cls.read_ramp(words, session), number(words[2], "fix baoab damp"), whole(words[3], "fix baoab seed"))

    def to_lammps(self) -> list[str]:
        return [write(self.start), repr(self.stop), repr(self.damping), str(self.seed)]

    def parameters(self, loop) -> np.ndarray:
        variable = callable(self.start)
        ramp = (0.0, 0.0) if variable else (self.start, self.stop)
        self.p = np.array([loop.group_bit(self.group), self.seed, variable, *ramp, 1.0 / self.damping, loop.units.boltz / loop.units.mvv2e,
                           loop.units.mvv2e, self.p[8]], dtype=float)
        return self.p

    def atom_arrays(self, loop) -> np.ndarray | None:
        """The square root of the target temperature, for a variable."""
        if not callable(self.start):
            return None
        self.a = np.zeros((loop.system.n, 1))
        self._follow_variable(loop)
        return self.a

    def _follow_variable(self, loop) -> None:
        self.a[:, 0] = np.sqrt(self.target(loop))

    @hook
    def initial_integrate(th, s, p, a):
        bit, seed = np.int32(np.int64(p[0])), np.int64(p[1])
        done = 0.0
        if th.end != th.begin:
            done = (th.step - th.begin) / (th.end - th.begin)
        root = math.sqrt(p[3] + done * (p[4] - p[3]))
        keep = math.exp(-th.dt * p[5])
        size = math.sqrt(-math.expm1(-2.0 * th.dt * p[5]) * p[6])
        half = 0.5 * th.dt
        given = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row, mass = s.row[i], s.mass[i]
                spread = size * (a[row, 0] if p[2] != 0.0 else root) / math.sqrt(mass)
                for d in range(3):
                    v = s.v[d, i] + half * s.inverse_mass[i] * s.f[d, i]
                    new = keep * v + spread * normal(seed, th.step, row, d)
                    s.x[d, i] += half * v
                    s.x[d, i] += half * new
                    s.v[d, i] = new
                    given += 0.5 * mass * (v - new) * (v + new)
        given = reduce_sum(th, given)
        if th.tid == 0:
            p[8] += p[7] * given

    final_integrate = staticmethod(NVE.final_integrate)     # the last B

    def scalar(self) -> float:
        """Energy given to the heat bath so far, energy units."""
        return float(self.p[8])

    def state(self) -> dict:
        """The energy given to the bath."""
        return {"energy": self.scalar()}

    def restore(self, state: dict) -> None:
        self.p[8] = state["energy"]
