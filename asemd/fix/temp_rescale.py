r"""Thermostat by brute force: every N steps velocities are scaled towards the target temperature if they are too far from it.

.. math:: T \leftarrow T - \phi\,(T - T_0) \quad \text{if } |T - T_0| > w

with the fraction :math:`\phi` and the window w. It does not move atoms: use it with fix nve.

Source: L. V. Woodcock, Chem. Phys. Lett. 10, 257 (1971); LAMMPS manual, fix temp/rescale. Units: temperature. Output: the scalar is the
energy taken out of the atoms (thermo keywords ecouple, econserve).
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.formula import write
from asemd.fix.thermostat import VelocityScaling, measured_temperature, ramped, scale_velocities
from asemd.words import number, whole


def rescaled(now, target, dt, p):
    """The temperature to go to: ``p[9]`` is the window, ``p[10]`` the fraction."""
    return now - p[10] * (now - target) if abs(now - target) > p[9] else now


class TempRescale(VelocityScaling):
    """Velocity rescaling.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    every : int
        Steps between two looks.
    window : float
        Differences up to this are left alone, in temperature units.
    fraction : float
        How much of the difference goes, above 0 and at most 1.

    Raises
    ------
    InputError
        A value out of its range.
    SimulationError
        After a run in which the temperature was exactly 0.
    """

    style = "temp/rescale"
    scaled = staticmethod(rescaled)

    def __init__(self, group: str = "all", temperature=300.0, every: int = 1, window: float = 0.0, fraction: float = 1.0):
        super().__init__(group, temperature)
        if every < 1:
            raise InputError(f"fix temp/rescale: N must be at least 1, got {every}")
        if window < 0.0 or not 0.0 < fraction <= 1.0:
            raise InputError("fix temp/rescale: window must not be negative and fraction must be above 0, at most 1; "
                             f"got {window:g} and {fraction:g}")
        self.every, self.window, self.fraction = every, window, fraction

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) != 5:
            raise InputError(f"fix temp/rescale needs N Tstart Tstop window fraction, got {len(words)} values")
        return cls(group, cls.read_ramp(words[1:3], session), whole(words[0], "fix temp/rescale N"),
                   number(words[3], "fix temp/rescale window"), number(words[4], "fix temp/rescale fraction"))

    def to_lammps(self) -> list[str]:
        return [str(self.every), write(self.start), repr(self.stop), repr(self.window), repr(self.fraction)]

    def settings(self) -> tuple[float, ...]:
        return self.window, self.fraction

    @hook(uses=[measured_temperature, ramped, rescaled, scale_velocities])
    def end_of_step(th, s, p, a):
        now = measured_temperature(th, s, p)
        scale_velocities(th, s, p, now, rescaled(now, ramped(th, p), th.dt, p))
