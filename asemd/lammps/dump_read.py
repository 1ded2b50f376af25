"""Snapshots of dump files: LAMMPS's own text format, and xyz."""
from __future__ import annotations

import bz2
import gzip
import lzma
import os
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from asemd.errors import InputError, Where
from asemd.words import number, whole

FORMATS = ("native", "xyz")
OPENERS = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}


@dataclass
class Frame:
    """One snapshot.

    Attributes
    ----------
    step : int
        Of xyz files the number of the snapshot, from 0.
    bounds : (3, 2 or 3) array or None
        As in the file: lower and upper bounds, of a tilted box those around it, and tilt factors.
    boundary : tuple of three str, or ()
    columns : list of str
    rows : list of list of str
    where : Where
        The place of its first line.
    units : str
        What the file says of its unit style; empty if nothing.
    """

    step: int
    bounds: np.ndarray | None
    boundary: tuple[str, ...]
    columns: list[str]
    rows: list[list[str]]
    where: Where
    units: str = ""

    def corners(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Lower and upper corner (3,) of the box without its tilt, and its tilt factors (3,): xy, xz, yz."""
        lo, hi, tilt = self.bounds[:, 0].copy(), self.bounds[:, 1].copy(), np.zeros(3)
        if self.bounds.shape[1] == 3:
            tilt = xy, xz, yz = self.bounds[:, 2]
            lo[0], hi[0] = lo[0] - min(0.0, xy, xz, xy + xz), hi[0] - max(0.0, xy, xz, xy + xz)
            lo[1], hi[1] = lo[1] - min(0.0, yz), hi[1] - max(0.0, yz)
        return lo, hi, tilt

    def column(self, name: str) -> np.ndarray:
        """The values of a column.

        Raises
        ------
        InputError
            A value that is not a number.
        """
        k = self.columns.index(name)
        try:
            return np.array([row[k] for row in self.rows], float)
        except ValueError:
            bad = next(row[k] for row in self.rows if not _is_number(row[k]))
            raise InputError(f"dump file: column {name} of step {self.step} holds {bad!r}, not a number").at(self.where) from None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def frames(path: str, form: str) -> Iterator[Frame]:
    """The snapshots of a file one after the other.

    Raises
    ------
    InputError
        The file cannot be read, or ends within a snapshot.
    """
    if path.endswith(".bin"):
        raise InputError(f"dump file {path}: binary dumps cannot be read, write a text dump")
    try:
        with OPENERS.get(os.path.splitext(path)[1], open)(path, "rt", encoding="utf-8", errors="replace") as file:
            lines = _Lines(path, file)
            reader = _native if form == "native" else _xyz
            k = 0
            while (frame := reader(lines, k)) is not None:
                yield frame
                k += 1
    except (OSError, EOFError) as e:
        raise InputError(f"cannot open dump file {path}: {getattr(e, 'strerror', None) or e}") from None


class _Lines:
    """Lines of a file with their numbers."""

    def __init__(self, path: str, file):
        self.path, self.file, self.line, self.text = path, iter(file), 0, ""

    def next(self) -> str | None:
        self.line += 1
        self.text = next(self.file, None)
        return self.text

    @property
    def where(self) -> Where:
        return Where(self.path, self.line, (self.text or "").strip())

    def must(self, what: str) -> str:
        text = self.next()
        if text is None:
            raise InputError(f"dump file {self.path} ends before {what}")
        return text

    def item(self, title: str) -> list[str]:
        """The words behind ``ITEM: title``."""
        text = self.must(f"ITEM: {title}")
        if not text.startswith(f"ITEM: {title}"):
            raise InputError(f"dump file: expected ITEM: {title}, the file is not a dump in native format").at(self.where)
        return text[6 + len(title):].split()

    def rows(self, n: int, width: int) -> list[list[str]]:
        out = []
        for _ in range(n):
            words = self.must("the last atom").split()
            if len(words) < width:
                raise InputError(f"dump file: a line of atoms has {len(words)} words, {width} are needed").at(self.where)
            out.append(words)
        return out


def _native(lines: _Lines, k: int) -> Frame | None:
    text, units = lines.next(), ""
    while text is not None and text.startswith(("ITEM: UNITS", "ITEM: TIME\n")):
        value = lines.must("the value").strip()
        units = value if text.startswith("ITEM: UNITS") else units
        text = lines.next()
    if text is None or not text.strip():
        return None
    if not text.startswith("ITEM: TIMESTEP"):
        raise InputError("dump file: expected ITEM: TIMESTEP, the file is not a dump in native format").at(lines.where)
    where = lines.where
    step = _whole(lines, "the step")
    lines.item("NUMBER OF ATOMS")
    n = _whole(lines, "the number of atoms")
    words = lines.item("BOX BOUNDS")
    if words[:1] == ["abc"]:
        raise InputError("dump file: general triclinic boxes (BOX BOUNDS abc origin) cannot be read").at(lines.where)
    tilted = words[:3] == ["xy", "xz", "yz"]
    bounds = []
    for _ in range(3):
        values = lines.must("the bounds of the box").split()
        if len(values) < 2 + tilted:
            raise InputError("dump file: a line of box bounds is too short").at(lines.where)
        bounds.append([number(v, "dump file: box bounds") for v in values[:2 + tilted]])
    columns = lines.item("ATOMS")
    return Frame(step, np.array(bounds), tuple(words[3:] if tilted else words), columns, lines.rows(n, len(columns)), where, units)


def _whole(lines: _Lines, what: str) -> int:
    word = lines.must(what).strip()
    try:
        return whole(word, f"dump file: {what}")
    except InputError as e:
        raise e.at(lines.where) from None


def _xyz(lines: _Lines, k: int) -> Frame | None:
    text = lines.next()
    if text is None or not text.strip():
        return None
    where = lines.where
    try:
        n = whole(text.strip(), "dump file: the number of atoms")
    except InputError as e:
        raise e.at(where) from None
    lines.must("the comment line")
    rows = [[str(i), *words[:4]] for i, words in enumerate(lines.rows(n, 4), 1)]
    return Frame(k, None, (), ["id", "type", "x", "y", "z"], rows, where)
