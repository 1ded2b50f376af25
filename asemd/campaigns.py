"""A campaign: one function or script over many parameters, on any executor, each result a row of an ``ase.db`` database.

Only this process writes the database, a row when a run is over; what is there is not run again, so a campaign that was killed goes on.
"""
from __future__ import annotations

import contextlib
import hashlib
import itertools
import json
import os
import warnings
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future, as_completed
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from ase import Atoms
from ase.db import connect
from ase.db.core import check as check_pairs

from asemd.errors import InputError, nearest
from asemd.text_table import Table


@dataclass
class Campaign:
    """The runs that are over, in the order of their parameters: each a dict of `parameters`, `results` and `error` (text)."""

    database: Path
    rows: list[dict[str, Any]]

    @property
    def failed(self) -> list[dict[str, Any]]:
        """Runs that ended with an error; they are tried again the next time."""
        return [row for row in self.rows if row["error"]]

    def column(self, name: str) -> list[Any]:
        """A parameter or result of every run that did not fail."""
        rows = [row["parameters"] | row["results"] for row in self.rows if not row["error"]]
        if not any(name in row for row in rows):
            raise InputError(f"campaign: no parameter or result {name!r}{nearest(name, {k for row in rows for k in row})}")
        return [row.get(name) for row in rows]

    def table(self) -> Table:
        """A line for each run; lists and the like are in the database only."""
        lines = [{k: f"{v:.6g}" if isinstance(v, float) else str(v) for k, v in (row["parameters"] | row["results"]).items()
                  if isinstance(v, (int, float, str))} | ({"error": row["error"]} if row["error"] else {}) for row in self.rows]
        names = list(dict.fromkeys(k for line in lines for k in line))
        return Table(f"{self.database.name}: {len(lines)} runs", names, [[line.get(n, "") for n in names] for line in lines])

    def plot(self, x: str, y: str, path: str | os.PathLike) -> None:
        """Draw one column over another into a file of a format that matplotlib knows."""
        from matplotlib.figure import Figure
        figure = Figure(figsize=(5, 3.5), layout="constrained")
        axes = figure.subplots()
        axes.plot(self.column(x), self.column(y), "o")
        axes.set(xlabel=x, ylabel=y)
        figure.savefig(path)


def campaign(function: Callable[..., Any] | str | os.PathLike, parameters: Mapping[str, Iterable] | Iterable[Mapping[str, Any]],
             database: str | os.PathLike, executor: Any = None, tell: Callable[[int, int], None] | None = None) -> Campaign:
    """Run something for each of many parameters.

    Parameters
    ----------
    function : callable or path
        Called with the parameters as keywords; returns a dict of results, ``ase.Atoms``, or both (atoms, dict). For other processes it
        must be defined in a module. A path is a LAMMPS script: the parameters are its variables, the results its last thermo row.
    parameters : mapping or sequence of mappings
        Name -> values, of which every combination is run; or the parameters of each run. Numbers, text and lists of them.
    database : path
        SQLite file of ASE; made if it does not exist.
    executor : object, optional
        Has ``submit`` as in `concurrent.futures`: ``ProcessPoolExecutor``, Parsl's ``ParslPoolExecutor``. None: one after the other, here.
    tell : callable, optional
        Told after each run how many are done, and of how many.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        A script that cannot be read; parameters that are no mappings.
    """
    work, name = _work(function)
    given = list(parameters)
    if isinstance(parameters, Mapping):
        given = [dict(zip(parameters, values)) for values in itertools.product(*parameters.values())]
    if not all(isinstance(p, Mapping) for p in given):
        raise InputError("campaign: parameters are a mapping from names to values, or a sequence of mappings")
    todo = {hashlib.sha256(json.dumps([name, p], sort_keys=True, default=str).encode()).hexdigest()[:24] + "k": dict(p) for p in given}
    with connect(os.fspath(database), type="db") as db:
        done = {row.campaign for row in db.select(state="done", include_data=False)} & set(todo)
    waiting = [key for key in todo if key not in done]
    futures = {_submit(executor, work, todo[key]): key for key in waiting} if executor is not None else {}
    answers = ((key, _attempt(work, todo[key])) for key in waiting)
    if executor is not None:
        answers = ((futures[future], _outcome(future.result)) for future in as_completed(futures))
    try:
        for count, (key, answer) in enumerate(answers, len(done) + 1):
            _write(database, key, todo[key], *answer)
            if tell is not None:
                tell(count, len(todo))
    finally:
        for future in futures:
            with contextlib.suppress(NotImplementedError):      # Parsl's futures cannot be taken back
                future.cancel()
    with connect(os.fspath(database), type="db") as db:
        found = {row.campaign: row.data["campaign"] for row in db.select() if row.get("campaign") in todo}
    return Campaign(Path(database), [found[key] for key in todo if key in found])


def run_script(path: str, **variables: Any) -> tuple[Atoms, dict[str, Any]]:
    """The atoms at the end of a script, in ASE's units, and its last thermo row; no log is written."""
    from asemd.lammps import Lammps
    words = [str(w) for name, v in variables.items() for w in ("-var", name, *(v if isinstance(v, (list, tuple)) else [v]))]
    with Lammps(cmdargs=["-screen", "none", "-log", "none", *words]) as lmp:
        lmp.file(path)
        return lmp.scene.need_system("campaign").to_ase(), dict(lmp.last_thermo() or {})


def _work(function) -> tuple[Callable, str]:
    """What is called, and a name for it, which changes when a script does."""
    if callable(function):
        return function, f"{function.__module__}.{function.__qualname__}" if hasattr(function, "__qualname__") else repr(function)
    try:
        return partial(run_script, os.fspath(function)), hashlib.sha256(Path(function).read_bytes()).hexdigest()
    except OSError as e:
        raise InputError(f"campaign: cannot open {os.fspath(function)}: {e.strerror or e}") from None


def _submit(executor, work: Callable, parameters: dict[str, Any]) -> Future:
    """A pool whose process died takes no more: that is the error of the run."""
    try:
        return executor.submit(_attempt, work, parameters)
    except Exception as e:
        future: Future = Future()
        future.set_exception(e)
        return future


def _attempt(work: Callable, parameters: dict[str, Any]) -> tuple[Atoms, dict[str, Any], str]:
    """Atoms, results and error of one run, wherever it is."""
    def found():
        got = work(**parameters)
        atoms, results = got if isinstance(got, tuple) else (got, {}) if isinstance(got, Atoms) else (Atoms(), got)
        return atoms, dict(results or {}), ""
    return _outcome(found)


def _outcome(ask: Callable) -> tuple[Atoms, dict[str, Any], str]:
    try:
        return ask()
    except Exception as e:
        return Atoms(), {}, f"{type(e).__name__}: {' '.join(str(e).split())}"


def _write(database, key: str, parameters: dict[str, Any], atoms: Atoms, results: dict[str, Any], error: str) -> None:
    """One row: what ASE takes as keys can be searched for, everything is in the row's data."""
    pairs = {}
    for name, value in (parameters | results).items():
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")      # names that are chemical formulas cannot be searched for
                check_pairs({name: value})
            pairs[name] = value
        except (ValueError, UserWarning):
            continue
    data = dict(atoms.info) | {"campaign": {"parameters": parameters, "results": results, "error": error}}
    with connect(os.fspath(database), type="db") as db:
        db.delete([row.id for row in db.select(campaign=key)])
        db.write(atoms, key_value_pairs=pairs | {"campaign": key, "state": "failed" if error else "done"}, data=data)
