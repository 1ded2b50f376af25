"""``dump ID group atom N file``: id, type and scaled positions."""
from __future__ import annotations

from asemd.dump import Dump
from asemd.words import yes_no


class Atom(Dump):
    """Columns ``id type xs ys zs``; ``dump_modify scale no`` writes x y z, ``image yes`` adds ix iy iz."""

    style = "atom"
    binary = True
    by_column = False
    KEYWORDS = {**Dump.KEYWORDS, "image": 1, "scale": 1, "triclinic/general": 1, "types": 1}

    def __init__(self, group: str, every: int, path: str, *, variables=None, regions=None):
        self.scale = True
        super().__init__(group, every, path, ["id", "type", "xs", "ys", "zs"], variables=variables, regions=regions)

    def _arrange(self) -> None:
        middle = ["xs", "ys", "zs"] if self.scale else ["x", "y", "z"]
        self.columns = [*self.columns[:2], *middle, *(["ix", "iy", "iz"] if self.image else [])]

    def _modify_flag(self, values, what, key):
        if key in ("scale", "image"):
            setattr(self, key, yes_no(values[0], what))
            self._arrange()
        else:
            super()._modify_flag(values, what, key)
