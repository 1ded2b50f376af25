r"""Add or take kinetic energy at a given rate, every N steps, without a change of the momentum.

.. math:: v_i \leftarrow \xi_i v_i - \frac1M \sum_j m_j (\xi_j - 1) v_j, \qquad
          \xi^2 = \frac{K + N \Delta t\, \dot Q - \frac12 M V^2}{K - \frac12 M V^2}

with kinetic energy K, mass M and centre-of-mass velocity V of the atoms of the group (within the region). An atom-style variable gives each
atom a factor of its own.

Source: P. Jund, R. Jullien, Phys. Rev. B 59, 13707 (1999); LAMMPS manual, fix heat. Units: energy/time. Output: the scalar is the last
factor :math:`\xi`, its mean over the atoms for an atom-style variable.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.fix import Fix
from asemd.fix.formula import read, write
from asemd.words import take, whole


class Heat(Fix):
    """Heat source or sink.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two changes.
    rate : float or callable
        Energy for each time unit; a function of the loop gives one number or one for each atom.
    region : object with ``inside(x)``, optional
        Only atoms within it.

    Raises
    ------
    InputError
        `every` below 1; at the start of a run, a group without atoms.
    SimulationError
        The kinetic energy would become negative.
    """

    style = "heat"
    extensive = False

    def __init__(self, group: str = "all", every: int = 1, rate=0.0, region=None, region_id: str = ""):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix {self.style}: N must be at least 1, got {every}")
        self.every, self.rate, self.region, self.region_id, self.factor = every, rate, region, region_id, 1.0

    @classmethod
    def from_lammps(cls, group, words, session):
        take(words, 2, "fix heat")
        region = None
        if words[2:]:
            if words[2] != "region" or len(words) != 4:
                raise InputError(f"fix heat: expected region ID after N and the rate, got {' '.join(words[2:])}")
            region = session.scene.region(words[3], "fix heat region")
        return cls(group, whole(words[0], "fix heat N"), read(words[1], "fix heat", session), region, words[3] if region else "")

    def to_lammps(self) -> list[str]:
        return [str(self.every), write(self.rate), *(["region", self.region_id] if self.region is not None else [])]

    def setup(self, loop) -> None:
        if not loop.groups[self.group].any():
            raise InputError(f"fix {self.id} (style {self.style}): group {self.group} has no atoms")

    def chosen(self, loop) -> np.ndarray:
        """(m,) slots of the atoms it acts on now."""
        s = loop.state
        slots = np.flatnonzero(s.mask[:loop.nslots] & np.int32(loop.group_bit(self.group)))
        return slots if self.region is None else slots[self.region.inside(s.x[:, slots].T)]

    def end_of_step(self, loop) -> None:
        """Scale the velocities."""
        rate = self.rate(loop) if callable(self.rate) else self.rate
        slots, s = self.chosen(loop), loop.state
        mass, v = s.mass[slots], s.v[:, slots]
        total = mass.sum()
        thermal = v - (v @ mass / total)[:, None] if total > 0.0 else v
        kinetic = 0.5 * float((thermal * thermal).sum(axis=0) @ mass)
        if not kinetic > 0.0:
            raise SimulationError(f"step {loop.step}: fix {self.id} (style {self.style}): there is no kinetic energy to scale")
        square = 1.0 + (rate[s.row[slots]] if np.ndim(rate) else rate) * self.every * loop.dt * loop.units.ftm2v / kinetic
        if np.min(square) < 0.0:
            raise SimulationError(f"step {loop.step}: fix {self.id} (style {self.style}): the kinetic energy went negative")
        factor = np.sqrt(square)
        self.factor = float(np.mean(factor))
        s.v[:, slots] = factor * v - (v @ (mass * (factor - 1.0)) / total)[:, None]

    def scalar(self) -> float:
        """The last factor."""
        return self.factor
