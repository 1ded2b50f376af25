"""Pair styles of four-site water (TIP4P): Lennard-Jones between atoms, charges of oxygen atoms on massless sites.

The words of such a style begin with the types of oxygen, hydrogen, O-H bond and H-O-H angle and the distance of the massless site from the
oxygen atom. Where the sites are and what acts on them: `asemd.charge_sites`. Hydrogen atoms have no Lennard-Jones interactions.
"""
from __future__ import annotations

import copy
import inspect
import math
import sys

from asemd.charge_sites import ChargeSites
from asemd.errors import InputError
from asemd.pair.lj_cut_soft import SoftPair
from asemd.pairstyle import PairStyle
from asemd.style import register

WORDS = "otype htype btype atype qdist"
UNITS = {"otype": "integer", "htype": "integer", "btype": "integer", "atype": "integer", "qdist": "distance"}


class TIP4P(PairStyle):
    """A pair style whose parts with charges act on sites. Its pieces: Lennard-Jones between atoms, Coulomb between sites.

    Parameters
    ----------
    settings, before : str
        The words after the distance of the site, and before the type of oxygen, see `asemd.pairstyle.PairStyle`.
    """

    needs_newton = True

    def __init__(self, name, parts, *, settings, before="", units=None, **options):
        super().__init__(name, parts, settings=f"{before} {WORDS} {settings}", units={**UNITS, **(units or {})}, **options)
        self.solvers = frozenset({"pppm/tip4p"}) if self.solvers else self.solvers
        self._pieces = [self._piece(kind) for kind in ("vdwl", "coul") if any(p.kind == kind for p in self.parts)]

    def _piece(self, kind: str) -> TIP4P:
        out = copy.copy(self)
        out.parts = tuple(p for p in self.parts if p.kind == kind)
        out.charged = out.on_sites = kind == "coul"
        out.tail = None if out.charged else self.tail
        return out

    def pieces(self):
        return self._pieces

    def parse_settings(self, words):
        values = super().parse_settings(words)
        for name in ("otype", "htype", "btype", "atype"):
            if values[name] < 1:
                raise InputError(f"pair_style {self.name}: {name} must be at least 1, got {values[name]}")
        if values["qdist"] < 0.0:
            raise InputError(f"pair_style {self.name}: qdist must not be negative, got {values['qdist']:g}")
        return values

    def reach(self, coeff, settings):
        return max([super().reach(coeff, settings), *(settings[p.cut] + 2.0 * settings["qdist"] for p in self.parts if p.charged)])

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables, hydrogen = super().pack_pairs(settings, filled, ntypes, units, shift), settings["htype"]
        if self.parts[0].kind == "vdwl" and hydrogen <= ntypes:
            tables.rows[0, hydrogen, :] = tables.rows[0, :, hydrogen] = 0.0
        return tables

    def check_scene(self, interactions, system):
        super().check_scene(interactions, system)
        for use in interactions.uses["pair"]:
            if use.style is self:
                self.sites(use.settings, interactions).atoms(system)
                for name, n in (("otype", "ntypes"), ("htype", "ntypes"), ("btype", "nbondtypes"), ("atype", "nangletypes")):
                    if use.settings[name] > system.counts[n]:
                        raise InputError(f"pair_style {self.name}: {name} {use.settings[name]} is larger than the number of types, "
                                         f"{system.counts[n]}")
                h = use.settings["htype"]
                if use.coeff.get((h, h), {}).get("epsilon", 0.0) != 0.0:
                    raise InputError(f"pair style {self.name}: epsilon of hydrogen, type {h}, must be 0, here it is "
                                     f"{use.coeff[h, h]['epsilon']:g}")

    def sites(self, settings, interactions) -> ChargeSites:
        """Where the charges of oxygen atoms are, from the rest length of the bond and the rest angle.

        Raises
        ------
        InputError
            The bond or the angle style is missing, or has no rest value for that type.
        """
        rest = {}
        for category, key in (("bond", "btype"), ("angle", "atype")):
            t, values = settings[key], [math.nan]
            if not interactions.uses[category]:
                raise InputError(f"pair style {self.name} must have {'an angle' if category == 'angle' else 'a bond'} style: the massless "
                                 f"site follows from the rest {'angle' if category == 'angle' else 'length'} of {category} type {t}")
            values += [use.style.rest_value(use.coeff[t]) for use in interactions.uses[category] if t in use.coeff]
            if not values[-1] > 0.0:
                raise InputError(f"pair style {self.name}: {category} type {t} of the water molecules has no rest "
                                 f"{'angle' if category == 'angle' else 'length'}")
            rest[category] = values[-1]
        share = settings["qdist"] / (math.cos(0.5 * math.radians(rest["angle"])) * rest["bond"])
        return ChargeSites(settings["otype"], settings["htype"], share, self.name)


class TIP4PSoft(TIP4P, SoftPair):
    """The same with a soft core."""


def tip4p(name: str, *parts, cls=TIP4P, **options) -> TIP4P:
    """Register the sum of `parts` (function, name of its cutoff) as a pair style of four-site water."""
    doc = inspect.cleandoc(sys._getframe(1).f_globals["__doc__"] or "")
    return register(cls(name, list(parts), doc=doc, **options))
