r"""Walls with a Morse potential.

.. math:: E = D_0 \left[ e^{-2 \alpha (r - r_0)} - 2 e^{-\alpha (r - r_0)} \right]

for atoms at a distance :math:`r < r_c` in front of the wall, less the value at the cutoff.

Source: LAMMPS manual, fix wall/morse. Arguments: face, position, D0, alpha, r0, cutoff for each wall, all but the cutoff
numbers or variables; ``units box`` or ``lattice``; ``pbc yes`` for periodic directions.
Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

from asemd.fix.wall import MORSE, Wall


class WallMorse(Wall):
    """Morse walls.

    Parameters
    ----------
    group : str
        The atoms that feel the walls.
    walls : mapping of str to sequence
        Face ``xlo`` to ``zhi`` -> position, D0, alpha, r0, cutoff, in units of the scene.
    pbc : bool
        Walls may stand in periodic directions.

    Examples
    --------
    >>> WallMorse(walls={"zlo": (0.0, 1.0, 1.0, 1.0, 2.5)}).size
    1
    """

    style = "wall/morse"
    kind = MORSE
    names = ("D0", "alpha", "r0")
