"""How charges are spread on the mesh of a long-range solver, and how forces are read from it."""
from __future__ import annotations

from asemd.report.knob import Knob
from asemd.report.knobs.accuracy import solver_class, solver_commands, tight, why_not

VALUES = ((5, "ad"), (6, "ik"), (4, "ik"), (7, "ik"), (6, "ad"), (7, "ad"))


class Mesh(Knob):
    """``kspace_modify order N diff ik|ad`` of pppm and its relatives: few points and wide weights, or the other way round."""

    name, title, order = "mesh", "mesh", 58

    def needs(self, scene):
        if why := why_not(scene):
            return why
        style = solver_class(scene).style
        return None if style.startswith("pppm") else f"kspace_style {style} has no such mesh"

    def values(self, scene):
        return list(VALUES)

    def current(self, scene):
        modify = scene.interactions.kspace_modify
        return modify.get("order") or solver_class(scene).usual_order, modify.get("diff", "ik")

    def reference(self, scene):
        return ("accuracy", tight(scene))

    def commands(self, scene, value, folder):
        if value[0] == "accuracy":
            return solver_commands(scene, value[1])
        return [f"kspace_modify order {value[0]} diff {value[1]}"]

    def label(self, value):
        return f"order {value[0]} {value[1]}"

    def phrase(self, value):
        return f"kspace_modify order {value[0]} diff {value[1]}"
