"""The cutoff of pair forces: what lies beyond is missing from the model."""
from __future__ import annotations

import copy

from asemd import units as unit_styles
from asemd.lammps.command.pair_write import pair_value
from asemd.report.knob import Knob, nice

FACTORS = (0.8, 1.2, 0.7, 1.4, 0.9)
LONGEST = 1.8       # the reference, relative to the script's own
ENDS = 0.01         # of the force at 0.8 of the cutoff: it ends there (the repulsive half cut at 1.12 has 0.001, 2.5 sigma has 0.2)


def lengths(values: dict) -> list[str]:
    """Names of what must grow with the cutoff: cutoffs and the limits of a switch."""
    return [name for name, value in values.items() if name.startswith(("cut", "inner", "outer")) and isinstance(value, float)]


def scaled(scene, factor: float):
    """The interactions with all cutoffs of pair styles multiplied."""
    out = copy.deepcopy(scene.interactions)
    for use in out.uses["pair"]:
        for values in (use.settings, *use.coeff.values()):
            for name in lengths(values):
                values[name] = nice(values[name] * factor)
    return out


def pair_commands(interactions) -> list[str]:
    """The commands that make the pair styles of these interactions."""
    lines = [" ".join(["pair_style", *interactions.style_line("pair")])]
    lines += [" ".join(["pair_coeff", *words]) for words in interactions.coeff_lines("pair")]
    return lines + [" ".join(["pair_modify", *words]) for words in interactions.modify_lines()]


class Cutoff(Knob):
    """All cutoffs of pair styles, multiplied; those of a switch with it."""

    name, title, order = "cutoff", "cutoff", 60
    model = True

    def needs(self, scene):
        uses = scene.interactions.uses["pair"]
        if not uses:
            return "no pair style"
        for use in uses:
            if use.style.name == "table":
                return "pair style table ends where its table does"
            if not lengths(use.settings) and not any(lengths(c) for c in use.coeff.values()):
                return f"pair style {use.style.name} has no cutoff to change"
        return "the force is zero at the cutoff, which is part of the model" if self._designed(scene) else None

    def _designed(self, scene) -> bool:
        """Whether all forces vanish at their cutoffs without a switch that makes them: the repulsive half of a potential, a soft bump."""
        ntypes = scene.system.counts["ntypes"]
        terms = scene.interactions.pair_terms(ntypes, unit_styles.get(scene.units))
        for term in terms:
            if term.style.charged or any(name.startswith("inner") for name in term.use.settings):
                return False
            for i in range(1, ntypes + 1):
                for j in range(i, ntypes + 1):
                    cut = float(term.tables.rows[term.cut_rows, i, j].max()) ** 0.5
                    at, near = (abs(pair_value([term], i, j, (part * cut) ** 2, 0.0)[1]) for part in (1.0 - 1e-9, 0.8))
                    if cut > 0.0 and at > ENDS * near:
                        return False
        return bool(terms)

    def values(self, scene):
        return list(FACTORS)

    def current(self, scene):
        return 1.0

    def reference(self, scene):
        return LONGEST

    def commands(self, scene, value, folder):
        return pair_commands(scaled(scene, value))

    def label(self, value):
        return f"x {value:g}"
