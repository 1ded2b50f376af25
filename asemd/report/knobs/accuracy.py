"""The accuracy that a long-range solver is asked for: fewer points of its mesh, or better forces."""
from __future__ import annotations

from asemd.kspace import KSpace
from asemd.registry import class_of
from asemd.report.knob import Knob, nice, spread

FACTORS = (10.0, 0.1, 100.0)
FINEST = 1e-7       # the reference; meshes of better ones do not fit into memory
BEYOND = 0.01       # the reference relative to the script's own
OWN = ("force", "mesh", "gewald")       # of kspace_modify: what the accuracy decides otherwise


def solver_class(scene) -> type[KSpace] | None:
    """The class of the solver that the scene asks for."""
    name = scene.interactions.kspace.split()[0]
    return None if name == "none" else class_of("kspace", name, KSpace)


def why_not(scene) -> str | None:
    """Why nothing can be turned on a solver of charges."""
    cls = solver_class(scene)
    if cls is None:
        return "no kspace_style"
    if not cls.adds:
        return f"kspace_style {cls.style} adds nothing"
    if not scene.interactions.kspace_modify.get("compute", True):
        return "kspace_modify compute no"
    q = scene.system.q
    return None if cls.coulomb and q is not None and q.any() else f"kspace_style {cls.style}: no charges"


def accuracy(scene) -> float:
    """What the script asks for."""
    return abs(float(scene.interactions.kspace.split()[1]))


def tight(scene) -> float:
    """An accuracy whose forces count as exact."""
    return nice(min(accuracy(scene), max(BEYOND * accuracy(scene), FINEST)))


def solver_commands(scene, value: float) -> list[str]:
    """The commands that make the solver with another accuracy."""
    style, _, *more = scene.interactions.kspace.split()
    modify = scene.interactions.kspace_lines()[1:]
    return [" ".join(["kspace_style", style, repr(value), *more]), *modify]


class Accuracy(Knob):
    """The number after ``kspace_style``."""

    name, title, order = "accuracy", "solver accuracy", 56

    def needs(self, scene):
        given = [key for key in OWN if scene.interactions.kspace_modify.get(key) not in (None, -1.0, 0.0, (0, 0, 0))]
        return why_not(scene) or (f"kspace_modify {given[0]} stands for the accuracy" if given else None)

    def values(self, scene):
        return [a for a in spread(accuracy(scene), FACTORS) if a <= 0.1]

    def current(self, scene):
        return accuracy(scene)

    def reference(self, scene):
        return tight(scene)

    def commands(self, scene, value, folder):
        return solver_commands(scene, value)
