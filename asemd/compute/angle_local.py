"""Angles and their energies, as local values.

Keywords: theta (degrees), eng, v_name with ``set theta variable`` (in radians there). Turned off angles have energy 0.

Source: LAMMPS manual, compute angle/local.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute._local import Geometry, Local


def theta(g: Geometry) -> np.ndarray:
    """Angles at atom 2, degrees."""
    a, b = g.between(0, 1), g.between(2, 1)
    sine = np.sqrt((np.cross(a, b) ** 2).sum(axis=1))
    return np.degrees(np.arctan2(sine, (a * b).sum(axis=1)))


class AngleLocal(Local):
    """Local values of angles; arguments as in `asemd.compute._local.Local`."""

    style, kind, given = "angle/local", "angle", "theta"
    columns = {"theta": theta, "eng": Geometry.energy}

    def formula_value(self, value):
        return math.radians(value)
