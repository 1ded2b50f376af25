"""The compiled time loop as an ASE dynamics: observers, trajectories and log files as everywhere in ASE, compiled steps in between."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ase.md.md import MolecularDynamics as ASEMolecularDynamics

from asemd import units as unit_styles
from asemd.calculator import ForceField
from asemd.errors import InputError
from asemd.fix import Fix
from asemd.loop import Loop


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
    trajectory, logfile, loginterval, **kwargs
        As in ``ase.md``.

    Notes
    -----
    Between two calls of observers no Python runs. Constraints of ASE are not applied: use fixes (setforce, freeze) instead; atoms with
    constraints are refused.
    """

    def __init__(self, atoms, timestep: float, fixes: Sequence[Fix] | None = None, groups=None, trajectory=None, logfile=None,
                 loginterval: int = 1, **kwargs):
        if not isinstance(atoms.calc, ForceField):
            raise InputError("asemd.MolecularDynamics needs atoms whose calculator is asemd.ForceField; other calculators run under ase.md")
        if atoms.constraints:
            raise InputError("asemd.MolecularDynamics does not apply ASE constraints: use fixes such as asemd.fix.SetForce, or ase.md")
        if fixes is None:
            from asemd.fix.nve import NVE
            fixes = [NVE()]
        self.fixes = list(fixes)
        self.groups = {"all": np.ones(len(atoms), bool), **(groups or {})}
        super().__init__(atoms, timestep, trajectory=trajectory, logfile=logfile, loginterval=loginterval, **kwargs)
        self._loop: Loop | None = None

    def _factors(self):
        units = self.atoms.calc.units
        return {d: unit_styles.factor(d, units) for d in ("time", "distance", "velocity", "force", "energy")}

    def _start(self, steps: int) -> Loop:
        """A loop that starts from the atoms as they are now."""
        calc, u = self.atoms.calc, self._factors()
        system = calc._system(self.atoms)
        system.v[:] = self.atoms.get_velocities() / u["velocity"]
        if self._loop is None or self._loop.system.n != system.n:
            self._loop = Loop(system, calc.interactions, calc.settings, self.fixes, self.groups, self.dt / u["time"], self.nsteps)
        else:
            self._loop.system = system
            self._loop.engine.update(system)
            self._loop.dt, self._loop.step = self.dt / u["time"], self.nsteps
        self._start_x = self.atoms.get_positions()
        self._loop.setup(self.nsteps, self.nsteps + steps)
        return self._loop

    def _publish(self, result) -> None:
        """Positions, momenta and results of the loop to the atoms."""
        loop, u, atoms = self._loop, self._factors(), self.atoms
        system = loop.system
        x = system.box.unwrap(system.x, system.image) * u["distance"]
        atoms.arrays["positions"][:] = x
        atoms.set_momenta(system.v * u["velocity"] * self.masses, apply_constraint=False)
        calc = atoms.calc
        calc.atoms = atoms.copy()
        energy = result.potential * u["energy"]
        calc.results = {"energy": energy, "free_energy": energy, "forces": result.forces * u["force"]}
        if atoms.cell.rank == 3:
            from asemd.calculator import VOIGT
            calc.results["stress"] = -(result.virial + result.virial_of.get("tail", 0.0))[VOIGT] * u["energy"] / atoms.get_volume()

    def step(self):
        """One step (for code that drives the dynamics by hand)."""
        loop = self._start(1)
        self._publish(loop.advance(1))
        loop.finish()

    def irun(self, steps=50):
        """As in ASE, but compiled from one observer call to the next; yields whenever Python has control."""
        self.max_steps = self.nsteps + steps
        if self.nsteps == 0:
            self._refresh_properties()
            self.log()
            self.call_observers()
        yield self.nsteps == self.max_steps
        loop = self._start(steps) if steps else None
        while self.nsteps < self.max_steps:
            stretch = min([self.max_steps - self.nsteps] + [
                interval - self.nsteps % interval if interval > 0 else max(1, -interval - self.nsteps)
                for _, interval, _, _ in self.observers])
            self._publish(loop.advance(stretch))
            self.nsteps += stretch
            self.log()
            self.call_observers()
            yield self.nsteps == self.max_steps
        if loop is not None:
            loop.finish()

    def todict(self):
        return {"type": "molecular-dynamics", "md-type": "asemd", "timestep": self.dt, "fixes": [f.style for f in self.fixes]}
