"""``dump ID group custom N file columns...``"""
from __future__ import annotations

import re

from asemd.dump import Dump
from asemd.dump._modify import SELECT
from asemd.errors import InputError

RANGE = re.compile(r"(c_|f_|i2_|d2_)(\w+)\[(\d*)\*(\d*)\]")


class Custom(Dump):
    """The columns are chosen by the user; see `asemd.dump._columns.COLUMNS`. ``c_ID[*]`` stands for all columns of a compute."""

    style = "custom"
    binary = True
    KEYWORDS = {**Dump.KEYWORDS, **SELECT}

    def __init__(self, group: str, every: int, path: str, columns: list[str], *, variables=None, regions=None):
        columns = [name for word in columns for name in self._expanded(word, variables)]
        super().__init__(group, every, path, columns, variables=variables, regions=regions)

    @classmethod
    def chosen(cls, words):
        if not words:
            raise InputError(f"dump {cls.style} needs at least one column, for example: id type x y z")
        return (list(words),)

    @staticmethod
    def _expanded(word: str, variables) -> list[str]:
        found = RANGE.fullmatch(word)
        if not found or variables is None:
            return [word]
        kind, id, first, last = found.groups()
        width = variables.provider.per_atom_columns(kind[:-1], id)
        return [f"{kind}{id}[{k}]" for k in range(int(first or 1), int(last or width) + 1)]
