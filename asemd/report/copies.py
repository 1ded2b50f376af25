"""Scenes to measure on: read from a script, or made from atoms, and copied, so that nothing of the user's is touched."""
from __future__ import annotations

import copy
import math
import os
import warnings
from dataclasses import replace

import numpy as np

from asemd import units as unit_styles
from asemd.errors import AsemdError, InputError
from asemd.lammps.live_coefficients import freeze
from asemd.lammps.session import ACTIONS, Session, Stop
from asemd.lammps.switches import Switches
from asemd.scene import GroupTable, Scene, default_computes

EARLIER = 1000      # steps of runs before the one that is asked for
SILENT = ("write_data", "write_restart", "write_dump", "write_coeff", "group2ndx")      # commands that only write files


class Reader(Session):
    """Executes a script up to one of its runs: no log, no dumps, no restart files, no ``write_data``, no shell.

    Attributes
    ----------
    runs : int
        How many runs were reached.
    where : asemd.errors.Where or None
        The place of the run whose scene is `taken`.
    taken : Scene or None
        The scene at the run that is asked for; with ``at=None`` at the last one reached so far.
    action : str
        The command of that run.
    stopped : str
        With ``at=None``: the error that ended the script, perhaps because a file was not written.
    """

    def __init__(self, switches: Switches | None, at: int | None):
        super().__init__(switches=copy.deepcopy(switches), passive=True)
        if at != 1:
            self.switches.cap = EARLIER if self.switches.cap is None else min(EARLIER, self.switches.cap)
        self.at, self.runs, self.where, self.taken, self.skipped = at, 0, None, None, []
        self.action = self.stopped = ""

    def call(self, name, args):
        if name in SILENT:
            self.skipped.append(name)
            return
        if name not in ACTIONS:
            super().call(name, args)
            return
        scene = self.scene
        scene.need_system(name)
        if name == "run":
            self.runs += 1
            if self.at is None or self.runs == self.at:
                self.where, self.action = self._position, " ".join([name, *args])
                self.scene = self.taken = copied(scene)
                freeze(self)        # copies have no variables
                self.scene = scene
            if self.runs == self.at:
                raise Stop
        dumps, restarts, scene.dumps, scene.restarts = scene.dumps, scene.restarts, {}, {}
        self.passive = False
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                super().call(name, args)
        finally:
            self.passive, scene.dumps, scene.restarts = True, dumps, restarts


def load(source, switches: Switches | None = None, at: int | None = 1) -> Scene:
    """A scene of one's own, to be changed at will.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        A script is executed up to one of its runs; minimisations before it are carried out. No log and no dump is written and no shell
        runs. Atoms need `asemd.ForceField` as calculator.
    switches : asemd.lammps.switches.Switches, optional
        LAMMPS's command line switches, for a script.
    at : int or None
        Which run, from 1; None: the last one. Runs before it are cut to 1000 steps.

    Raises
    ------
    InputError
        A mistake in the script, fewer runs, missing coefficients, atoms without a force field.
    """
    if isinstance(source, (str, os.PathLike)):
        source = read(os.fspath(source), switches, at).taken
    elif not isinstance(source, Scene):
        source = of_atoms(source)
    source.need_system("report")
    source.interactions.check_complete(source.system)
    return copied(source)


def read(path: str, switches: Switches | None = None, at: int | None = 1) -> Reader:
    """The script, executed up to one of its runs (see `load`); without any run up to its end."""
    session = Reader(switches, at)
    try:
        session.file(path)
    except Stop:
        session.label = None
    except AsemdError as error:
        if at is not None or session.taken is None:
            raise
        session.stopped = str(error)
    session.scene.need_system("report")
    if at is not None and session.runs < at and at != 1:
        raise InputError(f"{path} has {session.runs} run{'s' * (session.runs != 1)}, there is no run {at}")
    if session.taken is None:
        session.taken = copied(session.scene)
    return session


def copied(scene: Scene) -> Scene:
    """An independent copy of a scene, without its dumps and restart files."""
    groups = GroupTable()
    groups._slots, groups._masks = list(scene.groups._slots), {name: mask.copy() for name, mask in scene.groups._masks.items()}
    return replace(scene, system=scene.need_system("report").copy(), interactions=copy.deepcopy(scene.interactions), groups=groups,
                   fixes=copy.deepcopy(scene.fixes), computes=copy.copy(scene.computes), dumps={}, restarts={}, restored=None,
                   neighbor=replace(scene.neighbor), thermo=copy.copy(scene.thermo))


def of_atoms(atoms) -> Scene:
    """The scene of ``ase.Atoms`` whose calculator is `asemd.ForceField`, velocities included; it has no fixes of its own."""
    from asemd.calculator import ForceField
    calc = getattr(atoms, "calc", None)
    if not isinstance(calc, ForceField):
        raise InputError("needs the path of a LAMMPS script, a Scene, or atoms whose calculator is asemd.ForceField")
    if calc.loads:
        raise InputError("atoms with added forces: give the script they come from instead")
    system = calc._system(atoms)
    system.v = atoms.get_velocities() / unit_styles.factor("velocity", calc.units)
    scene = Scene(system=system, units=calc.units, dimension=system.dimension, boundary=tuple(system.box.boundary),
                  atom_style=system.atom_style, interactions=calc.interactions, computes=default_computes(), groups=GroupTable(system.n),
                  dt=unit_styles.get(calc.units).dt, neighbor=replace(calc.settings), precision=calc.settings.precision,
                  threads=calc.settings.threads)
    for name in calc.bits:
        if name != "all":
            scene.groups[name] = calc.mask(atoms, name)
    return scene


def warm(scene: Scene, temperature: float, seed: int = 1) -> None:
    """Velocities of a Maxwell distribution without total momentum, scaled to that temperature exactly."""
    system, u = scene.system, unit_styles.get(scene.units)
    mass = system.atom_masses()
    v = np.random.default_rng(seed).standard_normal((system.n, 3)) / np.sqrt(mass)[:, None]
    if system.dimension == 2:
        v[:, 2] = 0.0
    moving = np.zeros(system.n, bool)
    for fix in scene.fixes.values():
        if fix.integrates:
            moving |= scene.groups.mask(fix.group)
    v[~moving if moving.any() else slice(0, 0)] = 0.0
    part = v.any(axis=1)
    if part.sum() > 1:
        v[part] -= (mass[part, None] * v[part]).sum(axis=0) / mass[part].sum()
    dof = max(system.dimension * (int(part.sum()) - 1), 1)
    now = u.mvv2e * float(np.einsum("i,ij,ij->", mass, v, v)) / (dof * u.boltz)
    system.v = v * math.sqrt(temperature / now) if now > 0.0 else v
