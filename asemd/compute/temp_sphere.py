r"""Temperature of spheres that turn: translation and rotation, or rotation alone.

.. math:: T = \frac{\sum_i m_i v_i^2 + \sum_i I_i \omega_i^2}{f k_B}, \qquad I = \tfrac25 m R^2

Each sphere has as many degrees of freedom of rotation as the box allows: three, in two dimensions one. With ``bias ID`` velocities are
those without the bias of another compute; with ``dof rotate`` rotation alone counts.

Source: LAMMPS manual, compute temp/sphere. Units: temperature; the tensor is an energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.erotate_sphere import INERTIA, energies
from asemd.compute.pressure import find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, nearest
from asemd.result import COMPONENTS
from asemd.words import choice, take


class TempSphere(Temp):
    """Temperature of spheres.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    rotation_only : bool
        Rotation alone counts.
    without : Temp, optional
        Velocities are those without the bias of this one.
    extra_dof : float, optional
        Degrees of freedom to leave out; None is the dimension of the system.
    """

    style = "temp/sphere"
    needed = "radius", "a radius", "sphere"     # the array it takes of the atoms, in words, and the atom style with it

    def __init__(self, group: str = "all", rotation_only: bool = False, without: Temp | None = None, extra_dof: float | None = None):
        super().__init__(group, extra_dof)
        self.rotation_only, self.without = rotation_only, without
        self.bias = without is not None

    @classmethod
    def from_lammps(cls, group, words, session):
        rotate, without = False, None
        while words:
            value, what = take(words[1:], 1, f"compute {cls.style} {words[0]}")[0], f"compute {cls.style} {words[0]}"
            if words[0] == "bias":
                without = find_temperature(value, session, what)
                if not without.bias:
                    raise InputError(f"{what}: compute {value} (style {without.style}) removes no bias")
                if without.hides:
                    raise InputError(f"{what}: the bias must be a flow, as of temp/com, not that of {without.style}")
                if without.group != group:
                    raise InputError(f"{what}: compute {value} is of group {without.group}, not of {group}")
            elif words[0] == "dof":
                rotate = choice(value, ("all", "rotate"), what) == "rotate"
            else:
                raise InputError(f"compute {cls.style}: unknown keyword {words[0]!r}{nearest(words[0], ('bias', 'dof'))}")
            words = words[2:]
        kind, has, style = cls.needed
        if kind not in session.scene.need_system(f"compute {cls.style}").extra:
            raise InputError(f"compute {cls.style} needs atoms with {has}: use atom_style {style}, or hybrid with it")
        return cls(group, rotate, without)

    def to_lammps(self) -> list[str]:
        return (["bias", self.without.id] if self.without is not None else []) + ["dof", "rotate"] * self.rotation_only

    def turning(self, state) -> int:
        """How many atoms of the group turn."""
        return int(np.count_nonzero(state.groups[self.group] & (state.system.extra["radius"] > 0.0)))

    def rotation(self, state) -> np.ndarray:
        """(n,) twice the energy of rotation of each atom, zero outside the group."""
        return energies(state, self.group, f"compute {self.style}")

    def rotation_tensor(self, state) -> np.ndarray:
        """(6,) sum of I w w in energy units: xx yy zz xy xz yz."""
        system, w = state.system, state.system.extra["omega"]
        inertia = np.where(state.mask(self.group), INERTIA * system.atom_masses() * system.extra["radius"] ** 2, 0.0)
        return state.units.mvv2e * np.array([np.einsum("i,i,i->", inertia, w[:, i], w[:, j]) for i, j in COMPONENTS])

    def dof(self, state) -> float:
        turning = float(self.turning(state)) * (3 if state.system.dimension == 3 else 1)
        if not self.rotation_only:
            return super().dof(state) + turning
        mask = state.groups[self.group]
        removed = sum(fix.removed_dof(mask) - (0.0 if self.dynamic else fix.added_dof(mask)) for fix in state.fixes)
        return max(turning - (self.extra_dof or 0.0) - removed, 0.0)        # by default none for the conserved momentum

    def remove_bias(self, state) -> np.ndarray:
        return state.system.v if self.without is None else self.without.remove_bias(state)

    def scalar(self, state) -> float:
        dof = self.dof(state)
        if dof <= 0.0:
            return 0.0
        v = self.remove_bias(state)
        twice = 0.0 if self.rotation_only else state.units.mvv2e * np.einsum("i,ij,ij->", self._weights(state), v, v)
        return float((twice + self.rotation(state).sum()) / (dof * state.units.boltz))

    def vector(self, state) -> np.ndarray:
        return (np.zeros(6) if self.rotation_only else super().vector(state)) + self.rotation_tensor(state)
