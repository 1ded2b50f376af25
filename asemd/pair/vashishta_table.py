r"""Vashishta potential whose pairs are looked up in tables: ``pair_style vashishta/table N inner``.

Energy and force/r of `pair vashishta` at N points, equally spaced in $r^2$ from the inner distance to the cutoff, with lines in between;
below the inner distance, and for triples, the formula itself. The force is that of the table, not the derivative of the energy.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from asemd import words as read
from asemd.errors import InputError
from asemd.kernels.manybody import add_stretch
from asemd.kernels.whole_power import whole_power
from asemd.pair.vashishta import Vashishta, two_body, vashishta
from asemd.style import register


def pairs(n, m, ti, near, types, room, grad, three, constants, arrays, shares):
    """Energy of the first `m` pairs."""
    energy = 0.0
    for k in range(m):
        p = three[ti, types[k], types[k]]
        r = room[4, k]
        if r >= p[0]:
            continue
        r2 = near[3, k]
        if r2 < constants[0]:
            e, d = two_body(r, p[2], p[3], p[4], p[5], p[6], p[7], p[8])
            e -= p[9] + (r - p[0]) * p[10]
            d -= p[10]
        else:
            t = (r2 - constants[0]) * constants[1]
            a = int(t)
            t -= a
            tables = arrays[1]
            e = (1.0 - t) * tables[ti, types[k], a, 0] + t * tables[ti, types[k], a + 1, 0]
            d = -r * ((1.0 - t) * tables[ti, types[k], a, 1] + t * tables[ti, types[k], a + 1, 1])
        energy += e
        add_stretch(k, e, d, room, grad, shares)
    return energy


class VashishtaTable(Vashishta):
    """The same numbers, and tables of the pairs."""

    def parse_settings(self, words):
        what = f"pair_style {self.name}"
        n, inner = read.exactly(words, 2, what)
        values = {"N": read.whole(n, f"{what}: N"), "inner": read.number(inner, f"{what}: inner")}
        if values["N"] < 2 or not values["inner"] > 0.0:
            raise InputError(f"{what} needs N of at least 2 and an inner distance above 0, got {n} {inner}")
        return values

    def format_settings(self, settings):
        return [str(settings["N"]), repr(settings["inner"])]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, shift)
        three, inner2, n = tables.arrays[0], settings["inner"] * settings["inner"], settings["N"]
        delta = (tables.rows[0].max() - inner2) / (n - 1)
        if not delta > 0.0:
            raise InputError(f"pair_style {self.name}: the inner distance {settings['inner']:g} is beyond the cutoff")
        looked = np.zeros((*tables.rows[0].shape, n + 1, 2))
        for a, b in filled:
            for i, j in {(a, b), (b, a)}:
                p = three[i, j, j]
                if p[0] > 0.0:
                    for k in range(n + 1):
                        r = (inner2 + k * delta) ** 0.5
                        e, d = two_body(r, *p[2:9])
                        looked[i, j, k] = e - p[9] - (r - p[0]) * p[10], -(d - p[10]) / r
        return replace(tables, constants=np.array([inner2, 1.0 / delta]), arrays=(three, looked))


register(VashishtaTable("vashishta/table", site=vashishta, helpers=(whole_power, two_body, pairs), rooms=8, doc=__doc__, settings="N inner",
                        settings_example="10000 0.2", units={"N": "integer", "inner": "distance"}, example="SiC.vashishta Si",
                        see="LAMMPS manual, pair_style vashishta/table"))
