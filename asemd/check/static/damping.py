r"""Are the damping times of thermostats and barostats right for the timestep?

Nose-Hoover chains oscillate with a period near the damping time, which the timestep must resolve; the friction of Langevin, applied once in
a step, must be small: :math:`\Delta t / \tau \ll 1`. LAMMPS's manual recommends 100 steps for temperatures, 1000 for pressures.
"""
from __future__ import annotations

import inspect
import math

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

TEMPERATURE = (2.0, 10.0, 1e6)     # steps: below the first an error, below the second a warning, above the third no coupling
PRESSURE = (20.0, 100.0, 1e7)
FRICTION = (0.5, 5.0, 1e7)         # for fixes that act as friction: at half a step they turn velocities round
USUAL = {"temperature": "damping", "pressure": "pressure_damping"}     # what a damping time is called as an argument of a fix
FRICTIONAL = ("langevin", "gjf", "gronbech", "baoab", "brownian", "viscous")


@static("damping")
def damping(case: Case) -> list[Finding]:
    times = [(fix, word, float(value)) for fix in case.fixes.values() for word, value in relaxation_times(fix)]
    if not times:
        raise DoesNotApply("no thermostat or barostat")
    if not case.dt:
        raise DoesNotApply("no timestep")
    return [_judge(case, fix, word, time) for fix, word, time in times]


def relaxation_times(fix) -> list[tuple[str, float]]:
    """``temperature`` or ``pressure`` and the damping time of a fix; fixes say it by a method of this name or by the usual arguments."""
    if hasattr(fix, "relaxation_times"):
        return list(fix.relaxation_times())
    taken = inspect.signature(type(fix)).parameters         # some have the attribute only from their base class
    found = [(word, getattr(fix, name)) for word, name in USUAL.items() if name in taken]
    return [(word, t) for word, t in found if isinstance(t, (int, float)) and math.isfinite(t)]


def _judge(case: Case, fix, word: str, time: float) -> Finding:
    frictional = word == "temperature" and any(s in fix.style for s in FRICTIONAL)
    least, low, most = PRESSURE if word == "pressure" else FRICTION if frictional else TEMPERATURE
    steps, name, dt = time / abs(case.dt), f"{word} damping", abs(case.dt)
    usual = 1000.0 if word == "pressure" else 100.0
    text = f"Fix {fix.id} ({fix.style}) couples the {word} with a damping time of {time:g}, {steps:.3g} steps"
    advice = f"usual are {usual:g} steps: {usual * dt:g}"
    if frictional and steps < low and (fix.style in ("baoab", "gjf") or getattr(fix, "gjf", "no") != "no"):
        severity = "note" if steps < 1.0 else "ok"
        return Finding(severity, name, f"{text}: motion is diffusive, its positions are right for any friction.", value=time, limit=dt)
    if steps < least:
        end = "the friction of one step turns velocities round" if frictional else "too short to be integrated"
        severity, limit = "warning" if case.force else "error", least
    elif steps < low:
        end = (f"the friction of a step is {100.0 / steps:.0f} %, and the temperature comes out wrong by about as much" if frictional else
               "it hardly resolves its own oscillation, and dynamics are those of the bath")
        severity, limit = "warning", low
    elif steps > most:
        return Finding("note", name, f"{text}: in practice there is no coupling.", value=time, limit=most * dt, advice=advice)
    else:
        return Finding("ok", name, f"{text}.", value=time, limit=low * dt)
    if frictional and word == "temperature":
        advice += "; fix baoab, fix gjf and the keyword gjf of fix langevin stay right at any friction"
    return Finding(severity, name, f"{text}: {end}.", value=time, limit=limit * dt, advice=advice)
