r"""Give all atoms of a group the average force, plus a force.

.. math:: F_i \leftarrow \frac{1}{N} \sum_j F_j + f

A component NULL (None) stays as it is. It acts in minimisation as well.

Source: LAMMPS manual, fix aveforce. Units: force. Output: a vector of 3, the total force on the group before.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.kernels.threads import reduce_sum


class AveForce(Forcing):
    """Average the force over the atoms of a group.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    force : sequence of 3 of float or callable or None
        What is added to the average, in force units of the scene; None leaves a component alone; a function of the loop returns a number.
    region : Region, optional
        Only atoms inside it.
    """

    style = "aveforce"
    told = size = 3

    def __init__(self, group: str = "all", force=(0.0, 0.0, 0.0), region=None):
        super().__init__(group, force, region)
        if len(self.values) != 3:
            raise InputError(f"fix aveforce: a force has 3 components, got {len(self.values)}")

    @classmethod
    def from_lammps(cls, group, words, session):
        force = cls.read_values(words, "fx fy fz", session, null=True)
        options = cls.read_keywords(words[3:], {"region": None}, session)
        fix = cls(group, force, options.get("region"))
        fix.region_id = options.get("region_id", "")
        return fix

    def to_lammps(self) -> list[str]:
        return self.value_words() + self.region_words()

    def numbers(self, loop) -> list[float]:
        return [float(v is not None) for v in self.values]

    @hook
    def post_force(th, s, p, a):
        bit, some = np.int32(np.int64(p[0])), p[2] != 0.0
        n = 0.0
        total = np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0 and (not some or a[s.row[i], 0] != 0.0):
                n += 1.0
                for d in range(3):
                    total[d] += s.f[d, i]
        n = reduce_sum(th, n)
        for d in range(3):
            before = reduce_sum(th, total[d])
            if th.tid == 0:
                p[3 + d] = before
            if n > 0.0 and p[9 + d] != 0.0:
                value = before / n + p[6 + d]
                for i in range(th.lo, th.hi):
                    if s.mask[i] & bit != 0 and (not some or a[s.row[i], 0] != 0.0):
                        s.f[d, i] = value

    def elsewhere(self, loop) -> np.ndarray:
        """What it does on the other levels of ``run_style respa``: the average, with nothing added."""
        s = loop.state
        slots = np.flatnonzero(s.mask[:loop.nslots] & np.int64(loop.group_bit(self.group)))
        if self.region is not None:
            slots = slots[self.region.inside(s.x[:, slots].T)]
        for d, value in enumerate(self.values):
            if value is not None and len(slots):
                s.f[d, slots] = s.f[d, slots].mean()
        return np.zeros(3)

    @property
    def before(self) -> np.ndarray:
        """(3,) the total force before."""
        return self.p[3:6]

    @before.setter
    def before(self, value) -> None:
        self.p[3:6] = value
