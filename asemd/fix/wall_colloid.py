r"""Walls that attract colloidal spheres: Lennard-Jones 12/6 integrated over the sphere and the half space behind the wall.

.. math:: E = \epsilon \left[ \frac{\sigma^6}{7560} \left( \frac{6 R - D}{D^7} + \frac{D + 8 R}{(D + 2 R)^7} \right)
          - \frac{1}{6} \left( \frac{2 R (D + R)}{D (D + 2 R)} + \ln \frac{D}{D + 2 R} \right) \right]

with the radius R of the sphere and the gap :math:`D = r - R` to the wall, for centres at a distance :math:`r < r_c`, less the value at the
cutoff. Atoms need a radius (atom style sphere) that is not zero, and stay farther from the wall than it.

Source: R. Everaers, M. R. Ejtehadi, Phys. Rev. E 67, 041710 (2003); LAMMPS manual, fix wall/colloid. Arguments: face, position, epsilon,
sigma, cutoff for each wall, all but the cutoff numbers or variables; ``units box`` or ``lattice``; ``pbc yes`` for periodic directions.
Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.wall import COLLOID, Wall, forces_with


def colloid_energy(r, p, at, radius):
    """Energy and slope of a sphere at a distance r."""
    far = r + radius
    near = r - radius
    s2 = p[at + 7] * p[at + 7]
    repulsion = p[at + 6] * s2 * s2 * s2 / 7560.0
    attraction = p[at + 6] / 6.0
    near3, far3 = near * near * near, far * far * far
    near7, far7 = near3 * near3 * near, far3 * far3 * far
    a, b = 7.0 * radius - r, 7.0 * radius + r
    e = (repulsion * (a / near7 + b / far7) - attraction * (2.0 * radius * r / (near * far) + math.log(near / far)))
    gap = near * far
    slope = (repulsion * ((-1.0 - 7.0 * a / near) / near7 + (1.0 - 7.0 * b / far) / far7)
             - attraction * (2.0 * radius / gap - 4.0 * radius * r * r / (gap * gap) + 2.0 * radius / gap))
    return e, slope


CHANGES = (("energy += e - shift", "energy += e - colloid_energy(cut, p, at, a[0][s.row[i]])[0]"),
           ("if r > 0.0:", "if r > a[0][s.row[i]]:"))


class WallColloid(Wall):
    """Walls for colloidal spheres.

    Parameters
    ----------
    group : str
        The atoms that feel the walls; all have a radius.
    walls : mapping of str to sequence
        Face ``xlo`` to ``zhi`` -> position, epsilon (energy), sigma, cutoff (of the distance of the centre), in units of the scene.
    pbc : bool
        Walls may stand in periodic directions.

    Raises
    ------
    InputError
        Also for atoms without a radius.

    Examples
    --------
    >>> WallColloid(walls={"zlo": (0.0, 1.0, 1.0, 5.0)}).size
    1
    """

    style = "wall/colloid"
    kind = COLLOID

    def energy_at(self, cutoff, block) -> float:
        return 0.0      # depends on the radius: the hook takes it off

    def uses_atoms(self) -> bool:
        return False

    def atom_arrays(self, loop) -> tuple:
        radius = loop.system.extra.get("radius")
        if radius is None:
            raise InputError(f"fix wall/colloid requires atom attribute radius: use atom_style sphere, not {loop.system.atom_style}")
        if not (radius[loop.groups[self.group]] > 0.0).all():
            raise InputError("fix wall/colloid requires extended particles: all atoms of its group need a diameter above 0")
        return (radius,)

    @hook(uses=[colloid_energy, forces_with("colloid_forces", "colloid_energy(r, p, at, a[0][s.row[i]])", CHANGES)])
    def post_force(th, s, p, a):
        colloid_forces(th, s, p, a)  # noqa: F821
