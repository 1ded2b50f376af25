r"""No forces; makes a neighbour list with the given cutoff.  Words after the cutoff: nocoeff (pair_coeff is not read), full."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.pairstyle import PairStyle
from asemd.style import register


class Zero(PairStyle):
    """Coefficients only say how far the list goes."""

    def parse_settings(self, words):
        flags = words[1:]
        for word in flags:
            if word not in ("nocoeff", "full"):
                raise InputError(f"pair_style zero: unknown keyword {word!r}{nearest(word, ('nocoeff', 'full'))}")
        values = super().parse_settings(words[:1])
        return values | {"nocoeff": "nocoeff" in flags, "full": "full" in flags}

    def format_settings(self, settings):
        return super().format_settings({"cut": settings["cut"]}) + [w for w in ("nocoeff", "full") if settings[w]]

    def parse_coeff(self, words, settings):
        return {} if settings["nocoeff"] else super().parse_coeff(words, settings)

    def reach(self, coeff, settings):
        return coeff["cut"]


register(Zero("zero", [], settings="cut [nocoeff] [full]", coeff="[cut]", units={"nocoeff": "word", "full": "word"},
              mix={"cut": "distance"}, settings_example="10.0", example="8.0", doc=__doc__, splits=True,
              see="LAMMPS manual, pair_style zero"))
