r"""Is the timestep short enough for the fastest motions?

Velocity Verlet is stable for :math:`\omega \Delta t < 2`, which is period / :math:`\pi`; its frequencies are off by
:math:`(\omega \Delta t)^2 / 24`: 0.4 % at period / 20, 2 % at period / 10.
"""
from __future__ import annotations

import math

from asemd.check import spectrum
from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

RECOMMENDED, COARSE, FINE = 20.0, 10.0, 500.0     # steps per period
RARE = 4.0              # steps per period of the fastest motion of all as it is now, which may be a rare collision
RESONANCE = 3.0         # outer steps of r-RESPA per period
SHOWN = 3


@static("time step")
def timestep(case: Case) -> list[Finding]:
    name = "time step"
    if not case.motions:
        raise DoesNotApply("nothing vibrates")
    m = case.motions[0]
    period, advice = f"period {m.period:.4g}", _advice(case, m)
    others = [f"{o.label} {o.period:.4g}" + (f" (atoms {' '.join(map(str, o.atoms))})" if o.atoms else "") for o in case.motions[:SHOWN]]
    text = f"The fastest motions and their periods: {'; '.join(others)}."
    if not math.isfinite(m.dt):
        return [Finding("ok", name, text, m.atoms, period, m.period / RECOMMENDED, advice)]
    steps = m.period / m.dt
    text += f" A step of {m.dt:g} is period / {steps:.3g}"
    level = "" if case.respa is None else f" (the inner step of r-RESPA; the outer one is {case.dt:g})"
    value, limit = m.dt, m.period / RECOMMENDED
    if steps < math.pi:
        return [Finding("warning" if case.force else "error", name, f"{text}{level}: beyond period / pi = {m.period / math.pi:.4g} no run "
                        "with velocity Verlet is stable.", m.atoms, value, m.period / math.pi, advice)]
    if steps < COARSE:
        return [Finding("warning", name, f"{text}{level}: the motion is off by {_error(steps):.1f} % in its frequency, and energy drifts "
                        "as soon as it gets stiffer.", m.atoms, value, m.period / COARSE, advice)]
    if steps < RECOMMENDED:
        return [Finding("note", name, f"{text}{level}: it runs, with frequencies off by {_error(steps):.1f} %.", m.atoms, value, limit,
                        advice)]
    if steps > FINE:
        return [Finding("note", name, f"{text}{level}: far more steps than the motion needs.", m.atoms, value, limit,
                        f"if that is not meant, a timestep up to {limit:.2g} is accurate{_usual(case)}")]
    return [Finding("ok", name, f"{text}.", m.atoms, value, limit)]


@static("fastest vibration")
def fastest(case: Case) -> list[Finding]:
    name = "fastest vibration"
    if case.result is None:
        raise DoesNotApply("there are no forces: see the other findings")
    found = spectrum.top(case)
    if found is None:
        raise DoesNotApply("nothing vibrates about these positions")
    period = 2.0 * math.pi / found.omega
    order = (-found.weight).argsort()[:4]
    ids = case.ids([i for i in order if found.weight[i] > 0.05])
    who = f" of atoms {' '.join(map(str, ids))}" if ids else ", in which many atoms take part,"
    text = f"Of the whole system as it is now the fastest vibration{who} has the period {period:.4g} ({found.how})"
    dt = min((m.dt for m in case.motions), default=case.dt if case.dt is not None else math.nan)
    if not math.isfinite(dt):
        return [Finding("ok", name, f"{text}.", ids, f"period {period:.4g}", period / RECOMMENDED)]
    steps = period / dt
    limit = period / math.pi
    advice = f"use a timestep below {period / COARSE:.2g}" + ("" if not case.relaxes else ", or look again after the minimisation")
    if steps < math.pi:
        severity = "note" if case.gentle else "warning" if case.force else "error"
        return [Finding(severity, name, f"{text}: with a step of {dt:g} it grows without bounds.", ids, dt, limit, advice)]
    if steps < RARE:
        return [Finding("note" if case.gentle else "warning", name, f"{text}: a step of {dt:g} is only just stable for it.", ids, dt, limit,
                        advice)]
    return [Finding("ok", name, f"{text}.", ids, dt, limit)]


@static("r-RESPA")
def resonance(case: Case) -> list[Finding]:
    name = "r-RESPA"
    if case.respa is None or case.dt is None:
        raise DoesNotApply("run_style verlet")
    if not case.motions:
        raise DoesNotApply("nothing vibrates")
    period = min(m.period for m in case.motions)
    text = f"The outermost step is {case.dt:g}, the fastest motion has the period {period:.4g}"
    if case.dt * RESONANCE > period:
        return [Finding("warning", name, f"{text}: near half a period kicks by the slow forces come in tune with it, and energy flows in "
                        "however short the inner step is.", case.motions[0].atoms, case.dt, period / RESONANCE,
                        "make the outermost step shorter, or damp with fix langevin")]
    return [Finding("ok", name, f"{text}.", value=case.dt, limit=period / RESONANCE)]


def _error(steps: float) -> float:
    """Per cent by which velocity Verlet misses a frequency."""
    half = math.pi / steps
    return 100.0 * (math.asin(half) / half - 1.0)


def _usual(case: Case) -> str:
    usual = {"real": "1.0 (fs)", "metal": "0.001 (ps)", "electron": "0.001 (fs)"}.get(case.units.name)
    return f"; usual in units {case.units.name}: {usual}" if usual else ""


def _advice(case: Case, m) -> str:
    best = m.period / RECOMMENDED
    factor = f" (now {m.dt:g})" if math.isfinite(m.dt) else ""
    out = f"a timestep of {best:.2g}{factor} is accurate: period / 20"
    if math.isfinite(m.dt) and m.period < COARSE * m.dt and m.atoms and case.respa is None:
        out += ("; or give the stiff bonded forces shorter steps with run_style respa"
                if len(case.motions) > 1 and m.period < 0.7 * case.motions[-1].period else "")
    return out
