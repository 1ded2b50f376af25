"""``dump ID group xyz N file``: the XYZ format."""
from __future__ import annotations

from asemd.dump import Dump
from asemd.dump._columns import column_of
from asemd.dump._modify import conversions
from asemd.errors import InputError


class XYZ(Dump):
    """Number of atoms, a comment line with the step, then type (or element, or label) and x y z."""

    style = "xyz"
    wildcards = "*"
    by_column = False
    KEYWORDS = {**{k: n for k, n in Dump.KEYWORDS.items() if k != "colname"}, "element": 0, "types": 1}

    def __init__(self, group: str, every: int, path: str, *, variables=None, regions=None):
        super().__init__(group, every, path, ["typelabel", "x", "y", "z"], variables=variables, regions=regions)
        self.numeric = True

    def symbols(self, view) -> list[str]:
        """What stands in the first column."""
        return view.element() if self.element else [str(t) for t in column_of(view, "type")] if self.numeric else view.labels()

    def lines(self, view):
        form = self.format()
        columns = [self.symbols(view), *(column_of(view, c).tolist() for c in self.columns[1:])]
        return "".join([form % row for row in zip(*columns[:conversions(form)])])

    def head(self, snapshot, step, n):
        time = f" Time: {step * snapshot.dt:f}" if self.time else ""
        return f"{n}\n Atoms. Timestep: {step}{time}\n"

    def _modify_types(self, values, what, session):
        super()._modify_types(values, what, session)
        if values[0] == "labels" and not session.scene.system.labels.get("atom"):
            raise InputError(f"{what} labels: atom types have no labels, use the labelmap command")
        self.columns[0], self.numeric = "typelabel", values[0] == "numeric"
