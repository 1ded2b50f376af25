r"""Walls of the integrated Lennard-Jones potential of a half space.

.. math:: E = \epsilon \left[ \tfrac{2}{15} (\sigma / r)^9 - (\sigma / r)^3 \right]

for atoms at a distance :math:`r < r_c` in front of the wall, less the value at the cutoff.

Source: LAMMPS manual, fix wall/lj93. Arguments: face, position, epsilon, sigma, cutoff for each wall, all but the cutoff
numbers or variables; ``units box`` or ``lattice``; ``pbc yes`` for periodic directions.
Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

from asemd.fix.wall import LJ93, Wall


class WallLJ93(Wall):
    """Lennard-Jones walls of a half space.

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
    >>> WallLJ93(walls={"zlo": (0.0, 1.0, 1.0, 2.5)}).size
    1
    """

    style = "wall/lj93"
    kind = LJ93
