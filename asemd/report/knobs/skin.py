"""The skin of the neighbour list: more pairs to look at, or more lists to build."""
from __future__ import annotations

from asemd.report.knob import Knob, spread

FACTORS = (1.5, 0.5, 2.0, 0.75, 0.25)


class Skin(Knob):
    """Multiples of the script's skin."""

    name, title, unit, order = "skin", "skin", "distance", 40

    def needs(self, scene):
        if not scene.interactions.uses["pair"]:
            return "no pair style, so no neighbour list"
        return None if scene.neighbor.skin > 0.0 else "the script asks for no skin: the list is built on every step"

    def values(self, scene):
        return spread(scene.neighbor.skin, FACTORS)

    def current(self, scene):
        return scene.neighbor.skin

    def commands(self, scene, value, folder):
        return [f"neighbor {value!r} {scene.list_style}"]
