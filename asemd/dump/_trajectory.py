"""Binary trajectories of a fixed set of atoms in single precision: what DCD and XTC files have in common."""
from __future__ import annotations

import numpy as np

from asemd.dump import Dump, View, frame
from asemd.errors import InputError


class Trajectory(Dump):
    """Base class; a subclass opens, writes and closes the file of the library that knows the format."""

    wildcards = ""
    by_column = False       # there is no text: a format is taken and not used
    KEYWORDS = {**{k: n for k, n in Dump.KEYWORDS.items()
                   if k not in ("colname", "fileper", "header", "maxfiles", "nfile", "pad")}, "unwrap": 1}

    def __init__(self, group: str, every: int, path: str, *, variables=None, regions=None):
        super().__init__(group, every, path, ["id", "x", "y", "z"], variables=variables, regions=regions)
        self.unwrap = False
        self.atoms = -1

    def _check_path(self, path):
        super()._check_path(path)
        if path.endswith((".gz", ".bz2", ".xz", ".zst", ".lz4", ".lzma")):
            raise InputError(f"dump {self.style}: {path} cannot be compressed")

    def modify(self, words, session):
        super().modify(words, session)
        if self.sort != "id":
            self.sort = "id"
            raise InputError(f"dump_modify sort: dump {self.style} must be sorted by id")

    def _modify_append(self, values, what, session):
        raise InputError(f"{what} is not possible with dump style {self.style}: write to another file")

    def start(self, path: str, n: int, step: int, dt: float) -> None:
        """Open the file for n atoms."""
        raise NotImplementedError

    def frame(self, positions: np.ndarray, cell: np.ndarray, step: int, dt: float) -> None:
        """Write positions (n, 3) and cell (3, 3)."""
        raise NotImplementedError

    def write_view(self, snapshot, step: int, view: View) -> None:
        n = len(view.rows)
        if self._file is None:
            if self.atoms >= 0:
                raise InputError(f"dump {self.id}: {self.path} was closed and cannot be continued, define another dump")
            if not n:
                raise InputError(f"dump {self.id}: {self.style} files need atoms, group {self.group} has none")
            self.atoms = n
            try:
                with open(self.path, "wb"):
                    self.start(self.path, n, step, snapshot.dt)
            except OSError as e:
                raise self.cannot_write(self.path, e) from None
        if n != self.atoms:
            raise InputError(f"dump {self.id}: the number of atoms changed from {self.atoms} to {n}, {self.style} files cannot hold that")
        box, _ = frame(snapshot.system.box)
        try:
            self.frame(view.xu if self.unwrap else view.x, box.cell, step, snapshot.dt)
        except OSError as e:
            raise self.cannot_write(self.path, e) from None


def library():
    """MDAnalysis's readers and writers of trajectory formats.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        from MDAnalysis.lib.formats import libdcd, libmdaxdr
    except ImportError:
        raise InputError("dump styles dcd and xtc need MDAnalysis: pip install MDAnalysis") from None
    return libdcd, libmdaxdr
