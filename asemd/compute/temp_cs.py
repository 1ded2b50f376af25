r"""Temperature of the pairs of core and shell in models of polarisable ions, from the motion of their centres of mass.

.. math:: T = \frac{\sum_i m_i \mathbf V_i^2}{f k_B}, \qquad \mathbf V_i = \frac{m_c \mathbf v_c + m_s \mathbf v_s}{m_c + m_s}

where :math:`c` and `s` are the core and the shell that atom i is one of, joined by a bond; other atoms have their own velocity. What the
two move against each other is the bias: a thermostat with this compute (``fix_modify ID temp``) leaves it alone, so that the shells stay
cold. Each pair takes the degrees of freedom of one atom away. The vector is the tensor of all of the motion, as the pressure needs it.

Source: P. J. Mitchell, D. Fincham, J. Phys.: Condens. Matter 5, 1031 (1993); behaviour of LAMMPS's compute temp/cs. Units: temperature; the
vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._clusters import bonded
from asemd.compute.temp import Temp
from asemd.errors import InputError
from asemd.kernels import observe
from asemd.words import exactly


class TempCS(Temp):
    """Temperature of centres of mass of cores and shells.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    cores, shells : str
        Groups; each atom of one has a bond to one atom of the other.

    Raises
    ------
    InputError
        (When it is used) groups of different size, a core without a shell or with two.
    """

    style = "temp/cs"
    bias = True

    def __init__(self, group: str = "all", cores: str = "cores", shells: str = "shells"):
        super().__init__(group)
        self.cores, self.shells, self._pairs = cores, shells, None

    @classmethod
    def from_lammps(cls, group, words, session):
        names = exactly(words, 2, "compute temp/cs (group-ID of cores, group-ID of shells)")
        for name in names:
            session.scene.groups.mask(name, "compute temp/cs")
        return cls(group, *names)

    def to_lammps(self) -> list[str]:
        return [self.cores, self.shells]

    def setup(self, state) -> None:
        self._pairs = None      # groups may be others now

    def pairs(self, state) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the cores, and of their shells."""
        topology = state.system.topology
        if self._pairs is None or self._pairs[0] is not topology:
            self._pairs = (topology, *self._find(state))
        return self._pairs[1:]

    def _find(self, state) -> tuple[np.ndarray, np.ndarray]:
        core, shell = state.groups[self.cores], state.groups[self.shells]
        what, n = f"compute {self.id or self.style}", (int(core.sum()), int(shell.sum()))
        if n[0] != n[1]:
            raise InputError(f"{what}: group {self.cores} has {n[0]} cores, but group {self.shells} has {n[1]} shells")
        a, b = bonded(state)
        turned = ~core[a] | ~shell[b]
        a, b = np.where(turned, b, a), np.where(turned, a, b)
        chosen = core[a] & shell[b]
        a, b = a[chosen], b[chosen]
        for rows, mask, name, other in ((a, core, "core", "shell"), (b, shell, "shell", "core")):
            count = np.bincount(rows, minlength=len(mask))
            if (wrong := np.flatnonzero(mask & (count != 1))).size:
                raise InputError(f"{what}: {name} {state.system.id[wrong[0]]} has bonds to {count[wrong[0]]} {other}s, it must have one")
        return a, b

    def dof(self, state) -> float:
        whole = Temp.dof(self, state)
        dof = whole - state.system.dimension * len(self.pairs(state)[0])
        if dof < 0.0 < whole:
            raise InputError(f"compute {self.id or self.style}: all pairs of core and shell take degrees of freedom from group "
                             f"{self.group}, which has too few; use group all")
        return max(dof, 0.0)

    def remove_bias(self, state) -> np.ndarray:
        system = state.system
        (a, b), v, m = self.pairs(state), system.v.copy(), system.atom_masses()[:, None]
        v[a] = v[b] = (m[a] * v[a] + m[b] * v[b]) / (m[a] + m[b])
        return v

    def created(self, state, flow: np.ndarray) -> np.ndarray:
        return self.remove_bias(state)      # cold shells, as in LAMMPS

    def vector(self, state) -> np.ndarray:
        """(6,) sum of m v v of all motion in energy units: xx yy zz xy xz yz."""
        out = np.empty(6)
        observe.kinetic(state.system.v, self._weights(state), out)
        return state.units.mvv2e * out
