r"""Walls of the integrated Lennard-Jones potential of lattice planes.

.. math:: E = 2 \pi \epsilon \left[ \tfrac25
          (\sigma / r)^{10} - (\sigma / r)^4 - \frac{\sqrt2 \sigma^3}{3 (r + 0.61 \sigma / \sqrt2)^3} \right]

for atoms at a distance :math:`r < r_c` in front of the wall, less the value at the cutoff.

Source: LAMMPS manual, fix wall/lj1043. Arguments: face, position, epsilon, sigma, cutoff for each wall, all but the cutoff
numbers or variables; ``units box`` or ``lattice``; ``pbc yes`` for periodic directions.
Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

from asemd.fix.wall import LJ1043, Wall


class WallLJ1043(Wall):
    """Lennard-Jones walls of a stack of lattice planes.

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
    >>> WallLJ1043(walls={"zlo": (0.0, 1.0, 1.0, 2.5)}).size
    1
    """

    style = "wall/lj1043"
    kind = LJ1043
