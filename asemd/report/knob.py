r"""Knobs: settings that trade error for run time. One knob, one file in `asemd.report.knobs`; a style or fix may bring its own.

A knob is a subclass of `Knob` with LAMMPS commands as its means, so what is measured is what ``--apply`` writes::

    class Skin(Knob):
        name, title, order = "skin", "neighbour skin", 40

        def needs(self, scene):
            return None if scene.interactions.uses["pair"] else "no pair style, so no neighbour list"

        def values(self, scene):
            return [0.5 * scene.neighbor.skin, scene.neighbor.skin, 2.0 * scene.neighbor.skin]

        def current(self, scene):
            return scene.neighbor.skin

        def commands(self, scene, value, folder):
            return [f"neighbor {value!r} bin"]

A module of `asemd.report.knobs` defines one such class and is found by itself. A style, fix or long-range solver brings knobs as the
attribute ``knobs``: a tuple of classes with these methods, which need not be derived from `Knob`; what they do not say is taken from it.
A fix with constraints, for example, says ``knobs = (Tolerance,)``, its method ``constraint_error(loop)`` gives the error, and::

    class Tolerance:
        name, title, order, metric = "tolerance", "tolerance of constraints", 80, "constraint_error"

        def values(self, scene):
            return [1e-3, 1e-5, 1e-6]

        def current(self, scene):
            return next(f.tolerance for f in scene.fixes.values() if f.style == "shake")

        def commands(self, scene, value, folder):
            ...     # the same fix with that tolerance

An accuracy of long-range forces has ``metric = "force_error"`` and a method ``reference`` that gives the tightest value worth computing:
its forces are then the exact ones for this knob. A class without ``values`` or ``current`` is refused at once.
"""
from __future__ import annotations

import importlib
import inspect
import os
import pkgutil
import warnings
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

from asemd.errors import InputError, InputWarning
from asemd.kspace import KSpace
from asemd.registry import class_of
from asemd.scene import Scene


class Knob(ABC):
    """Something that can be set in several ways.

    Attributes
    ----------
    name, title : str
        The word it is called by, and what people call it.
    unit : str
        ``time``, ``distance`` or empty.
    order : int
        Small numbers are measured and applied first.
    metric : str
        The error that its curve shows: an attribute of `asemd.report.result.Point`.
    model : bool
        Other values mean another model, not the same one less well computed: its values are measured, never recommended; `remark` says
        why.
    worth : float
        How many times faster it must make a run to be recommended.
    excludes : tuple of str
        Knobs that cannot be turned together with this one.
    fixes : str
        Which fixes its runs have: ``nve`` or ``own``, see `asemd.report.nve.run`.
    """

    name: ClassVar[str] = ""
    title: ClassVar[str] = ""
    unit: ClassVar[str] = ""
    order: ClassVar[int] = 50
    metric: ClassVar[str] = "force_error"
    model: ClassVar[bool] = False
    remark: ClassVar[str] = "another model"
    worth: ClassVar[float] = 1.03
    excludes: ClassVar[tuple[str, ...]] = ()
    fixes: ClassVar[str] = "nve"

    def needs(self, scene: Scene) -> str | None:
        """Why this scene has no such knob, or None if it has."""
        return None

    @abstractmethod
    def values(self, scene: Scene) -> list[Any]:
        """The values to try, the most telling ones first; the present one need not be among them."""

    @abstractmethod
    def current(self, scene: Scene) -> Any:
        """The value that the scene has; None if it has none of these."""

    def duration(self, scene: Scene, value: Any) -> float:
        """Time units that a run must cover to tell something about this value, if the budget allows it; 0: as long as the others."""
        return 0.0

    def reference(self, scene: Scene) -> Any:
        """The value whose forces are the exact ones for this knob; None: those of the scene itself, in double precision."""
        return None

    def commands(self, scene: Scene, value: Any, folder: str) -> list[str]:
        """LAMMPS commands that set the value; files they read are written into `folder`."""
        return []

    def options(self, value: Any) -> list[str]:
        """Words of ``asemd run`` that set the value, for what no command says."""
        return []

    def apply(self, scene: Scene, value: Any, folder: str) -> None:
        """Set the value on a scene that may be changed."""
        commands = self.commands(scene, value, folder)
        clear_tables(commands)
        execute(scene, commands)

    def risk(self, value: Any) -> str:
        """Why a value is measured but never recommended, even if its errors are small; empty if it may be."""
        return ""

    def label(self, value: Any) -> str:
        """The value in a few characters."""
        return f"{value:g}" if isinstance(value, float) else str(value)

    def phrase(self, value: Any) -> str:
        """The value in a sentence: ``timestep 2``."""
        return f"{self.title} {self.label(value)}"

    def number(self, value: Any, position: int) -> float:
        """Where the value stands on an axis."""
        return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else float(position)


def execute(scene: Scene, commands: Sequence[str]) -> None:
    """Carry out LAMMPS commands on a scene, silently."""
    from asemd.lammps.session import Session
    session = Session(scene=scene, passive=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputWarning)
        for command in commands:
            session.execute(command)


def writes(command: str) -> str:
    """The table file that a command writes (it appends to it), empty for other commands."""
    words = command.split()
    return words[-2] if words[0] in ("pair_write", "bond_write", "angle_write", "dihedral_write") else ""


def clear_tables(commands: Sequence[str]) -> None:
    """Remove table files that commands are about to write."""
    for path in filter(None, map(writes, commands)):
        if os.path.exists(path):
            os.remove(path)


def all_knobs(scene: Scene) -> list[Knob]:
    """Every knob: those of the package, and those that styles and fixes of the scene bring along; in their order."""
    from asemd.report import knobs as package
    found: dict[str, Knob] = {}
    for module in pkgutil.iter_modules(package.__path__):
        loaded = importlib.import_module(f"{package.__name__}.{module.name}")
        for cls in vars(loaded).values():
            if inspect.isclass(cls) and issubclass(cls, Knob) and cls.__module__ == loaded.__name__ and cls.name:
                found[cls.name] = cls()
    for owner in owners(scene):
        for cls in getattr(owner, "knobs", ()):
            found[cls.name] = adopt(cls)
    return sorted(found.values(), key=lambda knob: (knob.order, knob.name))


def owners(scene: Scene) -> list:
    """What may bring knobs: styles in use and fixes, long-range solvers among them."""
    styles = [use.style for uses in scene.interactions.uses.values() for use in uses]
    solver = scene.interactions.kspace.split()[0]
    return [*styles, *scene.fixes.values(), *([] if solver == "none" else [class_of("kspace", solver, KSpace)])]


def adopt(cls: type) -> Knob:
    """A knob of that class; what it does not define comes from `Knob`.

    Raises
    ------
    InputError
        It has no name, or no method ``values`` or ``current``.
    """
    made = cls if issubclass(cls, Knob) else type(cls.__name__, (cls, Knob), {})
    missing = sorted(made.__abstractmethods__)
    if missing or not made.name:
        raise InputError(f"report: class {cls.__name__} is no knob: it lacks {', '.join(missing) or 'a name'}")
    return made()


def nice(x: float) -> float:
    """Rounded to six digits, as people write numbers."""
    return float(f"{x:.6g}")


def spread(x: float, factors: Sequence[float]) -> list[float]:
    """Multiples of a number, rounded."""
    return [x if f == 1.0 else nice(f * x) for f in factors]
