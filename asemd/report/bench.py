"""Measures settings of a scene: forces against a reference, a run at constant energy, warm times."""
from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from asemd import units as unit_styles
from asemd.compute.temp import Temp
from asemd.engine import Engine
from asemd.report import nve
from asemd.report.clock import Clock
from asemd.report.constraints import field_forces
from asemd.report.copies import copied
from asemd.report.knob import Knob
from asemd.report.knobs.thermostat import baths
from asemd.report.result import SCRIPT, Point
from asemd.report.statistics import block_error
from asemd.scene import Scene

SAMPLES = 120       # of energies in a run
LOOKS = 6           # samples with reference forces and configurational temperature
OFTEN = 24          # samples with configurational temperature where the temperature is what is looked at
WARM = 10           # steps that compile what a run needs
COMPLETE = 0.9      # part of its time that a run must have covered for its fluctuation to be compared
BURSTS = 12         # of each runner in a race
FEWEST_BURSTS = 3   # if the time is over


class Reference:
    """Exact energies, forces and pressures: double precision, one thread, a fresh list, the tightest value of one knob."""

    def __init__(self, scene: Scene):
        self.scene = scene
        settings = replace(scene.settings(), precision="double", threads=1, every=1, delay=0, check=True)
        self.engine = Engine(scene.system.copy(), scene.interactions, settings)

    def at(self, x: np.ndarray):
        """The result at these positions."""
        self.engine.move(x)
        return self.engine.collect()


