"""A run from setup to timing table: checks, stretches of steps between outputs, thermo rows and dumps."""
from __future__ import annotations

import math
import os
import time
import warnings
from dataclasses import dataclass

import numpy as np

from asemd import units
from asemd.errors import InputError, InputWarning
from asemd.lammps import checkpoint, log, references, restart, setup_log, torn
from asemd.lammps.live_coefficients import fill, own_fixes, scale
from asemd.moment import Moment, Progress
from asemd.thermo import evaluate

STRETCH = 1.1   # LAMMPS's allowance for bonds that get longer
CHUNK = 0.5     # seconds between looks at the keyboard and updates of the progress bar


@dataclass
class Plan:
    """What ``run`` was asked: steps, the span that ramps cover, and which parts of the ceremony are wanted."""

    steps: int
    first: int
    last: int
    pre: bool = True
    post: bool = True


def check(session) -> None:
    """Everything a run needs, and what looks wrong.

    Raises
    ------
    InputError
        A missing mass or coefficient.
    """
    scene = session.scene
    system = scene.system
    references.renew(session)
    fill(session)
    scale(session)
    if system.rmass is None:
        for kind in sorted({int(t) for t in np.unique(system.type)}):
            if not math.isfinite(system.mass[kind]):
                raise InputError(f"no mass for atom type {kind}: use the mass command or a Masses section")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InputWarning)
        scene.interactions.check_complete(system)
    for warning in caught:
        session.warn(str(warning.message))
    if not scene.newton[0] and (strict := [use.style.name for use in scene.interactions.uses["pair"] if use.style.needs_newton]):
        raise InputError(f"pair style {strict[0]} needs newton on, which stands before the box is defined", session.places.get("newton"))
    if scene.newton[1]:
        for use in scene.interactions.uses["bond"]:
            settings = use.settings
            if not getattr(use.style, "newton_bond", True) and settings["break"] and not settings["overlay/pair"]:
                raise InputError(f"bond_style {use.style.name} without overlay/pair yes or break no needs newton on off, which stands "
                                 "before the box is defined")
    for id, fix in scene.fixes.items():
        if fix.needs_atoms and fix.group not in scene.dynamic_groups and not scene.groups.mask(fix.group).any():
            raise InputError(f"fix {id} (style {fix.style}): group {fix.group} has no atoms", session.places.get(f"fix {id}"))
    torn.check(session)
    for dump in scene.dumps.values():
        dump.check_scene(system)
    check_lengths(session)
    neighbor = scene.neighbor
    if neighbor.delay % neighbor.every:
        raise InputError(f"neigh_modify delay {neighbor.delay} must be 0 or a multiple of every {neighbor.every}",
                         session.places.get("neigh_modify"))
    for kind, atoms, _ in system.topology:
        if len(atoms) and not scene.interactions.uses[kind]:
            apart = {"bond": 0, "angle": 1, "dihedral": 2}.get(kind)
            hidden = apart is not None and (scene.interactions.special_lj[apart] != 1.0 or scene.interactions.special_coul[apart] != 1.0)
            session.warn(f"{kind.capitalize()}s are defined but no {kind} style is set: they have no energy"
                         + (f", and special_bonds takes interactions of 1-{apart + 2} pairs away" if hidden else ""))
    check_extent(session)
    if scene.interactions.style_name("bond") == "fene":
        lj, coul = tuple(scene.interactions.special_lj), tuple(scene.interactions.special_coul)
        if lj != (0.0, 1.0, 1.0) or (system.has_charge and coul != (0.0, 1.0, 1.0)):
            session.warn("bond_style fene should be used with special_bonds lj/coul 0 1 1 (special_bonds fene)")


def check_lengths(session) -> None:
    """Warn of coefficients that are lengths but negative: allowed by LAMMPS, hardly meant."""
    for category, uses in session.scene.interactions.uses.items():
        for use in uses:
            lengths = [p.name for p in use.style.coeff if p.unit == "distance"]
            wrong = [(key, n, c[n]) for key, c in use.coeff.items() for n in lengths if (c.get(n) or 0.0) < 0.0]
            if wrong:
                key, name, value = wrong[0]
                types = " ".join(map(str, key)) if isinstance(key, tuple) else key
                session.warn(f"{category}_coeff {types}: {name} of {category} style {use.style.name} is negative: {value:g}")


