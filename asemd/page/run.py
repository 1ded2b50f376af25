"""The page of a run: what `asemd run --html` writes."""
from __future__ import annotations

import os
import platform
import time
from collections.abc import Sequence

import numpy as np

from asemd import units
from asemd.errors import AsemdError
from asemd.lammps import plan
from asemd.lammps.log import SECTIONS
from asemd.lammps.record import Record, Run
from asemd.page import Page
from asemd.text_table import Table
from asemd.thermo import KEYWORDS

CURVES = 14             # most plots of thermo columns
APART = 6               # runs that are drawn as curves of their own
WARNINGS = 12
OUTLYING = 8.0          # a curve whose range is so many times that of nine tenths of its rows is cut off
# columns that say where the run is rather than how the system does
CLOCK = {"step", "elapsed", "elaplong", "dt", "time", "cpu", "tpcpu", "spcpu", "cpuremain", "cpuuse", "timeremain", "part"}
TITLES = {"temp": "Temperature", "press": "Pressure", "pe": "Potential energy", "ke": "Kinetic energy", "etotal": "Total energy",
          "enthalpy": "Enthalpy", "evdwl": "Van der Waals energy", "ecoul": "Coulomb energy", "epair": "Pair energy",
          "ebond": "Bond energy", "eangle": "Angle energy", "edihed": "Dihedral energy", "eimp": "Improper energy",
          "emol": "Energy of bonded terms",
          "elong": "Long-range energy", "etail": "Tail energy", "ecouple": "Energy of heat baths", "econserve": "Conserved energy",
          "vol": "Volume", "density": "Density", "fmax": "Largest force component", "fnorm": "Norm of the forces"}
# unit style -> energy, temperature, pressure, time, distance, density
NAMES = {"lj": ("\u03b5", "\u03b5/k", "\u03b5/\u03c3\u00b3", "\u03c4", "\u03c3", "m/\u03c3\u00b3"),
         "real": ("kcal/mol", "K", "atm", "fs", "\u00c5", "g/cm\u00b3"), "metal": ("eV", "K", "bar", "ps", "\u00c5", "g/cm\u00b3"),
         "si": ("J", "K", "Pa", "s", "m", "kg/m\u00b3"), "cgs": ("erg", "K", "dyn/cm\u00b2", "s", "cm", "g/cm\u00b3"),
         "electron": ("hartree", "K", "Pa", "fs", "bohr", ""),
         "micro": ("pg \u00b5m\u00b2/\u00b5s\u00b2", "K", "pg/(\u00b5m \u00b5s\u00b2)", "\u00b5s", "\u00b5m", "pg/\u00b5m\u00b3"),
         "nano": ("ag nm\u00b2/ns\u00b2", "K", "ag/(nm ns\u00b2)", "ns", "nm", "ag/nm\u00b3")}


def page_of_run(session, source: str, error: str = "") -> Page:
    """The page of what a session has run so far.

    Parameters
    ----------
    session : asemd.lammps.session.Session
        With a `record`.
    source : str
        The script.
    error : str
        Why it ended, if it did not end well.
    """
    record: Record = session.record
    scene = session.scene
    runs = [r for r in record.runs if r.kind == "run"]
    name = os.path.basename(source) or "run"
    day = time.strftime("%Y-%m-%d %H:%M")
    many = f"{scene.threads} thread{'s' * (scene.threads > 1)}"
    page = Page(name, " \u00b7 ".join((day, platform.node(), many, f"{scene.precision} precision")))
    moving = [r for r in runs if r.steps]
    page.facts(_facts(scene, record, moving))
    for text in ([f"The run ended early: {error}"] if error else []) + session.log.warned[:WARNINGS]:
        page.warning(text)
    more = session.log.warnings - WARNINGS
    if more > 0:
        page.warning(f"and {more} more, which are in the log")
    if scene.system is not None:
        page.section("Snapshot")
        try:
            page.snapshot(scene.system, f"Step {scene.step:,}", note=_says(scene))
        except AsemdError as e:         # of a run that came apart
            page.text(f"The atoms of step {scene.step:,} cannot be drawn: {e}.")
    _thermo(page, "Thermo", runs)
    _thermo(page, "Minimisation", [r for r in record.runs if r.kind == "minimize"])
    _drift(page, moving)
    _timing(page, record)
    _plan(page, session, source)
    return page


