r"""$$E = 4 \lambda^n \epsilon \left[ \frac{1}{D^2} - \frac{1}{D} \right], \qquad
    D = \alpha (1 - \lambda)^2 + (r/\sigma)^6 \qquad r < r_c$$

Lennard-Jones with a soft core, for free energies of particles that appear or vanish: finite at r = 0 for lambda below 1, lj/cut for
lambda = 1. Types mix only if their lambda is the same.  Beutler et al., Chem. Phys. Lett. 222, 529 (1994).
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair, power_tail


def derived(c, settings):
    """The factor with lambda, and what stands beside (r/sigma)^6."""
    return {"front": c["epsilon"] * c["lambda"] ** settings["n"], "core": settings["alpha"] * (1.0 - c["lambda"]) ** 2}


class SoftPair(PairStyle):
    """Keeps lambda between 0 and 1 and takes its power into the tail correction; mixes nothing of different lambda."""

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if not 0.0 <= values["lambda"] <= 1.0:
            raise InputError(f"pair_coeff {self.name}: lambda must be between 0 and 1, got {values['lambda']:g}")
        if not values.get("sigma", 1.0) > 0.0:
            raise InputError(f"pair_coeff {self.name}: sigma must be > 0, got {values['sigma']:g}")
        return values

    def mixed(self, a, b, rule):
        if a["lambda"] != b["lambda"]:
            raise InputError(f"lambda {a['lambda']:g} and {b['lambda']:g} cannot be mixed: give pair_coeff for that pair of types")
        return super().mixed(a, b, rule) | {"lambda": a["lambda"], "power": a["power"]}

    def complete(self, values, settings):
        return super().complete(values, settings) | {"power": settings["n"]}


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair, of powers without the soft core."""
    s3, e = c["sigma"] ** 3, 4.0 * c["epsilon"] * c["lambda"] ** c["power"]
    return power_tail(((e * s3 * s3 * s3 * s3, 12), (-e * s3 * s3, 6)), cut)


def lj_cut_soft_d2(r2, front, core, sigma):
    s2 = sigma * sigma
    u = r2 / s2
    d = core + u * u * u
    slope, curve = 3.0 * u * u / s2, 6.0 * u / (s2 * s2)
    return 4.0 * front * ((6.0 / d - 2.0) / (d * d * d) * slope * slope + (1.0 - 2.0 / d) / (d * d) * curve)


@pair("lj/cut/soft", settings="n alpha cut", coeff="epsilon sigma lambda [cut]", derived=derived, rows="front core", cls=SoftPair,
      mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail, units={"epsilon": "energy"}, settings_example="2.0 0.5 2.5",
      example="1.0 1.1 0.6 2.4", d2=lj_cut_soft_d2, see="LAMMPS manual, pair_style lj/cut/soft", splits=True)
def lj_cut_soft(r2, front: "energy", core, sigma: "distance"):
    s2 = 1.0 / (sigma * sigma)
    u = r2 * s2
    d = 1.0 / (core + u * u * u)
    e = front * d
    return 4.0 * e * (d - 1.0), -12.0 * e * d * (2.0 * d - 1.0) * u * u * s2
