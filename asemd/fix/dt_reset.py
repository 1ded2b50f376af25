r"""Choose the timestep anew every N steps, so that no atom of the group moves further than a limit in one step.

.. math:: \Delta t = \min_i \left( \frac{x_{max}}{|v_i|}, \sqrt{\frac{2 m_i x_{max}}{|F_i|}}, \frac{e_{max}}{|v_i| |F_i|} \right)

and less where both together go further; within Tmin and Tmax. For energetic events: collision cascades, overlapping atoms.

Source: LAMMPS manual, fix dt/reset. Arguments: N, Tmin, Tmax (NULL: no limit), Xmax; emax; units box or lattice. Units: time, distance,
energy. Output: a scalar, the last step on which the timestep changed.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.words import choice, number, take, whole

FREE = ("nve", "nve/sphere", "nve/asphere", "nve/noforce", "move", "nvt", "npt", "nph", "nvt/sphere", "npt/sphere", "nph/sphere",
        "nvt/asphere", "npt/asphere", "nph/asphere")        # of those that move atoms: they look at the timestep of each step


class DtReset(Fix):
    """A timestep that follows the fastest atom.

    Parameters
    ----------
    group : str
        The atoms that are looked at.
    every : int
        Steps between two looks.
    shortest, longest : float, optional
        Limits of the timestep, time units of the scene.
    xmax : float
        Longest way in one step, distance units.
    emax : float, optional
        Most energy that an atom may take up in one step, energy units.

    Raises
    ------
    InputError
        A number out of its range; at the start of a run, a fix that moves atoms with numbers that belong to one timestep.
    """

    style = "dt/reset"

    def __init__(self, group: str = "all", every: int = 1, shortest: float | None = None, longest: float | None = None, xmax: float = 0.1,
                 emax: float | None = None):
        super().__init__(group)
        if every < 1 or not xmax > 0.0:
            raise InputError(f"fix dt/reset: N must be at least 1 and Xmax positive, got {every} and {xmax:g}")
        if any(t is not None and t < 0.0 for t in (shortest, longest)) or (None not in (shortest, longest) and shortest >= longest):
            raise InputError("fix dt/reset: Tmin must be below Tmax, and neither negative")
        if emax is not None and not emax > 0.0:
            raise InputError(f"fix dt/reset: emax must be positive, got {emax:g}")
        self.every, self.shortest, self.longest, self.xmax, self.emax = every, shortest, longest, xmax, emax
        self.last, self.scene, self.words = 0, None, []

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix dt/reset"
        every, *limits, xmax = take(words, 4, f"{what} N Tmin Tmax Xmax")
        limits = [None if w == "NULL" else number(w, f"{what} {n}") for w, n in zip(limits, ("Tmin", "Tmax"))]
        rest, lattice, emax = words[4:], True, None
        while rest:
            if rest[0] not in ("emax", "units"):
                raise InputError(f"{what}: unknown keyword {rest[0]!r}{nearest(rest[0], ('emax', 'units'))}")
            value = take(rest[1:], 1, f"{what} {rest[0]}")[0]
            if rest[0] == "emax":
                emax = number(value, f"{what} emax")
            else:
                lattice = choice(value, ("lattice", "box"), f"{what} units") == "lattice"
            rest = rest[2:]
        scale = float(session.scene.lattice.spacings[0]) if lattice and session.scene.lattice is not None else 1.0
        fix = cls(group, whole(every, f"{what} N"), *limits, number(xmax, f"{what} Xmax") * scale, emax)
        fix.scene, fix.words = session.scene, list(words)
        return fix

    def to_lammps(self) -> list[str]:
        limits = ["NULL" if t is None else repr(t) for t in (self.shortest, self.longest)]
        emax = [] if self.emax is None else ["emax", repr(self.emax)]
        return list(self.words) or [str(self.every), *limits, repr(self.xmax), *emax, "units", "box"]

    def setup(self, loop) -> None:
        for fix in loop.fixes:
            if fix.integrates and fix.style not in FREE:
                raise InputError(f"fix dt/reset does not work with fix {fix.id} (style {fix.style}), which belongs to one timestep: "
                                 f"use one of {' '.join(FREE)}")
        self.end_of_step(loop)

    def end_of_step(self, loop) -> None:
        """Choose the timestep."""
        loop.sync_out()
        system, mask, u = loop.system, loop.groups[self.group], loop.units
        dt = self.choose(system.v[mask], system.f[mask], system.atom_masses()[mask], u)
        if self.shortest is not None:
            dt = max(dt, self.shortest)
        if self.longest is not None:
            dt = min(dt, self.longest)
        if dt == loop.dt or not math.isfinite(dt):
            return
        self.last = loop.step
        if self.scene is not None:
            self.scene.step = loop.step
            self.scene.set_dt(dt)
        loop.dt = dt

    def choose(self, v: np.ndarray, f: np.ndarray, mass: np.ndarray, u) -> float:
        """The longest timestep that the limits allow for these atoms."""
        speed, force = np.sqrt((v * v).sum(axis=1)), np.sqrt((f * f).sum(axis=1))
        with np.errstate(divide="ignore"):
            dt = np.minimum(self.xmax / speed, np.sqrt(2.0 * self.xmax * mass / (u.ftm2v * force)))
            if self.emax is not None:
                dt = np.minimum(dt, self.emax / (speed * force) / math.sqrt(u.ftm2v * u.mvv2e))
        finite = np.isfinite(dt)
        dt, v, f, mass = dt[finite, None], v[finite], f[finite], mass[finite, None]
        way = dt * v + 0.5 * dt * dt * u.ftm2v * f / mass
        far = np.sqrt((way * way).sum(axis=1))
        dt = np.where(far > self.xmax, dt[:, 0] * self.xmax / np.maximum(far, 1e-300), dt[:, 0])
        return float(dt.min(initial=math.inf))

    def scalar(self) -> float:
        """The last step on which the timestep changed."""
        return float(self.last)

    def state(self) -> dict:
        """The last step on which the timestep changed."""
        return {"last": self.last}

    def restore(self, state: dict) -> None:
        self.last = int(state["last"])
