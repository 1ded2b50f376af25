"""Multiple timesteps: bonded forces at the script's step, pair forces only on every second, third or fourth one."""
from __future__ import annotations

from asemd.report.knob import Knob, nice

BONDED = ("bond", "angle", "dihedral", "improper")


class Integrator(Knob):
    """``run_style verlet`` and ``run_style respa`` with two levels; 0 is the script's own run_style if it is another respa."""

    name, title, order = "integrator", "integrator", 20
    metric = "relative_fluctuation"
    excludes = ("timestep",)

    def needs(self, scene):
        if scene.respa is not None:
            return None
        uses = scene.interactions.uses
        if not uses["pair"]:
            return "no pair style: there is no slow force to compute less often"
        if not any(len(items) and uses[kind] for kind, items, _ in scene.system.topology):
            return "no bonded forces: there is no fast force to compute more often"
        for fix in scene.fixes.values():
            if set(fix.hooks()) - {"end_of_step"} and not fix.levels:
                return f"fix {fix.id} (style {fix.style}) does not work with run_style respa"
        return None

    def values(self, scene):
        return [1] if scene.respa is not None else [2, 4, 3]

    def current(self, scene):
        return 0 if scene.respa is not None else 1

    def commands(self, scene, value, folder):
        if value == 1:
            inner = scene.respa.steps(scene.dt)[0] if scene.respa is not None else scene.dt
            return ["run_style verlet", f"timestep {nice(inner)!r}"]
        # a dihedral style that weighs 1-4 pairs must be on the level of the pair forces, and impropers not below dihedrals
        slow = any(use.style.weight_14 and any(c.get(use.style.weight_14) for c in use.coeff.values())
                   for use in scene.interactions.uses["dihedral"])
        levels = " ".join(f"{kind} {2 if slow and kind in BONDED[2:] else 1}" for kind in BONDED)
        return [f"run_style respa 2 {value} {levels} pair 2", f"timestep {nice(value * scene.dt)!r}"]

    def label(self, value):
        return "verlet" if value == 1 else f"respa 1:{value}" if value else "respa of the script"

    def phrase(self, value):
        return self.label(value)
