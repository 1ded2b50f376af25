"""The lines of a text file of any size, without an object for each."""
from __future__ import annotations

import gzip
import os
import warnings
import zlib
from collections.abc import Iterator, Sequence

import numpy as np

from asemd.errors import InputError, InputWarning, nearest
from asemd.lammps import lex

BLOCK = 1 << 15     # lines that become objects together
INDENT = 80         # how far a heading may be indented


class Lines(Sequence):
    """The lines of a text, made when they are asked for.

    Parameters
    ----------
    raw : bytes
        UTF-8; lines end with a newline.
    """

    def __init__(self, raw: bytes):
        self.raw = raw
        ends = np.flatnonzero(np.frombuffer(raw, np.uint8) == 10)
        self.ends = np.append(ends, len(raw))       # of each line, without the newline

    def __len__(self) -> int:
        return len(self.ends)

    def _start(self, index: int) -> int:
        return int(self.ends[index - 1]) + 1 if index else 0

    def __getitem__(self, index):
        if isinstance(index, slice):
            first, last, step = index.indices(len(self))
            return [line for block in self.blocks(first, last) for line in block][::step]
        if index < 0:
            index += len(self)
        if not 0 <= index < len(self):
            raise IndexError(index)
        return self.raw[self._start(index):int(self.ends[index])].decode("utf-8", "replace")

    def blocks(self, first: int, last: int) -> Iterator[list[str]]:
        """Lines first to last - 1, many at a time."""
        for k in range(first, last, BLOCK):
            stop = min(k + BLOCK, last)
            yield self.raw[self._start(k):int(self.ends[stop - 1])].decode("utf-8", "replace").split("\n")

    def beginning_with_letters(self, first: int) -> np.ndarray:
        """Indices, from `first` on, of the lines whose first character that is not blank is a letter."""
        text = np.frombuffer(self.raw, np.uint8)
        rows = np.arange(first, len(self))
        at, end = np.append(0, self.ends[:-1] + 1)[first:], self.ends[first:]
        found = []
        for _ in range(INDENT):
            inside = at < end
            rows, at, end = rows[inside], at[inside], end[inside]
            if not len(rows):
                break
            c = text[at]
            found.append(rows[((c >= 65) & (c <= 90)) | ((c >= 97) & (c <= 122)) | (c >= 128)])
            blank = (c == 32) | (c == 9)
            rows, at, end = rows[blank], at[blank] + 1, end[blank]
        return np.sort(np.concatenate(found)) if found else np.zeros(0, int)


def similar_file(path: str) -> str:
    """` (did you mean X?)` for a file of nearly that name in the folder, or an empty string."""
    folder, name = os.path.split(path)
    try:
        return nearest(name, os.listdir(folder or "."))
    except OSError:
        return ""


def read_lines(path: str | os.PathLike) -> Lines:
    """The lines of a file (``.gz``: compressed).

    Raises
    ------
    InputError
        No such file, not readable, not text, empty.
    """
    path = os.fspath(path)
    try:
        with (gzip.open if path.endswith(".gz") else open)(path, "rb") as f:
            raw = f.read()
    except FileNotFoundError:
        raise InputError(f"read_data: file {path} not found{similar_file(path)}") from None
    except (EOFError, zlib.error, gzip.BadGzipFile) as e:
        raise InputError(f"read_data: {path} is not a complete gzip file: {e}") from None
    except OSError as e:
        raise InputError(f"read_data: cannot read {path}: {e.strerror or e}") from None
    if b"\0" in raw:
        raise InputError(f"read_data: {path} is not a text file")
    raw = raw.removeprefix(b"\xef\xbb\xbf")        # byte order mark
    if b"\r" in raw:
        raw = raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if not raw or raw.isspace():
        raise InputError(f"read_data: {path} is empty")
    if not raw.isascii():
        plain = lex.plain(raw.decode("utf-8", "surrogateescape")).encode("utf-8", "surrogateescape")
        if plain != raw:
            warnings.warn(f"read_data: signs of {path} that are not ASCII (dashes, blanks) were read as their ASCII equivalents",
                          InputWarning, stacklevel=4)
        raw = plain
    return Lines(raw)
