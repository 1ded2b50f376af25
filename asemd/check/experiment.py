"""Stability by experiment, ``asemd check --run``: short runs on copies of a scene at constant energy.

Where does it come apart, does the error fall with the square of the timestep, does it find its way back, does its list miss pairs? Nothing
of the scene is changed, no file is written, and every number follows from `seed`.
"""
from __future__ import annotations

import math
import sys
import time
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from asemd.check.report import Report
from asemd.check.trial import Bench, bench, boltzmann, comes_apart
from asemd.engine import Engine
from asemd.errors import AsemdError, InputWarning
from asemd.finding import Finding
from asemd.report import nve
from asemd.scene import Scene
from asemd.text_table import Table

GROWTH = 10.0           # of the kinetic energy: the run has come apart
PRECISE = 1.005         # ratio of the timesteps between which the onset is known in the end
LONGEST = 2.0**8        # of the timestep: where the search for the onset ends
CLOSE, NEAR = 0.5, 0.75         # of the onset: a timestep above is worth a note, a warning
ORDER = 0.3             # how far from 2 the order may be
TINY = 1e-6             # energies that fluctuate less, relative to the kinetic energy, are as good as constant
LOST = 1e-9             # energy of missed pairs, relative to the energy, double precision
SINGLE = 1e4            # digits that mixed precision has less, as a factor
SEARCH = 0.5            # of the time for the onset
SMALL = 1e-3            # kT per atom: a smaller error of the energy by missed pairs is a note, as is a path that misses its beginning by
                        # this part of its length
STEPS = 400             # of one run
APART = "the run comes apart"
TOO_SHORT = "it does not fit into the time: give a larger budget"


def run(scene: Scene, *, dt: float | None = None, temperature: float | None = None, force: bool = False, relax: bool = False,
        budget: float = 60.0, seed: int = 1, progress: Callable[[float, str], None] | None = None) -> Report:
    """All experiments.

    Parameters
    ----------
    scene : Scene
        Not changed.
    dt : float, optional
        Timestep in the scene's units; by default its own.
    temperature : float, optional
        Fresh velocities of this temperature; by default the scene's velocities, and for atoms at rest those of its thermostat.
    force : bool
        A timestep at which the run comes apart is a warning, not an error.
    relax : bool
        Minimise the energy of the copy first, as the script does; without it that is done only where no run could begin.
    budget : float
        Seconds, without compilation. What does not fit is left out, or has fewer steps, and the report says so.
    seed : int
        Of velocities and displacements.
    progress : callable, optional
        ``progress(fraction, what)``; by default a bar on a terminal.

    Returns
    -------
    Report
        Findings ``onset of instability``, ``order of the integrator``, ``energy``, ``time reversal`` and ``missed pairs``.
    """
    report = Report("experiments")
    with _bar(progress) as tell, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", InputWarning)
        tell(0.0, "preparing")
        try:
            b = bench(scene, dt, temperature, seed, relax, tell)
        except AsemdError as problem:
            report.findings.append(Finding("error", "experiments", f"No run is possible: {problem}"))
            return report
        b.until = time.perf_counter() + budget          # compilation does not count
        if b.notes:
            report.findings.append(Finding("note", "experiments", f"Short runs on copies; {'; '.join(b.notes)}."))
        limit = None
        for k, part in enumerate((onset, order, time_reversal, missed_pairs)):
            tell(k / 4, part.__doc__.partition(":")[0])
            try:
                limit = part(b, report, force, limit) or limit
            except AsemdError as problem:
                report.findings.append(Finding("error", part.__name__.replace("_", " "), f"A run failed: {problem}"))
        tell(1.0, "done")
    return report


# ------------------------------------------------------------------------------------------------------------------------------- onset ---

