"""``dihedral_write dtype N file keyword``: a dihedral potential as a section of a table file, N angles from 0 degrees round the circle.

Styles that take lengths and angles besides see right angles, bonds 1-2 and 3-4 of length 1 and 2-3 of length 2. Forces are derivatives by
phi, exact ones (LAMMPS takes differences).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.lammps.table_write import BENT, chain, run_bonded


def points(style, n, args):
    """N torsion angles; atom 4 goes round the axis 2-3."""
    degrees, places, paths = [], [], []
    for i in range(n):
        degrees.append(i * (360.0 / n))
        phi = math.radians(degrees[-1] if degrees[-1] <= 180.0 else degrees[-1] - 360.0)
        named = {"phi": (phi, 1.0), "r12": (1.0, 0.0), "r23": (2.0, 0.0), "r34": (1.0, 0.0), "theta1": (0.5 * math.pi, 0.0),
                 "theta2": (0.5 * math.pi, 0.0)}
        cosine, sine = math.cos(phi), math.sin(phi)
        place, path = chain(style, np.vstack([BENT, [cosine, sine, 1.0]]), np.array([-sine, cosine, 0.0]), named)
        places.append(place)
        paths.append(path)
    return degrees, places, paths


def run(session, args):
    run_bonded(session, args, "dihedral", 4, points)
