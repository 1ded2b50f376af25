r"""Stillinger-Weber potential whose triples stop to act when their angle is far from the preferred one, as for MoS2 and its relatives.

The deviation $\delta=\cos\theta-\cos\theta_0$ of `pair sw` counts in full up to delta1, with the factor
$\tfrac12+\tfrac12\cos\frac{\pi(|\delta|-\delta_1)}{\delta_2-\delta_1}$ between delta1 and delta2, and not at all beyond:
``maxdelcs delta1 delta2``, 0.25 and 0.35 by default. LAMMPS's forces leave out the derivative of that factor; ``compat="lammps"`` has them.
"""
from __future__ import annotations

import copy
import math

from asemd import words as read
from asemd.errors import InputError
from asemd.pair.sw import SW, neighbours, power, sw
from asemd.style import register


def bend(delta, constants):
    """What counts of the deviation of a cosine, and the derivative."""
    size = abs(delta)
    if size <= constants[0]:
        return delta, 1.0
    if size >= constants[1]:
        return 0.0, 0.0
    u = 3.141592653589793 / (constants[1] - constants[0])
    x = u * (size - constants[0])
    f = 0.5 + 0.5 * math.cos(x)
    return delta * f, f - 0.5 * u * size * math.sin(x) if constants[2] == 1.0 else 1.0


class SWMod(SW):
    exact = 1.0      # the factor's derivative counts

    def parse_settings(self, words):
        what, words, values = f"pair_style {self.name}", list(words), {"threebody": "on", "delta1": 0.25, "delta2": 0.35}
        while words:
            keyword, *words = words
            if keyword == "maxdelcs":
                values["delta1"], values["delta2"] = (read.number(w, f"{what} maxdelcs") for w in read.take(words, 2, f"{what} maxdelcs"))
                words = words[2:]
                if not 0.0 <= values["delta1"] < values["delta2"]:
                    raise InputError(f"{what} maxdelcs: delta1 must be less than delta2 and not negative")
            else:
                values |= super().parse_settings([keyword, *words[:1]])
                words = words[1:]
        return values

    def format_settings(self, settings):
        return [*super().format_settings(settings), "maxdelcs", repr(settings["delta1"]), repr(settings["delta2"])]

    def variant(self, settings, compat=""):
        if compat != "lammps":
            return self
        twin = copy.copy(self)
        twin.exact = 0.0
        return twin

    def numbers(self, settings):
        return [settings["delta1"], settings["delta2"], self.exact]


register(SWMod("sw/mod", site=sw, helpers=(power, bend, neighbours), rooms=6, doc=__doc__,
               settings="[threebody] [on|off] [maxdelcs] [delta1] [delta2]",
               units={"threebody": "word", "on|off": "word", "maxdelcs": "word"}, example="tmd.sw.mod Mo S",
               see="J.-W. Jiang, Nanotechnology 26, 315706 (2015); LAMMPS manual, pair_style sw/mod"))
