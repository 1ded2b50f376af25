"""Torsion angles, as local values.

Keywords: phi (degrees, -180 to 180, trans is 180), v_name with ``set phi variable`` (in radians there).

Source: LAMMPS manual, compute dihedral/local.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute._local import Geometry, Local


def phi(g: Geometry) -> np.ndarray:
    """Torsion angles about the bond of atoms 2 and 3, degrees."""
    f, k, h = g.between(0, 1), g.between(1, 2), g.between(3, 2)
    a, b = np.cross(f, k), np.cross(h, k)
    length = np.sqrt((k * k).sum(axis=1))
    sine = (np.cross(b, a) * k).sum(axis=1) / np.where(length > 0.0, length, 1.0)
    return np.degrees(np.arctan2(sine, (a * b).sum(axis=1)))


class DihedralLocal(Local):
    """Local values of dihedrals; arguments as in `asemd.compute._local.Local`."""

    style, kind, given = "dihedral/local", "dihedral", "phi"
    columns = {"phi": phi}

    def formula_value(self, value):
        return math.radians(value)
