"""When the neighbour list is rebuilt. A list that comes too late misses pairs: forces are then wrong without a word."""
from __future__ import annotations

from asemd.report.knob import Knob

VALUES = ((1, 0, True), (1, 5, True), (5, 0, True), (10, 0, True), (1, 10, True), (20, 0, False))


class Rebuild(Knob):
    """``neigh_modify every delay check``."""

    name, title, order = "rebuild", "list rebuild", 45

    def needs(self, scene):
        if not scene.interactions.uses["pair"]:
            return "no pair style, so no neighbour list"
        return "neigh_modify once: the list is built once" if scene.list_once else None

    def values(self, scene):
        return list(VALUES)

    def current(self, scene):
        n = scene.neighbor
        return n.every, n.delay, n.check

    def commands(self, scene, value, folder):
        every, delay, check = value
        return [f"neigh_modify every {every} delay {delay} check {'yes' if check else 'no'}"]

    def risk(self, value):
        return "" if value[2] else "nothing looks whether atoms have moved too far for the list"

    def label(self, value):
        every, delay, check = value
        return f"every {every} delay {delay}" + ("" if check else " unchecked")