def _facts(scene, record: Record, moving: Sequence[Run]) -> dict[str, str]:
    facts = {"Atoms": f"{scene.system.n:,}" if scene.system is not None else "none"}
    if moving:
        last = moving[-1]
        rate = last.steps / last.seconds if last.seconds > 0.0 else 0.0
        u = units.get(last.units)
        facts["Steps"] = f"{sum(r.steps for r in moving):,}"
        reduced = last.units == "lj"
        facts["Steps per second"] = _short(rate)
        facts["\u03c4 per day" if reduced else "ns per day"] = _short(rate * 86400.0 * last.dt / (1.0 if reduced else 1e6 * u.femtosecond))
        fit = _slope(last)
        if fit is not None and not last.leaks:
            facts["Drift, kT per dof and " + _span(last)] = f"{fit:.1e}"
    facts["Wall time"] = _clock(record.seconds)
    return facts


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 1000.0 else f"{value:.3g}"


def _clock(seconds: float) -> str:
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    return f"{int(seconds) // 3600}:{int(seconds) // 60 % 60:02d}:{int(seconds) % 60:02d}"


def _says(scene) -> str:
    system = scene.system
    words = [f"{n:,} {kind}s" for kind, n in system.topology.counts().items() if n]
    still = [] if any(f.integrates for f in scene.fixes.values()) else ["no fix moves the atoms"]
    if len(system.topology.bonds) and system.box.periodic.any():
        still.append("bonds that cross a periodic face are drawn on both sides")
    text = "; ".join([", ".join(words)] * bool(words) + still)
    return text[:1].upper() + text[1:]


# -------------------------------------------------------------------------------------------------------------------- thermo ---

def _unit(word: str, run: Run) -> str:
    energy, temperature, pressure, clock, distance, density = NAMES.get(run.units, ("",) * 6)
    keyword = KEYWORDS.get(word)
    if word == "temp":
        return temperature
    if word == "press" or (keyword is not None and keyword.needs == {"virial"} and not keyword.extensive):
        return pressure
    if word in ("vol", "density", "fmax", "fnorm"):
        return {"vol": f"{distance}\u00b3", "density": density}.get(word, f"{energy}/{distance}")
    if keyword is not None and keyword.extensive:
        return energy + (" per atom" if run.normalised else "")
    return distance if word in ("lx", "ly", "lz", "cella", "cellb", "cellc") else ""


def _thermo(page: Page, section: str, runs: Sequence[Run]) -> None:
    runs = [r for r in runs if len(r.rows) > 1 and r.steps]
    words = list(dict.fromkeys(w for r in runs for w in r.keywords if w not in CLOCK))
    if not words:
        return
    page.section(section)
    constant, left = [], []
    drawn = 0
    for word in words:
        having = [r for r in runs if word in r.keywords]
        title = having[0].titles[having[0].keywords.index(word)]
        steps = [_steps(r) for r in having]
        values = [np.array([row[r.keywords.index(word)] for row in r.rows]) for r in having]
        known = np.concatenate(values)
        known = known[np.isfinite(known)]
        if not known.size or np.ptp(known) == 0.0:
            constant.append(f"{title} = {known[0]:g}" if known.size else f"{title} is not a number")
        elif drawn == CURVES:
            left.append(title)
        else:
            drawn += 1
            unit = _unit(word, having[0])
            x, curves = _joined(steps, values, section == "Thermo")
            limits, note = _limits(np.concatenate(steps), np.concatenate(values), unit)
            page.curve(TITLES.get(word, title), x, curves, "step", f"{title} ({unit})" if unit else title, limits=limits, note=note)
    if constant:
        page.text("Constant: " + ", ".join(f"`{c}`" for c in constant))
    if left:
        page.text("Not drawn: " + ", ".join(f"`{c}`" for c in left))


def _limits(steps: np.ndarray, values: np.ndarray, unit: str) -> tuple[tuple[float, float] | None, str]:
    """Where a few rows, as at the start of many runs, would flatten the curve: what to show instead, and a line that says so."""
    known = np.isfinite(values)
    if known.sum() < 20:
        return None, ""
    steps, values = steps[known], values[known]
    low, high = np.percentile(values, (5, 95))
    margin = 0.6 * (high - low)
    if np.ptp(values) < OUTLYING * (high - low) or not high > low:
        return None, ""
    beyond = np.flatnonzero((values < low - margin) | (values > high + margin))
    worst = beyond[np.argmax(np.abs(values[beyond] - 0.5 * (low + high)))]
    inside = np.delete(values, beyond)
    room = 0.08 * np.ptp(inside)
    note = f"{len(beyond)} of {len(values)} rows are beyond the plot, up to {values[worst]:.5g} {unit} at step {steps[worst]:.0f}."
    return (float(inside.min() - room), float(inside.max() + room)), " ".join(note.split())


def _steps(run: Run) -> np.ndarray:
    """The step of each row."""
    if "step" in run.keywords:
        return np.array([row[run.keywords.index("step")] for row in run.rows])
    return np.linspace(run.begin, run.begin + run.steps, len(run.rows))


