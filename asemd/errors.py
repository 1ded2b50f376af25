"""Errors that name the place in the user's file, and the nearest match for a misspelt word."""
from __future__ import annotations

import difflib
import re
import sys
from collections.abc import Iterable
from dataclasses import dataclass

LINE = 300       # characters of a line of the user's that a message repeats
# what helps where atoms are in one place: no force tells in which direction they should part
ONE_PLACE = "delete one of them (delete_atoms overlap) or move it (displace_atoms), minimize cannot part them"


def readable(text: str, longest: int) -> str:
    """Text for a terminal: control characters as Python writes them, cut when it is long."""
    text = text if len(text) <= longest else f"{text[:longest]}..."
    return "".join(c if c.isprintable() or c in "\n\t\u00a0" else repr(c)[1:-1] for c in text)


@dataclass(frozen=True)
class Where:
    """A place in a text file: path, line number (from 1) and the text of the line."""

    file: str
    line: int
    text: str = ""

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.file else f"line {self.line}"
        return f"{place}: {readable(self.text.strip(), LINE)}" if self.text.strip() else place


class AsemdError(Exception):
    """Base class of everything asemd raises on purpose."""


class InputError(AsemdError):
    """A mistake in the user's input; knows its place once a reader has added it.

    Parameters
    ----------
    message : str
        What is wrong and what to do, one line.
    where : Where, optional
        The place in the user's file.
    """

    def __init__(self, message: str, where: Where | None = None):
        super().__init__(message)
        self.message, self.where = message, where

    def __str__(self) -> str:
        # a word that goes on and on is no name
        message = re.sub(rf"\S{{{LINE},}}", lambda word: readable(word[0], LINE), self.message)
        return f"{message} ({self.where})" if self.where else message

    def at(self, where: Where) -> InputError:
        """The same error with a place; a place that is already there stays."""
        if self.where is None:
            self.where = where
        return self


class NotYet(InputError):
    """A quantity that is known once a run has begun."""


class Undefined(InputError):
    """A formula that has no value for the numbers it met, such as a division by 0."""


class InputWarning(UserWarning):
    """Something in the input that is probably not meant; the run goes on."""


class SimulationError(AsemdError):
    """The physics went wrong: an atom lost, a bond past its limit, NaN; the message names atom ids."""


class Halted(SimulationError):
    """A condition holds on which the user wants a run to fail; nothing went wrong with it."""


class LostAtoms(SimulationError):
    """Atoms that are beyond a fixed face of the box, where nothing interacts with them.

    Parameters
    ----------
    message : str
    rows : (m,) int array
        Their rows in the system.
    """

    def __init__(self, message: str, rows):
        super().__init__(message)
        self.rows = rows


def nearest(word: str, known: Iterable[str]) -> str:
    """` (did you mean X?)` for the closest known word, or an empty string."""
    match = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f" (did you mean {match[0]}?)" if match else ""


def in_one_line(kind: type[BaseException], error: BaseException, trace) -> None:
    """A ``sys.excepthook``: errors of asemd without the lines of code that led to them."""
    if issubclass(kind, AsemdError):
        print(f"ERROR: {error}", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)
