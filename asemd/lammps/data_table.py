"""A block of numbers in a text file as arrays: in bulk, or line by line where that fails."""
from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain

import numpy as np

from asemd.errors import InputError, nearest
from asemd.lammps.data_lines import BLOCK, Lines

WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE | re.ASCII)


def parse_table(lines: Lines, first: int, last: int, columns: Sequence[str], kinds: Mapping[str, str], optional: Sequence[str],
                labels: Mapping[int, str], done: Callable[[int], None] | None = None) -> tuple[dict[str, np.ndarray], Callable[[int], int]]:
    """The columns of ``lines[first:last]``; blank lines and comments (``#``) do not count.

    Parameters
    ----------
    columns, optional : sequence of str
        Names of the columns; the optional ones follow on all lines or none.
    kinds : mapping
        Column -> ``real``, or ``type`` (a number or a label), or any other word for whole numbers.
    labels : mapping
        Type -> label.
    done : callable, optional
        Told from time to time how many lines are read.

    Returns
    -------
    dict of str to array
    callable
        Row -> index into `lines`.

    Raises
    ------
    InputError
        With the index of the faulty line in the attribute ``line``.
    """
    @cache
    def content() -> list[int]:
        return [i for i in range(first, last) if lines[i].split("#", 1)[0].strip()]

    start = next((i for i in range(first, last) if lines[i].split("#", 1)[0].strip()), None)
    if start is None:
        return {c: np.zeros(0, float if kinds[c] == "real" else np.int64) for c in columns}, lambda row: content()[row]
    if len(lines[start].split("#", 1)[0].split()) == len(columns) + len(optional):
        columns, optional = (*columns, *optional), ()
    dtype = np.dtype([(c, "f8" if kinds[c] == "real" else "i8") for c in columns])
    numbers = _Numbers({label: t for t, label in labels.items()})
    named = {k: numbers.__getitem__ for k, c in enumerate(columns) if labels and kinds[c] == "type"}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")       # numpy would read 1.0 as a whole number
            table = np.loadtxt(chain.from_iterable(_each(lines, start, last, done)), dtype=dtype, comments="#", ndmin=1, converters=named,
                               encoding="utf-8")
        values = {c: np.ascontiguousarray(table[c]) for c in columns}
    except (ValueError, KeyError, DeprecationWarning, OverflowError):
        values = _slowly(lines, content(), columns, kinds, optional, labels)
    return values, lambda row: content()[row]


class _Numbers(dict):
    """The number of a type by its label; a word that is no label is the number itself."""

    def __missing__(self, word: str) -> int:
        if not WHOLE.fullmatch(word):
            raise KeyError(word)
        return int(word)


def _each(lines, first: int, last: int, done) -> Iterator[list[str]]:
    """Many lines at a time."""
    for k, block in enumerate(lines.blocks(first, last)):
        yield block
        if done is not None:
            done(min(last, first + (k + 1) * BLOCK))


def _slowly(lines, rows, columns, kinds, optional, labels) -> dict[str, np.ndarray]:
    number = {label: t for t, label in labels.items()}
    out = np.empty(len(rows), dtype=[(c, "f8" if kinds[c] == "real" else "i8") for c in columns])
    for k, i in enumerate(rows):
        try:
            words = lines[i].split("#", 1)[0].split()
            if len(words) != len(columns):
                form = " ".join(columns) + (f" [{' '.join(optional)}]" if optional else "")
                raise InputError(f"line has {len(words)} values, expected {len(columns)}: {form}")
            out[k] = tuple(_value(w, c, kinds[c], number) for w, c in zip(words, columns))
        except InputError as e:
            e.line = i
            raise
        except OverflowError:
            error = InputError("a number is too large")
            error.line = i
            raise error from None
    return {c: np.ascontiguousarray(out[c]) for c in columns}


def _value(word: str, column: str, kind: str, labels: Mapping[str, int]) -> float | int:
    if kind == "real":
        if not REAL.fullmatch(word):
            raise InputError(f"{column} must be a number, got {word!r}")
        return float(word)
    if kind == "type" and word in labels:
        return labels[word]
    if not WHOLE.fullmatch(word):
        what = "type number or label" if kind == "type" and labels else "whole number"
        raise InputError(f"{column} must be a {what}, got {word!r}{nearest(word, labels) if kind == 'type' else ''}")
    return int(word)
