"""What the checks look at: a copy of a scene, and what several of them want to know about it, worked out once."""
from __future__ import annotations

import copy
import os
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from asemd import units as unit_styles
from asemd.engine import Engine
from asemd.errors import AsemdError, InputError
from asemd.result import Settings


@dataclass
class Case:
    """One run to be: system, interactions, and how it is going to be moved.

    Attributes
    ----------
    source : str
    system : asemd.system.System
        A copy.
    interactions : asemd.forcefield.Interactions
    settings : asemd.result.Settings
    fixes : dict
        ID -> fix; empty for atoms without a script.
    groups : dict
        Group -> (n,) bool.
    dt : float or None
        Timestep; None: not known.
    respa : asemd.respa.Levels or None
    scene : asemd.scene.Scene or None
        Where all this comes from, if there is a script; not to be changed.
    force : bool
        What would be an error because of its numbers alone is a warning: the user knows.
    relaxes : bool
        The script minimises the energy before this run, so that these positions are not those of the run.
    where : str
        The run of the script, if not the first one.
    """

    source: str
    system: Any
    interactions: Any
    settings: Settings = field(default_factory=Settings)
    fixes: dict[str, Any] = field(default_factory=dict)
    groups: dict[str, np.ndarray] = field(default_factory=dict)
    dt: float | None = None
    respa: Any = None
    scene: Any = None
    force: bool = False
    relaxes: bool = False
    where: str = ""

    @property
    def units(self):
        """Constants of the unit style."""
        return unit_styles.get(self.system.units)

    def ids(self, rows) -> tuple[int, ...]:
        """Ids of atoms by their rows."""
        return tuple(int(i) for i in np.atleast_1d(self.system.id[np.asarray(rows, int)]))

    @cached_property
    def masses(self) -> np.ndarray:
        """(n,) masses; 1 where there is none."""
        return np.nan_to_num(np.asarray(self.system.atom_masses(), float), nan=1.0)

    @cached_property
    def engine(self) -> Engine:
        """Forces of the scene; not evaluated yet."""
        return Engine(copy.deepcopy(self.system), self.interactions, self.settings)

    @cached_property
    def _evaluated(self):
        try:
            return self.engine.compute(), None
        except AsemdError as e:
            return None, e

    @property
    def result(self):
        """Energy and forces, None where they do not exist; `failure` says why."""
        return self._evaluated[0]

    @property
    def failure(self) -> AsemdError | None:
        """Why there are no forces."""
        return self._evaluated[1]


def case_of(source, force: bool = False, dt: float | None = None) -> Case:
    """The case of a script, a scene or atoms.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        A script is executed up to its first run; atoms need `asemd.ForceField` as calculator.
    dt : float, optional
        Timestep in time units of the scene, instead of the scene's.

    Raises
    ------
    InputError
        A mistake in the script, missing coefficients, atoms without a force field.
    """
    from asemd.scene import Scene
    if isinstance(source, (str, os.PathLike)):
        from asemd.check.stages import of_script
        found = of_script(os.fspath(source))
    elif isinstance(source, Scene):
        found = of_scene(source)
    else:
        found = _of_atoms(source)
    found.force, found.dt = force, dt if dt is not None else found.dt
    return found


def of_scene(scene, source: str = "scene") -> Case:
    """The case of a scene as it is now."""
    system = scene.need_system("check")
    scene.interactions.check_complete(system)
    return Case(source, copy.deepcopy(system), scene.interactions, scene.settings(), dict(scene.fixes), dict(scene.groups), scene.dt,
                scene.respa, scene)


def _of_atoms(atoms) -> Case:
    from asemd.calculator import ForceField
    calc = getattr(atoms, "calc", None)
    if not isinstance(calc, ForceField):
        raise InputError("check needs the path of a LAMMPS script, a Scene, or atoms whose calculator is asemd.ForceField")
    system = calc._system(atoms)
    calc.interactions.check_complete(system)
    return Case(repr(calc), copy.deepcopy(system), calc.interactions, calc.neighbor_settings(atoms))
