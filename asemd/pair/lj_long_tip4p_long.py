r"""lj/long/coul/long for four-site water (TIP4P): Lennard-Jones whose attraction has no cutoff between atoms, charges of oxygen atoms on
massless sites, see tip4p/cut; kspace_style pppm/disp/tip4p adds the rest of both.

With ``cut`` instead of ``long`` the first part is lj/cut, and the solver pppm/tip4p. Coulomb is ``long`` or ``off``. Hydrogen atoms have no
Lennard-Jones interactions. Source: LAMMPS manual, pair_style lj/long/tip4p/long.
"""
from __future__ import annotations

import inspect

from asemd.errors import InputError
from asemd.pair.coul_long import coul_long
from asemd.pair.lj_cut import lj_cut
from asemd.pair.lj_long_coul_long import derived, dispersion, repulsion
from asemd.style import register
from asemd.tip4p import TIP4P

OPTIONS = dict(
    before="dispersion coulomb", settings="cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj]", defaults={"cut_coul": "cut_lj"},
    units={"dispersion": "word", "coulomb": "word", "C6": "energy*distance^6", "g_ewald_6": "1/distance", "g_ewald": "1/distance"},
    rows="C6", derived=derived, mix={"epsilon": "sigma", "sigma": "distance"}, settings_example="long long 1 2 1 1 0.15 10.0",
    example="0.1 3.0", see="LAMMPS manual, pair_style lj/long/tip4p/long", doc=inspect.cleandoc(__doc__))


class LongTIP4P(TIP4P):
    """The first two words say what goes on beyond the cutoff."""

    def __init__(self, name: str, **options):
        super().__init__(name, [(repulsion, "cut_lj"), (dispersion, "cut_lj"), (coul_long, "cut_coul")], **options)
        self.forms: dict[tuple[str, str], TIP4P] = {}

    def parse_settings(self, words):
        values = super().parse_settings(words)
        for name, known in (("dispersion", ("long", "cut")), ("coulomb", ("long", "off"))):
            if values[name] not in known:
                raise InputError(f"pair_style {self.name}: {name} must be {' or '.join(known)}, got {values[name]!r}")
        if values["dispersion"] == "cut" and values["coulomb"] == "off":
            raise InputError(f"pair_style {self.name}: one of dispersion and coulomb must be long")
        return values

    def variant(self, settings, compat=""):
        key = settings["dispersion"], settings["coulomb"]
        if key not in self.forms:
            near = [repulsion, dispersion] if key[0] == "long" else [lj_cut]
            self.forms[key] = TIP4P(self.name, [*((f, "cut_lj") for f in near), *[(coul_long, "cut_coul")] * (key[1] == "long")],
                                    **{**OPTIONS, "shifts": key[0] == "cut"})
        return self.forms[key]

    def needs(self, settings):
        return frozenset({"pppm/disp/tip4p" if settings["dispersion"] == "long" else "pppm/tip4p"})


register(LongTIP4P("lj/long/tip4p/long", **OPTIONS))
