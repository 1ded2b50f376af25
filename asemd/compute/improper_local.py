"""Improper angles, as local values.

Keyword: chi, the angle between the planes of atoms 1 2 3 and 2 3 4 in degrees, whatever the improper style.

Source: LAMMPS manual, compute improper/local.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._local import Local
from asemd.compute.dihedral_local import phi


class ImproperLocal(Local):
    """Local values of impropers; arguments as in `asemd.compute._local.Local`."""

    style, kind, given = "improper/local", "improper", "chi"
    columns = {"chi": lambda g: np.abs(phi(g))}

    def __init__(self, group: str = "all", keywords=(), interactions=None, variables=None, setting: str = ""):
        for word in keywords:      # no formulas here
            if word not in self.columns:
                raise self.unknown(word)
        super().__init__(group, keywords, interactions, variables, setting)
