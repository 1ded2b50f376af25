"""``angle_write atype N file keyword``: an angle potential as a section of a table file, from 0 to 180 degrees.

Styles that take lengths besides see bonds of length 1. Forces are derivatives by the angle, exact ones (LAMMPS takes differences).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.lammps.table_write import CORNER, chain, run_bonded


def points(style, n, args):
    """N angles; atom 3 goes round atom 2."""
    degrees, places, paths = [], [], []
    for i in range(n):
        degrees.append(i * (180.0 / (n - 1)) if i < n - 1 else 180.0)
        half = math.radians(0.5 * degrees[-1])
        theta = 2.0 * half
        cosine, sine = math.cos(theta), math.sin(theta) if i < n - 1 else 0.0
        named = {"theta": (theta, 1.0), "r12": (1.0, 0.0), "r32": (1.0, 0.0), "r13": (2.0 * math.sin(half), math.cos(half))}
        place, path = chain(style, np.vstack([CORNER, [cosine, sine, 0.0]]), np.array([-sine, cosine, 0.0]), named)
        places.append(place)
        paths.append(path)
    return degrees, places, paths


def run(session, args):
    run_bonded(session, args, "angle", 4, points)
