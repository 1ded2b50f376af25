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
        """(m,) slots of the atoms it acts on now; those that have just left the box count where they come back."""
        s = loop.state
        slots = np.flatnonzero(s.mask[:loop.nslots] & np.int32(loop.group_bit(self.group)))
        if self.region is None:
            return slots
        x = s.x[:, slots].T.copy()
        loop.system.box.wrap(x, np.zeros(x.shape, np.int32))
        return slots[self.region.inside(x)]

    def end_of_step(self, loop) -> None:
        """Scale the velocities and correct the positions."""
        slots, s, ftm2v = self.chosen(loop), loop.state, loop.units.ftm2v
        mass, v, f = s.mass[slots], s.v[:, slots], s.f[:, slots] * ftm2v
        total = mass.sum()
        if not total > 0.0:
            raise SimulationError(f"step {loop.step}: fix {self.id} (style ehex): there are no atoms in region {self.region_id}")
        drift = (v @ mass / total)[:, None]
        thermal = v - drift
        kinetic = 0.5 * float((thermal * thermal).sum(axis=0) @ mass)
        power = self.rate * ftm2v * self.every
        square = 1.0 + power * loop.dt / kinetic if kinetic > 0.0 else -1.0
        if square < 0.0:
            raise SimulationError(f"step {loop.step}: fix {self.id} (style ehex): the kinetic energy went negative")
        self.factor = math.sqrt(square)
        if not self.hex:
            work = float((f * thermal).sum())
            eta = 0.5 * power / kinetic * thermal
            shift = eta / kinetic * (power / 48.0 + work / 6.0)
            s.x[:, slots] -= loop.dt**3 * (shift - power / (12.0 * kinetic) * (f / mass - f.sum(axis=1, keepdims=True) / total))
        s.v[:, slots] = self.factor * v - (self.factor - 1.0) * drift