class Bench:
    """Measures points, one after another.

    Parameters
    ----------
    scene : Scene
        Where all runs start; not changed.
    knobs : mapping
        Name -> knob.
    clock : Clock
        Knows what compilation takes.
    seed : int
    """

    def __init__(self, scene: Scene, knobs: Mapping[str, Knob], clock: Clock, seed: int = 1):
        self.scene, self.knobs, self.clock, self.seed = scene, dict(knobs), clock, seed
        self.shifted = copied(scene)
        nve.prepare(self.shifted)
        self.frames = [scene.system.x.copy()]
        self.references: dict[str, Reference] = {}
        self.given: dict[int, float] = {}   # relative force errors of the script's settings, by reference
        self.shares: list[float] = []       # processor time by wall time of runs with one thread
        self.busy = False                   # other work on the machine: processor time counts
        self.forced = self._forced()

    def _forced(self) -> np.ndarray:
        """(n,) bool: atoms whose forces fixes change, which say nothing of the force field."""
        out = np.zeros(self.scene.system.n, bool)
        for fix in self.scene.fixes.values():
            if fix.minimizes and fix.style not in ("enforce2d", "shake", "rattle"):
                out |= self.scene.groups.mask(fix.group)
        return out

    # ---- scenes -------------------------------------------------------------------------------------------------------------------------
    def trial(self, settings: Mapping[str, Any], folder: str, shifted: bool = True) -> Scene:
        """A copy of the scene with some knobs turned."""
        scene = copied(self.shifted if shifted else self.scene)
        for name in sorted(settings, key=lambda n: self.knobs[n].order):
            self.knobs[name].apply(scene, settings[name], folder)
        return scene

    def reference(self, settings: Mapping[str, Any], shifted: bool) -> Reference:
        """The reference for some knobs turned: each at its tightest value, if that is not the script's own."""
        tight = {n: self.knobs[n].reference(self.scene) for n in settings}
        tight = {n: value for n, value in tight.items() if value is not None}
        key = f"{sorted(tight.items())} {shifted}"
        if key not in self.references:
            with tempfile.TemporaryDirectory(prefix="asemd-report-") as folder:
                self.references[key] = Reference(self.trial(tight, folder, shifted))
        return self.references[key]

    # ---- measurements -------------------------------------------------------------------------------------------------------------------
    def warm(self, scene: Scene, fixes: str) -> tuple[float, float]:
        """Compile what a run of the scene needs; seconds of compilation, and of a step, roughly."""
        before = self.clock.compiled
        with self.clock.warming():
            series = nve.run(scene, steps=WARM, samples=2, fixes=fixes, seed=self.seed, configurational=1)
        return self.clock.compiled - before, series.seconds_per_step

    def measure(self, knob: str, label: str, number: float, settings: Mapping[str, Any], duration: float, deadline: float,
                keep_frame: bool = False) -> Point:
        """One point.

        Parameters
        ----------
        settings : mapping
            Knob -> value, those that are not the script's own.
        duration : float
            Time the run covers, time units.
        deadline : float
            Reading of ``time.perf_counter`` at which the run ends early; compilation is given in addition.
        keep_frame : bool
            Energies and pressures of later points are compared at the end of this run too.
        """
        point = Point(knob, label, number, dict(settings))
        fixes = next((self.knobs[n].fixes for n in settings if self.knobs[n].fixes != "nve"), "nve")
        with tempfile.TemporaryDirectory(prefix="asemd-report-") as folder:
            scene = self.trial(settings, folder)
            point.compile_seconds, _ = self.warm(scene, fixes)
            series = self._run(point, scene, settings, fixes, duration, deadline + point.compile_seconds)
        with tempfile.TemporaryDirectory(prefix="asemd-report-") as folder:
            if keep_frame and not series.failed:
                self.frames.append(series.system.x.copy())
            self._compare(point, self.trial(settings, folder, shifted=False), settings)
        return point

    def _run(self, point: Point, scene: Scene, settings, fixes: str, duration: float, deadline: float) -> nve.Series:
        steps = max(2, int(round(duration / scene.dt)))
        samples = max(2, min(SAMPLES, steps // 4))
        looks = set(np.linspace(0, samples, LOOKS + 1, dtype=int)[1:].tolist())
        reference = self.reference(settings, True) if fixes == "nve" else None
        free = ~self.forced
        squares: list[tuple[float, float]] = []

        def observe(k, loop, result):
            if k in looks and reference is not None and free.any():
                found = field_forces(loop)[free]
                d = found - reference.at(loop.system.x).forces[free]
                f = found - d
                squares.append((float((d * d).sum()), float((f * f).sum())))
        series = nve.run(scene, steps=steps, samples=samples, fixes=fixes, seed=self.seed, observe=observe,
                         configurational=LOOKS if fixes == "nve" else min(samples, OFTEN),
                         deadline=deadline)
        if squares and sum(f for _, f in squares) > 0.0:
            point.force_error = math.sqrt(sum(d for d, _ in squares) / sum(f for _, f in squares))
        self._fill(point, scene, series, fixes, duration)
        return series

    def _fill(self, point: Point, scene: Scene, s: nve.Series, fixes: str, duration: float) -> None:
        """Numbers of a run."""
        point.dt, point.steps, point.failed, point.dangerous = s.dt, s.steps, s.failed, s.dangerous
        point.setup_seconds, point.run_seconds, point.fixes = s.setup_seconds, float(s.seconds.sum()), fixes
        if s.failed or len(s.step_seconds) == 0:
            point.failed = s.failed or "no time for a run"
            return
        point.wall = [float(q) for q in np.percentile(s.step_seconds, (25, 50, 75))]
        point.processor = [float(q) / scene.threads for q in np.percentile(s.step_processor, (25, 50, 75))]
        if scene.threads == 1:
            self.shares.append(float(s.processor.sum() / max(s.seconds.sum(), 1e-9)))
        self.choose_clock(point)
        point.builds_per_step = s.builds / max(s.steps, 1)
        point.drift, point.drift_error = s.drift, s.drift_error
        if point.knob == SCRIPT or fixes == "own" or s.time[-1] >= COMPLETE * duration:       # a shorter run is no comparison
            point.fluctuation, point.fluctuation_error = s.fluctuation, s.fluctuation_error
            point.relative_fluctuation = s.relative_fluctuation
            point.relative_fluctuation_error = s.fluctuation_error * s.relative_fluctuation / s.fluctuation if s.fluctuation > 0.0 else 0.0
        half = len(s.temperature) // 2 if len(s.temperature) > 8 else 0
        point.temperature, point.temperature_error = float(np.mean(s.temperature[half:])), block_error(s.temperature[half:])
        conf = s.configurational[half if fixes == "own" else 0:]
        conf = conf[np.isfinite(conf)]
        if len(conf):
            point.configurational = float(np.mean(conf))
            point.configurational_error = float(np.std(conf, ddof=1) / math.sqrt(len(conf))) if len(conf) > 1 else math.nan
        target = baths(scene)[0].start if fixes == "own" and baths(scene) else point.configurational
        if target > 0.0:
            point.temperature_offset = point.temperature / target - 1.0
            if fixes == "own" and len(conf):
                point.configurational_offset = point.configurational / target - 1.0
                point.configurational_offset_error = point.configurational_error / target
            point.offset_error = math.hypot(point.temperature_error, 0.0 if fixes == "own" else point.configurational_error) / target
            if fixes == "own" and baths(scene):
                # blocks do not see what takes longer than the run: a temperature forgets within a damping time, not sooner
                forgotten = max(1.0, (s.time[-1] - s.time[half]) / max(f.damping for f in baths(scene)))
                least = math.sqrt(2.0 / max(s.dof, 1.0) / forgotten)
                point.offset_error = float(np.fmax(point.offset_error, least))
                point.configurational_offset_error = float(np.fmax(point.configurational_offset_error, least))
        point.constraint_error = float(np.max(s.constraint, initial=0.0))

    def choose_clock(self, point: Point) -> None:
        """Times of a point by wall clock, or by processor time on a busy machine."""
        low, middle, high = point.processor if self.busy else point.wall
        point.seconds_per_step, point.quartiles = middle, (low, high)
        point.seconds_per_span = middle * nve.span(self.scene.units) / point.dt

    def race(self, settings: Mapping[str, Any], seconds: float) -> tuple[float, float, float]:
        """How many times faster a simulated time is with these settings than with the script's, by turns; median and quartiles."""
        times: list[list[float]] = [[], []]
        with tempfile.TemporaryDirectory(prefix="asemd-report-") as folder:
            runners = [(nve.start(scene), scene.dt) for scene in (self.trial({}, folder), self.trial(settings, folder))]
            clock, bursts = time.process_time if self.busy else time.perf_counter, []
            for loop, _ in runners:
                loop.advance(WARM)
                began = clock()
                loop.advance(WARM)
                # at least so many steps that lists are built in them
                bursts.append(max(2 * WARM, int(WARM * seconds / (2 * BURSTS) / max(clock() - began, 1e-9))))
            until = time.perf_counter() + 2.0 * seconds
            for k in range(BURSTS):
                if k >= FEWEST_BURSTS and time.perf_counter() > until:
                    break
                for (loop, dt), steps, found in zip(runners, bursts, times):
                    began = clock()
                    loop.advance(steps)
                    found.append((clock() - began) / (steps * dt) / (loop.engine.threads if self.busy else 1))
        low, middle, high = np.percentile(np.array(times[0]) / np.array(times[1]), (25, 50, 75))
        return float(middle), float(low), float(high)

    def _compare(self, point: Point, scene: Scene, settings) -> None:
        """Energy and pressure against the reference, at all frames; forces too if the run said nothing of them."""
        reference, n = self.reference(settings, False), scene.system.n
        engine = Engine(scene.system, scene.interactions, scene.settings())
        energies, pressures, squares = [], [], [0.0, 0.0]
        for x in self.frames:
            exact = reference.at(x)
            force, energy, pressure = exact.forces.copy(), exact.potential, virial_pressure(scene.system, exact)
            engine.move(x)
            found = engine.collect()
            energies.append(abs(found.potential - energy) / max(n, 1))
            pressures.append(abs(virial_pressure(scene.system, found) - pressure))
            squares[0] += float(((found.forces - force) ** 2).sum())
            squares[1] += float((force * force).sum())
        point.energy_error, point.pressure_error = max(energies), max(pressures)
        if any(not self.knobs[name].model and self.knobs[name].reference(self.scene) is not None for name in settings):
            point.given_error = self.given_error(*settings)
        if math.isnan(point.force_error) and squares[1] > 0.0:
            point.force_error = math.sqrt(squares[0] / squares[1])


    def given_error(self, *names: str) -> float:
        """What the script's settings miss of the forces with the tightest values of some knobs, relative; at the first frame."""
        reference = self.reference(dict.fromkeys(names), False)
        if id(reference) not in self.given:
            scene = self.trial({}, "", shifted=False)
            engine, exact = Engine(scene.system, scene.interactions, scene.settings()), reference.at(self.frames[0]).forces
            engine.move(self.frames[0])
            d = engine.collect().forces - exact
            self.given[id(reference)] = math.sqrt(float((d * d).sum()) / max(float((exact * exact).sum()), 1e-300))
        return self.given[id(reference)]


def virial_pressure(system, result) -> float:
    """The pressure without its kinetic part, in pressure units; nan for a box that is not periodic."""
    if not system.box.periodic.any():
        return math.nan
    virial = result.virial + result.virial_of.get("tail", 0.0)
    axes = system.dimension
    volume = abs(float(np.linalg.det(system.box.cell)))
    if axes == 2:
        volume = float(np.linalg.norm(np.cross(system.box.cell[0], system.box.cell[1])))
    return float(virial[:axes].sum()) / (axes * volume) * unit_styles.get(system.units).nktv2p


def kinetic_temperature(scene: Scene) -> float:
    """Of the velocities a scene has."""
    from asemd.result import Snapshot
    snapshot = Snapshot(scene.system, None, scene.groups, scene.dt, scene.step, [])
    return Temp("all").scalar(snapshot)
