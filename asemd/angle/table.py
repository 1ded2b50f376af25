r"""$$E = E_{table}(\theta)$$

Energy and its negative derivative by the angle from a table file, which goes from 0 to 180 degrees, interpolated linearly or by cubic
splines. Source: LAMMPS manual, angle_style table.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.bonded_table import INTERPOLATED, TableStyle, interpolate
from asemd.style import angle


class AngleTable(TableStyle):
    """Table in degrees on file, in radians inside."""

    def finish(self, section, x, e, f, ends, rest):
        if abs(x[0]) > 1e-6 or abs(x[-1] - 180.0) > 1e-6:
            raise self.wrong(section, f"the angles must range from 0 to 180 degrees, not from {x[0]:g} to {x[-1]:g}")
        x = np.radians(x)
        x[0], x[-1] = 0.0, math.pi
        degree = 180.0 / math.pi
        return {"table": (x, e, f * degree, *(v * degree * degree for v in ends)), "theta0": 180.0 if rest is None else rest}


@angle("table", cls=AngleTable, equilibrium="theta0", xfail=INTERPOLATED, domain="the table ends there (outside table range)")
def table(theta, lo, hi, delta, first, rows, mode, nodes: "array"):
    if not lo <= theta <= hi:
        return math.inf, math.inf
    return interpolate(theta, lo, delta, first, rows, mode, nodes)
