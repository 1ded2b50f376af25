r"""$$E = C \frac{q_i q_j}{r} \left( \frac{\epsilon}{\epsilon_D(r)} - 1 \right) \qquad
\epsilon_D(r) = \frac{5.2 + \epsilon}{2} + \frac{\epsilon - 5.2}{2} \tanh \frac{r - r_{me}}{\sigma_e}$$

Correction of the Coulomb interaction of ions in an implicit solvent, whose permittivity falls from eps_s to 5.2 where they touch; add it
to coul/cut or coul/long. Lenart, Jusufi and Panagiotopoulos, J. Chem. Phys. 126, 044509 (2007).

LAMMPS takes the eps_s of the last pair_coeff for all pairs of types, here each has its own. ``pair_modify shift yes`` has no effect:
LAMMPS's offset holds the charges of two atoms that have nothing to do with the pair.
"""
from __future__ import annotations

import math
import warnings

from asemd.errors import InputWarning
from asemd.pairstyle import PairStyle, pair


class UnshiftedPair(PairStyle):
    """Says that ``pair_modify shift yes`` has no effect."""

    def check_scene(self, interactions, system):
        if any(use.style is self and interactions.modified(use, "shift") for use in interactions.uses["pair"]):
            warnings.warn(f"pair_modify shift yes has no effect on pair style {self.name}", InputWarning, stacklevel=2)


def coul_diel_d2(r, qq, eps_s, rme, sigmae):
    x = 2.0 * (r - rme) / sigmae
    w = math.exp(-abs(x))
    up, low = (w, eps_s + 5.2 * w) if x > 0.0 else (1.0, eps_s * w + 5.2)
    rate = 2.0 / sigmae
    g = (eps_s - 5.2) * up / low
    s = eps_s * (1.0 if x > 0.0 else w) / low            # dg/dr = -rate g s, ds/dr = rate s (1 - s)
    return qq / r * g * (2.0 / (r * r) + 2.0 * rate * s / r + rate * rate * s * (2.0 * s - 1.0))


@pair("coul/diel", settings="cut", coeff="eps_s rme sigmae", units={"eps_s": ""}, settings_example="10.0", example="78.0 2.375 0.8",
      see="LAMMPS manual, pair_style coul/diel", d2=coul_diel_d2, cls=UnshiftedPair)
def coul_diel(r, qq, eps_s, rme: "distance", sigmae: "distance"):
    # with u = exp(-2 (r - rme) / sigmae): eps_D = (eps_s + 5.2 u) / (1 + u), and no digits cancel in eps_s / eps_D - 1
    x = 2.0 * (r - rme) / sigmae
    w = math.exp(-abs(x))
    low = eps_s + 5.2 * w if x > 0.0 else eps_s * w + 5.2
    up = w if x > 0.0 else 1.0
    s = eps_s * (1.0 if x > 0.0 else w)
    inverse = 1.0 / (r * low)
    e = qq * (eps_s - 5.2) * up * inverse
    return e, -e * inverse * (low + 2.0 * s * r / sigmae)
