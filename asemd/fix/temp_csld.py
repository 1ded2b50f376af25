r"""Canonical sampling by Langevin dynamics of all velocities at once; it does not move atoms: use it with fix nve.

.. math:: v \leftarrow c\, v + \sqrt{(1 - c^2) \frac{T_0}{T_u}}\; u, \qquad c = e^{-\Delta t / \tau}

at the end of every step, with velocities :math:`u` drawn from a normal distribution of variance :math:`1 / m`, whose temperature is
:math:`T_u`. The random numbers are LAMMPS's.

Source: G. Bussi, M. Parrinello, Phys. Rev. E 75, 056707 (2007); LAMMPS manual, fix temp/csld. Units: temperature, time. Output: the scalar
is the energy taken out of the atoms (thermo keywords ecouple, econserve).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix.atom_order import ListOrder
from asemd.fix.formula import write
from asemd.fix.thermostat import Thermostat
from asemd.kernels.marsaglia import normals
from asemd.marsaglia import Marsaglia
from asemd.words import number, whole


class TempCSLD(Thermostat):
    """Stochastic thermostat of all velocities.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time, in time units of the scene.
    seed : int
        A positive number.

    Raises
    ------
    InputError
        A value out of its range.
    """

    style = "temp/csld"
    brings = ("temp",)
    takes_bias = True

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, seed: int = 1):
        super().__init__(group, temperature, damping)
        if not 0 < seed <= 900_000_000:
            raise InputError(f"fix {self.style}: seed must be a whole number from 1 to 900000000, got {seed}")
        self.seed, self.energy, self.random, self.storage = seed, 0.0, Marsaglia(seed), ListOrder()

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) != 4:
            raise InputError(f"fix {cls.style} needs Tstart Tstop Tdamp seed, got {len(words)} values")
        damping, seed = number(words[2], f"fix {cls.style} Tdamp"), whole(words[3], f"fix {cls.style} seed")
        fix = cls(group, cls.read_ramp(words, session), damping, seed)
        fix.storage = ListOrder(*session.scene.sort, order=session.scene.order)
        return fix

    def to_lammps(self) -> list[str]:
        return [write(self.start), repr(self.stop), repr(self.damping), str(self.seed)]

    def modify_option(self, keyword, value, session):
        known = super().modify_option(keyword, value, session)
        if self.style == "temp/csld" and self.temp.style == "temp/sphere" and self.temp.bias:
            raise InputError(f"fix_modify temp: fix temp/csld takes no compute temp/sphere with a bias, as {value} is: the flow of random "
                             "velocities is not that of the atoms; take fix temp/csvr")
        return known

    def setup(self, loop) -> None:
        self.storage.begin(loop)

    def resize(self, loop) -> None:
        if len(self.storage.place) != loop.system.n:
            self.storage.listed(loop)

    def post_neighbor(self, loop) -> None:
        self.storage.listed(loop)

    def end_of_step(self, loop) -> None:
        """Mix the velocities with random ones, drawn in the order in which LAMMPS keeps atoms."""
        target = self.target(loop)
        loop.sync_out()
        system, mask, state = loop.system, loop.groups[self.group], loop.snapshot()
        dof = self.temp.dof(state)
        if dof < 1.0:
            return
        unit = 0.5 * loop.units.boltz * dof
        rows = self._rows(mask)
        before, held = self.temp.scalar(state), system.v[rows]
        system.v[rows] = normals(self.random, held.size).reshape(held.shape) / np.sqrt(system.atom_masses()[rows])[:, None]
        keep = math.exp(-loop.dt / self.damping)
        mix = math.sqrt((1.0 - keep * keep) * target / self.temp.scalar(state))
        flow = self._flow(state, rows, held)
        system.v[rows] = (held - flow) * keep + system.v[rows] * mix + flow
        self.energy += unit * (before - self.temp.scalar(state))
        loop.sync_in()

    def _rows(self, mask: np.ndarray) -> np.ndarray:
        """The atoms of a group in the order in which LAMMPS keeps them."""
        rows = np.empty(len(mask), np.int64)
        rows[self.storage.place] = np.arange(len(mask))
        return rows if mask.all() else rows[mask[rows]]

    def _flow(self, state, rows, held) -> np.ndarray | float:
        """The bias of the velocities before, `held`: a flow is that of the random velocities, which LAMMPS measured last."""
        if not self.temp.bias:
            return 0.0
        v = state.system.v
        if not self.temp.hides and self.temp.style != "temp/region":
            return (v - self.temp.remove_bias(state))[rows]
        drawn = v.copy()
        v[rows] = held
        flow = (v - self.temp.remove_bias(state))[rows]
        v[:] = drawn
        return flow

    def scalar(self) -> float:
        """Energy taken out of the atoms so far, energy units."""
        return self.energy

    def state(self) -> dict:
        """The energy taken out, and where the random numbers are."""
        r = self.random
        saved = math.nan if r._saved is None else r._saved
        return {"energy": self.energy, "random": np.array([*r._u, r._c, r._i, r._j, saved])}

    def restore(self, state: dict) -> None:
        r, numbers = self.random, [float(n) for n in state["random"]]
        self.energy, r._u, r._c, r._i, r._j = state["energy"], numbers[:97], numbers[97], int(numbers[98]), int(numbers[99])
        r._saved = None if math.isnan(numbers[100]) else numbers[100]
