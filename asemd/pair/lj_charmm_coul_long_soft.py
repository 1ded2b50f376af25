r"""Lennard-Jones with a soft core, switched off between inner and outer as in lj/charmm/coul/long, and coul/long/soft up to cut_coul, with
one lambda, for a long-range solver. epsilon14 and sigma14 (default: epsilon, sigma) are used, without switch and soft core, by
dihedral_style charmm for the ends of a dihedral. Force of coul/long/soft: see there."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.pair.coul_long_soft import coul_long_soft, coul_long_soft_lammps
from asemd.pair.lj_charmm_coul_long import OPTIONS as CHARMM
from asemd.pair.lj_charmm_coul_long import CharmmLongPair
from asemd.pair.lj_cut_coul_cut_soft import derived
from asemd.pair.lj_cut_soft import SoftPair
from asemd.pairstyle import PairStyle, pair_sum


class SoftCharmmPair(SoftPair, CharmmLongPair):
    """Mixes nothing of different lambda; epsilon14 and sigma14 come after lambda."""

    def parse_coeff(self, words, settings):
        if len(words) == 4:
            raise InputError(f"pair_coeff {self.name} needs epsilon sigma lambda [epsilon14 sigma14], got 4 values")
        values = PairStyle.parse_coeff(self, words, settings)
        if not 0.0 <= values["lambda"] <= 1.0:
            raise InputError(f"pair_coeff {self.name}: lambda must be between 0 and 1, got {values['lambda']:g}")
        return values


def lj_charmm_soft(r2, front: "energy", core, sigma: "distance", inner2, outer2, scale):
    s2 = 1.0 / (sigma * sigma)
    u = r2 * s2
    low = 1.0 / (core + u * u * u)
    half = front * low
    e = 4.0 * half * (low - 1.0)
    d = -12.0 * half * low * (2.0 * low - 1.0) * u * u * s2
    gap = outer2 - r2
    switch = gap * gap * (outer2 + 2.0 * r2 - 3.0 * inner2) * scale
    slope = 6.0 * gap * (inner2 - r2) * scale
    inside = r2 <= inner2
    return (e if inside else e * switch), (d if inside else d * switch + e * slope)


def lj_charmm_soft_d2(r2, front, core, sigma, inner2, outer2, scale):
    s2 = 1.0 / (sigma * sigma)
    u = r2 * s2
    low = 1.0 / (core + u * u * u)
    e, first, second = 4.0 * front * low * (low - 1.0), 3.0 * u * u * s2, 6.0 * u * s2 * s2
    d = -4.0 * front * low * low * (2.0 * low - 1.0) * first
    curve = 4.0 * front * low * low * ((6.0 * low - 2.0) * low * first * first + (1.0 - 2.0 * low) * second)
    if r2 <= inner2:
        return curve
    gap = outer2 - r2
    switch = gap * gap * (outer2 + 2.0 * r2 - 3.0 * inner2) * scale
    return curve * switch + 12.0 * d * gap * (inner2 - r2) * scale + 6.0 * e * (2.0 * r2 - inner2 - outer2) * scale


lj_charmm_soft.d2 = lj_charmm_soft_d2
OPTIONS = CHARMM | dict(
    cls=SoftCharmmPair, settings="n alphaLJ alphaC inner outer [cut_coul]", coeff="epsilon sigma lambda [epsilon14] [sigma14]",
    units={"epsilon": "energy", "epsilon14": "energy", "sigma14": "distance", "alphaC": "distance^2"}, derived=derived,
    rows="front core weight gap", settings_example="2.0 0.5 5.0 8.0 10.0 9.0", example="0.1 3.0 0.7 0.05 2.9",
    splits=True, see="LAMMPS manual, pair_style lj/charmm/coul/long/soft")
style = pair_sum("lj/charmm/coul/long/soft", (lj_charmm_soft, "outer"), (coul_long_soft, "cut_coul"), **OPTIONS)
style.twin = SoftCharmmPair("lj/charmm/coul/long/soft", [(lj_charmm_soft, "outer"), (coul_long_soft_lammps, "cut_coul")], doc=__doc__,
                            **{k: v for k, v in OPTIONS.items() if k != "cls"})
