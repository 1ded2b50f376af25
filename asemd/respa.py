r"""The multiple time step integrator r-RESPA: fast forces on short steps, slow forces on long ones.

Level 1 is the innermost one. Every level kicks the velocities by its own forces with its own step; the innermost one moves the atoms:

.. math:: \Delta t_{l-1} = \Delta t_l / n_l, \qquad \Delta t_N = \Delta t

Source: M. Tuckerman, B. J. Berne, G. J. Martyna, J. Chem. Phys. 97, 1990 (1992); LAMMPS manual, run_style.
"""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.loop import Loop

FORCES = ("bond", "angle", "dihedral", "improper", "pair", "kspace")
# fixes whose force acts on the outermost level, as in LAMMPS
OUTERMOST = ("addforce", "drag", "efield", "indent", "langevin", "restrain", "spring", "spring/self", "wall/harmonic", "wall/lj126",
             "wall/lj93", "wall/lj1043", "wall/morse")


@dataclass
class Levels:
    """How often each level acts, and where each kind of force is.

    Parameters
    ----------
    factors : list of int
        How many steps of a level make one of the next, from the innermost on; one less than there are levels.
    level : dict of str to int
        ``bond angle dihedral improper pair kspace`` -> level, from 1.
    """

    factors: list[int]
    level: dict[str, int] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of levels."""
        return len(self.factors) + 1

    def steps(self, dt: float) -> list[float]:
        """The time step of each level, innermost first, for the outermost step `dt`."""
        out = [dt]
        for factor in reversed(self.factors):
            out.insert(0, out[0] / factor)
        return out

    def forces(self, level: int) -> list[str]:
        """The kinds of forces on a level."""
        return [kind for kind in FORCES if self.level[kind] == level]


class RespaLoop(Loop):
    """A `Loop` whose steps have levels; fixes nve move the atoms.

    Parameters
    ----------
    levels : Levels
    others
        As `Loop`.

    Raises
    ------
    InputError
        A fix that does not know levels.
    """

    def __init__(self, *args, levels: Levels, **keywords):
        super().__init__(*args, **keywords)
        self.levels = levels
        for fix in self.fixes:
            own = set(fix.hooks()) - {"end_of_step"}
            if own and fix.style not in ("nve", *OUTERMOST):
                raise InputError(f"run_style respa does not work with fix {fix.id} (style {fix.style}): use fix nve, fix langevin and "
                                 "forces from outside, or run_style verlet")

    def setup(self, begin=None, end=None, virial: bool = True):
        super().setup(begin, end, virial)
        self._level_forces: list[np.ndarray] = []
        for level in range(1, self.levels.n + 1):
            self._forces(level, True)
            self._level_forces.append(self.state.f.copy())
        return self._total()

    def _make_module(self) -> None:
        super()._make_module()
        self._compiled = False

    def _total(self):
        """The sum of all levels, which everybody sees, and its energies."""
        self.state.f[:] = sum(self._level_forces)
        self.result = self.engine.collect()
        return self.result

    def _python_step(self, energy: bool) -> None:
        self.step += 1
        self._times = self.levels.steps(self.dt)
        self._recurse(self.levels.n, energy)
        self.state.f[:] = sum(self._level_forces)
        self._hook("end_of_step")

    def _recurse(self, level: int, energy: bool) -> None:
        outermost = level == self.levels.n
        for _ in range(1 if outermost else self.levels.factors[level - 1]):
            self._kick(level)
            if level == 1:
                self._drift()
            if outermost:
                self._look_at_list()
            if level > 1:
                self._recurse(level - 1, energy)
            self._forces(level, energy)
            self._level_forces[level - 1][:] = self.state.f
            self._kick(level)

    def _moved(self):
        """Masks of the slots that each fix nve moves."""
        s = self.state
        return [(s.mask & np.int32(self.group_bit(f.group))) != 0 for f in self.fixes if f.integrates]

    def _kick(self, level: int) -> None:
        s, half = self.state, 0.5 * self._times[level - 1]
        for mask in self._moved():
            s.v[:, mask] += half * s.inverse_mass[mask] * self._level_forces[level - 1][:, mask]

    def _drift(self) -> None:
        for mask in self._moved():
            self.state.x[:, mask] += self._times[0] * self.state.v[:, mask]

    def _look_at_list(self) -> None:
        """Once in a step, after the outermost kick: a fresh list if it is time; the forces of the levels keep their atoms."""
        e, s = self.engine, self.settings
        self._ago += 1
        if self._ago < s.delay or self._ago % s.every:
            return
        if s.check and e.k.moved(e.state.x, e.held, e.ns) <= (0.5 * s.skin) ** 2:
            return
        if s.check and self._ago == max(s.every, s.delay):
            e.dangerous += 1
        old, n = e.state.row[:e.ns].copy(), self.system.n
        by_row = np.zeros((len(self._level_forces), 3, n))
        for forces, f in zip(by_row, self._level_forces):
            forces[:, old[old >= 0]] = f[:, :len(old)][:, old >= 0]
        self._rebuild()
        if self.system.n != n:
            raise SimulationError(f"step {self.step}: an atom was lost, which run_style respa does not allow")
        new = e.state.row[:e.ns]
        self._level_forces = [np.zeros_like(e.state.f) for _ in by_row]
        for forces, f in zip(by_row, self._level_forces):
            f[:, :len(new)][:, new >= 0] = forces[:, new[new >= 0]]

    def _forces(self, level: int, energy: bool) -> None:
        """The forces of one level into ``state.f``; of its terms, energies and virials too."""
        e, kinds = self.engine, self.levels.forces(level)
        chosen = [(k, t.kernel(energy, False)) for k, t in enumerate(e.terms) if t.category in kinds]
        if energy:
            for k, _ in chosen:
                e.acc[:, e.terms[k].index] = 0.0

        def work(tid):
            e.k.clear(e.buffers[tid], e.ns)
            arguments = e.arguments(tid)
            for k, kernel in chosen:
                kernel(*arguments[k])
        e.parallel(work)
        if e.threads > 1:
            e.k.add_buffers(e.buffers, e.ns)
        try:
            e.check()
        except SimulationError as error:
            e.store()
            raise SimulationError(f"step {self.step}: {error}") from None
        if level == self.levels.n:
            self._hook("post_force")


__all__ = ["Levels", "RespaLoop"]
