r"""$$E = k (r_c - r)^2 \qquad r < r_c$$

A soft repulsion; the cutoff belongs to each pair of types, and mixes as a length."""
from __future__ import annotations

from asemd.pairstyle import PairStyle, pair


class HarmonicCutPair(PairStyle):
    """The cutoff is a coefficient that must be given."""

    def reset_cutoffs(self, coeffs):
        return {pair_: dict(values) for pair_, values in coeffs.items()}


def harmonic_cut_d2(r, k, cut):
    return 2.0 * k


@pair("harmonic/cut", coeff="k cut", mix={"k": "cut", "cut": "distance"}, cls=HarmonicCutPair, d2=harmonic_cut_d2,
      example="30.0 1.1", see="LAMMPS manual, pair_style harmonic/cut")
def harmonic_cut(r, k: "energy/distance^2", cut: "distance"):
    gap = cut - r
    return k * gap * gap, -2.0 * k * gap
