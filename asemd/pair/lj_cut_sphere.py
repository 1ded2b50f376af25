r"""$$E = 4\epsilon \left[ (\sigma_{ij}/r)^{12} - (\sigma_{ij}/r)^6 \right] \qquad r < r_c \sigma_{ij}$$

Lennard-Jones of spheres: sigma of a pair is the mean of both diameters, geometric or arithmetic as pair_modify says. The cutoff is a
multiple of it.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, mix_distance, pair


class SpherePair(PairStyle):
    """Knows how diameters mix, and the cutoff of the largest spheres of both types."""

    def learn(self, settings, system):
        super().learn(settings, system)
        if not min(system.extra["radius"], default=1.0) > 0.0:
            raise InputError(f"pair style {self.name} needs atoms that have a diameter")

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        rule = rule or self.mix_rule
        if rule == "sixthpower":
            raise InputError(f"pair_modify mix sixthpower does not work with pair style {self.name}")
        out, radii = super().filled(coeffs, settings, ntypes, rule, only), settings.get("radii", (0.5,) * (ntypes + 1))
        return {(i, j): {**c, "largest": mix_distance(rule, 2.0 * radii[i], 2.0 * radii[j]), "straight": float(rule == "arithmetic")}
                for (i, j), c in out.items()}

    def cutoffs(self, coeff, settings):
        return [cut * coeff["largest"] for cut in super().cutoffs(coeff, settings)]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        full = {}
        for pair_, c in filled.items():
            x = c["cut"] ** -6
            full[pair_] = {**c, "offset": 4.0 * c["epsilon"] * x * (x - 1.0) if shift else 0.0}
        return super().pack_pairs(settings, full, ntypes, units, False)


@pair("lj/cut/sphere", settings="cut", coeff="epsilon [cut]", mix={"epsilon": "geometric"}, rows="offset straight", cls=SpherePair,
      settings_example="2.5", example="1.0 2.4", see="LAMMPS manual, pair_style lj/cut/sphere")
def lj_cut_sphere(r2, radius_i: "distance", radius_j: "distance", epsilon: "energy", cut, offset, straight):
    r2inv = 1.0 / r2
    mean = radius_i + radius_j
    sigma2 = mean * mean if straight > 0.0 else 4.0 * radius_i * radius_j
    s2 = sigma2 * r2inv
    s6 = s2 * s2 * s2
    inside = r2 < cut * cut * sigma2
    e = epsilon * s6
    return (4.0 * e * (s6 - 1.0) - offset if inside else 0.0), (-12.0 * e * (2.0 * s6 - 1.0) * r2inv if inside else 0.0)
