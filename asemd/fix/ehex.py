r"""Heat exchange that conserves energy: kinetic energy at a given rate, and positions corrected in the third order of the step.

.. math:: v_i \leftarrow \xi v_i - (\xi - 1) V, \quad \xi^2 = 1 + \frac{F \Delta t}{K}, \quad r_i \leftarrow r_i - \Delta t^3 \epsilon_i

.. math:: \epsilon_i = \frac{\eta_i}{m_i K} \Bigl[ \frac{F}{48} + \frac16 \sum_j f_j \cdot (v_j - V) \Bigr]
          - \frac{F}{12 K} \Bigl[ \frac{f_i}{m_i} - \frac1M \sum_j f_j \Bigr], \qquad \eta_i = \frac{m_i F}{2 K} (v_i - V)

with the kinetic energy K of the atoms (of the group, within the region) relative to their centre of mass, its velocity V and the mass M.
With ``hex`` positions are not corrected.

With ``constrain`` the forces of fix shake or fix rattle are found anew after each change, so that the next step keeps the bonds. With
``com`` clusters of that fix are taken whole: those whose centre of mass is within the region, if all their atoms are in the group.

Source: P. Wirnsberger, D. Frenkel, C. Dellago, J. Chem. Phys. 143, 124104 (2015); LAMMPS manual, fix ehex. Units: energy/time. Output: the
scalar is the last factor :math:`\xi`.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, SimulationError, nearest
from asemd.fix.constraint_clusters import SIZE
from asemd.fix.heat import Heat
from asemd.fix.shake import Shake
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
    constrain : bool
        Constraints of fix shake or rattle are solved again after each change.
    com : bool
        Their clusters are within the region with all atoms or with none; needs `constrain`.

    Raises
    ------
    InputError
        `every` below 1, `com` without `constrain`; at the start of a run, a group without atoms, or no fix shake or rattle for `constrain`.
    SimulationError
        The kinetic energy would become negative.
    """

    style = "ehex"

    def __init__(self, group: str = "all", every: int = 1, rate: float = 0.0, region=None, hex: bool = False, region_id: str = "",
                 constrain: bool = False, com: bool = False):
        super().__init__(group, every, rate, region, region_id)
        if com and not constrain:
            raise InputError("fix ehex: com is for clusters of fix shake or rattle and needs constrain too")
        self.hex, self.constrain, self.com = hex, constrain, com

    @classmethod
    def from_lammps(cls, group, words, session):
        every, rate = take(words, 2, "fix ehex")[:2]
        words, region, id, flags = words[2:], None, "", {}
        while words:
            if words[0] not in KEYWORDS:
                raise InputError(f"fix ehex: unknown keyword {words[0]!r}{nearest(words[0], KEYWORDS)}")
            if words[0] == "region":
                id = take(words[1:], 1, "fix ehex region")[0]
                region, words = session.scene.region(id, "fix ehex region"), words[2:]
            else:
                flags[words[0]], words = True, words[1:]
        return cls(group, whole(every, "fix ehex N"), number(rate, "fix ehex F"), region, region_id=id, **flags)

    def to_lammps(self) -> list[str]:
        return super().to_lammps() + [word for word in ("constrain", "com", "hex") if getattr(self, word)]

    def setup(self, loop) -> None:
        super().setup(loop)
        if self.constrain and self._holder(loop) is None:
            raise InputError(f"fix {self.id} (style ehex): constrain needs a fix shake or rattle, there is none")

    @staticmethod
    def _holder(loop) -> Shake | None:
        """The fix that holds bonds."""
        return next((f for f in loop.fixes if isinstance(f, Shake)), None)

    def chosen(self, loop) -> np.ndarray:
        """(m,) slots of the atoms it acts on now; those that have just left the box count where they come back."""
        s = loop.state
        allowed = s.mask[:loop.nslots] & np.int32(loop.group_bit(self.group)) != 0
        if self.region is not None:
            there = np.flatnonzero(allowed)
            allowed[there] = self._within(s.x[:, there].T, loop)
        if self.com:
            self._choose_clusters(allowed, loop)
        return np.flatnonzero(allowed)

    def _within(self, x: np.ndarray, loop) -> np.ndarray:
        """(m,) bool: which places (m, 3) are in the region, as seen in the box."""
        x = x.copy()
        loop.system.box.wrap(x, np.zeros(x.shape, np.int32))
        return self.region.inside(x)

    def _choose_clusters(self, allowed: np.ndarray, loop) -> None:
        """All atoms of a cluster are chosen, or none: by the group, and by where its centre of mass is."""
        s, clusters = loop.state, self._holder(loop).clusters
        member = np.arange(4) < SIZE[clusters.kind][:, None]
        slots = s.slot[np.where(member, clusters.atoms, clusters.atoms[:, :1])]
        whole = (s.mask[slots] & np.int32(loop.group_bit(self.group)) != 0).all(axis=1)
        if self.region is not None:
            first = s.x[:, slots[:, 0]].T
            apart = (s.x[:, slots] - s.x[:, slots[:, :1]]).reshape(3, -1).T
            apart = loop.system.box.minimum_image(apart)[0].reshape(*slots.shape, 3)
            mass = s.mass[slots] * member
            whole &= self._within(first + np.einsum("ck,ckd->cd", mass, apart) / mass.sum(axis=1)[:, None], loop)
        allowed[slots[member]] = np.repeat(whole, member.sum(axis=1))

    def end_of_step(self, loop) -> None:
        """Scale the velocities and correct the positions."""
        self._change(loop)
        if self.constrain:
            self._holder(loop).hold_again(loop)

    def _change(self, loop) -> None:
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
