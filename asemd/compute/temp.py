r"""Temperature of a group from its translational kinetic energy, and the kinetic energy tensor.

.. math:: T = \frac{\sum_i m_i v_i^2}{f k_B}, \qquad K_{ab} = \sum_i m_i v_{ia} v_{ib}

with :math:`f` degrees of freedom: dimension times the number of atoms, minus those that fixes remove (SHAKE, rigid bodies), minus the
dimension for the conserved momentum (``compute_modify ID extra/dof N`` sets another number). Atoms lost during a run (``thermo_modify lost
ignore``) count until its end, as in LAMMPS, unless ``compute_modify ID dynamic/dof yes``.

Temperatures with a *bias* take a part of the velocities away first: that of the centre of mass, a profile of flow, some components. They
are subclasses of `Temp` with ``bias = True`` and their own `Temp.remove_bias`. A thermostat with such a compute (``fix_modify ID temp``)
acts on what is left.

Source: LAMMPS manual, compute temp and compute_modify. Units: temperature; the tensor is an energy (twice the kinetic energy on its trace).
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError
from asemd.kernels import observe


class Temp(Compute):
    """Temperature.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    extra_dof : float, optional
        Degrees of freedom to leave out; None is the dimension of the system.

    Attributes
    ----------
    bias : bool
        Whether `remove_bias` changes anything.
    hides : bool
        Whether the bias is all of some velocities or components, to which the compute is blind; otherwise it is a flow.
    """

    style = "temp"
    size = 6        # elements of the vector
    bias = False
    hides = False

    def __init__(self, group: str = "all", extra_dof: float | None = None):
        super().__init__(group)
        self.extra_dof = extra_dof

    def dof(self, state) -> float:
        """Degrees of freedom of the group; `state` is a `asemd.engine.Snapshot` or a `asemd.loop.Loop`.

        Raises
        ------
        InputError
            Constraints and extra/dof leave fewer than none.
        """
        mask = state.groups[self.group]
        gone = 0 if self.dynamic else state.gone.get(self.group, 0)
        n, dimension = int(np.count_nonzero(mask)) + gone, state.system.dimension
        extra = dimension if self.extra_dof is None else self.extra_dof
        removed = sum(fix.removed_dof(mask) - (0.0 if self.dynamic else fix.added_dof(mask)) for fix in state.fixes)
        dof = dimension * n - extra - removed
        if dof < 0.0 and n > 0:
            raise InputError(f"compute {self.id or 'temp'}: group {self.group} has {n} atoms and {dof:g} degrees of freedom")
        return max(dof, 0.0)

    def remove_bias(self, state) -> np.ndarray:
        """(n, 3) velocities without the bias, of all atoms, whatever the group; those of the system stay as they are."""
        return state.system.v

    def created(self, state, flow: np.ndarray) -> np.ndarray:
        """(n, 3) velocities after ``velocity create ... bias yes``; `flow` is the bias of those before."""
        return state.system.v + flow

    def scalar(self, state) -> float:
        """The temperature; 0 without degrees of freedom."""
        dof = self.dof(state)
        if dof <= 0.0:
            return 0.0
        return float(state.units.mvv2e / (dof * state.units.boltz) * self._sums(state)[:3].sum())

    def _weights(self, state) -> np.ndarray:
        """(n,) masses, 0 outside the group."""
        mask, masses = state.mask(self.group), state.system.atom_masses()
        return masses if mask.all() else np.where(mask, masses, 0.0)

    def _sums(self, state) -> np.ndarray:
        """(6,) sum of m v v: xx yy zz xy xz yz."""
        out = np.empty(6)
        observe.kinetic(self.remove_bias(state), self._weights(state), out)
        return out

    def vector(self, state) -> np.ndarray:
        """(6,) sum of m v v in energy units: xx yy zz xy xz yz."""
        return state.units.mvv2e * self._sums(state)
