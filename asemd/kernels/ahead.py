"""Generated modules compiled by several processes at once, before they are used: numba compiles one function at a time in a process.

The code goes from one process to the other through the cache on disk. What goes wrong in a helper is left to the process that needs the
code: it compiles it, and meets the error.
"""
from __future__ import annotations

import atexit
import base64
import contextlib
import os
import pickle
import re
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

from asemd.errors import InputError
from asemd.kernels import generate

MOST = 4            # processes, unless ASEMD_COMPILERS says how many
WORTH = 150         # lines to compile beside the longest module, below which helpers take longer to start than they save
IDLE = 30.0         # seconds after which a helper without work ends
SERVE = "from asemd.kernels.ahead import serve; serve()"

helpers: list[subprocess.Popen] = []
at_work = threading.Lock()
seen: set[str] = set()      # sources that were asked for


def processes() -> int:
    """How many compile at once: as many as there are processors, four at most; the environment variable ``ASEMD_COMPILERS`` says otherwise.

    One where Python is part of another program.

    Raises
    ------
    InputError
        It is not a whole number of 1 or more.
    """
    given = os.environ.get("ASEMD_COMPILERS", "")
    if given and not (given.isdecimal() and int(given)):
        raise InputError(f"the environment variable ASEMD_COMPILERS is a number of processes, 1 or more, not {given!r}")
    if not Path(sys.executable or "").name.startswith("python"):
        return 1
    if given:
        return int(given)
    return min(MOST, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


def together(texts: Iterable[str], functions: Sequence[tuple[Callable, tuple]] = ()) -> None:
    """Compile what is not in the cache yet, if several processes do so sooner.

    Parameters
    ----------
    texts : iterable of str
        Sources of modules whose functions have an address, which are compiled when the module is loaded.
    functions : sequence of (function, arguments)
        Functions of loaded modules, and what they will be called with.
    """
    most = processes()
    if most < 2:
        return
    jobs, new = {}, [text for text in texts if text not in seen]
    seen.update(new)
    for text in new:
        stem = generate.stem_of(text)
        if f"{generate.PACKAGE}.{stem}" not in sys.modules:
            try:
                generate.written(stem, text)
            except OSError:      # no room on the disk, by which the code would come
                return
            jobs[stem] = ""
    jobs |= {function.__module__.rpartition(".")[2]: " ".join((function.__name__, *map(_kind_of, arguments)))
             for function, arguments in functions if not function.overloads}
    if not jobs:
        return
    left = _not_compiled(generate.cache_dir())
    lines = {stem: left(stem) for stem in jobs}
    # what takes long first: functions with wrappers for Python, then long modules
    jobs = {stem: jobs[stem] for stem in sorted(jobs, key=lambda stem: (not jobs[stem], -lines[stem])) if lines[stem]}
    if sum(lines.values()) - max(lines.values(), default=0) >= WORTH:
        generate.tell()
        with at_work:
            _share(deque(f"{stem} {call}".strip() for stem, call in jobs.items()), min(most, len(jobs)) - 1)


def _kind_of(value) -> str:
    """The type of an argument, as one word."""
    import numba
    return base64.b64encode(pickle.dumps(numba.typeof(value))).decode()


def _not_compiled(folder: Path) -> Callable[[str], int]:
    """A function for the number of lines of a module, and of those that it imports, which are not in the cache."""
    have = {entry.partition(".")[0] for entry in os.listdir(folder / "__pycache__") if entry.endswith(".nbi")} \
        if (folder / "__pycache__").is_dir() else set()

    @cache
    def lines(stem: str) -> int:
        if stem in have:
            return 0
        text = (folder / f"{stem}.py").read_text()
        return text.count("\n") + sum(map(lines, set(re.findall(rf"^from {generate.PACKAGE}\.(\w+) import", text, re.M))))
    return lines


def _share(jobs: deque[str], others: int) -> None:
    """Do all jobs, here and in that many helpers."""
    helpers[:] = [h for h in helpers if h.poll() is None]
    with contextlib.suppress(OSError):      # there may be no more processes
        while len(helpers) < others:
            helpers.append(_start())
    with ThreadPoolExecutor(others) as pool:
        try:
            for helper in helpers[:others]:
                pool.submit(_feed, helper, jobs)
            while job := _next(jobs):
                do(job)
        except BaseException:
            jobs.clear()
            stop()
            raise


def _start() -> subprocess.Popen:
    """A helper that finds the same modules as this process, and is not meant by a Ctrl-C in the terminal."""
    env = {**os.environ, "ASEMD_CACHE_DIR": str(generate.cache_dir().parent), "ASEMD_COMPILERS": "1",
           "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen([sys.executable, "-c", SERVE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                            env=env, text=True, start_new_session=True, creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0))


def _next(jobs: deque[str]) -> str:
    """Take a job that no other thread takes; empty if there is none."""
    try:
        return jobs.popleft()
    except IndexError:
        return ""


def _feed(helper: subprocess.Popen, jobs: deque[str]) -> None:
    """Give one job after the other to a helper, as long as it answers."""
    while job := _next(jobs):
        try:
            helper.stdin.write(job + "\n")
            helper.stdin.flush()
        except (OSError, ValueError):
            return
        if not helper.stdout.readline():
            return


@atexit.register
def stop() -> None:
    """End all helpers."""
    while helpers:
        helper = helpers.pop()
        helper.kill()
        helper.wait()
        for pipe in (helper.stdin, helper.stdout):
            with contextlib.suppress(OSError):      # what it has not read
                pipe.close()


def do(job: str) -> None:
    """Load a module; of a function in it, compile it for its arguments."""
    stem, *call = job.split()
    module = generate.load((generate.cache_dir() / f"{stem}.py").read_text())
    if call:
        getattr(module, call[0]).compile(tuple(pickle.loads(base64.b64decode(word)) for word in call[1:]))


def serve() -> None:
    """What a helper does: jobs that it reads, one in a line, until there are no more."""
    out, sys.stdout = sys.stdout, sys.stderr
    while True:
        clock = threading.Timer(IDLE, os._exit, (0,))
        clock.daemon = True
        clock.start()
        line = sys.stdin.readline()
        clock.cancel()
        if not line:
            return
        try:
            do(line)
        except Exception as error:      # whoever needs the code meets it, too
            print(error, file=sys.stderr)
        print("done", file=out, flush=True)
