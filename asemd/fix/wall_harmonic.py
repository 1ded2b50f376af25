r"""Soft walls: repulsive springs that end at the cutoff.

.. math:: E = \epsilon (r - r_c)^2

for atoms at a distance :math:`r < r_c` in front of the wall, less the value at the cutoff.

Source: LAMMPS manual, fix wall/harmonic. Arguments: face, position, epsilon, sigma, cutoff for each wall, all but the cutoff
numbers or variables; ``units box`` or ``lattice``; ``pbc yes`` for periodic directions.
Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

from asemd.fix.wall import HARMONIC, Wall


class WallHarmonic(Wall):
    """Soft walls; sigma has no meaning here.

    Parameters
    ----------
    group : str
        The atoms that feel the walls.
    walls : mapping of str to sequence
        Face ``xlo`` to ``zhi`` -> position, epsilon, sigma, cutoff, in units of the scene.
    pbc : bool
        Walls may stand in periodic directions.

    Examples
    --------
    >>> WallHarmonic(walls={"zlo": (0.0, 1.0, 1.0, 2.5)}).size
    1
    """

    style = "wall/harmonic"
    kind = HARMONIC
