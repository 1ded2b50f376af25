r"""Berendsen thermostat: the temperature relaxes exponentially to its target. Not a canonical ensemble.

.. math:: v \leftarrow v \sqrt{1 + \frac{\Delta t}{\tau} \left( \frac{T_0}{T} - 1 \right)}

at the end of every step. It does not move atoms: use it with fix nve.

Source: H. J. C. Berendsen, J. P. M. Postma, W. F. van Gunsteren, A. DiNola, J. R. Haak, J. Chem. Phys. 81, 3684 (1984); LAMMPS manual,
fix temp/berendsen. Units: temperature, time. Output: the scalar is the energy taken out of the atoms (thermo keywords ecouple, econserve).
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.formula import write
from asemd.fix.thermostat import VelocityScaling, measured_temperature, ramped, scale_velocities
from asemd.words import number


def relaxed(now, target, dt, p):
    """The temperature to go to: ``p[9]`` is the damping time; systems without a degree of freedom stay as they are."""
    return now + dt / p[9] * (target - now) if p[2] >= 1.0 else now


class TempBerendsen(VelocityScaling):
    """Weak coupling to a heat bath.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time, in time units of the scene.

    Raises
    ------
    InputError
        A value out of its range.
    SimulationError
        After a run in which the temperature was exactly 0.
    """

    style = "temp/berendsen"
    scaled = staticmethod(relaxed)

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) != 3:
            raise InputError(f"fix temp/berendsen needs Tstart Tstop Tdamp, got {len(words)} values")
        return cls(group, cls.read_ramp(words[:2], session), number(words[2], "fix temp/berendsen Tdamp"))

    def to_lammps(self) -> list[str]:
        return [write(self.start), repr(self.stop), repr(self.damping)]

    def settings(self) -> tuple[float, ...]:
        return (self.damping,)

    @hook(uses=[measured_temperature, ramped, relaxed, scale_velocities])
    def end_of_step(th, s, p, a):
        now = measured_temperature(th, s, p)
        scale_velocities(th, s, p, now, relaxed(now, ramped(th, p), th.dt, p))
