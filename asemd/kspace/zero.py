"""No long-range interaction: pair styles that need a solver have theirs within the cutoff, with the splitting parameter of an accuracy.

It is there for tests, and for charges whose long-range part something else adds. `kspace_modify` gewald, gewald/disp and, for the pair
styles of msm, order count; the other keywords change nothing.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.kspace import KSpace
from asemd.kspace.msm import BOUNDS, of_pairs, smoothed


class Zero(KSpace):
    """``kspace_style zero accuracy``."""

    style = "zero"
    adds = False
    smooth: list[float] | None = None

    def check(self, system):
        if system.q is None:
            raise InputError(f"kspace_style {self.style} needs atom attribute q: use atom_style charge or full")

    @property
    def stretch(self):
        return super().stretch * 0.0 + 1.0

    def serves(self, use):
        return use.style.variant(use.settings).charged or bool(use.style.needs(use.settings))

    def take(self, uses, interactions, system):
        kinds = frozenset().union(*(use.style.needs(use.settings) for use in uses))
        parts = [part for use in uses for part in use.style.variant(use.settings).parts]
        self.disperses = any(part.long and not part.charged for part in parts)
        if kinds & {"msm", "msm/dielectric"}:
            if self.modify["order"] // 2 not in {order // 2 for order in BOUNDS}:
                raise InputError(f"kspace_style {self.style}: kspace_modify order must be 4 to 11 for pair styles of msm, not "
                                 f"{self.modify['order']}")
            self.smooth = smoothed(self.modify["order"])
        return super().take(uses, interactions, system)

    def choose(self, system):
        if self.disperses and self.modify["gewald/disp"] <= 0.0:
            raise InputError(f"kspace_style {self.style}: give kspace_modify gewald/disp for dispersion without a cutoff")
        if not self.modify["gewald"]:
            self.accuracy = self.accuracy_relative * self.two_charges
            self.g_ewald = self.first_guess()

    @property
    def constants(self):
        out = {"g_ewald": self.g_ewald, "g_ewald_6": self.modify["gewald/disp"]}
        return out if self.smooth is None else {**out, **of_pairs(self.smooth, self.cutoff)}

    def lines(self):
        return ["Dummy KSpace initialization ...", f"  G vector (1/distance) = {self.g_ewald:.8g}"]

    def terms(self, engine):
        return []
