r"""$$E = E_{table}(\phi)$$

Energy and its negative derivative by the angle from a table file that repeats after 360 degrees, interpolated linearly or by cubic
splines. Source: LAMMPS manual, dihedral_style table.
"""
from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from asemd.bonded_table import INTERPOLATED, TableStyle, interpolate, periodic_spline, spline_slope
from asemd.style import dihedral
from asemd.tabulated import spline_value

TURN = 2.0 * math.pi


class DihedralTable(TableStyle):
    """Cyclic table. ``NOF``: no forces on file, they follow from the energy. ``CHECKU`` and ``CHECKF`` write the inner table."""

    smallest = 3

    def read(self, path, keyword, settings):
        known = {"NOF": 0, "DEGREES": 0, "RADIANS": 0}
        section = self.section(path, keyword, known, 3, ("CHECKU", "CHECKF"))
        forces, degrees = "NOF" not in section.parameters, "RADIANS" not in section.parameters
        if forces:
            section = self.section(path, keyword, known, 4, ("CHECKU", "CHECKF"))
        if len(section.columns) < 3 and settings["style"] == "spline":
            raise self.wrong(section, "splines need at least 3 angles, two can be interpolated linearly")
        x, e = section.columns[:, 1], section.columns[:, 2]
        f = section.columns[:, 3] if forces else None
        if x[-1] - x[0] >= (360.0 if degrees else TURN):
            raise self.wrong(section, "the range of angles must be less than 360 degrees")
        if degrees:
            x, f = np.radians(x), f * (180.0 / math.pi) if forces else None
        x = x - TURN * np.floor(x / TURN)
        order = np.argsort(x)
        x, e, f = x[order], e[order], f[order] if forces else None
        if forces:
            self.compare(section, x, e, f)
        out = {"units": section.units, "table": (x, e, f)}
        for word, column in (("CHECKU", 0), ("CHECKF", 1)):
            if word in section.parameters:
                name = section.parameters[word][0]
                nodes = self.inner(out["table"], settings)[3][:-1]
                angle, value = np.arange(len(nodes)) * (360.0 if degrees else TURN) / len(nodes), nodes[:, column]
                value = value * math.pi / 180.0 if degrees and column else value
                try:
                    Path(name).write_text("".join(f"{a:g} {v:g}\n" for a, v in zip(angle, value)))
                except OSError as error:
                    raise self.wrong(section, f"cannot write {word} file {name}: {error.strerror}") from None
        return out

    def compare(self, section, x, e, f) -> None:
        """Refuse forces that are not within a factor of 2 of the energy's slope at more than half of the angles; zeros are not judged."""
        before, after = np.roll(x, 1), np.roll(x, -1)
        before[0] -= TURN
        after[-1] += TURN
        slope = (np.roll(e, 1) - np.roll(e, -1)) / (after - before)
        judged = (f != 0.0) & (slope != 0.0)
        ratio = np.divide(f, slope, out=np.ones(len(x)), where=judged)
        if np.count_nonzero((ratio < 0.5) | (ratio > 2.0)) > len(x) // 2:
            raise self.wrong(section, "inconsistent forces and energies (the force is -dE/dphi; or use NOF)")

    def inner(self, table, settings):
        x, e, f = table
        n = settings["N"]
        delta = TURN / n
        at = np.arange(n) * delta
        # one node more at both ends closes the circle
        ring = np.concatenate([[x[-1] - TURN], x, [x[0] + TURN]])
        wide = np.concatenate([[-1], np.arange(len(x)), [0]])
        nodes = np.zeros((n + 1, 4))
        if settings["style"] == "spline":
            second = periodic_spline(x, e, TURN)
            nodes[:n, 0] = spline_value(ring, e[wide], second[wide], at)
            nodes[:n, 2] = periodic_spline(at, nodes[:n, 0], TURN)
            if f is None:
                whole = np.append(at, TURN)
                nodes[:n, 1] = -spline_slope(whole, np.append(nodes[:n, 0], nodes[0, 0]), np.append(nodes[:n, 2], nodes[0, 2]), at)
            else:
                nodes[:n, 1] = spline_value(ring, f[wide], periodic_spline(x, f, TURN)[wide], at)
            nodes[:n, 3] = periodic_spline(at, nodes[:n, 1], TURN)
        else:
            nodes[:n, 0] = np.interp(at, ring, e[wide])
            if f is None:
                nodes[:n, 1] = (np.roll(nodes[:n, 0], 1) - np.roll(nodes[:n, 0], -1)) / (2.0 * delta)
            else:
                nodes[:n, 1] = np.interp(at, ring, f[wide])
        nodes[n] = nodes[0]
        return 0.0, TURN, delta, nodes

    def mode(self, settings, values):
        return 0.0 if settings["style"] == "linear" else 1.0 if values["table"][2] is not None else 2.0


@dihedral("table", cls=DihedralTable, xfail=INTERPOLATED)
def table(phi, lo, hi, delta, first, rows, mode, nodes: "array"):
    if not -3.5 < phi < 3.5:
        return math.inf, math.inf
    return interpolate(phi if phi >= 0.0 else phi + hi, lo, delta, first, rows, mode, nodes)
