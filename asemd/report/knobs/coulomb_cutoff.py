"""Where charges go over from pairs to the long-range solver: its accuracy stays, the work is shared otherwise."""
from __future__ import annotations

import copy

from asemd.report.knob import Knob, nice, spread
from asemd.report.knobs.accuracy import solver_commands, tight, why_not
from asemd.report.knobs.cutoff import pair_commands

FACTORS = (0.8, 1.2, 0.9, 1.4)


def cutoffs(use) -> set[str]:
    """Names of the settings of a pair style that end the pair part of charges."""
    return {part.cut for part in use.style.variant(use.settings).parts if part.long or (part.charged and not use.style.solvers)}


class CoulombCutoff(Knob):
    """The cutoff of charges in pair styles that leave the rest to a solver."""

    name, title, unit, order = "coulomb-cutoff", "Coulomb cutoff", "distance", 57

    def _charged(self, scene) -> list:
        return [use for use in scene.interactions.uses["pair"] if use.style.needs(use.settings) and cutoffs(use)]

    def needs(self, scene):
        if why := why_not(scene):
            return why
        uses = self._charged(scene)
        if not uses:
            return "no pair style has a cutoff of charges"
        for use in uses:
            others = {part.cut for part in use.style.variant(use.settings).parts} - {None}
            if not cutoffs(use) <= set(use.settings) or (others - cutoffs(use)) & cutoffs(use):
                return f"pair style {use.style.name} has no cutoff of charges of its own"
        if scene.interactions.kspace.startswith("msm") and scene.interactions.kspace_modify.get("cutoff/adjust", True):
            return "msm chooses the cutoff by itself (kspace_modify cutoff/adjust)"
        return None

    def values(self, scene):
        return spread(self.current(scene), FACTORS)

    def current(self, scene):
        use = self._charged(scene)[0]
        return float(use.settings[min(cutoffs(use))])

    def reference(self, scene):
        return ("accuracy", tight(scene))

    def commands(self, scene, value, folder):
        if isinstance(value, tuple):
            return solver_commands(scene, value[1])
        changed = copy.copy(scene)
        changed.interactions = copy.deepcopy(scene.interactions)
        for use in self._charged(changed):
            for name in cutoffs(use):
                use.settings[name] = nice(value)
        return pair_commands(changed.interactions)
