"""Dumps whose style says that they are compressed, ``atom/gz`` and its relatives: the same text through gzip."""
from __future__ import annotations

import gzip

from asemd.errors import InputError
from asemd.words import whole


class Compressed:
    """Comes before the class of the plain style; ``dump_modify compression_level`` is 0 (none) to 9, or -1 for the default of zlib.

    Source: LAMMPS manual, dump atom/gz.
    """

    binary = False
    level = 9

    def _check_path(self, path):
        super()._check_path(path)
        if not path.endswith(".gz"):
            raise InputError(f"dump {self.style} writes compressed files: the name {path} must end in .gz")

    def open(self, path):
        return gzip.open(path, "ab" if self.append else "wb", self.level)

    def _modify_compression_level(self, values, what, session):
        level = whole(values[0], what)
        if not -1 <= level <= 9:
            raise InputError(f"{what}: expected 0 to 9, or -1, got {level}")
        self.level = level
