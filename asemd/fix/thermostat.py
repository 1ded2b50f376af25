r"""What all thermostats share: a target temperature, a compute that measures the temperature, the energy of the bath.

The target ramps linearly over the run, :math:`T_0(t) = T_{start} + \frac{t - t_{begin}}{t_{end} - t_{begin}} (T_{stop} - T_{start})`.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from asemd.compute.pressure import find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, SimulationError
from asemd.fix import Fix
from asemd.fix.formula import Value, read
from asemd.fix.measured import take_temperature
from asemd.kernels.threads import reduce_sum
from asemd.words import number

if TYPE_CHECKING:
    from asemd.loop import Loop


class Thermostat(Fix):
    """Base class of thermostats.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units; a function of the loop is evaluated when needed.
    damping : float
        Relaxation time, in time units.

    Attributes
    ----------
    temp : Temp
        Measures the temperature; that of the group unless ``fix_modify ID temp`` names another one.
    takes_bias : bool
        Whether `temp` may be another style than temp: one with a bias, or with degrees of freedom of its own.

    Raises
    ------
    InputError
        A negative temperature, a damping time that is not positive.
    """

    ecouple = True
    takes_bias: ClassVar[bool] = False

    def __init__(self, group: str = "all", temperature: Value | tuple[float, float] = 300.0, damping: float = 100.0):
        super().__init__(group)
        if not isinstance(temperature, tuple):
            temperature = (temperature, 0.0 if callable(temperature) else temperature)
        self.start, self.stop = temperature
        if callable(self.stop):
            raise InputError(f"fix {self.style}: Tstop must be a number; a variable as Tstart is the target at all times")
        if min(self.stop, self.stop if callable(self.start) else self.start) < 0.0:
            raise InputError(f"fix {self.style}: temperatures must not be negative, got {self.start} and {self.stop}")
        if not damping > 0.0:
            raise InputError(f"fix {self.style}: the damping time must be positive, got {damping:g}")
        self.damping = damping
        self.temp = Temp(group)

    @classmethod
    def read_ramp(cls, words: list[str], session) -> tuple[Value, float]:
        """``Tstart Tstop``; when Tstart is a variable Tstop is read but not used."""
        start = read(words[0], f"fix {cls.style} Tstart", session)
        stop = number(words[1], f"fix {cls.style} Tstop")
        return start, max(stop, 0.0) if callable(start) else stop

    def target(self, loop: Loop):
        """The target temperature now; for an atom-style variable (n,) by atom row.

        Raises
        ------
        InputError
            A variable returned a negative temperature.
        """
        if callable(self.start):
            value = self.start(loop)
            if not (value >= 0.0 if isinstance(value, float) else (value >= 0.0).all()):
                raise InputError(f"fix {self.id} (style {self.style}): the variable returned a negative temperature")
            return value
        done = (loop.step - loop.begin) / (loop.end - loop.begin) if loop.end != loop.begin else 0.0
        return self.start + done * (self.stop - self.start)

    @property
    def plain(self) -> bool:
        """Whether compiled hooks can measure the temperature: it is that of all velocities of a group."""
        return type(self.temp) is Temp

    def modify_option(self, keyword, value, session):
        if keyword == "temp":
            found = find_temperature(value, session, "fix_modify temp")
            if type(found) is not Temp and not self.takes_bias:
                raise InputError(f"fix_modify temp: fix {self.style} takes a compute of style temp only, {value} has style {found.style}")
            take_temperature(self, found, session)
            return True
        if keyword == "energy" and value in ("yes", "on", "true"):
            raise InputError(f"fix_modify energy: the energy of fix {self.style} is that of a heat bath, not potential energy; "
                             "print it with the thermo keywords ecouple and econserve")
        return super().modify_option(keyword, value, session)


def thermal_velocities(loop: Loop, temp: Temp) -> np.ndarray:
    """(n, 3) by atom row: velocities now, without the bias of a temperature compute."""
    loop.sync_out()
    return temp.remove_bias(loop.snapshot())


def scale_thermal(loop: Loop, temp: Temp, group: str, factor: float) -> None:
    """Multiply the velocities of a group, but for the bias of a temperature compute, by a factor; not compiled."""
    thermal, mask = thermal_velocities(loop, temp), loop.groups[group]
    if temp.bias:
        loop.system.v[mask] += (factor - 1.0) * thermal[mask]
    else:
        loop.system.v[mask] *= factor
    loop.sync_in()


def measured_temperature(th, s, p):
    """The temperature of the group with bit ``p[1]``, from its degrees of freedom ``p[2]``, ``p[3]`` = boltz and ``p[4]`` = mvv2e."""
    bit, mine = np.int32(np.int64(p[1])), slice(th.lo, th.hi)
    mask, mass = s.mask[mine], s.mass[mine]
    twice = 0.0
    for d in range(3):
        v = s.v[d, mine]
        for i in range(v.size):
            if mask[i] & bit != 0:
                twice += mass[i] * v[i] * v[i]
    twice = reduce_sum(th, twice)
    return p[4] * twice / (p[2] * p[3]) if p[2] > 0.0 else 0.0


def ramped(th, p):
    """The target temperature of this step, from ``p[5]`` to ``p[6]`` over the run."""
    done = 0.0
    if th.end != th.begin:
        done = (th.step - th.begin) / (th.end - th.begin)
    return p[5] + done * (p[6] - p[5])


def scale_velocities(th, s, p, now, new):
    """Velocities of the group with bit ``p[0]`` from one temperature to another; ``p[7]`` gets the energy, ``p[8]`` counts zeros."""
    factor = math.sqrt(new / now) if now > 0.0 else 1.0
    if factor != 1.0:
        bit, mine = np.int32(np.int64(p[0])), slice(th.lo, th.hi)
        mask = s.mask[mine]
        for d in range(3):
            v = s.v[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] *= factor
    if th.tid == 0:
        p[7] += 0.5 * p[3] * p[2] * (now - new) if now > 0.0 else 0.0
        p[8] += 1.0 if now <= 0.0 else 0.0


class VelocityScaling(Thermostat):
    """Base class of thermostats that scale all velocities at the end of a step.

    A subclass names the compiled function ``scaled(now, target, dt, p)`` that gives the temperature to go to, and its numbers from ``p[9]``
    on by `settings`.
    """

    scaled = None
    takes_bias = True
    brings = ("temp",)

    def __init__(self, group="all", temperature=300.0, damping=1.0):
        super().__init__(group, temperature, damping)
        self.p = np.zeros(9)

    def hooks(self) -> dict[str, bool]:
        vars(self).pop("end_of_step", None)
        if callable(self.start) or not self.plain:
            self.end_of_step = self._in_python
        return super().hooks()

    def settings(self) -> tuple[float, ...]:
        return ()

    def parameters(self, loop) -> np.ndarray:
        energy, start = self.p[7], 0.0 if callable(self.start) else self.start
        self.p = np.array([loop.group_bit(self.group), loop.group_bit(self.temp.group), self.temp.dof(loop), loop.units.boltz,
                           loop.units.mvv2e, start, self.stop, energy, 0.0, *self.settings()], dtype=float)
        return self.p

    def resize(self, loop) -> None:
        self.p[2] = self.temp.dof(loop)

    def _in_python(self, loop) -> None:
        """One step with the target from a variable, or with a temperature that compiled code does not measure."""
        target = self.target(loop)
        loop.sync_out()
        state = loop.snapshot()
        now, dof = self.temp.scalar(state), self.temp.dof(state)
        if now <= 0.0:
            self.p[8] += 1.0
            return
        self.p[2] = dof
        new = type(self).scaled(now, target, loop.dt, self.p)
        if new != now:
            scale_thermal(loop, self.temp, self.group, math.sqrt(new / now))
        self.p[7] += 0.5 * self.p[3] * dof * (now - new)

    def finish(self, loop) -> None:
        if self.p[8] > 0.0:
            raise SimulationError(f"fix {self.id} (style {self.style}): the temperature of group {self.temp.group} was 0, "
                                  "there is nothing to scale; give the atoms velocities first")

    def scalar(self) -> float:
        """Energy taken out of the atoms so far, energy units."""
        return float(self.p[7])

    def state(self) -> dict:
        """The energy taken out."""
        return {"energy": self.scalar()}

    def restore(self, state: dict) -> None:
        self.p[7] = state["energy"]
