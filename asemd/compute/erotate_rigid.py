r"""Rotational kinetic energy of the rigid bodies of a fix.

.. math:: E = \frac12 \sum_b L_b \cdot \omega_b

Source: LAMMPS manual, compute erotate/rigid. Units: energy.
"""
from __future__ import annotations

from asemd.compute import Compute
from asemd.errors import InputError, nearest
from asemd.words import exactly


class ErotateRigid(Compute):
    """Rotational energy of rigid bodies.

    Parameters
    ----------
    fix : str
        Id of a fix rigid of any form.
    group : str
        Has no effect.

    Raises
    ------
    InputError
        No fix of rigid bodies with that id.
    """

    style = "erotate/rigid"
    extensive = True
    part = 1        # of the energies of translation and rotation

    def __init__(self, fix: str, group: str = "all"):
        super().__init__(group)
        self.fix = fix

    @classmethod
    def from_lammps(cls, group, words, session):
        name = exactly(words, 1, f"compute {cls.style}")[0]
        if name not in session.scene.fixes:
            raise InputError(f"compute {cls.style}: there is no fix {name}{nearest(name, session.scene.fixes)}")
        return cls(name, group)

    def to_lammps(self) -> list[str]:
        return [self.fix]

    def scalar(self, state) -> float:
        """The energy, energy units."""
        for fix in state.fixes:
            if fix.id == self.fix and hasattr(fix, "bodies_energies"):
                return float(fix.bodies_energies()[self.part].sum())
        raise InputError(f"compute {self.id} (style {self.style}): fix {self.fix} has no rigid bodies")