def check_extent(session) -> None:
    """Warn when molecules are so large that the closest image of a bonded atom may be the wrong one.

    Source: LAMMPS manual, "Bond/angle/dihedral extent > half of periodic box length".
    """
    system = session.scene.system
    top, box = system.topology, system.box
    if not len(top.bonds) or not box.periodic.any():
        return
    s = (system.x[top.bonds[:, 1]] - system.x[top.bonds[:, 0]]) @ box.inverse
    s -= np.where(box.periodic, np.rint(s), 0.0)
    lengths = np.linalg.norm(s @ box.cell, axis=1)
    longest = int(np.argmax(lengths))
    span = 3 if len(top.dihedrals) or len(top.impropers) else 2 if len(top.angles) else 1
    half = 0.5 * float(box.lengths[box.periodic].min())
    if STRETCH * span * lengths[longest] > half:
        i, j = system.id[top.bonds[longest]]
        session.warn(f"Bond/angle/dihedral extent > half of periodic box length ({half:g}): the longest bond, {i}-{j}, is "
                         f"{lengths[longest]:.6g} long; closest images may be the wrong ones")


def check_integration(session) -> None:
    """Warn when nothing moves the atoms, or two fixes move the same ones."""
    scene, movers = session.scene, []
    filled = {*scene.dynamic_groups, *(f.group for f in scene.fixes.values() if f.style in ("deposit", "gcmc"))}
    for id, fix in scene.fixes.items():
        if fix.group not in filled and not scene.groups.mask(fix.group).any() and scene.system.n:
            session.warn(f"fix {id} (style {fix.style}) acts on no atoms: group {fix.group} is empty", session.places.get(f"fix {id}"))
        if fix.integrates:
            mask = scene.groups.mask(fix.group)
            for other, before in movers:
                if (mask & before).any():
                    session.warn(f"one or more atoms are time integrated more than once: by fix {other} and fix {id}",
                                 session.places.get(f"fix {id}"))
            movers.append((id, mask))
    if not movers:
        session.warn("no fixes with time integration, atoms won't move")


