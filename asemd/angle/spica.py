r"""$$E = K (\theta - \theta_0)^2 + [E_{LJ}(r_{13}) + \epsilon]_{r_{13} < r_{min}}$$

Harmonic angle of the coarse-grained SPICA (formerly SDK, CMM) force field; the second part is the inside of the minimum of pair_style
lj/spica, with that style's coefficients of the first and the third atom. A third coefficient 0 leaves it out.

special_bonds does not act on this repulsion; its 1-3 factors should be 0, or the pair counts twice.
Source: Shinoda, DeVane and Klein, Mol. Simul. 33, 27 (2007); LAMMPS manual, angle_style spica.
"""
from __future__ import annotations

from asemd.angle.harmonic import harmonic_d2
from asemd.errors import InputError
from asemd.style import Parameter, Style, angle


class SpicaAngle(Style):
    """``repulsion`` is 1 unless the third word is 0 or negative; the words of the old style cg/cmm (type, epsilon, sigma) are taken too."""

    repulsion = "repulsion"

    def parse_coeff(self, words, settings):
        if len(words) == 5:
            words = [*words[:2], words[3]]
        if len(words) not in (2, 3):
            raise InputError(f"angle_coeff {self.name} needs K theta0 [repulsion], got {len(words)} value{'s' * (len(words) != 1)}")
        values = super().parse_coeff(words, settings)
        values["repulsion"] = 1.0 if values.get("repulsion", 1.0) > 0.0 else 0.0
        return values


OPTIONS = dict(cls=SpicaAngle, example="300.0 107.0 1.0", equilibrium="theta0", d2=harmonic_d2,
               coeff=(Parameter("K", "energy"), Parameter("theta0", "angle"), Parameter("repulsion", "", optional=True)))


@angle("spica", **OPTIONS)
def spica(theta, K: "energy", theta0: "angle"):
    d = theta - theta0
    return K * d * d, 2.0 * K * d
