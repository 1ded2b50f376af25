r"""Heat flux of a group of atoms.

.. math:: \mathbf J = \sum_i e_i \mathbf v_i - \sum_i \mathbf S_i \mathbf v_i

times the volume, with energies and stresses of three other computes; the first three elements are both sums, the last three the first
alone. Source: LAMMPS manual, compute heat/flux. Units: energy times velocity.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute.ke_atom import KEAtom
from asemd.compute.pe_atom import PEAtom
from asemd.compute.stress_atom import StressAtom
from asemd.errors import InputError, nearest
from asemd.kernels import observe
from asemd.words import exactly

ROLES = (("ke/atom", KEAtom), ("pe/atom", PEAtom), ("stress/atom", StressAtom))


class HeatFlux(Compute):
    """Heat flux.

    Parameters
    ----------
    group : str
        The atoms of the sums.
    ke : KEAtom, optional
        Kinetic energies.
    pe : PEAtom, optional
        Potential energies.
    stress : StressAtom or CentroidStressAtom, optional
        Its kinetic part should be off; the default is ``StressAtom(terms=["virial"])``.
    """

    style = "heat/flux"
    extensive = True
    size = 6

    def __init__(self, group: str = "all", ke=None, pe=None, stress=None):
        super().__init__(group)
        self.ke, self.pe, self.stress = ke or KEAtom(), pe or PEAtom(), stress or StressAtom(terms=["virial"])
        self.needs = self.ke.needs | self.pe.needs | self.stress.needs

    @classmethod
    def from_lammps(cls, group, words, session):
        computes, found = session.scene.computes, []
        for id, (style, kind) in zip(exactly(words, 3, "compute heat/flux"), ROLES, strict=True):
            if id not in computes:
                raise InputError(f"compute heat/flux: there is no compute {id}{nearest(id, computes)}")
            if not isinstance(computes[id], kind):
                raise InputError(f"compute heat/flux: compute {id} (style {computes[id].style}) is not a compute {style}")
            found.append(computes[id])
        return cls(group, *found)

    def to_lammps(self) -> list[str]:
        return [self.ke.id, self.pe.id, self.stress.id]

    def vector(self, state) -> np.ndarray:
        """(6,) flux, then its part of carried energy."""
        mask, v = state.mask(self.group), state.system.v
        stress, sums = self.stress.per_atom(state), np.empty(6)
        lower = (3, 4, 5) if stress.shape[1] == 6 else (6, 7, 8)        # yx zx zy
        observe.flux(v, self.ke.per_atom(state), self.pe.per_atom(state), stress, lower, mask, sums)
        return np.concatenate([sums[:3] - sums[3:] / state.units.nktv2p, sums[:3]])