class Driver:
    """Carries out one run.

    Parameters
    ----------
    session : asemd.lammps.session.Session
    plan : Plan
    """

    kind = "run"

    def __init__(self, session, plan: Plan):
        self.session, self.plan, self.scene = session, plan, session.scene
        self.words = self.scene.thermo.columns(self.scene.box_changes)
        self.output_seconds = 0.0
        self.afresh = False         # the next run must not go on without a setup

    def run(self) -> None:
        """Setup, steps, summary."""
        session, plan, scene = self.session, self.plan, self.scene
        if session.dry:
            session.drive(self)
            return
        if session.timer.expired:
            return
        begin = scene.step
        loop = session.loop
        fresh = plan.pre or loop is None
        if fresh:
            from asemd.loop import Loop
            from asemd.respa import RespaLoop
            check(session)
            check_integration(session)
            setup_log.report_mixing(session)
            restart.check_folders(session)
            state = restart.first_run(session)
            session.close_loop()
            fixes = [*scene.dynamic_groups.values(), *scene.fixes.values(), *own_fixes(session)]
            parts = (scene.system, scene.interactions, scene.settings(), fixes, scene.groups, scene.dt)
            with session.passing_warnings():        # of solvers
                loop = session.loop = RespaLoop(*parts, step=begin, levels=scene.respa) if scene.respa else Loop(*parts, step=begin)
            loop.warn, loop.say, loop.watchdog.on = session.warn, session.later.append, session.switches.watchdog     # said after the list
            loop.watchdog.path = f"{session.log.path}.last_good.dump" if os.path.isfile(session.log.path or "") else ""
            with session.in_a_run(Progress(begin=begin, first=plan.first, last=begin + plan.steps, stop=plan.last)):
                loop.setup(plan.first, plan.last, needs=self._needs(begin, begin))
            if state is not None:
                checkpoint.resume(loop, state)
            setup_log.report_list(session, loop.engine)
            loop.say = session.print
            session.log.write("Per MPI rank memory allocation (min/avg/max) = {0:.4g} | {0:.4g} | {0:.4g} Mbytes\n".format(memory()))
        else:
            loop.sync_in()      # commands between the runs may have changed velocities
            loop.watchdog.again()
        loop.begin, loop.end, loop.dt = plan.first, plan.last, scene.dt
        engine = loop.engine
        counted = engine if fresh else session.moment.progress      # without a new setup the counters go on
        self.progress = Progress(begin=begin, first=plan.first, last=begin + plan.steps, stop=plan.last, builds=counted.builds,
                                 dangerous=counted.dangerous, remaining=session.timer.remaining)
        before = dict(engine.timings)
        session.running = True
        try:
            self._provide(begin, begin + plan.steps, fresh=True)
            header = scene.thermo.header(self.words)
            if header:
                session.log.write(header + "\n")
            self._output(begin, ends=True)
            self._watch("start", plan.steps)
            self.progress.started = time.perf_counter()
            self.output_seconds = 0.0
            self._advance(begin, begin + plan.steps)
            seconds = time.perf_counter() - self.progress.started
        finally:
            session.running = False
            self._watch("stop")
        loop.finish()
        scene.set_dt(scene.dt)
        if scene.thermo.footer():
            session.log.write(scene.thermo.footer() + "\n")
        steps = scene.step - begin
        self._summary(seconds, steps, {k: v - before.get(k, 0.0) for k, v in engine.timings.items()})
        session.log.flush()
        if self.afresh:
            session.loop = None
        if session.interrupted:
            raise KeyboardInterrupt

    # ----------------------------------------------------------------- steps ---

    def _advance(self, begin: int, end: int) -> None:
        session, loop, timer = self.session, self.session.loop, self.session.timer
        rate, step, loop.halted = 0.0, begin, False
        stopping = False
        while step < end and not stopping:
            target = min(end, self._next_output(step))
            while step < target and not session.interrupted:
                if loop.halted or timer.check(step - begin):
                    if not loop.halted:
                        session.warn("Wall time limit reached")
                    checkpoint.renew(loop)
                    self._provide(step, step, fresh=True)
                    return
                left = target - step
                chunk = left if not session.watched else max(1, min(left, int(rate * CHUNK) if rate else 20))
                chunk = min(chunk, timer.pause(step - begin))
                try:
                    if chunk == left:
                        needs = self._needs(target, end)
                        loop.advance(chunk, virial=True, energies="energies" in needs, virials="virials" in needs)
                    else:
                        loop.advance(chunk, virial=False)
                except KeyboardInterrupt:
                    self.scene.step = loop.step
                    restart.write_due(session, loop.step, checkpoint.renew(loop), all_of_them=True)
                    raise
                step = self.scene.step = loop.step
                rate = (step - begin) / max(time.perf_counter() - self.progress.started - self.output_seconds, 1e-9)
                self._watch("update", step - begin)
            started = time.perf_counter()
            stopping = session.interrupted      # it may change at any moment
            saving = restart.due(session, step) or (stopping and bool(self.scene.restarts))
            early = stopping and step < target          # between outputs energies are not computed
            going_on = step < end or stopping           # otherwise the next run begins afresh by itself
            alone = checkpoint.renew(loop) if early or (saving and going_on) else None
            self._provide(step, step if early else end, fresh=alone is not None)
            self._output(step, ends=step == end or stopping, dumps=stopping)
            if saving:
                restart.write_due(session, step, alone, all_of_them=stopping)
                self.afresh = not going_on
            self.output_seconds += time.perf_counter() - started

    def _next_output(self, step: int) -> int:
        """The next step on which something is written."""
        return min([d.schedule.next for d in self.scene.dumps.values()] + [self._next_thermo(step), restart.next_step(self.session, step)])

    def _next_thermo(self, step: int) -> int:
        every = self.scene.thermo.every
        if isinstance(every, str):
            if self._thermo_step <= step:
                value = int(self.session.variables.number(every))
                if value <= step:
                    raise InputError(f"thermo v_{every}: variable {every} gave step {value}, which is not after step {step}")
                self._thermo_step = value
            return self._thermo_step
        return _multiple(every, step)

    _thermo_step = -1

    def _needs(self, step: int, end: int) -> set[str]:
        """What the forces of an output step must bring: all that is defined on the last step, what is shown on others."""
        scene = self.scene
        if step == end:
            return {"virial"}.union(*(c.needs for c in scene.computes.values()), *(d.needs for d in scene.dumps.values()))
        needs: set[str] = set()
        if self._is_thermo(step):
            needs |= scene.thermo.needs(self.words, scene.computes, self.session.variables.references)
        for dump in scene.dumps.values():
            if dump.schedule.next == step:
                needs |= dump.needs
        return needs

    def _is_thermo(self, step: int) -> bool:
        every = self.scene.thermo.every
        return step == self._thermo_step if isinstance(every, str) else _due(every, step)

    # ---------------------------------------------------------------- output ---

    def _provide(self, step: int, end: int, fresh: bool) -> None:
        """Make the state of this step what formulas and output see."""
        session, scene = self.session, self.scene
        loop = session.loop
        if fresh:       # the first step may have to bring per-atom values too
            loop.engine.per_atom(loop.result, self._needs(step, step))
        session.moment = Moment(scene, loop.snapshot(), session.variables.number, self.progress, loop.engine)
        if fresh:
            for compute in scene.computes.values():
                compute.setup(session.moment.snapshot)

    def _output(self, step: int, ends: bool, dumps: bool = False) -> None:
        """Thermo row and dumps of a step that are due, or all of them."""
        session, scene = self.session, self.scene
        if ends or self._is_thermo(step):
            self._thermo(step)
        clock = (step, scene.time(step), scene.dt)
        for dump in scene.dumps.values():
            starts = step == self.progress.begin
            due = dump.schedule.is_due(*clock) or (dump.first and dump.last_written is None) if starts else dump.schedule.next == step
            if (dumps or due) and dump.last_written != step:        # a run's last step is the next one's first
                dump.write(session.moment.snapshot, step)
            if starts:
                dump.schedule.start(*clock, session.variables.number)
            elif due:
                dump.schedule.advance(*clock, session.variables.number)

    def _thermo(self, step: int) -> None:
        session, scene = self.session, self.scene
        self._tell_lost()
        norm = scene.thermo.is_normalised(scene.units)
        values = [evaluate(session.moment, w, norm) for w in self.words]
        session.log.write(scene.thermo.row(self.words, values, step, self.progress.cpu() if step > self.progress.begin else 0.0) + "\n")
        session.last_words, session.last_thermo_step = self.words, step
        session.last_thermo = {scene.thermo.name(k, w): v for k, (w, v) in enumerate(zip(self.words, values), 1)}
        if session.record is not None:
            session.record.row(self, values)
        if scene.thermo.flush or session.watched:
            session.log.flush()

    def _tell_lost(self) -> None:
        """With ``thermo_modify lost warn``: say once that atoms are gone."""
        thermo, n, expected = self.scene.thermo, self.scene.system.n, self.session.loop.natoms
        if thermo.lost == "warn" and n < expected and not thermo.lost_told:
            self.session.warn(f"Lost atoms: original {expected} current {n}")
            thermo.lost_told = True

    def _watch(self, what: str, *args) -> None:
        if self.session.observer is not None:
            getattr(self.session.observer, what)(*args)

    # --------------------------------------------------------------- summary ---

    def _summary(self, seconds: float, steps: int, timings: dict[str, float]) -> None:
        scene, write = self.scene, self.session.log.write
        n, engine = scene.system.n, self.session.loop.engine
        timer = self.session.timer
        timings["Output"] = timings.get("Output", 0.0) + self.output_seconds
        if self.session.record is not None:
            self.session.record.ended(self, steps, seconds, timings)
        if timer.style != "off":
            write(log.loop_line(seconds, steps, n) + "\n")
        if not self.plan.post:
            return
        if timer.style != "off":
            write(log.performance(seconds, steps, n, scene.dt, scene.units, units.get(scene.units).femtosecond))
            write(f"100.0% CPU use with 1 MPI tasks x {scene.threads} OpenMP threads\n")
        write("\n")
        present = tuple(s for s in log.SECTIONS if s not in ("Bond", "Kspace") or timings.get(s, 0.0) > 0.0
                        or (s == "Bond" and scene.system.molecular))
        write(log.timing_table(seconds, timings, present, timer))
        self._counts(engine, engine.builds - self.progress.builds, engine.dangerous - self.progress.dangerous)

    def _counts(self, engine, builds: int, dangerous: int) -> None:
        scene = self.scene
        special = setup_log.partners_per_atom(self.session) if scene.system.molecular else None
        self.session.log.write(log.counts(scene.system.n, 0, int(engine.pairs), special, builds,
                                          dangerous if scene.neighbor.check else None))


def _multiple(every: int, step: int) -> int:
    """The next multiple of `every` after `step`; beyond every run for 0."""
    return (step // every + 1) * every if every else 2**62


def _due(every: int, step: int) -> bool:
    return bool(every) and step % every == 0


def memory() -> float:
    """Largest memory of this process so far, in Mbytes; 0 where the system does not say."""
    try:
        import resource
    except ImportError:
        return 0.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
