r"""$$E = K (\cos\gamma - \cos\gamma_0)^2$$

Holds the dipole of the first atom at the angle $\gamma_0$ to the vector from the first to the second atom; the third atom is not used.
The dipole feels a torque and the two atoms a couple that balances it; as in LAMMPS there is no virial.
Source: Orsi and Essex, PLoS ONE 6, e28637 (2011); LAMMPS manual, angle_style dipole.
"""
from __future__ import annotations

import math

from asemd.style import angle


@angle("dipole", example="75.0 110.1", equilibrium="gamma0",
       xfail=dict.fromkeys(("slope", "twin", "invariance", "balance", "gradient", "virial", "singular"), "it needs atoms with dipoles"))
def dipole(gamma, K: "energy", gamma0: "angle"):
    d = -2.0 * math.sin(0.5 * (gamma + gamma0)) * math.sin(0.5 * (gamma - gamma0))
    return K * d * d, -2.0 * K * d * math.sin(gamma)
