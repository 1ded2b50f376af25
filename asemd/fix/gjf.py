r"""Langevin dynamics by the complete set of Verlet-type thermostats of Gronbech-Jensen: positions have the right distribution at any step.

With :math:`g = \Delta t / \tau`, one Gaussian impulse :math:`\beta` of variance :math:`2 m k_B T_0 \Delta t / \tau` for each component and
step, :math:`c_1 = (1 + c_2) / 2` and :math:`c_3 = (1 - c_2) / g`:

.. math:: \begin{aligned}
          u &= \sqrt{c_1}\, v + \sqrt{c_3} \left( \tfrac{\Delta t}{2} \tfrac{F}{m} + \tfrac{\beta}{2 m} \right), \quad
          x \leftarrow x + \sqrt{c_3}\, \Delta t\, u, \quad \text{new } F, \\
          v &\leftarrow \tfrac{c_2}{\sqrt{c_1}} u + \sqrt{\tfrac{c_3}{c_1}} \left( \tfrac{\Delta t}{2} \tfrac{F}{m} +
          \tfrac{\beta}{2 m} \right) \end{aligned}

The methods 1 to 8 differ in :math:`c_2`: :math:`(1 - \tfrac g2) / (1 + \tfrac g2)`, :math:`e^{-g}`, :math:`1 - g`,
:math:`(\sqrt{1 + 4 g} - 1) / 2 g`, :math:`1 / (1 + g)`, :math:`1 / (1 + \tfrac g2)^2`, a number of one's own, :math:`\sqrt{1 + g^2} - g`.
Diffusion of free atoms and the distribution in a harmonic well are exact in all of them but 7, which has, as LAMMPS,
:math:`\sqrt{c_3} = - \sqrt{c_1} \ln(c_2) / g` and impulses of the variance that keeps the temperature, :math:`2 m k_B T_0 (1 - c_2) / c_3`:
its motion is faster or slower unless c2 is near :math:`e^{-g}`. The velocities seen are the half-step ones, u (``vel vhalf``, right for
harmonic forces), or those at the positions, v (``vel vfull``); what other fixes do to either counts. It moves the atoms itself: no fix nve
besides.

Source: N. Gronbech-Jensen, Mol. Phys. 118, e1662506 (2020); N. Gronbech-Jensen, O. Farago, Mol. Phys. 111, 983 (2013), for method 1.
Arguments: Tstart Tstop damp seed, as in fix langevin; vel vhalf or vfull; method 1 to 8, 7 followed by c2. Units: temperature, time. Noise
equals LAMMPS's in distribution, all else in every digit.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.fix.formula import write
from asemd.fix.gronbech_jensen import NONE, VELOCITIES
from asemd.fix.thermostat import Thermostat
from asemd.kernels.random import normal
from asemd.words import number, take, whole

METHODS = {1: lambda g: (1.0 - 0.5 * g) / (1.0 + 0.5 * g), 2: lambda g: math.exp(-g), 3: lambda g: 1.0 - g,
           4: lambda g: 2.0 / (math.sqrt(1.0 + 4.0 * g) + 1.0), 5: lambda g: 1.0 / (1.0 + g), 6: lambda g: (1.0 + 0.5 * g) ** -2,
           8: lambda g: 1.0 / (math.sqrt(1.0 + g * g) + g)}
OWN = 7
KEYWORDS = ("vel", "method")


class GJF(Thermostat):
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
    velocity : str
        ``vhalf`` or ``vfull``: which velocities the atoms show.
    method : int
        1 to 8.
    c2 : float, optional
        Of method 7: how much of the velocity is left after a step, between 0 and 1.

    Raises
    ------
    InputError
        A value out of its range, or at the start of a run a timestep that method 3 does not stand.

    Examples
    --------
    >>> GJF(temperature=300.0, damping=100.0, seed=4711, velocity="vhalf", method=1)
    """

    style = "gjf"
    integrates = True
    ecouple = False

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, seed: int = 1, velocity: str = "vhalf",
                 method: int = 1, c2: float | None = None):
        super().__init__(group, temperature, damping)
        if seed <= 0:
            raise InputError(f"fix gjf: seed must be a positive whole number, got {seed}")
        if velocity not in VELOCITIES:
            raise InputError(f"fix gjf: vel must be vhalf or vfull, got {velocity}{nearest(velocity, VELOCITIES)}")
        if method != OWN and method not in METHODS:
            raise InputError(f"fix gjf: method must be a number from 1 to 8, got {method}")
        if (c2 is not None) != (method == OWN):
            raise InputError("fix gjf: method 7, and no other, needs a number c2")
        if c2 is not None and not 0.0 < c2 < 1.0:
            raise InputError(f"fix gjf: c2 of method 7 must be between 0 and 1, got {c2:g}")
        self.seed, self.velocity, self.method, self.c2 = seed, velocity, method, c2
        self.a = np.zeros((1, 10))
        if callable(self.start):
            self.pre_force = self._follow_variable

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) < 4:
            raise InputError(f"fix gjf needs Tstart Tstop damp seed, got {len(words)} values")
        given = [cls.read_ramp(words, session), number(words[2], "fix gjf damp"), whole(words[3], "fix gjf seed")]
        options, words = {}, words[4:]
        while words:
            keyword, what = words[0], f"fix gjf {words[0]}"
            if keyword not in KEYWORDS:
                raise InputError(f"fix gjf: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            values = take(words[1:], 1, what)
            if keyword == "vel":
                options["velocity"] = values[0]
            else:
                options["method"], options["c2"] = whole(values[0], what), None
                if options["method"] == OWN:
                    values = take(words[1:], 2, f"{what} 7")
                    options["c2"] = number(values[1], f"{what} 7")
            words = words[1 + len(values):]
        return cls(group, *given, **options)

    def to_lammps(self) -> list[str]:
        words = [write(self.start), repr(self.stop), repr(self.damping), str(self.seed), "vel", self.velocity, "method", str(self.method)]
        return words + [repr(self.c2)] * (self.c2 is not None)

    def parameters(self, loop) -> np.ndarray:
        g, variable = loop.dt / self.damping, callable(self.start)
        c2 = self.c2 if self.method == OWN else METHODS[self.method](g)
        if not c2 > -1.0 or not g > 0.0:
            raise InputError(f"fix {self.id} (style gjf): method {self.method} needs a damping time above half a timestep, and a timestep "
                             "above 0")
        c1, c3 = 0.5 * (1.0 + c2), (1.0 - c2) / g
        if self.method == OWN:
            c3 = c1 * (math.log(c2) / g) ** 2
        ramp = (0.0, 0.0) if variable else (self.start, self.stop)
        impulse = 0.5 * (1.0 - c2) / c3 * loop.units.boltz / loop.units.mvv2e
        return np.array([loop.group_bit(self.group), self.seed, variable, *ramp, impulse, math.sqrt(c1), math.sqrt(c3), c2 / math.sqrt(c1),
                         math.sqrt(c3 / c1), self.velocity == "vhalf"], dtype=float)

    def atom_arrays(self, loop) -> np.ndarray:
        """Columns: the impulse / 2 m (3), the velocity at the position (3), that of the half step (3), the root of a variable's target."""
        if self.a.shape[0] != loop.system.n:
            self.a = np.full((loop.system.n, 10), NONE)
        if callable(self.start):
            self._follow_variable(loop)
        return self.a

    def _follow_variable(self, loop) -> None:
        self.a[:, 9] = np.sqrt(self.target(loop))

    @hook
    def initial_integrate(th, s, p, a):
        bit, seed, half, far = np.int32(np.int64(p[0])), np.int64(p[1]), 0.5 * th.dt, p[7] * th.dt
        done = 0.0
        if th.end != th.begin:
            done = (th.step - th.begin) / (th.end - th.begin)
        root, size = math.sqrt(p[3] + done * (p[4] - p[3])), math.sqrt(p[5])
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                spread = size * (a[row, 9] if p[2] != 0.0 else root) / math.sqrt(s.mass[i])
                for d in range(3):
                    v = a[row, 3 + d] if s.v[d, i] == a[row, 6 + d] else s.v[d, i]     # half-step velocities that nobody has changed
                    a[row, d] = spread * normal(seed, th.step, row, d)
                    u = p[6] * v + p[7] * (half * s.inverse_mass[i] * s.f[d, i] + a[row, d])
                    s.x[d, i] += far * u
                    s.v[d, i] = u

    @hook
    def final_integrate(th, s, p, a):
        bit, half, shown = np.int32(np.int64(p[0])), 0.5 * th.dt, p[10] != 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                for d in range(3):
                    u = s.v[d, i]
                    s.v[d, i] = p[8] * u + p[9] * (half * s.inverse_mass[i] * s.f[d, i] + a[row, d])
                    if shown:
                        a[row, 6 + d] = u

    @hook
    def end_of_step(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                for d in range(3):
                    a[row, 3 + d] = s.v[d, i]
                    s.v[d, i] = a[row, 6 + d]

    def hooks(self) -> dict[str, bool]:
        hooks = super().hooks()
        if self.velocity != "vhalf":
            del hooks["end_of_step"]
        return hooks

    def modify_option(self, keyword, value, session):
        if keyword == "energy":
            return Fix.modify_option(self, keyword, value, session)
        return super().modify_option(keyword, value, session)

    def state(self) -> dict:
        """Of ``vel vhalf`` the velocities at the positions, which are not those that the atoms have after a run."""
        return {"velocities": self.a[:, 3:9].copy()} if self.velocity == "vhalf" and len(self.a) > 1 else {}

    def restore(self, state: dict) -> None:
        """Velocities that are not those of the atoms any more are not used."""
        if "velocities" in state:
            self.a = np.full((len(state["velocities"]), 10), NONE)
            self.a[:, 3:9] = state["velocities"]
