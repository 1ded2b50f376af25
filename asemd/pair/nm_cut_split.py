r"""$$E = \frac{E_0}{n - m} \left[ m (r_0/r)^n - n (r_0/r)^m \right] \;\; (r \le r_0), \qquad
    E = 4 E_0 \left[ r^{-12} - r^{-6} \right] \;\; (r_0 < r < r_c)$$

Exponents n and m inside r0, Lennard-Jones with sigma = 1 beyond, which continues it if r0 is 2^(1/6). ``pair_modify shift yes`` takes off
the energy of the inner function at the cutoff, inside r0 only, and ``tail yes`` adds the tail of the inner function, as in LAMMPS.
Dietz, Kroger and Hoy, Soft Matter 14, 5221 (2018).
"""
from __future__ import annotations

import math

from asemd.pair.nm_cut import check, nm_cut, tail
from asemd.pair.nm_cut import derived as of_nm
from asemd.pairstyle import PairStyle, pair


class SplitPair(PairStyle):
    """Has LAMMPS's shift of the energy."""

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        full = {}
        for pair_, c in filled.items():
            front = of_nm(c, settings)["front"]
            end = nm_cut(c["cut"] * c["cut"], front, c["r0"], c["nn"], c["mm"])[0] if shift else 0.0
            full[pair_] = {**c, "front": front, "end": end}
        return super().pack_pairs(settings, full, ntypes, units, False)


def nm_cut_split_d2(r2, front, e0, r0, nn, mm, end):
    s2, r2inv = r0 * r0 / r2, 1.0 / r2
    if r2 > r0 * r0:
        return 24.0 * e0 * r2inv**5 * (7.0 * r2inv**3 - 2.0)
    return 0.25 * front * nn * mm * ((nn + 2.0) * math.pow(s2, 0.5 * nn) - (mm + 2.0) * math.pow(s2, 0.5 * mm)) * r2inv * r2inv


@pair("nm/cut/split", settings="cut", coeff="e0 r0 nn mm [cut]", rows="front end", check=check, tail=tail, cls=SplitPair,
      d2=nm_cut_split_d2, settings_example="2.5", example="1.0 1.1224620483 8.0 6.0 2.4", see="LAMMPS manual, pair_style nm/cut/split")
def nm_cut_split(r2, front: "energy", e0: "energy", r0: "distance", nn, mm, end):
    r2inv = 1.0 / r2
    s2 = r0 * r0 * r2inv
    first = math.pow(s2, 0.5 * nn)
    second = math.pow(s2, 0.5 * mm)
    r6inv = r2inv * r2inv * r2inv
    near = s2 >= 1.0
    e = front * (mm * first - nn * second) - end
    d = -0.5 * front * nn * mm * (first - second) * r2inv
    return (e if near else 4.0 * e0 * r6inv * (r6inv - 1.0)), (d if near else -12.0 * e0 * r6inv * (2.0 * r6inv - 1.0) * r2inv)
