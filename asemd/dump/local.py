"""``dump ID group local N file index c_ID c_ID[n] ...``: values of bonds, angles, pairs ... that computes give."""
from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from asemd.dump import Dump
from asemd.errors import InputError

SOURCE = re.compile(r"([cf])_(\w+)(?:\[(\d+)\])?")
RANGE = re.compile(r"([cf])_(\w+)\[(\d*)\*(\d*)\]")


@dataclass
class Entries:
    """The lines of a snapshot: their numbers, and the values of each column."""

    rows: np.ndarray
    columns: list[np.ndarray]


class Local(Dump):
    """The columns are ``index`` (the number of the line) and local values of computes; the group has no effect.

    Lines come in the order of the computes unless ``dump_modify sort N`` names a column; ``dump_modify label`` is the word in the header.
    """

    style = "local"
    label = "ENTRIES"
    KEYWORDS = {**Dump.KEYWORDS, "label": 1}

    def __init__(self, group: str, every: int, path: str, columns: list[str], *, variables=None, regions=None):
        columns = [name for word in columns for name in self._expanded(word, variables)]
        super().__init__(group, every, path, columns, variables=variables, regions=regions)
        if all(c == "index" for c in columns):
            raise InputError("dump local needs at least one column of a compute, for example: index c_1[1] c_1[2]")
        self.sort = "off"

    @classmethod
    def chosen(cls, words):
        return (list(words),)

    @staticmethod
    def _expanded(word: str, variables) -> list[str]:
        """``c_ID[*]`` as all columns of the compute."""
        found = RANGE.fullmatch(word)
        if not found or variables is None:
            return [word]
        kind, id, first, last = found.groups()
        width = variables.provider.local_columns(kind, id)
        return [f"{kind}_{id}[{k}]" for k in range(int(first or 1), int(last or width) + 1)]

    def kind(self, name):
        return "integer" if name == "index" else "float"

    def _check(self, name):
        found = SOURCE.fullmatch(name)
        if name == "index":
            return
        if not found:
            raise InputError(f"dump local: column {name!r} must be index or local values such as c_ID or c_ID[1]")
        if self.variables is None:
            raise InputError(f"dump local: column {name} needs a session")
        kind, id, column = found.groups()
        width, what = self.variables.provider.local_columns(kind, id), "compute" if kind == "c" else "fix"
        if column is None and width:
            raise InputError(f"dump local: {what} {id} gives {width} columns, say which one: {kind}_{id}[1]")
        if column is not None and not 1 <= int(column) <= width:
            raise InputError(f"dump local: {name}: {what} {id} gives {width or 'no'} columns")

    def view(self, snapshot) -> Entries:
        provider = self.variables.provider
        values: dict[str, np.ndarray] = {}
        for name in self.columns:
            if name != "index":
                kind, id, column = SOURCE.fullmatch(name).groups()
                values[name] = provider.local(kind, id, int(column) if column else None)
        lengths = {name: len(v) for name, v in values.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"dump {self.id}: columns of different lengths cannot stand side by side: "
                             + ", ".join(f"{n} {name}" for name, n in lengths.items()))
        rows = np.arange(next(iter(lengths.values())))
        columns = [rows + 1 if name == "index" else values[name] for name in self.columns]
        if self.sort != "off":
            key = columns[abs(int(self.sort)) - 1]
            order = np.argsort(key if int(self.sort) > 0 else -key, kind="stable")
            rows, columns = rows[order], [c[order] for c in columns]
        return Entries(rows, columns)

    def format(self) -> str:
        return super().format()[:-1] + " \n"

    def lines(self, view) -> str:
        form = self.format()
        return "".join([form % row for row in zip(*(c.tolist() for c in view.columns))])

    def _modify_label(self, values, what, session):
        self.label = values[0]

    def _modify_sort(self, values, what, session):
        if values[0] == "id":
            raise InputError(f"{what}: lines of dump local have no atom ID, give the number of a column")
        super()._modify_sort(values, what, session)


__all__ = ["Entries", "Local"]
