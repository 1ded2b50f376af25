"""Where a switch sets in that takes pair forces to zero at the cutoff."""
from __future__ import annotations

import copy

from asemd.report.knob import Knob, nice
from asemd.report.knobs.cutoff import LONGEST, pair_commands, scaled

PARTS = (0.9, 0.6, 0.75, 0.5)


class Switching(Knob):
    """The inner limit of the switch, as a part of the outer one."""

    name, title, order = "switching", "switch from", 62
    model = True

    def _inner(self, use) -> list[str]:
        return [name for name in use.settings if name.startswith("inner") and name.replace("inner", "outer", 1) in use.settings]

    def needs(self, scene):
        uses = scene.interactions.uses["pair"]
        if not uses:
            return "no pair style"
        if not any(self._inner(use) for use in uses):
            names = ", ".join(use.style.name for use in uses)
            return f"{names}: no switch (pair_modify shift would move energies only, no force)"
        return None

    def _with(self, scene, part: float):
        out = copy.deepcopy(scene.interactions)
        for use in out.uses["pair"]:
            for name in self._inner(use):
                use.settings[name] = nice(part * use.settings[name.replace("inner", "outer", 1)])
        return out

    def values(self, scene):
        return list(PARTS)

    def current(self, scene):
        for use in scene.interactions.uses["pair"]:
            for name in self._inner(use):
                return nice(use.settings[name] / use.settings[name.replace("inner", "outer", 1)])
        return None

    def reference(self, scene):
        return ("cutoff", LONGEST)

    def commands(self, scene, value, folder):
        made = scaled(scene, value[1]) if isinstance(value, tuple) else self._with(scene, value)
        return pair_commands(made)

    def label(self, value):
        return f"{value:g} of the cutoff"
