r"""$$E = 4\epsilon \left[ \left( \frac{\sigma}{r - \Delta} \right)^{12} - \left( \frac{\sigma}{r - \Delta} \right)^6 \right],
    \qquad \Delta = R_i + R_j, \qquad r < r_c + \Delta$$

Lennard-Jones between the surfaces of spheres. ``pair_modify shift yes`` takes off as much as in lj/expand.

LAMMPS's force is (r - Delta)^2 (in distance units squared) times minus the gradient of its energy. Here it is the gradient;
``compat="lammps"`` gives LAMMPS's force.
"""
from __future__ import annotations

import copy
from dataclasses import replace

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair
from asemd.style import find


class ExpandSpherePair(PairStyle):
    """Cutoffs are counted from the surfaces of the largest spheres on."""

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        if rule == "sixthpower":
            raise InputError(f"pair_modify mix sixthpower does not work with pair style {self.name}")
        radii = settings.get("radii", (0.5,) * (ntypes + 1))
        return {(i, j): {**c, "largest": radii[i] + radii[j]} for (i, j), c in super().filled(coeffs, settings, ntypes, rule, only).items()}

    def cutoffs(self, coeff, settings):
        return [cut + coeff["largest"] for cut in super().cutoffs(coeff, settings)]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        return super().pack_pairs(settings, {k: {**c, "shifted": float(shift)} for k, c in filled.items()}, ntypes, units, False)


@pair("lj/expand/sphere", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, rows="shifted",
      cls=ExpandSpherePair, settings_example="2.5", example="1.0 0.5 2.4", see="LAMMPS manual, pair_style lj/expand/sphere")
def lj_expand_sphere(r, radius_i: "distance", radius_j: "distance", epsilon: "energy", sigma: "distance", cut: "distance", shifted):
    x = r - radius_i - radius_j
    xinv = 1.0 / x
    s = sigma * xinv
    s2 = s * s
    s6 = s2 * s2 * s2
    e, slope = epsilon * s6, -24.0 * epsilon * s6 * (2.0 * s6 - 1.0) * xinv
    inside = x < cut
    last = sigma / (cut + radius_i + radius_j)
    t2 = last * last
    t6 = t2 * t2 * t2
    e = 4.0 * (e * (s6 - 1.0) - shifted * epsilon * t6 * (t6 - 1.0))
    return (e if inside else 0.0), (slope if inside else 0.0)


def lj_expand_sphere_lammps(r, radius_i: "distance", radius_j: "distance", epsilon: "energy", sigma: "distance", cut: "distance", shifted):
    x = r - radius_i - radius_j
    s = sigma / x
    s2 = s * s
    s6 = s2 * s2 * s2
    e, slope = epsilon * s6, -24.0 * epsilon * s6 * (2.0 * s6 - 1.0) * x
    inside = x < cut
    last = sigma / (cut + radius_i + radius_j)
    t2 = last * last
    t6 = t2 * t2 * t2
    e = 4.0 * (e * (s6 - 1.0) - shifted * epsilon * t6 * (t6 - 1.0))
    return (e if inside else 0.0), (slope if inside else 0.0)


style = find("pair", "lj/expand/sphere")
style.twin = copy.copy(style)
style.twin.parts = (replace(style.parts[0], function=lj_expand_sphere_lammps),)
