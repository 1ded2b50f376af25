r"""Pressure of the whole system, and its tensor.

.. math:: P = \frac{f k_B T + \operatorname{tr} W}{d V}, \qquad P_{ab} = \frac{\sum_i m_i v_{ia} v_{ib} + W_{ab}}{V}

with the virial :math:`W_{ab} = \sum_i r_{ia} F_{ib}` of all terms, :math:`f` degrees of freedom and :math:`T` of the temperature
compute, and :math:`d` dimensions (:math:`V` is the area in two dimensions). The diagonal has the tail correction of the pair style; the
virial of fixes counts if they were told so (``fix_modify ID virial yes``). Keywords pick terms: ke pair bond angle dihedral improper
kspace fix, or virial for all of them but ke.

Source: LAMMPS manual, compute pressure. Units: pressure.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute.temp import Temp
from asemd.errors import InputError, nearest

VIRIAL = ("pair", "bond", "angle", "dihedral", "improper", "kspace", "fix")
KEYWORDS = ("ke", *VIRIAL, "virial")


def read_terms(words, what: str) -> tuple[str, ...]:
    """The checked keywords, ``virial`` written out; none given means all."""
    for word in words:
        if word not in KEYWORDS:
            raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
    wanted = set(words or ("ke", "virial"))
    if "virial" in wanted:
        wanted.update(VIRIAL)
    return tuple(k for k in ("ke", *VIRIAL) if k in wanted)


def find_temperature(name: str, session, what: str) -> Compute:
    """The temperature compute of that id."""
    computes = session.scene.computes
    if name not in computes:
        raise InputError(f"{what}: there is no compute {name}{nearest(name, computes)}")
    if not hasattr(computes[name], "dof"):
        raise InputError(f"{what}: compute {name} (style {computes[name].style}) does not compute a temperature")
    return computes[name]


def find_pressure(name: str, session, what: str) -> Pressure:
    """The pressure compute of that id."""
    computes = session.scene.computes
    if name not in computes:
        raise InputError(f"{what}: there is no compute {name}{nearest(name, computes)}")
    if not isinstance(computes[name], Pressure):
        raise InputError(f"{what}: compute {name} (style {computes[name].style}) does not compute a pressure")
    return computes[name]


class Pressure(Compute):
    """Pressure.

    Parameters
    ----------
    group : str
        Must be ``all``.
    temperature : Temp, optional
        Measures the kinetic part; None is allowed if `terms` has no ``ke``. By default that of all atoms.
    terms : sequence of str, optional
        Some of ke, pair, bond, angle, dihedral, improper, kspace, fix, virial; None: all.

    Raises
    ------
    InputError
        Another group, an unknown term, or a kinetic part without a temperature compute.
    """

    style = "pressure"
    size = 6        # elements of the vector
    needs = frozenset({"virial"})

    def __init__(self, group: str = "all", temperature: Temp | str | None = "default", terms=None):
        super().__init__(group)
        if group != "all":
            raise InputError(f"compute pressure must use group all, got {group}; compute stress/atom and reduce give that of a group")
        self.words, self.terms = tuple(terms or ()), read_terms(terms or (), "compute pressure")
        self.temperature = Temp() if temperature == "default" else temperature
        if self.temperature is None and "ke" in self.terms:
            raise InputError("compute pressure: needs a temperature compute for the kinetic part; give its ID, or the keyword virial")

    @classmethod
    def from_lammps(cls, group, words, session):
        if not words:
            raise InputError("compute pressure needs the ID of a temperature compute, or NULL")
        return cls(group, None if words[0] == "NULL" else find_temperature(words[0], session, "compute pressure"), words[1:])

    def to_lammps(self) -> list[str]:
        return [self.temperature.id if self.temperature else "NULL", *self.words]

    def virial(self, state) -> np.ndarray:
        """(6,) virial of the chosen terms, energy units, with the tail correction."""
        of = state.result.virial_of
        keys = [k for k in VIRIAL if k in self.terms] + ["tail"] * ("pair" in self.terms)
        return sum((of[k] for k in keys if k in of), np.zeros(6))

    def _per_volume(self, state) -> float:
        box = state.system.box
        volume = box.volume if state.system.dimension == 3 else float(np.linalg.norm(np.cross(box.cell[0], box.cell[1])))
        return state.units.nktv2p / volume

    def scalar(self, state) -> float:
        """The pressure."""
        d = state.system.dimension
        total = self.virial(state)[:d].sum()
        if "ke" in self.terms:
            total += self.temperature.dof(state) * state.units.boltz * self.temperature.scalar(state)
        return float(total / d * self._per_volume(state))

    def vector(self, state) -> np.ndarray:
        """(6,) xx yy zz xy xz yz; in two dimensions only xx, yy and xy are not zero."""
        total = self.virial(state)
        if "ke" in self.terms:
            total = total + self.temperature.vector(state)[:6]
        if state.system.dimension == 2:
            total[[2, 4, 5]] = 0.0
        return total * self._per_volume(state)
