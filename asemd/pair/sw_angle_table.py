r"""Stillinger-Weber form whose angular functions are tables, for coarse-grained models.

$$E=\sum_i\sum_{j>i}A\epsilon\Big[B\Big(\frac\sigma r\Big)^p-\Big(\frac\sigma r\Big)^q\Big]e^{\sigma/(r-a\sigma)}+
\sum_i\sum_{j<k}T(\theta_{jik})\,e^{\gamma\sigma/(r_{ij}-a\sigma)+\gamma\sigma/(r_{ik}-a\sigma)}$$

An entry of the file is that of `pair sw`, followed by a file of angle tables, the keyword of one, ``linear`` or ``spline`` and the number
of points to interpolate between, as in `angle table`; lambda and the angle are not used.
"""
from __future__ import annotations

import copy
import math

import numpy as np

from asemd.bonded_table import inner_table, interpolate
from asemd.errors import InputError
from asemd.kernels.manybody import add_bend
from asemd.manybody import element_of
from asemd.pair.sw import NAMES, SW, neighbours, power
from asemd.pairstyle import PairTables
from asemd.registry import find
from asemd.style import register


def tabled_angles(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    two, three, grids, nodes = arrays
    energy = neighbours(n, m, ti, near, types, room, grad, two, shares)
    for j in range(n - 1):
        for k in range(j + 1, n):
            g = grids[three[ti, types[j], types[k]]]
            c = min(max(room[0, j] * room[0, k] + room[1, j] * room[1, k] + room[2, j] * room[2, k], -1.0), 1.0)
            t, slope = interpolate(min(max(math.acos(c), g[0]), g[1]), g[0], g[2], g[3], g[4], g[5], nodes)
            both = room[4, j] * room[4, k]
            e = t * both
            energy += e
            add_bend(j, k, c, e, -slope * both / max(math.sqrt((1.0 - c) * (1.0 + c)), 1e-8), -e * room[5, j], -e * room[5, k], room,
                     grad, shares)
    return energy


class TabledAngles(SW):
    """Tables by triples of elements."""

    names = f"{NAMES} *table *keyword *style N"

    def parse_settings(self, words):
        if words:
            raise InputError(f"pair_style {self.name} takes no words, got {' '.join(words)}")
        return {"threebody": "on"}

    def read(self, file, elements, settings):
        found, reader = super().read(file, elements, settings), copy.copy(find("angle", "table"))
        reader.category, reader.name = "pair", self.name
        for key, p in found.items():
            if p["style"] not in ("linear", "spline") or p["N"] < 2.0 or p["N"] != int(p["N"]):
                raise InputError(f"{file.what}: entry {' '.join(key)} needs linear or spline and a number of points of at least 2, got "
                                 f"{p['style']} {p['N']:g}")
            p["grid"] = inner_table(reader.read(p["table"], p["keyword"], {})["table"], int(p["N"]), p["style"] == "spline")
        return found

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables, element = super().pack_pairs(settings, filled, ntypes, units, shift), element_of(filled, ntypes)
        c = next(iter(filled.values()))
        unit, data = self.unit_factor(c, units), c["data"]
        names, three = list(data), np.zeros(tables.arrays[1].shape[:3], np.int64)
        for types in np.ndindex(three.shape):
            key = tuple(element[t] for t in types)
            three[types] = names.index(key) if key in data else 0
        starts = np.cumsum([0, *(len(data[key]["grid"][3]) for key in names)])
        grids = [[*data[key]["grid"][:3], start, len(data[key]["grid"][3]), float(data[key]["style"] == "spline")]
                 for key, start in zip(names, starts)]
        nodes = unit * np.concatenate([data[key]["grid"][3] for key in names])
        return PairTables(tables.rows, tables.constants[:1], (tables.arrays[0], three, np.array(grids), nodes))


register(TabledAngles("sw/angle/table", site=tabled_angles, helpers=(power, neighbours, interpolate), rooms=6, doc=__doc__,
                      example="spce.sw type", see="LAMMPS manual, pair_style sw/angle/table"))
