"""Files of dumps: names with the step in them, compression by the ending, how many are kept."""
from __future__ import annotations

import bz2
import gzip
import lzma
import os
from collections import deque
from typing import IO, Any

from asemd.errors import InputError

LIBRARY = {".zst": "zstandard", ".lz4": "lz4"}      # ending -> package that reads and writes it


def _frames(path: str, mode: str) -> Any:
    """A file compressed by a package that is not part of Python."""
    ending = os.path.splitext(path)[1]
    try:
        if ending == ".zst":
            import zstandard
            return zstandard.open(path, mode)
        import lz4.frame
        return lz4.frame.open(path, mode)
    except ImportError:
        raise InputError(f"{path}: files ending in {ending} need the package {LIBRARY[ending]}: pip install {LIBRARY[ending]}, "
                         "or choose .gz, .bz2 or .xz") from None


def _lzma(path: str, mode: str) -> Any:
    return lzma.open(path, mode, format=lzma.FORMAT_ALONE)


COMPRESSED = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open, ".lzma": _lzma, ".zst": _frames, ".lz4": _frames}


def is_compressed(path: str) -> bool:
    return os.path.splitext(path)[1] in COMPRESSED


def open_binary(path: str, append: bool = False) -> IO[bytes]:
    """A file to write bytes into, compressed by its ending: gz bz2 xz lzma zst lz4.

    Raises
    ------
    InputError
        The package for that ending is missing.
    OSError
        The file cannot be written.
    """
    mode = "ab" if append else "wb"
    opener = COMPRESSED.get(os.path.splitext(path)[1])
    return opener(path, mode) if opener else open(path, mode)


class Series:
    """The files of a dump, one or one for each snapshot.

    Parameters
    ----------
    path : str
        ``*`` becomes the step, ``%`` the number of the process, which is 0.
    """

    def __init__(self, path: str):
        self.path, self.pad, self.most = path, 0, 0
        self._written: deque[str] = deque()

    @property
    def is_many(self) -> bool:
        return "*" in self.path

    def name(self, step: int) -> str:
        """The file of a step."""
        return self.path.replace("*", str(step).zfill(self.pad)).replace("%", "0")

    def written(self, path: str) -> None:
        """Note a finished file; the oldest ones go when there are more than `most`."""
        if not self.most:
            return
        self._written.append(path)
        while len(self._written) > self.most:
            old = self._written.popleft()
            if old not in self._written and os.path.exists(old):
                os.remove(old)
