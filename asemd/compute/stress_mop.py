r"""Pressure across one plane by the method of planes: forces of items that it cuts, momenta of atoms that go through.

Each keyword gives three numbers, the components of the momentum that passes a unit of area in unit time: ``kin`` carried by atoms, ``pair``
``bond`` ``angle`` ``dihedral`` by forces, ``conf`` by all of these forces, ``total`` by both. Long-range electrostatics, impropers and
fixes are not among them. A plane outside a periodic box means its image inside.

$$P_{bd} = \frac{1}{A} \Big[ \sum_{items} \sum_{i \text{ above}} F_{ib} + \frac{1}{\Delta t} \sum_{crossing} \pm m_i v_{ib} \Big]$$

Source: B. D. Todd, D. J. Evans, P. J. Daivis, Phys. Rev. E 52, 1627 (1995); LAMMPS manual, compute stress/mop. Units: pressure.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute._planes import Planes
from asemd.words import take


class StressMop(Planes):
    """Pressure across one plane; arguments as in `asemd.compute._planes.Planes`."""

    style = "stress/mop"

    @property
    def size(self) -> int:
        """Elements of the vector."""
        return 3 * len(self.terms)

    @classmethod
    def from_lammps(cls, group, words, session):
        axis, origin = take(words, 3, "compute stress/mop direction position keyword")[:2]
        out = cls(group, axis, cls.read_origin(origin), words[2:])
        box = session.scene.need_system("compute stress/mop").box
        if not box.triclinic:
            out.places = out.planes(box)
            if out.places[0] != out.at(box):
                session.warn(f"compute stress/mop: the plane lies outside of the simulation box; its image at {out.places[0]:g} is used")
        return out

    def to_lammps(self) -> list[str]:
        return ["xyz"[self.axis], self.origin if isinstance(self.origin, str) else repr(self.origin), *self.terms]

    def planes(self, box) -> np.ndarray:
        place, low, length = self.at(box), float(box.lo[self.axis]), float(box.lengths[self.axis])
        if box.periodic[self.axis] and not low <= place <= low + length:
            place -= math.floor((place - low) / length) * length
        return np.array([place])

    def vector(self, state) -> np.ndarray:
        """Three numbers for each keyword, pressure units."""
        return self.stresses(state)[0]
