"""Tolerance of constraints: fewer iterations, or bonds nearer to their lengths."""
from __future__ import annotations

from asemd.report.knob import Knob

VALUES = (1e-3, 1e-5, 1e-6, 1e-4, 1e-8)
STYLES = ("shake", "rattle")


class Tolerance(Knob):
    """Where the iteration of fix shake or rattle stops."""

    name, title, order, metric = "tolerance", "tolerance of constraints", 80, "constraint_error"

    def _fix(self, scene):
        return next((f for f in scene.fixes.values() if f.style in STYLES), None)

    def needs(self, scene):
        fix = self._fix(scene)
        if fix is None:
            return "no fix shake or rattle"
        return "the constraints are solved without iterations (settle)" if fix.settle else None

    def values(self, scene):
        return list(VALUES)

    def current(self, scene):
        return self._fix(scene).tolerance

    def commands(self, scene, value, folder):
        fix = self._fix(scene)
        return [f"fix {fix.id} {fix.group} {fix.style} {value!r} {' '.join(fix.to_lammps()[1:])}"]
