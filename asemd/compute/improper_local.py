"""Improper angles, as local values.

Keyword: chi, the angle between the planes of atoms 1 2 3 and 2 3 4 in degrees, whatever the improper style; 90 with three atoms on a line.

Source: LAMMPS manual, compute improper/local.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._local import Geometry, Local
from asemd.compute.dihedral_local import phi


def chi(g: Geometry) -> np.ndarray:
    """Angles between the planes, degrees."""
    along = g.between(1, 2)
    planes = [np.cross(g.between(0, 1), along), np.cross(g.between(3, 2), along)]
    line = np.logical_or(*(~plane.any(axis=1) for plane in planes))
    return np.where(line, 90.0, np.abs(phi(g)))


class ImproperLocal(Local):
    """Local values of impropers; arguments as in `asemd.compute._local.Local`."""

    style, kind, given = "improper/local", "improper", "chi"
    columns = {"chi": chi}

    def __init__(self, group: str = "all", keywords=(), interactions=None, variables=None, setting: str = ""):
        for word in keywords:      # no formulas here
            if word not in self.columns:
                raise self.unknown(word)
        super().__init__(group, keywords, interactions, variables, setting)
