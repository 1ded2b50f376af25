"""The battery: stiff and extreme cases with known answers, ``asemd check --battery``. One case, one file; each registers itself.

A case is a function of `start`, which gives a new session: of asemd, and for the figure beside it of LAMMPS. It returns its figures by
name; each is an error, so smaller is better, and what it may be at most follows from theory, which the file's docstring states::

    @case("Morse dissociation", Figure("speed far away", 1e-5, "what it means"))
    def morse(start): ...
        return {"speed far away": abs(found / known - 1.0)}

Figures may be infinite, or nan where there is none; both fail. A figure may be left out for a session in which a command is missing.
"""
from __future__ import annotations

import importlib
import json
import math
import pkgutil
import sys
import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asemd.check.battery.result import Line, Result
from asemd.errors import AsemdError, InputError, InputWarning, nearest

RECORDED = Path(__file__).with_name("lammps.json")


@dataclass(frozen=True)
class Figure:
    """One error that a case measures.

    Parameters
    ----------
    name : str
        A few words, with the unit if it has one.
    limit : float
        What it may be at most.
    meaning : str
        For users: what it says, one or two sentences.
    """

    name: str
    limit: float
    meaning: str


@dataclass(frozen=True)
class Case:
    """A named function of `start` with its figures."""

    name: str
    measure: Callable[[Callable[[], Any]], dict[str, float]]
    figures: tuple[Figure, ...]


CASES: dict[str, Case] = {}      # by name


def case(name: str, *figures: Figure):
    """Register a case under a name in plain words."""
    def decorate(function: Callable[[Callable[[], Any]], dict[str, float]]):
        CASES[name] = Case(name, function, figures)
        return function
    return decorate


def all_cases() -> dict[str, Case]:
    """Every case by name; imports their files."""
    for module in sorted(m.name for m in pkgutil.iter_modules(__path__)):
        importlib.import_module(f"{__name__}.{module}")
    return dict(sorted(CASES.items()))


def chosen(names: Iterable[str] | None) -> list[Case]:
    """The cases of these names, or whose names contain these words; all of them for None.

    Raises
    ------
    InputError
        A word that no name contains.
    """
    cases = all_cases()
    if names is None:
        return list(cases.values())
    for name in names:
        if not any(name.lower() in c.lower() for c in cases):
            raise InputError(f"check: the battery has no case {name!r}{nearest(name, list(cases))}; there are: {', '.join(cases)}")
    return [c for key, c in cases.items() if any(n.lower() in key.lower() for n in names)]


def run(names: Iterable[str] | None = None, *, lammps: bool | None = None,
        progress: Callable[[str, int, int], None] | None = None) -> Result:
    """Run the battery.

    Parameters
    ----------
    names : iterable of str, optional
        Words of the names of the cases wanted; by default all.
    lammps : bool, optional
        Measure LAMMPS's figures too; by default if LAMMPS starts here. Otherwise the recorded ones stand beside asemd's.
    progress : callable, optional
        Called with the name of the next case, how many are done and how many there are; by default a bar on a terminal.

    Returns
    -------
    Result
        ``print`` shows it.

    Raises
    ------
    InputError
        A name that does not exist.
    """
    from asemd.lammps import Lammps
    cases, sessions = chosen(names), []

    def start():
        sessions.append(Lammps(cmdargs=["-screen", "none", "-log", "none"]))
        return sessions[-1]

    began, lines = time.perf_counter(), []
    with _Bar() if progress is None else _Calls(progress) as tell:
        for k, one in enumerate(cases):
            tell(one.name, k, len(cases) + 1)
            at = time.process_time()
            found = measured(one, start)
            while sessions:
                sessions.pop().close()
            spent = time.process_time() - at
            lines += [Line(one.name, f.name, f.limit, _number(found, f.name), f.meaning, _why(found), seconds=spent) for f in one.figures]
        tell("the same with LAMMPS", len(cases), len(cases) + 1)
        version, theirs, live = beside([c.name for c in cases], lammps)
    for line in lines:
        of_case = theirs.get(line.case, {})
        line.lammps, line.lammps_why = _number(of_case, line.figure), _why(of_case)
    return Result(lines, version, live, time.perf_counter() - began)


def measured(one: Case, start: Callable[[], Any]) -> dict[str, float | str]:
    """The figures of a case; what ended it under ``error``."""
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore", InputWarning)       # of runs that are meant to come apart
            return {name: float(value) for name, value in one.measure(start).items()}
    except Exception as e:      # of asemd or of LAMMPS: whatever it is, the case has failed and the others go on
        return {"error": (str(e) or type(e).__name__).splitlines()[0]}


def _number(found: dict[str, float | str], name: str) -> float | None:
    value = found.get(name)
    return None if value is None else float(value)


