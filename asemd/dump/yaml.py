"""``dump ID group yaml N file columns...``: each snapshot a YAML document."""
from __future__ import annotations

import re

from asemd.dump import bounds_of, frame
from asemd.dump.custom import Custom


class YAML(Custom):
    """The columns of ``dump custom``; ``dump_modify thermo yes`` adds the thermo row of the step, where there is one.

    Source: LAMMPS manual, dump yaml. Any YAML library reads it: ``yaml.safe_load_all(file)``.
    """

    style = "yaml"
    binary = False
    KEYWORDS = {**Custom.KEYWORDS, "thermo": 1}
    thermo = False

    def head(self, snapshot, step, n):
        box, _ = frame(snapshot.system.box)
        text = f"---\ncreator: LAMMPS\ntimestep: {step}\n"
        if self.unit:
            text += f"units: {snapshot.system.units}\n"
        if self.time:
            text += f"time: {_shortest(step * snapshot.dt)}\n"
        text += f"natoms: {n}\nboundary: [ {''.join(f'{c}, ' for pair in box.boundary for c in pair)}]\n"
        row = self.variables.provider.thermo_row(step) if self.thermo and self.variables else {}
        if row:
            text += f"thermo:\n  - keywords: [ {''.join(_quoted(k) + ', ' for k in row)}]\n"
            text += f"  - data: [ {''.join(_shortest(v) + ', ' for v in row.values())}]\n"
        bounds = bounds_of(box)
        text += "box:\n" + "".join(f"  - [ {_shortest(lo)}, {_shortest(hi)} ]\n" for lo, hi in bounds[:, :2])
        if box.triclinic:
            text += f"  - [ {', '.join(map(_shortest, box.tilt))} ]\n"
        return text + f"keywords: [ {''.join(_quoted(c) + ', ' for c in self.column_names())} ]\ndata:\n"

    def format(self) -> str:
        return f"  - [ {' , '.join(self.column_formats())}, ]\n"

    def foot(self):
        return "...\n"


def _quoted(name: str) -> str:
    """A name as YAML takes it inside of a list."""
    return name if re.fullmatch(r"\w+", name) else f"'{name}'"


def _shortest(value: float) -> str:
    """All digits that matter; whole numbers without a point."""
    return str(int(value)) if value == int(value) and abs(value) < 1e16 else repr(float(value))
