"""The precision of pair forces: double, or single with sums in double."""
from __future__ import annotations

from asemd.cluster_term import in_double
from asemd.engine import Engine
from asemd.report.knob import Knob


class Precision(Knob):
    """``--precision``."""

    name, title, order = "precision", "precision", 30

    def needs(self, scene):
        engine = Engine(scene.system.copy(), scene.interactions, scene.settings())
        if engine.mode == "none":
            return "no pair style: bonded forces are always in double precision"
        names, why = in_double(engine)
        if len(names) == len({t.style.name for t in engine.pair_terms + engine.many_terms}):
            return f"pair style {', '.join(names)} is always computed in double precision here: {why}"
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
