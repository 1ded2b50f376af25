"""How Langevin dynamics is put together from steps: which temperature the positions get, at the script's timestep and at twice that."""
from __future__ import annotations

from asemd.report.constraints import holding, named
from asemd.report.knob import Knob, nice
from asemd.report.knobs.thermostat import TIMES

KINDS = {"langevin": "fix langevin", "gjf": "gjf", "baoab": "BAOAB"}


class Splitting(Knob):
    """``fix langevin``, the same with ``gjf vhalf`` (here and in LAMMPS), and ``fix baoab`` (here only), at one and two timesteps."""

    name, title, order = "splitting", "Langevin splitting", 72
    metric = "configurational_offset"
    model, remark = True, "the script's fixes in place of constant energy"
    fixes = "own"

    def _pair(self, scene):
        """The thermostat and the fix that moves its atoms."""
        bath = next((f for f in scene.fixes.values() if f.style == "langevin"), None)
        mover = next((f for f in scene.fixes.values() if bath and f.style == "nve" and f.group == bath.group), None)
        return bath, mover

    def needs(self, scene):
        bath, mover = self._pair(scene)
        if bath is None:
            return "no fix langevin"
        if mover is None:
            return f"fix langevin acts on group {bath.group}, which no fix nve moves"
        if held := holding(scene):
            return f"{named(held)} holds distances: there is no configurational temperature to compare"
        if sum(f.ecouple for f in scene.fixes.values()) > 1:
            return "several thermostats"
        if callable(bath.start) or bath.start != bath.stop:
            return f"the temperature of fix {bath.id} is not constant"
        return "fix langevin scale" if bath.scale else "run_style respa" if scene.respa is not None else None

    def values(self, scene):
        return [("langevin", 2.0), ("baoab", 2.0), ("gjf", 2.0), *((kind, 1.0) for kind in KINDS)]

    def current(self, scene):
        return None

    def duration(self, scene, value):
        return TIMES * self._pair(scene)[0].damping

    def commands(self, scene, value, folder):
        kind, factor = value
        bath, mover = self._pair(scene)
        words = f"{bath.start!r} {bath.stop!r} {bath.damping!r} {bath.seed}"
        out = [f"timestep {nice(factor * scene.dt)!r}", f"unfix {bath.id}", f"unfix {mover.id}"]
        if kind == "baoab":
            return [*out, f"fix {bath.id} {bath.group} baoab {words}"]
        return [*out, f"fix {bath.id} {bath.group} langevin {words}" + " gjf vhalf" * (kind == "gjf"), f"fix {mover.id} {mover.group} nve"]

    def label(self, value):
        return "none" if value is None else f"{KINDS[value[0]]}, {value[1]:g} dt"