def _why(found: dict[str, float | str]) -> str:
    return str(found.get("error", ""))


# ---------------------------------------------------------------------------------------------------------------------- LAMMPS ---

def beside(names: list[str], live: bool | None = None) -> tuple[str, dict[str, dict[str, float]], bool]:
    """LAMMPS's version and figures, and whether they were measured now: they are recorded ones where it does not start."""
    from asemd.testing import oracle
    if live or (live is None and oracle.lammps_available()):
        try:
            version, figures = from_lammps(names)
            return version, figures, True
        except AsemdError:
            if live:
                raise
    recorded = json.loads(RECORDED.read_text(encoding="utf-8"))
    return recorded["version"], {c: {k: _back(v) for k, v in f.items()} for c, f in recorded["figures"].items()}, False


def from_lammps(names: list[str]) -> tuple[str, dict[str, dict[str, float]]]:
    """LAMMPS's version and its figures of these cases, in a process of its own; a case that takes the process down has none.

    Raises
    ------
    OracleError
        LAMMPS does not start.
    """
    from asemd.testing.oracle import ask
    root, figures, left = str(Path(__file__).resolve().parents[3]), {}, list(names)
    while True:
        found = ask("sys.path.insert(0, given['root'])\nfrom asemd.check import battery\n"
                    "for answer in battery.answers(given['names'], start):\n    write(folder, 'answer', answer)", root=root, names=left)
        figures |= found["figures"]
        left = [name for name in left if name not in figures]
        if not left:
            return str(found["version"]), figures
        figures[left.pop(0)] = {"error": "LAMMPS crashed"}


def answers(names: list[str], start) -> Iterable[dict[str, Any]]:
    """What the process with LAMMPS tells, after each case: its version, and the figures of the cases of these very names so far."""
    sessions = [start()]
    found: dict[str, Any] = {"version": sessions[0].version(), "figures": {}}
    cases = all_cases()

    def opened():
        while sessions:
            sessions.pop().close()
        sessions.append(start())
        return sessions[-1]
    yield found
    for name in names:
        found["figures"][name] = measured(cases[name], opened)
        yield found


def record(path: Path = RECORDED) -> None:
    """Write the figures of the LAMMPS that is installed, for machines that have none."""
    version, figures = from_lammps(list(all_cases()))
    text = {c: {k: _plain(v) for k, v in f.items()} for c, f in figures.items()}
    path.write_text(json.dumps({"version": version, "figures": text}, indent=1) + "\n", encoding="utf-8")


def _plain(value):
    if isinstance(value, str):
        return value
    return float(f"{value:.3g}") if math.isfinite(value) else str(value)


def _back(value):
    return float(value) if value in ("inf", "-inf", "nan") else value


# -------------------------------------------------------------------------------------------------------------------- progress ---

class _Calls:
    def __init__(self, function):
        self.function = function

    def __enter__(self):
        return self.function

    def __exit__(self, *error):
        self.function = None


class _Bar:
    """A bar with the name of the case and the time left, on a terminal only."""

    def __enter__(self):
        self.bar = None
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
            self.bar = Progress(MofNCompleteColumn(), BarColumn(), TimeRemainingColumn(), TextColumn("{task.description}"),
                                console=Console(stderr=True), transient=True)
            self.task = self.bar.add_task("", total=None)
            self.bar.start()
        return self.tell

    def tell(self, name: str, done: int, total: int) -> None:
        if self.bar is not None:
            self.bar.update(self.task, description=name, completed=done, total=total)

    def __exit__(self, *error):
        if self.bar is not None:
            self.bar.stop()


# ------------------------------------------------------------------------------------------------------------- for the cases ---

def vectors(session, name: str) -> np.ndarray:
    """(n, 3) positions, velocities or forces in order of id."""
    return np.array(session.gather_atoms(name, 1, 3), float).reshape(-1, 3)


def steps(session, count: int, name: str = "x") -> np.ndarray:
    """(count, n, 3) positions, velocities or forces after each of the next steps."""
    out = []
    for _ in range(count):
        session.command("run 1 pre no post no")
        out.append(vectors(session, name))
    return np.array(out)


def survives(session, command: str) -> bool:
    """Whether a command ends without an error and with finite positions."""
    try:
        session.command(command)
    except Exception:       # LAMMPS raises its own class
        return False
    return bool(np.isfinite(vectors(session, "x")).all())


def onset(stable: Callable[[float], bool], low: float, high: float, tolerance: float) -> float:
    """Where runs stop being stable, by bisection between a stable and an unstable value; nan if they are not."""
    if not stable(low) or stable(high):
        return math.nan
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return 0.5 * (low + high)


__all__ = ["Case", "Figure", "Line", "Result", "all_cases", "answers", "case", "from_lammps", "onset", "record", "run", "steps", "survives",
           "vectors"]
