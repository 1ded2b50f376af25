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
from asemd.lammps import catalog

RECOMMENDED, COARSE, FINE = 20.0, 10.0, 500.0     # steps per period
RARE = 3.5              # steps per period of the fastest motion of all as it is now, which may be a rare collision
RESONANCE = 3.0         # outer steps of r-RESPA per period
CRUSHED = 1e-3          # steps per period below which atoms lie on each other
SHOWN = 3
TIME = {"real": " fs", "metal": " ps", "electron": " fs", "lj": " tau"}
USUAL = {"real": "1.0 (fs)", "metal": "0.001 (ps)", "electron": "0.001 (fs)"}


@static("time step")
def timestep(case: Case) -> list[Finding]:
    name = "time step"
    if not case.motions:
        raise DoesNotApply("nothing vibrates")
    m, unit = case.motions[0], TIME.get(case.units.name, "")
    text = f"The fastest motion is {m.label} with a period of {m.period:.4g}{unit}{_who(m)}"
    rest = "; ".join(f"{o.label} {o.period:.4g}{_who(o)}" for o in case.motions[1:SHOWN])
    rest = f" Then come {rest}." if rest else ""
    if not math.isfinite(m.dt):
        return [Finding("ok", name, f"{text}.{rest}", m.atoms, f"period {m.period:.4g}", m.period / RECOMMENDED, _advice(case, m))]
    if case.respa is not None:
        text += f"; it has the step {m.dt:g} of its r-RESPA level"
    verdict, rank, limit = _verdict(m.period / m.dt, m.period)
    return [Finding("warning" if rank == "error" and case.force else rank, name, f"{text}; a step of {m.dt:g} is {verdict}.{rest}", m.atoms,
                    m.dt, limit, _advice(case, m) if rank != "ok" else "")]


def _verdict(steps: float, period: float) -> tuple[str, str, float]:
    """What so many steps in a period mean: in words, the severity, the limit."""
    here = f"period / {steps:.3g}"
    if steps < math.pi:
        return (f"{here}: beyond period / pi = {period / math.pi:.4g} no run with velocity Verlet is stable", "error", period / math.pi)
    if steps < COARSE:
        return (f"{here}: its frequency is off by {_error(steps):.1f} %, and energy drifts as soon as the motion gets stiffer", "warning",
                period / COARSE)
    if period / steps > max(float(f"{period / RECOMMENDED:.2g}"), period / RECOMMENDED) * (1.0 + 1e-9):     # the step that is advised
        return f"{here}: it runs, with frequencies off by {_error(steps):.1f} %", "note", period / RECOMMENDED
    if steps > FINE:
        return f"{here}: far more steps than the motion needs", "note", period / RECOMMENDED
    return here, "ok", period / RECOMMENDED


def _who(m) -> str:
    return f" (stiffest: atoms {' '.join(map(str, m.atoms))})" if m.atoms else ""


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
    dt = min((m.dt for m in case.motions), default=abs(case.dt) if case.dt else math.nan)
    if not math.isfinite(dt):
        return [Finding("ok", name, f"{text}.", ids, f"period {period:.4g}", period / RECOMMENDED)]
    steps, limit = period / dt, period / math.pi
    if not case.motions and math.pi <= steps:        # forces of many atoms at once: nothing else tells how stiff they are
        verdict, rank, limit = _verdict(steps, period)
        return [Finding(rank, name, f"{text}; a step of {dt:g} is {verdict}.", ids, dt, limit)]
    advice = f"use a timestep below {period / COARSE:.2g}" + ("" if not case.relaxes else ", or look again after the minimisation")
    if steps < CRUSHED:
        advice = "no timestep helps: relax the structure first (minimize, fix nve/limit)"
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
    if case.respa is None or not case.dt:
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


def _advice(case: Case, m) -> str:
    best = m.period / RECOMMENDED
    if not math.isfinite(m.dt) or m.period > FINE * m.dt:
        usual = USUAL.get(case.units.name)
        return f"a timestep up to {best:.2g} is accurate" + (f"; usual in units {case.units.name}: {usual}" if usual else "")
    out = f"a timestep of {best:.2g} is accurate (period / 20)"
    if m.period < COARSE * m.dt and m.atoms:
        if m.label.startswith("bond") and catalog.exists("fix", "shake"):
            out += "; fix shake holds stiff bonds"
        if case.respa is None and m.period < 0.7 * case.motions[-1].period:
            out += "; run_style respa gives bonded forces shorter steps"
    return out
