"""From a script or atoms to a written report."""
from __future__ import annotations

import os
import platform
import signal
import threading
import time
import warnings
from contextlib import contextmanager
from pathlib import Path

from asemd import __version__
from asemd.errors import InputError, InputWarning
from asemd.report import copies
from asemd.report.apply import apply_to
from asemd.report.clock import Clock
from asemd.report.knobs.threads import cores
from asemd.report.result import Report
from asemd.report.study import Study
from asemd.scene import Scene

SHORTEST = 1.0      # seconds of a budget


def machine() -> dict[str, str]:
    """The machine that times are of."""
    from llvmlite import binding
    return {"processor": f"{binding.get_host_cpu_name()} ({platform.machine()})", "cores": str(cores()), "system": platform.system(),
            "name": platform.node() or "unnamed", "Python": platform.python_version(), "asemd": __version__}


def name_of(source) -> str:
    """A short name: of ``in.melt`` it is ``melt``."""
    if not isinstance(source, (str, os.PathLike)):
        return "scene"
    base = os.path.basename(os.fspath(source))
    return base[3:] if base.startswith("in.") and len(base) > 3 else Path(base).stem


def carry_out(source, budget, at, folder, apply, only, seed, tolerance, lammps, switches, tell) -> Report:
    """See `asemd.report.report`."""
    if not budget >= SHORTEST:
        raise InputError(f"report: the budget must be at least {SHORTEST:g} second, got {budget:g}")
    if at is not None and at < 1:
        raise InputError(f"report: runs are counted from 1, got {at}")
    if not tolerance > 0.0:
        raise InputError(f"report: the tolerance must be positive, got {tolerance:g}")
    clock = Clock(float(budget))
    with warnings.catch_warnings(), clock:
        warnings.simplefilter("ignore", InputWarning)
        warnings.simplefilter("ignore", RuntimeWarning)     # of numpy, in runs that end in numbers that are not finite
        reader = copies.read(os.fspath(source), switches, at) if isinstance(source, (str, os.PathLike)) else None
        try:
            scene = copies.load(reader.taken if reader else source)
        except InputError as error:
            raise error.at(reader.where if reader else None) from None
        found = Report(os.fspath(source) if reader else "scene" if isinstance(source, Scene) else "atoms", scene.system.n, scene.units,
                       machine=machine(), seed=seed, budget=float(budget))
        if reader:
            found.place = _place(reader)
            if reader.skipped:
                found.notes.append(f"Not carried out, for they only write files: {', '.join(sorted(set(reader.skipped)))}.")
            if reader.stopped:
                found.notes.append(f"The script was read until: {reader.stopped}")
        study = Study(scene, found, clock, tell or (lambda done, total, what: None), tolerance, only, lammps)
        if folder is not None:
            clock.keep(1.0)
        study.run()
        with undisturbed() as asked:
            if folder is not None:
                from asemd.report.write import write
                write(found, folder, study.scene.system, time.perf_counter() + clock.left() + clock.reserve)
            if apply is not None:
                apply_to(found, scene, reader, apply)
        found.interrupted |= bool(asked)
    return found


@contextmanager
def undisturbed():
    """A block that Ctrl-C does not end, so that what was measured is written; a second Ctrl-C does."""
    asked: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield asked
        return

    def note(number, frame):
        if asked:
            raise KeyboardInterrupt
        asked.append(number)
    before = signal.signal(signal.SIGINT, note)
    try:
        yield asked
    finally:
        signal.signal(signal.SIGINT, before)


def _place(reader: copies.Reader) -> str:
    if reader.where is None:
        return "the script runs nothing: its scene at the end"
    which = f"run {reader.runs} of the script"
    if reader.at is None:
        which = "the last run of the script" if reader.runs > 1 else "the run of the script"
    return f"{which} (line {reader.where.line}: {reader.action})"
