r"""Remove the linear and the angular momentum of a group every N steps.

.. math:: v_i \leftarrow v_i - v_{cm}, \qquad v_i \leftarrow v_i - \omega \times (r_i - r_{cm}), \qquad
          I \omega = \sum_i m_i (r_i - r_{cm}) \times v_i

with unwrapped positions. With ``rescale`` the velocities are then scaled so that the kinetic energy is what it was.

Source: LAMMPS manual, fix momentum.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.words import whole

KEYWORDS = ("linear", "angular", "rescale")


def rotation(r: np.ndarray, v: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """(3,) angular velocity of a rigid body with the atoms' angular momentum about r = 0; axes without inertia do not turn."""
    angular = (mass[:, None] * np.cross(r, v)).sum(axis=0)
    inertia = (mass * (r * r).sum(axis=1)).sum() * np.eye(3) - np.einsum("i,ia,ib->ab", mass, r, r)
    moments, axes = np.linalg.eigh(inertia)
    solid = moments > 1e-6 * moments.max(initial=0.0)
    return axes[:, solid] @ ((angular @ axes[:, solid]) / moments[solid])


class Momentum(Fix):
    """Stop drift and rotation.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two corrections.
    linear : sequence of 3 bool, optional
        Directions whose momentum goes; None: none.
    angular : bool
        Remove the rotation.
    rescale : bool
        Keep the kinetic energy.

    Raises
    ------
    InputError
        `every` is below 1, or neither linear nor angular is asked for.
    """

    style = "momentum"
    needs_atoms = True

    def __init__(self, group: str = "all", every: int = 1, linear=None, angular: bool = False, rescale: bool = False):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix momentum: N must be at least 1, got {every}")
        if linear is None and not angular:
            raise InputError("fix momentum needs linear xflag yflag zflag, or angular, or both")
        self.every, self.linear, self.angular, self.rescale = every, None if linear is None else tuple(map(bool, linear)), angular, rescale

    @classmethod
    def from_lammps(cls, group, words, session):
        if not words:
            raise InputError("fix momentum needs N and one of linear, angular")
        every, words = whole(words[0], "fix momentum N"), words[1:]
        options = {}
        while words:
            keyword = words[0]
            if keyword not in KEYWORDS:
                raise InputError(f"fix momentum: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            if keyword == "linear":
                flags, words = words[1:4], words[4:]
                if len(flags) != 3 or not set(flags) <= {"0", "1"}:
                    raise InputError(f"fix momentum: linear needs three flags 0 or 1, got {' '.join(flags) or 'nothing'}")
                options["linear"] = [flag == "1" for flag in flags]
            else:
                options[keyword], words = True, words[1:]
        return cls(group, every, **options)

    def to_lammps(self) -> list[str]:
        words = [str(self.every)] + (["linear", *(str(int(flag)) for flag in self.linear)] if self.linear is not None else [])
        return words + ["angular"] * self.angular + ["rescale"] * self.rescale

    def end_of_step(self, loop) -> None:
        """Correct the velocities."""
        mask = loop.groups[self.group]
        if not mask.any():
            return
        loop.sync_out()
        system = loop.system
        mass, v = system.atom_masses()[mask], system.v[mask]
        before = mass @ (v * v).sum(axis=1)
        if self.linear is not None:
            v = v - np.where(self.linear, mass @ v / mass.sum(), 0.0)
        if self.angular:
            r = system.box.unwrap(system.x, system.image)[mask]
            r = r - mass @ r / mass.sum()
            v = v - np.cross(rotation(r, v, mass), r)
        after = mass @ (v * v).sum(axis=1)
        if self.rescale and after > 0.0:
            v = v * np.sqrt(before / after)
        system.v[mask] = v
        loop.sync_in()
