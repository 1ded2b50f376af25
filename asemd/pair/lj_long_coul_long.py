r"""$$E = 4 \epsilon \left( \frac{\sigma}{r} \right)^{12} - C_6 g_6^6 \left( \frac{1}{u^3} + \frac{1}{u^2} + \frac{1}{2 u} \right) e^{-u}
    + \frac{C q_i q_j \, \mathrm{erfc}(g r)}{\epsilon_0 r}, \qquad u = g_6^2 r^2, \quad C_6 = 4 \epsilon \sigma^6, \quad r < r_c$$

Lennard-Jones whose attraction has no cutoff: a long-range solver (ewald/disp or pppm/disp) adds the rest, for interfaces above all. With
``cut`` instead of ``long`` the first part is lj/cut; so it is with ``off``, which LAMMPS's manual has without an attraction but LAMMPS
computes as ``cut``, for charges with the solver pppm/disp. Coulomb is ``long`` or ``off``. Special pairs lose the part of -C_6 / r^6 that
special_bonds takes off, for the solver knows nothing of bonds.  In 't Veld, Ismail, Grest, J. Chem. Phys. 127, 144711 (2007).
"""
from __future__ import annotations

import inspect
import math

from asemd.coulomb_table import coul_between_table, dispersion_table
from asemd.errors import InputError
from asemd.pair.coul_long import EWALD, coul_long, long_range
from asemd.pair.lj_cut import lj_cut
from asemd.pairstyle import PairStyle
from asemd.style import register

DISPERSION = ("ewald/disp", "pppm/disp")


def dispersion_d2(r2, C6, g_ewald_6):
    g2 = g_ewald_6 * g_ewald_6
    u = g2 * r2
    y = 1.0 / u
    return -C6 * g2**5 * y * (0.5 + y * (2.0 + y * (6.0 + y * (12.0 + 12.0 * y)))) * math.exp(-u)


@long_range(*DISPERSION)
def dispersion(r2, C6: "energy*distance^6", g_ewald_6):
    """What a solver leaves of -C6 / r^6."""
    g2 = g_ewald_6 * g_ewald_6
    u = g2 * r2
    y = 1.0 / u
    bell = C6 * g2 * g2 * g2 * y * math.exp(-u)
    return -bell * (0.5 + y * (1.0 + y)), g2 * bell * (0.5 + y * (1.5 + y * (3.0 + 3.0 * y)))


def repulsion_d2(r2, epsilon, sigma):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    return 168.0 * epsilon * s6 * s6 * r2inv * r2inv


def repulsion(r2, epsilon: "energy", sigma: "distance"):
    """The repulsive part of lj/cut."""
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = 4.0 * epsilon * s6 * s6
    return e, -6.0 * e * r2inv


dispersion.d2, repulsion.d2, dispersion.table = dispersion_d2, repulsion_d2, dispersion_table


class DispersionPair(PairStyle):
    """The first two words say what goes on beyond the cutoff; `near` are the parts without charges for ``cut``, `far` those for ``long``.

    `first` is the name of their cutoff.
    """

    kinds = ("long", "cut", "off")

    def form(self, coulomb: str) -> type[PairStyle]:
        """What it is with that second word."""
        return PairStyle

    def __init__(self, name: str, near, far, first: str, **options):
        options["settings"] = f"dispersion coulomb {first} [cut_coul]"
        options["defaults"] = {"cut_coul": first}
        options["units"] = {"dispersion": "word", "coulomb": "word", "C6": "energy*distance^6", "g_ewald_6": "1/distance",
                            "g_ewald": "1/distance", **options.get("units", {})}
        super().__init__(name, [*((f, first) for f in far), (coul_long, "cut_coul")], **options)
        self.near, self.far, self.first, self.made = near, far, first, options
        self.forms: dict[tuple[str, str], PairStyle] = {}

    def parse_settings(self, words):
        values = super().parse_settings(words)
        what = f"pair_style {self.name}"
        if values["dispersion"] not in self.kinds:
            raise InputError(f"{what}: dispersion must be {', '.join(self.kinds[:-1])} or {self.kinds[-1]}, got {values['dispersion']!r}")
        if values["coulomb"] not in ("long", "off"):
            raise InputError(f"{what}: coulomb must be long or off, got {values['coulomb']!r}")
        if values["dispersion"] == values["coulomb"] == "long" and len(words) == 4:
            raise InputError(f"{what}: only one cutoff where both dispersion and coulomb are long")
        return values

    def format_settings(self, settings):
        words = super().format_settings(settings)
        return words[:3] if settings["dispersion"] == settings["coulomb"] == "long" else words

    def variant(self, settings, compat=""):
        key = settings["dispersion"], settings["coulomb"]
        if key not in self.forms:
            long = key[0] == "long"
            parts = [(f, self.first) for f in (self.far if long else self.near)] + [(coul_long, "cut_coul")] * (key[1] == "long")
            made = self.forms[key] = self.form(key[1])(self.name, parts, **{**self.made, "shifts": not long})
            made.tables = {coul_long: coul_between_table}
        return self.forms[key]

    def needs(self, settings):
        if settings["dispersion"] == "long":
            return frozenset(DISPERSION)
        if settings["coulomb"] == "off":
            return frozenset()
        return frozenset(EWALD if settings["dispersion"] == "cut" else ["pppm/disp"])

    def works_with(self, settings):
        nothing = settings["dispersion"] == settings["coulomb"] == "off"
        return self.needs(settings) | ({"pppm/disp", "pppm/disp/dielectric"} if nothing else set())


def derived(c, settings):
    return {"C6": 4.0 * c["epsilon"] * c["sigma"] ** 6}


register(DispersionPair(
    "lj/long/coul/long", [lj_cut], [repulsion, dispersion], "cut_lj", coeff="epsilon sigma [cut_lj]", rows="C6", derived=derived,
    mix={"epsilon": "sigma", "sigma": "distance"}, splits=True, settings_example="long long 10.0", example="0.1 3.0",
    see="LAMMPS manual, pair_style lj/long/coul/long", doc=inspect.cleandoc(__doc__)))