def onset(b: Bench, report: Report, force: bool, _) -> float | None:
    """Onset of instability: the timestep at which the run comes apart, by bisection."""
    name = "onset of instability"
    until = time.perf_counter() + SEARCH * b.left
    steps = b.steps(STEPS, 24, SEARCH / 16)
    if not steps:
        report.left_out.append((name, TOO_SHORT))
        return None
    low = high = None
    dt = b.dt
    while low is None or high is None:
        if comes_apart(b, dt, steps, GROWTH):
            high = dt
            dt /= 2.0
        else:
            low = dt
            dt *= 2.0
        if dt > LONGEST * b.dt or dt < b.dt / LONGEST:
            break
    if low is None:
        report.findings.append(Finding("error", name, f"The run comes apart within {steps} steps at every timestep down to {high:.3g}.",
                                       value=b.dt, advice="minimize the energy first, or look at the coefficients"))
        return None
    if high is None:
        message = f"No timestep up to {low:.3g} makes the run come apart within {steps} steps."
        report.findings.append(Finding("ok", name, message, value=low))
        return None
    while high / low > PRECISE and time.perf_counter() < until:
        middle = math.sqrt(low * high)
        if comes_apart(b, middle, steps, GROWTH):
            high = middle
        else:
            low = middle
        b.tell(0.25 * min(1.0, math.log(PRECISE) / math.log(high / low)), name)
    limit, ratio = math.sqrt(low * high), b.dt / math.sqrt(low * high)
    top = static_limit(b)
    static = f" The fastest vibration of the start alone allows {top:.4g} (2/omega)." if top else ""
    severity = ("warning" if force else "error") if b.dt >= low else "warning" if ratio > NEAR else "note" if ratio > CLOSE else "ok"
    message = f"Runs of {steps} steps come apart from a timestep of {limit:.4g} on; {b.dt:.4g} is {_share(ratio)} that.{static}"
    advice = f"timestep {0.3 * limit:.2g} or less" if severity != "ok" else ""
    report.findings.append(Finding(severity, name, message, value=b.dt, limit=limit, advice=advice))
    return limit


def _share(ratio: float) -> str:
    return f"{100 * ratio:.3g} % of" if ratio < 10.0 else f"{ratio:.3g} times"


def static_limit(b: Bench) -> float | None:
    """The timestep 2 / omega of the fastest vibration, None where there is none."""
    try:
        from asemd.check.case import of_scene
        from asemd.check.spectrum import top
        from asemd.report.copies import copied
        found = top(of_scene(copied(b.scene)))
    except AsemdError:
        return None
    return 2.0 / found.omega if found else None


# ------------------------------------------------------------------------------------------------------------------------------- order ---

