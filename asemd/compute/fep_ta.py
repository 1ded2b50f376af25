r"""Energy of the box with another cross section and the same volume, for surface tensions by the test area method.

.. math:: \gamma = -\frac{k_B T}{\Delta A} \ln \langle e^{-\Delta U / k_B T} \rangle

The two lengths of the plane are multiplied by the square root of the factor, the third one is divided by the factor; tilts stay.
All energies count, bonded ones too. Words: the temperature T; plane xy, xz or yz; factor; ``tail yes``: with the tail correction, which
the shape does not change.

Source: LAMMPS manual, compute fep/ta; Gloor, Jackson, Blas and de Miguel, J. Chem. Phys. 123, 134703 (2005). Output: a vector of 3:
:math:`\Delta U` (energy), :math:`e^{-\Delta U/k_B T}`, :math:`\Delta A` (distance squared).
"""
from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from asemd.compute._pairs import force_cutoff, half, interactions
from asemd.compute._perturbed import Perturbed
from asemd.engine import Engine
from asemd.errors import InputError, nearest
from asemd.words import choice, number, take, yes_no

PLANES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


class FEPTA(Perturbed):
    """Perturbation of the cross section.

    Parameters
    ----------
    group : str
        Makes no difference: all atoms count.
    temperature : float
        Of the Boltzmann factor, temperature units.
    plane : str
        xy, xz or yz.
    scale : float
        Area of the perturbed plane relative to the present one.
    tail : bool
        Makes no difference: the volume stays.

    Raises
    ------
    InputError
        Another plane, a factor that is not positive; (in a script) two dimensions.
    """

    style = "fep/ta"

    def __init__(self, group: str = "all", temperature: float = 1.0, plane: str = "xy", scale: float = 1.0, tail: bool = False):
        super().__init__(group)
        self.temperature, self.plane, self.scale, self.tail = float(temperature), choice(plane, PLANES, "compute fep/ta plane"), scale, tail
        if scale <= 0.0:
            raise InputError(f"compute fep/ta: the scale factor must be positive, got {scale:g}")

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute fep/ta"
        temperature, plane, scale = take(words, 3, what)
        rest, given = list(words[3:]), {}
        while rest:
            if rest[0] != "tail":
                raise InputError(f"{what}: unknown keyword {rest[0]!r}{nearest(rest[0], ['tail'])}")
            given["tail"] = yes_no(take(rest[1:], 1, f"{what} tail")[0], f"{what} tail")
            rest = rest[2:]
        if session.scene.need_system(what).dimension == 2:
            raise InputError(f"{what} cannot be used in two dimensions")
        return cls(group, number(temperature, f"{what} temperature"), plane, number(scale, f"{what} scale factor"), **given)

    def to_lammps(self) -> list[str]:
        return [repr(self.temperature), self.plane, repr(self.scale), "tail", "yes" if self.tail else "no"]

    def vector(self, state) -> np.ndarray:
        """(3,) energy difference, Boltzmann factor, change of the area."""
        reach, axes = force_cutoff(state, "compute fep/ta"), list(PLANES[self.plane])
        factors, lengths = np.full(3, 1.0 / self.scale), np.diag(state.system.box.cell)
        factors[axes] = self.scale**0.5
        cell = state.system.box.cell + np.diag((factors - 1.0) * lengths)      # tilts stay
        strain = state.system.box.inverse @ cell
        energy = (_whole if any(t.category != "pair" for t in state.engine.terms) else _pairs)(state, cell, strain, reach)
        return np.array([energy, self.boltzmann(state, energy), float(lengths[axes].prod()) * (self.scale - 1.0)])


def _pairs(state, cell: np.ndarray, strain: np.ndarray, reach: float) -> float:
    """Change of the energy of the pairs."""
    pairs = half(state, reach * max(1.0, np.linalg.norm(np.linalg.inv(strain), 2)))
    d = pairs.d @ strain
    moved = replace(pairs, d=d, r2=(d * d).sum(axis=1))
    return float((interactions(state, moved)[0] - interactions(state, pairs)[0]).sum())


def _whole(state, cell: np.ndarray, strain: np.ndarray, reach: float) -> float:
    """Change of the energy of everything, bonded interactions too."""
    energies = []
    for deformed in (False, True):
        system, box = copy.copy(state.system), state.system.box
        system.f, system.image = system.f.copy(), system.image.copy()
        system.x = box.origin + (system.x - box.origin) @ (strain if deformed else np.eye(3))
        system.box = replace(box, cell=cell) if deformed else box
        result = Engine(system, state.engine.interactions, state.engine.settings).compute()
        energies.append(result.potential - result.energy["etail"])
    return energies[1] - energies[0]