def _joined(steps: list[np.ndarray], values: list[np.ndarray], named: bool) -> tuple[np.ndarray, dict[str, np.ndarray] | np.ndarray]:
    """Several runs over a common axis: as curves of their own while they are few, else as one with gaps between them."""
    if len(steps) == 1:
        return steps[0], values[0]
    if len(steps) > APART:
        gap = np.array([np.nan])
        x = np.concatenate([a for s in steps for a in (s, s[-1:])])
        return x, np.concatenate([a for v in values for a in (v, gap)])
    x = np.concatenate(steps)
    curves, at = {}, 0
    for k, v in enumerate(values, 1):
        curve = np.full(len(x), np.nan)
        curve[at:at + len(v)] = v
        curves[f"{'run' if named else 'minimisation'} {k}"] = curve
        at += len(v)
    return x, curves


# ----------------------------------------------------------------------------------------------------- the conserved quantity ---

def _slope(run: Run) -> float | None:
    """Drift in kT per degree of freedom and ns (1000 tau); None where it cannot be told."""
    data = np.array(run.conserved)
    if len(data) < 4 or not np.isfinite(data).all() or np.ptp(data[:, 0]) == 0.0:
        return None
    u = units.get(run.units)
    kt = u.boltz * float(data[:, 2].mean()) * run.dof
    span = 1000.0 if run.units == "lj" else 1e6 * u.femtosecond
    return float(np.polyfit(data[:, 0] - data[0, 0], data[:, 1] - data[0, 1], 1)[0]) * span / kt if kt > 0.0 else None


def _span(run: Run) -> str:
    """The time that drifts refer to."""
    return "1000 \u03c4" if run.units == "lj" else "ns"


def _drift(page: Page, runs: Sequence[Run]) -> None:
    runs = [r for r in runs if len(r.conserved) > 2 and np.isfinite(np.array(r.conserved)).all() and r.dof > 0.0]
    if not runs:
        return
    page.section("Conserved quantity")
    energies, steps, temperatures = [], [], []
    for run in runs:
        data = np.array(run.conserved)
        kt = units.get(run.units).boltz * max(float(data[:, 2].mean()), 1e-300)
        energies.append((data[:, 1] - data[0, 1]) / (kt * run.dof))
        steps.append(_steps(run))
        temperatures.append(data[:, 2])
    x, curves = _joined(steps, energies, True)
    last = runs[-1]
    fit = _slope(last)
    note = "Potential and kinetic energy and that of heat baths, since the start of each run."
    if fit is not None:
        note += f" A straight line through the last run: {fit:.2e} kT per degree of freedom and {_span(last)}."
    leaks = list(dict.fromkeys(leak for r in runs for leak in r.leaks))
    if leaks:
        note += f" Energy that goes through {', '.join(leaks)} is not counted, so this need not be constant."
    page.curve("Drift", x, curves, "step", "change in kT per degree of freedom", wide=True, note=note)


# ------------------------------------------------------------------------------------------------------------ timing and plan ---

def _timing(page: Page, record: Record) -> None:
    ran = [r for r in record.runs if r.seconds > 0.0]
    if not ran:
        return
    page.section("Timing")
    spent = {name: sum(r.timings.get(name, 0.0) for r in ran) for name in SECTIONS}
    total = sum(r.seconds for r in ran)
    spent["Other"] = max(0.0, total - sum(spent.values()))
    page.bars("Where the time went", {k: v for k, v in spent.items() if v > 0.001 * total}, "seconds", wide=True,
              note=f"{total:.4g} s in runs; {max(0.0, record.seconds - total):.3g} s outside them: reading, set-up, compilation.")
    rows = [(r.kind, f"{r.begin:,}", f"{r.steps:,}", f"{r.atoms:,}", f"{r.seconds:.4g}", f"{r.steps / r.seconds:,.4g}", f"{r.builds:,}",
             f"{r.dangerous:,}") for r in ran[-20:]]
    page.table(("command", "from step", "steps", "atoms", "seconds", "steps/s", "list builds", "dangerous"), rows,
               "Runs" if len(ran) <= 20 else f"The last 20 of {len(ran)} runs")


def _plan(page: Page, session, source: str) -> None:
    if session.scene.system is None:
        return
    try:
        found = plan.of_scene(session.scene, source, session.variables.references)
    except AsemdError:
        return      # coefficients are missing: nothing was run, and nothing can be planned
    page.section("Plan")
    for part in found.parts():
        if isinstance(part, Table):
            page.table(part.columns, part.rows, part.title)
