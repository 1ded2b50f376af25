"""``dump ID group cfg N file mass type xs ys zs columns...``: files of AtomEye, one for each snapshot.

Source: AtomEye's extended CFG format; LAMMPS manual, dump cfg. ASE (``ase.io.cfg``) and OVITO read them.
"""
from __future__ import annotations

import numpy as np

from asemd.dump import frame
from asemd.dump._columns import column_of
from asemd.dump.custom import Custom
from asemd.errors import InputError

EXPANSION = 10.0    # the cell is so much larger with unwrapped positions
STARTS = (["mass", "type", "xs", "ys", "zs"], ["mass", "type", "xsu", "ysu", "zsu"])


class CFG(Custom):
    """Mass, element and scaled position of each atom, and further columns as auxiliary properties; elements by ``dump_modify element``."""

    style = "cfg"
    binary = False
    one_each = True
    KEYWORDS = {k: n for k, n in Custom.KEYWORDS.items() if k not in ("colname", "header")}

    def __init__(self, group: str, every: int, path: str, columns: list[str], *, variables=None, regions=None):
        if columns[:5] not in STARTS:
            raise InputError("dump cfg: the columns must begin with mass type xs ys zs or mass type xsu ysu zsu")
        super().__init__(group, every, path, columns, variables=variables, regions=regions)

    def fits(self, column, conversion, kind):
        return column < 2 or super().fits(column, conversion, kind)     # mass and element have their own lines and formats

    def head(self, snapshot, step, n):
        box, _ = frame(snapshot.system.box)
        size = EXPANSION if self.columns[2] == "xsu" else 1.0
        text = f"Number of particles = {n}\nA = {size:g} Angstrom (basic length-scale)\n"
        text += "".join(f"H0({i + 1},{j + 1}) = {box.cell[i, j]:g} A\n" for i in range(3) for j in range(3))
        text += f".NO_VELOCITY.\nentry_count = {len(self.columns) - 2}\n"
        names = [name.replace("[", "_").replace("]", "") for name in self.columns[5:]]
        return text + "".join(f"auxiliary[{k}] = {name}\n" for k, name in enumerate(names))

    def lines(self, view):
        columns = [column_of(view, c) for c in self.columns]
        if self.columns[2] == "xsu":
            columns[2:5] = [(c - 0.5) / EXPANSION + 0.5 for c in columns[2:5]]
        form = "%f \n%s \n" + " ".join(self.column_formats()[2:]) + "\n"
        columns[1] = view.element()
        return "".join([form % row for row in zip(*(c.tolist() if isinstance(c, np.ndarray) else c for c in columns))])
