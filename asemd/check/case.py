"""What the checks look at: a copy of a scene, and what several of them want to know about it, worked out once."""
from __future__ import annotations

import copy
import os
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from asemd import units as unit_styles
from asemd.check.items import Items, items_of
from asemd.check.motions import Motion, motions, temperature
from asemd.engine import Engine
from asemd.errors import AsemdError
from asemd.report.copies import copied, of_atoms
from asemd.result import Settings
from asemd.scene import Scene


@dataclass
class Case:
    """One run to be: system, interactions, and how it is going to be moved.

    Attributes
    ----------
    source : str
    system : asemd.system.System
        Not to be changed: engines get copies.
    interactions : asemd.forcefield.Interactions
    settings : asemd.result.Settings
    fixes : dict
        ID -> fix; empty for atoms without a script.
    groups : dict
        Group -> (n,) bool.
    dt : float or None
        Timestep; None: not known.
    respa : asemd.respa.Levels or None
    scene : asemd.scene.Scene
        Where all this comes from; not to be changed.
    force : bool
        What would be an error because of its numbers alone is a warning: the user knows.
    relaxes : bool
        The script minimises the energy before this run, so that these positions are not those of the run.
    where : str
        The run of the script, if not the first one.
    warnings : list of str
        What a run of the script would warn of before it begins.
    later : list of Case
        Runs of the script after this one that differ in timestep, force field or fixes; their positions are those of the first.
    """

    source: str
    system: Any
    interactions: Any
    settings: Settings = field(default_factory=Settings)
    fixes: dict[str, Any] = field(default_factory=dict)
    groups: dict[str, np.ndarray] = field(default_factory=dict)
    dt: float | None = None
    respa: Any = None
    scene: Scene | None = None
    force: bool = False
    relaxes: bool = False
    where: str = ""
    warnings: list[str] = field(default_factory=list)
    later: list[Case] = field(default_factory=list)

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
    def spacing(self) -> float:
        """Mean distance of neighbours, or the median length of the shortest kind of bond if that is less."""
        box, n = self.system.box, max(self.system.n, 1)
        mean = (box.volume / n) ** (1.0 / 3.0) if self.system.dimension == 3 else (box.volume / box.lengths[2] / n) ** 0.5
        return min([mean, *(float(np.median(items.column("r"))) for items in self.items if items.column("r") is not None)])

    @property
    def settled(self) -> bool:
        """Whether the run begins with these positions."""
        return not self.relaxes and not self.where

    @property
    def gentle(self) -> bool:
        """Whether the script looks after bad contacts itself: it minimises first, or limits the steps of atoms (fix nve/limit)."""
        return self.relaxes or any(f.style == "nve/limit" for f in self.fixes.values())

    @cached_property
    def moving(self) -> np.ndarray:
        """(n,) bool: atoms that a fix moves; all of them if no fix does, for then something else will."""
        movers = [self.groups[f.group] for f in self.fixes.values() if f.integrates and f.group in self.groups]
        return np.any(movers, axis=0) if movers else np.ones(self.system.n, bool)

    def vibrates(self, category: str, atoms: np.ndarray) -> np.ndarray:
        """(m,) bool: items (m, k rows) with an atom that moves, and held by no fix.

        A fix that holds some has ``constrained_items(system, category, atoms)``, which returns the like.
        """
        free = self.moving[atoms].any(axis=1)
        for fix in self.fixes.values():
            if hasattr(fix, "constrained_items"):
                free &= ~fix.constrained_items(self.system, category, atoms)
        return free

    @cached_property
    def items(self) -> list[Items]:
        """Coordinates and frequencies of all bonded items."""
        return items_of(self)

    @cached_property
    def motions(self) -> list[Motion]:
        """Kinds of fast motion, the fastest first."""
        return motions(self)

    @cached_property
    def temperature(self) -> float:
        """The highest temperature in sight."""
        return temperature(self)

    @cached_property
    def engine(self) -> Engine:
        """Forces of the scene; not evaluated yet."""
        return Engine(copy.deepcopy(self.system), self.interactions, self.settings)

    @cached_property
    def _evaluated(self):
        try:
            result = self.engine.compute()
            self.forces = self.engine.system.f.copy()
            return result, None
        except AsemdError as e:
            return None, e

    @property
    def result(self):
        """Energy, None where there is none; `failure` says why. With it come `forces (n, 3)`."""
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
    if isinstance(source, (str, os.PathLike)):
        from asemd.check.stages import of_script
        found = of_script(os.fspath(source))
    elif isinstance(source, Scene):
        found = of_scene(copied(source))
    else:
        found = of_scene(of_atoms(source), repr(getattr(source, "calc", None)))
        found.dt = None
    found.force, found.dt = force, dt if dt is not None else found.dt
    return found


def of_scene(scene, source: str = "scene") -> Case:
    """The case of a scene, which becomes the case's own: it must be a copy."""
    system = scene.need_system("check")
    scene.interactions.check_complete(system)
    settings = replace(scene.settings(), precision="double")      # differences of forces need their digits
    return Case(source, system, scene.interactions, settings, dict(scene.fixes), dict(scene.groups), scene.dt, scene.respa, scene)
