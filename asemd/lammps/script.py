"""A script as a list of commands, and the check of all of it before anything runs."""
from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from asemd.errors import InputError, Where
from asemd.lammps import catalog, lex
from asemd.lammps.data_lines import similar_file

# command -> category of style, position of the style's name
STYLED = {**{f"{c}_style": (c, 1) for c in catalog.FORCE_FIELD}, "kspace_style": ("kspace", 1), "fix": ("fix", 3),
          "compute": ("compute", 3), "region": ("region", 2), "dump": ("dump", 3), "min_style": ("minimize", 1), "atom_style": ("atom", 1)}
REGION_ACTIONS = ("delete",)


@dataclass(frozen=True)
class Command:
    """One command of a script, before its variables are replaced.

    Attributes
    ----------
    text : str
        The whole line, continuation lines joined.
    where : Where
    """

    text: str
    where: Where

    @property
    def name(self) -> str:
        words = self.words
        return words[0] if words else ""

    @property
    def words(self) -> list[str]:
        """The words as written, without comment; raises `InputError` for unmatched quotes."""
        return lex.split(lex.strip_comment(lex.plain(self.text)))


class Problems(InputError):
    """Several mistakes found in one script; each is in `problems` and has its place."""

    def __init__(self, problems: list[InputError]):
        super().__init__(f"{len(problems)} problems, nothing was run: " + "; ".join(str(p) for p in problems))
        self.problems = problems


def read(path: str | os.PathLike) -> list[Command]:
    """The commands of a script file, or of standard input for ``-``; blank lines are included.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    try:
        if path == "-":
            text = sys.stdin.read()
        else:
            with open(path, encoding="utf-8-sig", errors="replace") as f:      # a byte order mark is no word
                text = f.read()
    except (OSError, ValueError) as e:
        similar = similar_file(os.fspath(path)) if isinstance(e, FileNotFoundError) else ""
        raise InputError(f"cannot open input script {os.fspath(path)}: {getattr(e, 'strerror', None) or e}{similar}") from None
    if "\0" in text:
        raise InputError(f"input script {os.fspath(path)} is not a plain text file (UTF-16, or no text at all): save it as UTF-8")
    return parse(text, os.fspath(path))


def parse(text: str, file: str = "") -> list[Command]:
    """The commands of a text."""
    return [Command(line.text, line.where) for line in lex.logical_lines(text, file)]


def check(commands: list[Command]) -> tuple[list[InputError], list[InputError]]:
    """Look for command and style names that do not exist.

    Returns
    -------
    errors, warnings : list of InputError
        Warnings are problems in lines that a ``jump`` may skip.
    """
    names = []
    for command in commands:
        try:
            names.append(command.name)
        except InputError:
            names.append("")
    jumps = [i for i, n in enumerate(names) if n == "jump"]
    marks = [i for i, n in enumerate(names) if n in ("jump", "label")]
    loop = range(marks[0], marks[-1] + 1) if jumps else range(0)
    errors: list[InputError] = []
    warnings: list[InputError] = []
    for i, command in enumerate(commands):
        problem = _problem(command)
        if problem:
            (warnings if i in loop else errors).append(problem.at(command.where))
        if names[i] == "quit" and i not in loop:
            break
    return errors, warnings


def labels(commands: Iterable[Command]) -> list[str]:
    """The labels that a ``jump`` may go to."""
    lines = (lex.strip_comment(command.text).split() for command in commands)
    return [words[1] for words in lines if len(words) == 2 and words[0] == "label"]


def before(commands: Iterable[Command], names: Sequence[str]) -> Iterator[Command]:
    """The commands before the first one with one of these names."""
    for command in commands:
        try:
            if command.name in names:
                return
        except InputError:
            pass        # found again, with its place, by `check`
        yield command


def _problem(command: Command) -> InputError | None:
    try:
        words = command.words
    except InputError as e:
        return e
    if not words or "$" in words[0]:
        return None
    if not catalog.exists("command", words[0]):
        return catalog.unknown("command", words[0])
    if words[0] in STYLED:
        category, position = STYLED[words[0]]
        if len(words) > position and "$" not in words[position]:
            name = words[position]
            if not (category == "region" and name in REGION_ACTIONS) and not catalog.exists(category, name):
                return catalog.unknown(category, name)
    return None


def raise_problems(problems: list[InputError]) -> None:
    """Raise the one problem, or all of them together."""
    if len(problems) == 1:
        raise problems[0]
    if problems:
        raise Problems(problems)
