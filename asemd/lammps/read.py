"""`asemd.read`: a LAMMPS script or data file as atoms with a calculator."""
from __future__ import annotations

import gzip
import os
import re
import warnings
from collections.abc import Mapping, Sequence

from asemd.errors import InputError, InputWarning, Where
from asemd.lammps.script import Command
from asemd.lammps.switches import Switches

HEAD = 200      # lines that show what a file is


def read(path: str | os.PathLike, units: str | None = None, atom_style: str | None = None,
         variables: Mapping[str, object] | None = None):
    """Atoms of a LAMMPS input script or data file.

    A script is executed up to, not including, the first run, minimize or rerun that is reached. It writes no log and no dump and runs
    no shell. A data file has a calculator only if a script says what the interactions are; alone it has none.

    Parameters
    ----------
    path : str
        Script or data file (also ``.gz``), told apart by what is in it. Relative paths in a script are relative to the working directory.
    units, atom_style : str, optional
        For a data file; by default what it says itself, else ``lj`` and what fits the number of columns.
    variables : mapping, optional
        For a script: variables of style index, as the switch ``-var`` sets them; a value, or a sequence of values. The script's own
        ``variable NAME index ...`` then gives way.

    Returns
    -------
    asemd.system.Atoms
        In order of id, in ASE's units (``units lj`` numbers pass unchanged).

    Raises
    ------
    InputError
        With the line of the script or data file.
    """
    from asemd.lammps.live_coefficients import freeze
    from asemd.lammps.session import Session, Stop
    path = os.fspath(path)
    lines = head(path)
    session = Session(switches=Switches(variables=[(name, _values(v)) for name, v in (variables or {}).items()]), passive=True)
    if is_data(lines):
        if variables:
            raise InputError(f"read: variables are for scripts, {path} is a data file")
        session.call("units", [units or hint(lines[:1], r"units = (\w+)") or "lj"])
        session.call("atom_style", [*atom_style.split()] if atom_style else [hint(lines, r"^\s*Atoms\s*#\s*(\w+)") or guess_style(lines)])
        session.execute(Command(f"read_data '{path}' nocoeff", Where("", 1, f"read_data {path}")))
        return session.scene.system.to_ase()
    if units or atom_style:
        raise InputError(f"read: units and atom_style are for data files, {path} is a script and says them itself")
    try:
        session.file(path)
    except Stop:
        session.label = None
    if session.scene.system is None:
        raise InputError(f"read: {path} defines no atoms before its first run")
    for name in freeze(session):
        warnings.warn(f"variable {name} of the force field may change during a run: the calculator has its present value", InputWarning,
                      stacklevel=2)
    return session.scene.to_atoms()


def _values(given: object) -> list[str]:
    """The words of a variable."""
    several = isinstance(given, Sequence) and not isinstance(given, str)
    return [str(v) for v in given] if several else [str(given)]


def head(path: str) -> list[str]:
    """The first lines of a file."""
    try:
        with (gzip.open if path.endswith(".gz") else open)(path, "rt", encoding="utf-8", errors="replace") as f:
            return [line for line, _ in zip(f, range(HEAD))]
    except OSError as e:
        raise InputError(f"cannot open {path}: {e.strerror or e}") from None


def is_data(lines: list[str]) -> bool:
    """A data file has counts and box bounds where a script has commands."""
    body = [line.partition("#")[0] for line in lines[1:]]
    counted = any(re.fullmatch(r"\s*\d+\s+atoms\s*", line) for line in body)
    return counted and any(re.search(r"\bxlo\s+xhi\b|\bavec\b", line) for line in body)


def refuse_data(path: str) -> None:
    """Tell whoever takes a data file for a script; other files pass.

    Raises
    ------
    InputError
        It is one.
    """
    if os.path.isfile(path) and is_data(head(path)):
        raise InputError(f"{path} is a data file, not a script: a script reads it by read_data")


def guess_style(lines: list[str]) -> str:
    """The atom style that fits the first line of ``Atoms``; image flags are the last three of 8 or more columns."""
    body = [line.partition("#")[0].split() for line in lines]
    start = next((i for i, words in enumerate(body) if words == ["Atoms"]), len(body))
    first = next((words for words in body[start + 1:] if words), [])
    columns = len(first) - 3 * (len(first) >= 8)
    bonded = any(len(w) == 2 and w[1] in ("bonds", "angles", "dihedrals", "impropers") and w[0] != "0" for w in body)
    return {6: "molecular" if bonded else "charge", 7: "full"}.get(columns, "atomic")


def hint(lines: list[str], pattern: str) -> str | None:
    """The first match of a pattern in some lines."""
    for line in lines:
        match = re.search(pattern, line)
        if match:
            return match[1]
    return None
