r"""$$E = K (\theta - \theta_0)^2 + [E_{LJ}(r_{13}) + \epsilon]_{r_{13} < r_{min}}$$

angle_style spica under its former name; see there. Source: LAMMPS manual, angle_style sdk.
"""
from __future__ import annotations

from asemd.angle.spica import OPTIONS
from asemd.style import angle


@angle("sdk", **OPTIONS)
def sdk(theta, K: "energy", theta0: "angle"):
    d = theta - theta0
    return K * d * d, 2.0 * K * d
