"""``minimize etol ftol maxiter maxeval``"""
from __future__ import annotations

import time

from asemd.errors import InputError
from asemd.lammps import log, restart, setup_log
from asemd.lammps.driver import Driver, Plan, check, memory
from asemd.lammps.landscape import BoxLandscape, Landscape
from asemd.lammps.pair_order import pair_order
from asemd.minimize import MAXITER, WALLTIME, Problem, find
from asemd.moment import Progress
from asemd.words import number, whole

DAMPED = ("fire", "quickmin")       # they move atoms with velocities, which stay


def run(session, args):
    session.scene.need_system("minimize")
    if len(args) != 4:
        raise InputError(f"minimize needs etol ftol maxiter maxeval, got {len(args)} values")
    etol, ftol = (number(w, "minimize") for w in args[:2])
    limits = [whole(w, "minimize") for w in args[2:]]
    if etol < 0.0 or ftol < 0.0 or min(limits) < 0:
        raise InputError("minimize: tolerances and limits must not be negative")
    if session.switches.cap is not None:
        limits[0] = min(limits[0], session.switches.cap)
    Minimization(session, etol, ftol, *limits).run()


class Minimization(Driver):
    """Carries out one minimisation, with the output of a run."""

    kind = "minimize"

    def __init__(self, session, etol: float, ftol: float, maxiter: int, maxeval: int):
        begin = session.scene.step
        super().__init__(session, Plan(maxiter, begin, begin + maxiter))
        self.arguments = (etol, ftol, maxiter, maxeval)

    def run(self) -> None:
        session, scene, begin = self.session, self.scene, self.scene.step
        if session.dry:
            session.drive(self)
            return
        if session.timer.expired:
            return
        check(session)
        setup_log.report_mixing(session)
        restart.check_folders(session)
        restart.first_run(session)
        session.close_loop()
        if scene.min_style in DAMPED:
            scene.system.v[:] = 0.0
        fixes = [*(f for f in scene.fixes.values() if f.minimizes), *pair_order(session)]
        for f in fixes:
            f.minimizing = True
        try:
            self._carry_out(fixes, begin)
        finally:
            for f in fixes:
                f.minimizing = False

    def _carry_out(self, fixes: list, begin: int) -> None:
        from asemd.loop import Loop
        session, scene = self.session, self.scene
        loop = session.loop = Loop(scene.system, scene.interactions, scene.settings(), fixes, scene.groups, scene.dt, step=begin)
        loop.warn, loop.say = session.warn, session.print
        with session.at_step(begin):
            loop.setup(begin, begin + self.plan.steps, moves=False)
        setup_log.report_list(session, loop.engine)
        if scene.min_style == "fire":
            session.log.write(find("fire").parameters(scene.min_modify) + "\n")
        session.log.write("Per MPI rank memory allocation (min/avg/max) = {0:.4g} | {0:.4g} | {0:.4g} Mbytes\n".format(memory()))
        self.progress = Progress(begin, begin, begin + self.plan.steps, builds=loop.engine.builds, dangerous=loop.engine.dangerous,
                                 remaining=session.timer.remaining)
        session.running = True
        try:
            result = self._minimize(loop, begin)
        finally:
            session.running = False
            self._watch("stop")
        seconds = time.perf_counter() - self.progress.started
        if scene.thermo.footer():
            session.log.write(scene.thermo.footer() + "\n")
        loop.finish()
        scene.set_dt(scene.dt)
        timings = dict(loop.engine.timings)
        timings["Output"] = timings.get("Output", 0.0) + self.output_seconds
        if session.record is not None:
            session.record.ended(self, result.iterations, seconds, timings)
        session.loop = None         # a run after a minimisation starts afresh
        self._report(loop, result, seconds, timings)
        if session.interrupted:
            raise KeyboardInterrupt

    def _minimize(self, loop, begin: int):
        session, scene = self.session, self.scene
        self._provide(begin, begin + self.plan.steps, fresh=True)
        if scene.thermo.header(self.words):
            session.log.write(scene.thermo.header(self.words) + "\n")
        self._output(begin, ends=True)
        self._watch("start", self.plan.steps)
        self.progress.started = time.perf_counter()
        self.output_seconds = 0.0
        relax = [f for f in loop.fixes if f.style == "box/relax"]
        if len(relax) > 1:
            raise InputError("minimize: there is more than one fix box/relax")
        if relax and scene.min_style not in ("cg", "sd"):
            raise InputError(f"minimize: fix box/relax does not work with min_style {scene.min_style}; use cg or sd")
        landscape = BoxLandscape(loop, session, relax[0]) if relax else Landscape(loop, session)
        system, norm = scene.system, scene.thermo.is_normalised(scene.units)
        def due(step: int) -> bool:
            return self._is_thermo(step) or any(d.schedule.next == step for d in scene.dumps.values())

        def shown(iteration: int) -> bool:
            return iteration == self.plan.steps or due(begin + iteration) or restart.due(session, begin + iteration)

        problem = Problem(landscape.x0, landscape, system.atom_masses(), scene.dt, loop.units, float(max(system.n, 1)) if norm else 1.0,
                          shown, landscape if relax else None, landscape.move if scene.min_style in DAMPED else None)

        def look(iteration: int, x, v, energy, forces) -> bool | str:
            loop.step = loop._collected = scene.step = begin + iteration
            landscape.step = landscape.next_step = scene.step + 1
            if scene.min_style in DAMPED:
                system.v[:] = v
            self._watch("update", iteration)
            for f in loop.fixes:
                if f.style == "halt" and f.next_end(scene.step - 1) == scene.step:
                    f.end_of_step(loop)
            if due(scene.step):
                began = time.perf_counter()
                self._provide(scene.step, scene.step, fresh=True)
                self._output(scene.step, ends=False)
                self.output_seconds += time.perf_counter() - began
            if restart.due(session, scene.step) or (session.interrupted and scene.restarts):
                restart.write_due(session, scene.step, all_of_them=session.interrupted)
            if loop.halted:
                return WALLTIME
            if session.timer.check(iteration):
                session.warn("Wall time limit reached")
                return WALLTIME
            return session.interrupted

        result = find(scene.min_style).minimize(problem, *self.arguments, scene.min_modify, look)
        if scene.min_style in DAMPED:
            system.v[:] = result.v
        landscape.step = begin + result.steps
        landscape.known = landscape.random and result.criterion == MAXITER
        landscape(result.x)
        loop.step = loop._collected = scene.step = begin + result.steps
        told = session.last_thermo_step == scene.step       # by the last iteration's output
        if result.steps:
            self._provide(scene.step, scene.step, fresh=True)
            if not told or session.interrupted:
                self._output(scene.step, ends=not told, dumps=result.iterations < self.plan.steps)
            restart.write_due(session, scene.step, all_of_them=True)
        return result

    def _report(self, loop, result, seconds: float, timings: dict[str, float]) -> None:
        session, scene, engine, write = self.session, self.scene, loop.engine, self.session.log.write
        if session.timer.style != "off":
            write(log.loop_line(seconds, result.iterations, scene.system.n) + "\n")
            write(f"100.0% CPU use with 1 MPI tasks x {scene.threads} OpenMP threads\n")
        write(f"\n{result.text()}\n\n")
        present = tuple(s for s in log.SECTIONS if s not in ("Bond", "Kspace") or timings.get(s, 0.0) > 0.0)
        write(log.timing_table(seconds, timings, present, session.timer))
        self._counts(engine, engine.builds, engine.dangerous)
        self.session.log.flush()
