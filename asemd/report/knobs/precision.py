"""The precision of pair forces: double, or single with sums in double."""
from __future__ import annotations

from asemd.engine import Engine
from asemd.report.knob import Knob


class Precision(Knob):
    """``--precision``."""

    name, title, order = "precision", "precision", 30

    def needs(self, scene):
        engine = Engine(scene.system.copy(), scene.interactions, scene.settings())
        if engine.mode == "none":
            return "no pair style: bonded forces are always in double precision"
        if engine.mode != "cluster":
            return f"{engine.why}: its pairs are computed one by one, in double precision"
        if engine.expanded or engine.sparse:
            return "the pairs of this scene are computed one by one, in double precision"
        return None

    def values(self, scene):
        return ["double", "mixed"]

    def current(self, scene):
        return scene.precision

    def apply(self, scene, value, folder):
        scene.precision = value

    def options(self, value):
        return ["--precision", value]

    def phrase(self, value):
        return f"{value} precision"
