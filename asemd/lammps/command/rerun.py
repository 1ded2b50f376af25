"""``rerun file1 file2 ... keyword values ... dump fields and keywords of read_dump``"""
from __future__ import annotations

import time

from asemd.errors import InputError, nearest
from asemd.lammps import log, setup_log
from asemd.lammps.command.read_dump import read_request, take_snapshot
from asemd.lammps.driver import Driver, Plan, check, memory
from asemd.lammps.dump_read import frames
from asemd.lammps.live_coefficients import own_fixes
from asemd.moment import Progress
from asemd.words import take, whole, yes_no

KEYWORDS = ("first", "last", "every", "skip", "start", "stop", "post", "dump")
FOREVER = 2**62


def run(session, args):
    session.scene.need_system("rerun")
    words, files = list(args), []
    while words and words[0] not in KEYWORDS:
        files.append(words.pop(0))
    if not files:
        raise InputError("rerun needs a dump file")
    options = {"first": 0, "last": FOREVER, "every": 0, "skip": 1, "start": None, "stop": None, "post": False}
    while words and words[0] != "dump":
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"rerun: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        what = f"rerun {key}"
        value = take(words, 1, what)[0]
        del words[0]
        options[key] = yes_no(value, what) if key == "post" else whole(value, what)
        if key != "post" and options[key] < (key == "skip"):
            raise InputError(f"{what}: must not be negative{' or 0' if key == 'skip' else ''}, got {value}")
    if not words:
        raise InputError("rerun needs the keyword dump and what to read, for example: dump x y z")
    request = read_request(session, words[1:], "rerun dump")
    request.timestep = True
    first, last = options["first"], options["last"]
    if first > last:
        raise InputError(f"rerun: first {first} is after last {last}")
    start = first if options["start"] is None else options["start"]
    stop = last if options["stop"] is None else options["stop"]
    Rerun(session, files, options, request, Plan(0, start, stop, post=options["post"])).run()


class Rerun(Driver):
    """Energies, forces and output of snapshots that are read from files."""

    def __init__(self, session, files: list[str], options: dict, request, plan: Plan):
        super().__init__(session, plan)
        self.files, self.options, self.request = files, options, request
        self.loop = None

    def snapshots(self):
        """The snapshots that are wanted, in ascending order of steps."""
        before, count, o = -1, 0, self.options
        for path in self.files:
            for frame in frames(path, self.request.format):
                if frame.step > o["last"]:
                    return
                if frame.step < o["first"] or frame.step <= before or (before >= 0 and o["every"] and frame.step % o["every"]):
                    continue
                if o["stop"] is not None and frame.step > o["stop"]:
                    raise InputError(f"rerun: snapshot {frame.step} is beyond stop {o['stop']}: give last too, or a later stop")
                count += 1
                if (count - 1) % o["skip"] == 0:
                    before = frame.step
                    yield frame

    def run(self) -> None:
        session, scene = self.session, self.scene
        check(session)
        setup_log.report_mixing(session)
        session.close_loop()
        done, seconds = 0, 0.0
        session.running = True
        try:
            for frame in self.snapshots():
                began = time.perf_counter()
                take_snapshot(session, frame, self.request)
                self._evaluate(frame.step, fresh=done == 0)
                done += 1
                seconds += time.perf_counter() - began
                if session.interrupted:
                    break
            if done > 1 and not self._is_thermo(scene.step):        # the last snapshot has a row in any case
                self._thermo(scene.step)
        finally:
            session.running = False
        if not done:
            raise InputError(f"rerun: {' '.join(self.files)}: no snapshot of the requested steps")
        if scene.thermo.footer():
            session.log.write(scene.thermo.footer() + "\n")
        self.loop.finish()
        if self.plan.post:
            session.loop = self.loop
            self._summary(seconds, done, {})
        else:
            session.log.write(log.loop_line(seconds, done, scene.system.n) + "\n")
        session.loop = None
        session.log.flush()
        if session.interrupted:
            raise KeyboardInterrupt

    def _evaluate(self, step: int, fresh: bool) -> None:
        from asemd.loop import Loop
        session, scene = self.session, self.scene
        if self.loop is None or self.loop.system is not scene.system:
            fixes = [*scene.fixes.values(), *own_fixes(session)]
            self.loop = Loop(scene.system, scene.interactions, scene.settings(), fixes, scene.groups, scene.dt, step=step)
            self.loop.warn = session.log.warn
        else:
            self.loop.engine.update(scene.system)       # the box is another one
        loop = session.loop = self.loop
        loop.step = step
        loop.setup(self.plan.first, min(self.plan.last, FOREVER), moves=False)
        loop.end_of_step()
        if fresh:
            setup_log.report_list(session, loop.engine)
            session.log.write("Per MPI rank memory allocation (min/avg/max) = {0:.4g} | {0:.4g} | {0:.4g} Mbytes\n".format(memory()))
            self.progress = Progress(begin=self.plan.first, first=self.plan.first, last=self.plan.last)
            if scene.thermo.header(self.words):
                session.log.write(scene.thermo.header(self.words) + "\n")
        self._provide(step, step, fresh=True)
        self._output(step, ends=fresh)
