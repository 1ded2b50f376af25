r"""Heat exchange that conserves energy: kinetic energy at a given rate, and positions corrected in the third order of the step.

.. math:: v_i \leftarrow \xi v_i - (\xi - 1) V, \quad \xi^2 = 1 + \frac{F \Delta t}{K}, \quad r_i \leftarrow r_i - \Delta t^3 \epsilon_i

.. math:: \epsilon_i = \frac{\eta_i}{m_i K} \Bigl[ \frac{F}{48} + \frac16 \sum_j f_j \cdot (v_j - V) \Bigr]
          - \frac{F}{12 K} \Bigl[ \frac{f_i}{m_i} - \frac1M \sum_j f_j \Bigr], \qquad \eta_i = \frac{m_i F}{2 K} (v_i - V)

with the kinetic energy K of the atoms (of the group, within the region) relative to their centre of mass, its velocity V and the mass M.
With ``hex`` positions are not corrected.

Source: P. Wirnsberger, D. Frenkel, C. Dellago, J. Chem. Phys. 143, 124104 (2015); LAMMPS manual, fix ehex. Units: energy/time. Output: the
scalar is the last factor :math:`\xi`.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, SimulationError, nearest
from asemd.fix.heat import Heat
from asemd.words import number, take, whole

KEYWORDS = ("region", "constrain", "com", "hex")


class EHEX(Heat):
    """Enhanced heat exchange.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two changes.
    rate : float
        Energy for each time unit.
    region : object with ``inside(x)``, optional
        Only atoms within it.
    hex : bool
        Without the correction of positions.

    Raises
    ------
    InputError
        `every` below 1; at the start of a run, a group without atoms.
    SimulationError
        The kinetic energy would become negative.
    """

    style = "ehex"

    def __init__(self, group: str = "all", every: int = 1, rate: float = 0.0, region=None, hex: bool = False, region_id: str = ""):
        super().__init__(group, every, rate, region, region_id)
        self.hex = hex

    @classmethod
    def from_lammps(cls, group, words, session):
        every, rate = take(words, 2, "fix ehex")[:2]
        words, region, id, hex_ = words[2:], None, "", False
        while words:
            if words[0] not in KEYWORDS:
                raise InputError(f"fix ehex: unknown keyword {words[0]!r}{nearest(words[0], KEYWORDS)}")
            if words[0] in ("constrain", "com"):
                raise InputError(f"fix ehex: {words[0]} is for clusters of fix shake, which fix ehex does not know; leave it out")
            if words[0] == "hex":
                hex_, words = True, words[1:]
            else:
                id = take(words[1:], 1, "fix ehex region")[0]
                region, words = session.scene.region(id, "fix ehex region"), words[2:]
        return cls(group, whole(every, "fix ehex N"), number(rate, "fix ehex F"), region, hex_, id)

    def to_lammps(self) -> list[str]:
        return super().to_lammps() + ["hex"] * self.hex

    def chosen(self, loop) -> np.ndarray:
        """(n,) which atoms it acts on now; those that have just left the box count where they come back."""
        loop.sync_out()
        mask, system = loop.groups[self.group], loop.system
        if self.region is None:
            return mask
        x = system.x.copy()
        system.box.wrap(x, system.image.copy())
        return mask & self.region.inside(x)

    def end_of_step(self, loop) -> None:
        """Scale the velocities and correct the positions."""
        mask, system, ftm2v = self.chosen(loop), loop.system, loop.units.ftm2v
        mass, v, f = system.atom_masses()[mask], system.v[mask], system.f[mask] * ftm2v
        total = mass.sum()
        if not total > 0.0:
            raise SimulationError(f"step {loop.step}: fix {self.id} (style ehex): there are no atoms in region {self.region_id}")
        drift = np.einsum("i,ij->j", mass, v) / total
        thermal = v - drift
        kinetic = 0.5 * np.einsum("i,ij,ij->", mass, thermal, thermal)
        power = self.rate * ftm2v * self.every
        square = 1.0 + power * loop.dt / kinetic if kinetic > 0.0 else -1.0
        if square < 0.0:
            raise SimulationError(f"step {loop.step}: fix {self.id} (style ehex): the kinetic energy went negative")
        self.factor = math.sqrt(square)
        if not self.hex:
            work = np.einsum("ij,ij->", f, thermal)
            eta = 0.5 * power / kinetic * thermal
            shift = eta / kinetic * (power / 48.0 + work / 6.0) - power / (12.0 * kinetic) * (f / mass[:, None] - f.sum(axis=0) / total)
            system.x[mask] -= loop.dt**3 * shift
        system.v[mask] = self.factor * v - (self.factor - 1.0) * drift
        loop.sync_in()
