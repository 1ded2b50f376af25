r"""Harmonic bond angles of atoms without bonds: $E=K(\theta_{jik}-\theta_0)^2$ for all pairs j, k of neighbours of i within the cutoffs.

An entry of the file is i j k with K, theta0 (degrees) and a cutoff; that of the distance i-j is the cutoff of the entry i j j.
"""
from __future__ import annotations

import math

from asemd.kernels.manybody import add_bend, directions
from asemd.style import radians, register
from asemd.triples import TripleStyle


def fade(r, p):
    """A factor of the energy by distance, and minus the derivative of its logarithm."""
    return 1.0, 0.0


def angles(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    three = arrays[0]
    energy = 0.0
    directions(n, near, room)
    for k in range(n):
        p = three[ti, types[k], types[k]]
        r = math.sqrt(near[3, k])
        room[3, k] = room[3, k] if r < p[0] else 0.0
        room[4, k], room[5, k] = fade(r, p)
    for j in range(n - 1):
        if room[3, j] == 0.0:
            continue
        for k in range(j + 1, n):
            p = three[ti, types[j], types[k]]
            if room[3, k] == 0.0 or p[1] == 0.0:
                continue
            c = min(max(room[0, j] * room[0, k] + room[1, j] * room[1, k] + room[2, j] * room[2, k], -1.0), 1.0)
            d = math.acos(c) - p[2]
            w = p[1] * room[4, j] * room[4, k]
            e = w * d * d
            energy += e
            slope = -2.0 * w * d / max(math.sqrt((1.0 - c) * (1.0 + c)), 0.001)
            add_bend(j, k, c, e, slope, -e * room[5, j], -e * room[5, k], room, grad, shares)
    return energy


class Angles(TripleStyle):
    names = "K theta0 cutoff"
    columns = ("cutoff", "K", "angle")
    energies = ("K",)
    positive = "K theta0 cutoff"

    def row(self, p, units):
        return {"angle": radians(p["theta0"])}


register(Angles("nb3b/harmonic", site=angles, helpers=(fade,), rooms=6, example="MOH.nb3b.harmonic O",
                see="LAMMPS manual, pair_style nb3b/harmonic"))
