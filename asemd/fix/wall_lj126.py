r"""Walls with the Lennard-Jones potential of one particle.

.. math:: E = 4 \epsilon \left[ (\sigma / r)^{12} - (\sigma / r)^6 \right]

for atoms at a distance :math:`r < r_c` in front of the wall, less the value at the cutoff.

Source: LAMMPS manual, fix wall/lj126. Arguments: face, position, epsilon, sigma, cutoff for each wall, all but the cutoff
numbers or variables; ``units box`` or ``lattice``; ``pbc yes`` for periodic directions.
Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

from asemd.fix.wall import LJ126, Wall


class WallLJ126(Wall):
    """Lennard-Jones walls.

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
    >>> WallLJ126(walls={"zlo": (0.0, 1.0, 1.0, 2.5)}).size
    1
    """

    style = "wall/lj126"
    kind = LJ126
