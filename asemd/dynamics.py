"""The compiled time loop as an ASE dynamics: observers, trajectories and log files as everywhere in ASE, compiled steps in between."""
from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence

import numpy as np
from ase.constraints import FixAtoms, FixCartesian
from ase.md.md import MolecularDynamics as ASEMolecularDynamics

from asemd import units as unit_styles
from asemd.atom_style import UNITS
from asemd.calculator import ForceField
from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix.setforce import SetForce
from asemd.loop import Loop
from asemd.seen import same
from asemd.topology import Topology

ROUND_OFF = 1e-13       # positions that change by less, relative to the largest, have only been wrapped


class MolecularDynamics(ASEMolecularDynamics):
    """Dynamics of ``ase.Atoms`` with a `ForceField` under a list of fixes.

    Parameters
    ----------
    atoms : ase.Atoms
        With a `asemd.ForceField` as calculator.
    timestep : float
        In ASE's unit of time (``2 * ase.units.fs``).
    fixes : sequence of Fix, optional
        By default constant energy, `asemd.fix.NVE`. Their numbers are in the units of the force field (``atoms.calc.units``).
    groups : mapping, optional
        Name -> (n,) bool, for fixes that act on some atoms.
    watchdog : bool
        Stop a run that has come apart (`asemd.watchdog`).
    trajectory, logfile, loginterval, **kwargs
        As in ``ase.md``.

    Raises
    ------
    InputError
        Another calculator, a constraint other than FixAtoms and FixCartesian.

    Notes
    -----
    `run` goes from one call of an observer to the next without Python; `irun` yields after every step, as in ASE. Positions are continuous:
    atoms are not wrapped. A fix that changes the box changes ``atoms.cell``, whose corner stays put. Observers may change the atoms; the
    loop then starts again from there. Runs in pieces equal one long run.

    FixAtoms and FixCartesian act as `asemd.fix.SetForce` with the velocities set to zero; forces of fixes that are part of the calculator
    act without being named here. After Ctrl-C the atoms are those of the last complete step, after an error those of the last observer
    call; the error tells what went wrong, its attribute ``verdict.good`` is the last good state, and with a log file or trajectory that
    state is written beside it (``NAME.last_good.extxyz``).
    """

    def __init__(self, atoms, timestep: float, fixes: Sequence[Fix] | None = None, groups=None, trajectory=None, logfile=None,
                 loginterval: int = 1, watchdog: bool = True, **kwargs):
        if not isinstance(atoms.calc, ForceField):
            raise InputError("asemd.MolecularDynamics needs atoms whose calculator is asemd.ForceField; other calculators run under ase.md")
        if fixes is None:
            from asemd.fix.nve import NVE
            fixes = [NVE()]
        self.fixes, self.groups, self.watchdog = list(fixes), dict(groups or {}), watchdog
        self._held(atoms)
        named = [os.fspath(f) for f in (logfile, trajectory) if isinstance(f, (str, os.PathLike)) and f != "-"]
        self._last_good = f"{named[0]}.last_good.extxyz" if named else ""
        super().__init__(atoms, timestep, trajectory=trajectory, logfile=logfile, loginterval=loginterval, **kwargs)
        self._loop: Loop | None = None

    # ---- atoms -> loop ------------------------------------------------------------------------------------------------------------------
    @staticmethod
    def _held(atoms) -> np.ndarray:
        """(n, 3) bool: components that constraints keep still."""
        held = np.zeros((len(atoms), 3), bool)
        for constraint in atoms.constraints:
            if isinstance(constraint, FixAtoms):
                held[constraint.index] = True
            elif isinstance(constraint, FixCartesian):
                held[constraint.index] |= np.asarray(constraint.mask, bool)
            else:
                raise InputError("asemd.MolecularDynamics knows the constraints FixAtoms and FixCartesian, not "
                                 f"{type(constraint).__name__}: use a fix, or ase.md")
        return held

    def _all_fixes(self) -> tuple[list[Fix], dict[str, np.ndarray], np.ndarray]:
        """The fixes asked for, those of the calculator and of constraints; the groups they act on; the components held still."""
        atoms, calc = self.atoms, self.atoms.calc
        groups = {"all": np.ones(len(atoms), bool)} | {name: np.asarray(mask, bool) for name, mask in self.groups.items()}
        fixes = list(self.fixes)
        for k, load in enumerate(calc.loads):
            masks = {f"load {k} {m}": calc.mask(atoms, name) for m, name in enumerate(load.groups)}
            groups |= masks
            fixes.append(load.fix(*masks))
        held = self._held(atoms)
        for pattern in np.unique(held, axis=0) if len(held) else ():
            if pattern.any():
                name = f"held {len(groups)}"
                groups[name] = (held == pattern).all(axis=1)
                fixes.append(SetForce(name, tuple(0.0 if h else None for h in pattern)))
        return fixes, groups, held

    def _start(self, steps: int) -> Loop:
        """A loop that starts from the atoms as they are now."""
        atoms, calc = self.atoms, self.atoms.calc
        u = {d: unit_styles.factor(d, calc.units) for d in ("time", "velocity")}
        system = calc._system(atoms)
        calc.interactions.check_complete(system)
        fixes, groups, held = self._all_fixes()
        self.masses = atoms.get_masses()[:, None]
        system.v = np.where(held, 0.0, atoms.get_velocities() / u["velocity"])
        self._given = (calc, self.dt, list(self.fixes), dict(self.groups), held)
        self._loop = Loop(system, calc.interactions, calc.neighbor_settings(atoms), fixes, groups, self.dt / u["time"], self.nsteps)
        self._forces_are_own = not any("post_force" in fix.hooks() for fix in fixes)
        self._loop.say, self._charges = print, None if system.q is None else system.q.copy()
        self._loop.watchdog.on = self.watchdog
        self._loop.watchdog.path, self._loop.watchdog.save = self._last_good, self._save
        before = system.box.unwrap(system.x, system.image)
        self._loop.setup(self.nsteps, self.nsteps + steps)
        here = system.box.unwrap(system.x, system.image)
        moved = np.where(abs(here - before) > ROUND_OFF * abs(here).max(initial=0.0), here - before, 0.0)      # by constraints
        self._from = atoms.get_positions() + moved * unit_styles.factor("distance", calc.units), here, system.box
        return self._loop

    # ---- loop -> atoms ------------------------------------------------------------------------------------------------------------------
    def _move(self, atoms, system) -> None:
        """Positions and momenta of a system to atoms, charges, dipoles and rotation too where they change."""
        u = {d: unit_styles.factor(d, self.atoms.calc.units) for d in ("distance", "velocity")}
        there, here, before = self._from
        now, box = system.box.unwrap(system.x, system.image), system.box
        if self._loop.engine.box_moves:     # the corner of the cell stays; atoms keep the periodic images they were given in
            images = (there / u["distance"] - here) @ before.inverse
            atoms.arrays["positions"][:] = (now - box.origin + before.origin + images @ box.cell) * u["distance"]
            cell = atoms.cell.array
            atoms.set_cell(np.where(cell.any(axis=1)[:, None], box.cell * u["distance"], cell))
        else:       # atoms that do not move keep their positions to the last bit
            atoms.arrays["positions"][:] = there + (now - here) * u["distance"]
        atoms.set_momenta(system.v * u["velocity"] * self.masses, apply_constraint=False)
        if self._charges is not None and (found := system.q != self._charges).any():      # by fixes
            atoms.arrays["initial_charges"][found] = system.q[found] * unit_styles.factor("charge", self.atoms.calc.units)
        solid = {"quaternions", "angmom", "torque"} if "shape" in atoms.arrays else set()
        for name in {"mu", "omega", "torque", "angmom", "quaternions"} & set(system.extra) & (solid | set(atoms.arrays)):
            if name not in atoms.arrays:
                atoms.set_array(name, np.zeros_like(system.extra[name]))
            atoms.arrays[name][:] = system.extra[name] * unit_styles.factor(UNITS[name], self.atoms.calc.units)

    def _save(self, system, path: str) -> None:
        """Write the last good state of a run that failed."""
        from ase.io import write
        atoms = self.atoms.copy()
        self._move(atoms, system)
        atoms.info["step"] = system.step
        write(path, atoms, format="extxyz")

    def _publish(self, result) -> None:
        """Positions, momenta and results of the loop to the atoms."""
        atoms, calc = self.atoms, self.atoms.calc
        self._move(atoms, self._loop.system)
        if result is not None:
            results = calc.convert(result, atoms, self._loop.system, of_loop=True)
            if not self._forces_are_own:     # the loop's forces hold those of thermostats too: the calculator computes its own when asked
                del results["forces"]
            calc.adopt(atoms, results)

    def _changed(self) -> bool:
        """Whether the loop cannot go on: the atoms, the fixes or the timestep are not those it has left."""
        atoms = self.atoms
        if self._loop is None or self._loop.step != self.nsteps:
            return True
        calc, dt, fixes, groups, held = self._given
        if calc is not atoms.calc or dt != self.dt or fixes != self.fixes or any(groups.get(k) is not m for k, m in self.groups.items()):
            return True
        arrays, topology = self._state()
        return (any(not same(array, self._left[0].get(name)) for name, array in arrays.items()) or topology != self._left[1]
                or not np.array_equal(held, self._held(atoms)))

    def _state(self) -> tuple[dict[str, np.ndarray | None], Topology | None]:
        """What the loop goes on from: other evaluations with the same calculator do not matter."""
        atoms = self.atoms
        arrays = self.atoms.calc._view(atoms) | {"momenta": atoms.arrays.get("momenta"), "masses": atoms.get_masses()}
        return arrays, getattr(atoms, "topology", None)

    def _advance(self, steps: int, begin: int, end: int) -> None:
        """That many compiled steps."""
        if self._changed():
            self._start(end - self.nsteps)
        loop = self._loop
        loop.begin, loop.end = begin, end
        try:
            self._publish(loop.advance(steps))
        except KeyboardInterrupt:
            self._publish(None)
            self.nsteps = loop.step
            loop.finish()
            self._loop = None
            raise
        except Exception:
            self._loop = None
            raise
        self._leave()

    def _leave(self) -> None:
        """Note what the atoms are like that the loop has left."""
        arrays, topology = self._state()
        self._left = {k: None if a is None else a.copy() for k, a in arrays.items()}, None if topology is None else topology.copy()

    def _refresh_properties(self) -> None:
        """Energy and forces of the start; those with friction and noise are the loop's."""
        calc = self.atoms.calc
        if calc.interactions is None:
            calc._system(self.atoms)
        if not any(use.style.stirred for use in calc.interactions.uses["pair"]):
            return super()._refresh_properties()
        self._publish(self._start(self.max_steps - self.nsteps).result)
        self._leave()

    def step(self):
        """One step (for code that drives the dynamics by hand)."""
        self._advance(1, self.nsteps, self.nsteps + 1)
        self._loop.finish()

    def _stretches(self, steps: int, longest: int) -> Iterator[bool]:
        begin, steps = self.nsteps, math.ceil(steps)      # as many as ASE makes of 2.5
        self.max_steps = end = begin + steps
        if self.nsteps == 0:
            self._refresh_properties()
            self.log()
            self.call_observers()
        yield self.nsteps == self.max_steps
        while self.nsteps < end:
            calls = [interval - self.nsteps % interval if interval > 0 else -interval - self.nsteps for _, interval, _, _ in self.observers]
            stretch = min([longest, end - self.nsteps, *(c for c in calls if c > 0)])
            self._advance(stretch, begin, end)
            self.nsteps = self._loop.step
            self.log()
            self.call_observers()
            yield self.nsteps == self.max_steps
            if self._loop is not None and self._loop.halted:
                break
        if self._loop is not None:
            self._loop.finish()

    def irun(self, steps=50):
        """As in ASE: yields before the first and after every step."""
        return self._stretches(steps, 1)

    def run(self, steps=50):
        """As in ASE, but compiled from one observer call to the next."""
        return list(self._stretches(steps, max(steps, 1)))[-1]

    def todict(self):
        return {"type": "molecular-dynamics", "md-type": "asemd", "timestep": self.dt, "fixes": [f.style for f in self.fixes]}
