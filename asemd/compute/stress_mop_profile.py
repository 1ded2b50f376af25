r"""Profile of the pressure across parallel planes by the method of planes, see compute stress/mop.

The rows of the array are planes, ``delta`` apart, as many as fit between the ends of the box on both sides of the origin; the first column
is the place of the plane, three more belong to each keyword.

$$P_{bd}(z) = \frac{1}{A} \Big[ \sum_{items} \sum_{z_i > z} F_{ib} + \frac{1}{\Delta t} \sum_{crossing} \pm m_i v_{ib} \Big]$$

Source: B. D. Todd, D. J. Evans, P. J. Daivis, Phys. Rev. E 52, 1627 (1995); LAMMPS manual, compute stress/mop/profile. Units: distance,
pressure.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._planes import Planes
from asemd.errors import InputError
from asemd.words import number, take


class StressMopProfile(Planes):
    """Pressure across parallel planes.

    Parameters
    ----------
    group, axis, origin, terms
        As in `asemd.compute._planes.Planes`.
    delta : float
        Distance of the planes.

    Raises
    ------
    InputError
        Also for a distance that is not positive and an origin outside the box.
    """

    style = "stress/mop/profile"

    def __init__(self, group: str = "all", axis: str = "z", origin: float | str = "lower", delta: float = 1.0, terms=("total",)):
        super().__init__(group, axis, origin, terms)
        if not delta > 0.0:
            raise InputError(f"compute stress/mop/profile: the distance of the planes must be above 0, got {delta:g}")
        self.delta = delta

    @classmethod
    def from_lammps(cls, group, words, session):
        axis, origin, delta = take(words, 4, "compute stress/mop/profile direction origin delta keyword")[:3]
        out = cls(group, axis, cls.read_origin(origin), number(delta, "compute stress/mop/profile delta"), words[3:])
        out.places = out.planes(session.scene.need_system("compute stress/mop/profile").box)
        return out

    def to_lammps(self) -> list[str]:
        origin = self.origin if isinstance(self.origin, str) else repr(self.origin)
        return ["xyz"[self.axis], origin, repr(self.delta), *self.terms]

    def planes(self, box) -> np.ndarray:
        origin, low, high = self.at(box), float(box.lo[self.axis]), float(box.hi[self.axis])
        if not low <= origin <= high:
            raise InputError(f"compute stress/mop/profile: Origin of bins is out of bounds, {origin:g} is not from {low:g} to {high:g}")
        inverse = 1.0 / self.delta
        first = origin - int((origin - low) * inverse) * self.delta
        last = origin + int((high - origin) * inverse) * self.delta
        return first + np.arange(int((last - first) * inverse + 1.5)) * self.delta

    def array_columns(self) -> int:
        return 1 + 3 * len(self.terms)

    def array(self, state) -> np.ndarray:
        """A row for each plane: its place, three numbers for each keyword."""
        out = self.stresses(state)
        return np.column_stack([self.places, out])
