"""``dump ID group custom N file columns...``"""
from __future__ import annotations

from asemd.dump import Dump
from asemd.errors import InputError


class Custom(Dump):
    """The columns are chosen by the user; see `asemd.dump._columns.COLUMNS`."""

    style = "custom"
    KEYWORDS = {k: n for k, n in Dump.KEYWORDS.items() if k != "types"}

    @classmethod
    def chosen(cls, words):
        if not words:
            raise InputError("dump custom needs at least one column, for example: id type x y z")
        return (list(words),)

    def _modify_format(self, values, what, session):
        super()._modify_format(values, what, session)
        self.line = " ".join(self.line.split())