def order(b: Bench, report: Report, force: bool, limit: float | None) -> None:
    """Order of the integrator: how the fluctuation of the energy depends on the timestep."""
    name = "order of the integrator"
    steps = b.steps(STEPS // 2, 20, 0.5 / 12)
    if not steps:
        report.left_out.append((name, TOO_SHORT))
        return
    longest = b.dt if limit is None else min(b.dt, 0.3 * limit)
    dts = [longest * f for f in (0.25, 0.35, 0.5, 0.71, 1.0)]
    found = nve.order(b.scene, dts, duration=steps * longest, settings=b.safe, levels=b.scene.respa)
    rows = [(f"{s.dt:.4g}", f"{s.fluctuation:.3g}", f"{s.drift:.3g}", s.failed or "") for s in found.series]
    report.tables.append(Table("Energy at constant energy, by timestep", ("timestep", "fluctuation", "drift", "failed"), rows))
    kinetic = max((float(np.mean(s.kinetic)) for s in found.series if not s.failed), default=0.0)
    small = len(found.fluctuation) and float(found.fluctuation.max()) <= TINY * kinetic
    if not math.isfinite(found.exponent):
        why = "the energy is constant to the last digit" if small or not any(s.failed for s in found.series) else "runs failed"
        report.left_out.append((name, why))
    else:
        right = abs(found.exponent - 2.0) <= ORDER
        message = (f"The fluctuation of the energy goes with the timestep to the power {found.exponent:.2f}, timesteps {dts[0]:.3g} to "
                   f"{dts[-1]:.3g}; 2 is right for velocity Verlet.")
        advice = ""
        if not right and not small:
            advice = ("something else than the timestep limits the energy: a force that is not the gradient of its energy or jumps at the "
                      "cutoff, tables with few points, single precision" if found.exponent < 2.0 else
                      "the timesteps are near the onset of instability")
        severity = "ok" if right or small else "warning"
        report.findings.append(Finding(severity, name, message, value=found.exponent, limit=2.0, advice=advice))
    if limit is not None and b.dt >= limit:
        report.left_out.append(("energy", APART))
        return
    at = [s for s in found.series if s.dt == longest and not s.failed] if longest == b.dt else []
    at = at or [nve.run(b.scene, b.dt, steps, settings=b.safe, levels=b.scene.respa)]
    energy(at[0], report, steps)


def energy(series, report: Report, steps: int) -> None:
    """Energy: what the scene's own timestep makes of it."""
    if series.failed:
        report.findings.append(Finding("error", "energy", f"At the timestep {series.dt:.4g} the run fails: {series.failed}"))
        return
    unit = nve.drift_unit(series.units)
    value = series.relative_fluctuation
    message = (f"At the timestep {series.dt:.4g} the total energy fluctuates by {series.fluctuation:.3g}, {100 * value:.2g} % of what the "
               f"kinetic energy does, and drifts by {series.drift:.2g} +- {series.drift_error:.1g} {unit} ({steps} steps).")
    bad = value > 0.2 and series.fluctuation > TINY * float(np.mean(series.kinetic))
    report.findings.append(Finding("warning" if bad else "ok", "energy", message, value=value, limit=0.2,
                                   advice=f"timestep {series.dt * math.sqrt(0.1 / value):.2g}" if bad else ""))


# ---------------------------------------------------------------------------------------------------------------------------- reversal ---

def reversal(b: Bench, dt: float, steps: int, settings=None, nudge: float = 0.0, seed: int = 1) -> tuple[float, float]:
    """How far atoms end from where they began when velocities are reversed half way, and how far they were in between (both rms).

    With a `nudge` there is no reversal: the first number is how far two paths are apart in the end that began so far apart.
    """
    loops = [b.loop(dt, settings) for _ in range(1 + (nudge > 0.0))]
    if nudge > 0.0:
        loops[1].system.x += nudge * np.random.default_rng(seed).standard_normal(loops[1].system.x.shape)
    places = []
    for loop in loops:
        loop.setup(loop.step, loop.step + 2 * steps)
        begin = _unwrapped(loop)
        loop.advance(steps, virial=False)
        middle = _unwrapped(loop)
        if nudge == 0.0:
            loop.system.v *= -1.0
            loop.sync_in()
        loop.advance(steps, virial=False)
        places.append((begin, middle, _unwrapped(loop)))
    begin, middle, end = places[0]
    return _rms(end - (places[1][2] if nudge > 0.0 else begin)), _rms(middle - begin)


def _unwrapped(loop) -> np.ndarray:
    return loop.system.box.unwrap(loop.system.x, loop.system.image)


def _rms(d: np.ndarray) -> float:
    return float(np.sqrt(np.mean(d * d))) if d.size else 0.0


def time_reversal(b: Bench, report: Report, force: bool, limit: float | None) -> None:
    """Time reversal: there and back again, against the growth of roundings."""
    name = "time reversal"
    dt = b.dt if limit is None else min(b.dt, CLOSE * limit)
    steps = b.steps(STEPS // 2, 20, 0.4 / 8)
    if not steps:
        report.left_out.append((name, TOO_SHORT))
        return
    every_step = replace(b.scene.neighbor, every=1, delay=0, check=False)
    length = max(float(np.abs(b.scene.system.box.lengths).max()), 1e-300)
    while True:
        best, way = reversal(b, dt, steps, every_step)
        if best <= 1e-4 * way or steps <= 10:
            break
        steps //= 2                 # chaos: after fewer steps there is still something to be seen
    own, way = reversal(b, dt, steps, b.scene.neighbor)
    grown = reversal(b, dt, steps, every_step, nudge=4e-16 * length)[0]
    allowed = max(100.0 * best, 1000.0 * grown, 1e-14 * length)
    found = f"After {steps} steps and as many back the atoms are {own:.2g} from where they began ({way:.2g} on the way)"
    if own <= allowed:
        report.findings.append(Finding("ok", name, f"{found}: roundings, which grow to {max(best, grown):.2g} by themselves.", value=own,
                                       limit=allowed))
        return
    advice = "neigh_modify every 1 delay 0 check yes, or a larger skin"
    message = f"{found}; with a list that is rebuilt in every step they are {best:.2g}: the path depends on when the list was built."
    severity = "warning" if own > SMALL * way else "note"
    report.findings.append(Finding(severity, name, message, value=own, limit=allowed, advice=advice))


# ------------------------------------------------------------------------------------------------------------------------ missed pairs ---

def missed_pairs(b: Bench, report: Report, force: bool, limit: float | None) -> None:
    """Missed pairs: the energy by the scene's own list against that by a list that is surely complete."""
    name = "missed pairs"
    settings = b.scene.neighbor
    period = max(settings.every, settings.delay, 1)
    stretch = period if period > 1 else 7
    looks = b.steps(STEPS, stretch, 0.5) // stretch
    loop = b.loop(b.dt, settings)
    if loop.engine.mode == "none" or (limit is not None and b.dt >= limit):
        report.left_out.append((name, "no pair interactions" if loop.engine.mode == "none" else APART))
        return
    if not looks:
        report.left_out.append((name, TOO_SHORT))
        return
    loop.setup(loop.step, loop.step + 10**6)
    fresh = Engine(loop.system.copy(), loop.interactions, replace(loop.settings, precision="double"))
    worst, far, missed, done = 0.0, 0.0, 0, 0
    for k in range(looks):
        result = loop.advance(stretch if k else stretch - 1)        # just before the list is due
        done = loop.step
        d = loop.state.x[:, :loop.nslots] - loop.engine.held[:, :loop.nslots]
        far = max(far, float(np.sqrt((d * d).sum(axis=0).max(initial=0.0))))
        whole = _complete(fresh, loop.system)
        scale = max(abs(whole), 0.5 * boltzmann(b.scene) * loop.system.n, 1e-300)
        off = result.potential - whole
        if abs(off) > LOST * (SINGLE if b.scene.precision == "mixed" else 1.0) * scale:
            missed += 1
            worst = max(worst, abs(off))
        if b.left <= 0.0:
            break
    kt = 2.0 * b.kinetic(loop) / max(3 * loop.system.n, 1)
    steps = done - b.scene.step
    if not missed:
        message = f"In {steps} steps the list missed no pair (skin {settings.skin:g}, atoms moved by {far:.2g} between builds)."
        report.findings.append(Finding("ok", name, message, value=0.0, limit=LOST))
        return
    message = (f"In {steps} steps the list missed pairs at {missed} of {looks} looks: the energy is wrong by up to {worst:.3g} "
               f"({worst / kt / loop.system.n:.2g} kT per atom), atoms moved by {far:.2g} between builds, "
               f"the skin allows {settings.skin / 2:g}.")
    advice = f"neighbor {2.2 * far:.2g} bin, or neigh_modify every 1 delay 0 check yes"
    severity = "warning" if worst > SMALL * kt * loop.system.n else "note"
    report.findings.append(Finding(severity, name, message, value=worst, limit=LOST, advice=advice))


def _complete(engine: Engine, system) -> float:
    """The potential energy by a fresh list."""
    y = engine.system
    y.x[:], y.image[:], y.v[:] = system.x, system.image, system.v
    if y.box != system.box:
        y.box = system.box
        engine.update(y)
    return engine.compute().potential


@contextmanager
def _bar(progress):
    """What shows progress: the caller's function, a bar on a terminal, nothing elsewhere."""
    if progress is not None:
        yield progress
    elif not sys.stderr.isatty():
        yield lambda fraction, what: None
    else:
        from rich.console import Console
        from rich.progress import Progress
        with Progress(console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("experiments", total=1.0)
            yield lambda fraction, what: bar.update(task, completed=fraction, description=what)


__all__ = ["run"]
