r"""$$E = E_{table}(r)$$

Energy and force from a table file, interpolated linearly or by cubic splines. Source: LAMMPS manual, bond_style table.
"""
from __future__ import annotations

import math

from asemd.bonded_table import INTERPOLATED, TableStyle, interpolate
from asemd.style import bond


@bond("table", cls=TableStyle, equilibrium="r0", xfail=INTERPOLATED, domain="the table ends there (outside table range)")
def table(r, lo: "distance", hi: "distance", delta: "distance", first, rows, mode, nodes: "array"):
    if not lo <= r <= hi:
        return math.inf, math.inf
    return interpolate(r, lo, delta, first, rows, mode, nodes)
