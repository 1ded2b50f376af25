"""The timestep of velocity Verlet: its error grows with the square, its cost per simulated time falls with the first power."""
from __future__ import annotations

from asemd.report.knob import Knob, nice, spread

FACTORS = (2.0, 0.5, 1.5, 0.25, 3.0, 4.0)


class Timestep(Knob):
    """Multiples of the script's timestep."""

    name, title, unit, order = "timestep", "timestep", "time", 10
    metric = "relative_fluctuation"

    def values(self, scene):
        return spread(scene.dt, FACTORS)

    def current(self, scene):
        return scene.dt

    def commands(self, scene, value, folder):
        return [f"timestep {nice(value)!r}"]
