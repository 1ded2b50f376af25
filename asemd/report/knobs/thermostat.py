"""The damping time of thermostats: strong coupling shows the error of the timestep in the temperature, weak coupling takes long."""
from __future__ import annotations

import copy

from asemd.report.knob import Knob, nice

FACTORS = (0.1, 10.0, 0.3, 3.0)
TIMES = 20.0        # damping times that a run should cover: a temperature forgets in one of them where it started


def baths(scene) -> list:
    """The thermostats of a scene."""
    return [f for f in scene.fixes.values() if f.ecouple and getattr(f, "damping", 0.0) > 0.0]


class Thermostat(Knob):
    """Damping times of all thermostats, multiplied."""

    name, title, order = "thermostat", "damping time", 70
    metric = "temperature_offset"
    model, remark = True, "the script's fixes in place of constant energy"
    fixes = "own"

    def needs(self, scene):
        found = baths(scene)
        if not found:
            return "no fix is a thermostat with a damping time"
        for fix in found:
            if callable(fix.start):
                return f"the temperature of fix {fix.id} is a variable"
            if fix.start != fix.stop:
                return f"the temperature of fix {fix.id} is ramped"
        if len({fix.start for fix in found}) > 1:
            return "thermostats of different temperatures"
        return None

    def values(self, scene):
        return [1.0, *FACTORS]

    def current(self, scene):
        return None         # with the script's own damping too it is another run than that at constant energy

    def duration(self, scene, value):
        return TIMES * value * max(fix.damping for fix in baths(scene))

    def commands(self, scene, value, folder):
        out = []
        for fix in baths(scene):
            other = copy.copy(fix)
            other.damping = nice(fix.damping * value)
            out.append(" ".join(["fix", fix.id, fix.group, fix.style, *map(str, other.to_lammps())]))
        return out

    def label(self, value):
        return "none (constant energy)" if value is None else f"x {value:g}"
