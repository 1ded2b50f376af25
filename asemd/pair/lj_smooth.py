r"""$$E = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] \;\; (r \le r_{in}), \qquad
    -\frac{dE}{dr} = C_1 + C_2 t + C_3 t^2 + C_4 t^3, \;\; t = r - r_{in} \;\; (r_{in} < r < r_c)$$

Lennard-Jones whose force goes smoothly to zero between inner and outer. The energy is continuous inside but ends at rc with a step, unless
``pair_modify shift yes`` takes it off.
"""
from __future__ import annotations

import math

from asemd.pair.lj_gromacs import SwitchedPair
from asemd.pairstyle import pair


def derived(c, settings):
    """The step at the end, and the force as (outer - r)^2 (quadratic + cubic (outer - r))."""
    inner, w = c["inner"], c["outer"] - c["inner"]
    s6 = (c["sigma"] / inner) ** 6
    e = 4.0 * c["epsilon"] * s6
    force, slope = e * (12.0 * s6 - 6.0) / inner, e * (42.0 - 156.0 * s6) / inner**2
    quadratic = (3.0 * force / w + slope) / w
    cubic = (force / (w * w) - quadratic) / w
    return {"end": e * (s6 - 1.0) - w * w * w * (quadratic / 3.0 + 0.25 * w * cubic), "quadratic": quadratic, "cubic": cubic}


def lj_smooth_d2(r2, epsilon, sigma, inner, outer, end, quadratic, cubic):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    r = math.sqrt(r2)
    u = outer - r
    force = u * u * (quadratic + u * cubic)
    rise = u * (2.0 * quadratic + 3.0 * u * cubic)
    return 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) * r2inv * r2inv if r <= inner else 0.25 * (force / r + rise) * r2inv


@pair("lj/smooth", settings="inner outer", coeff="epsilon sigma [inner] [outer]", cut="outer", derived=derived, cls=SwitchedPair,
      mix={"epsilon": "sigma", "sigma": "distance", "inner": "distance", "outer": "distance"}, rows="end quadratic cubic",
      settings_example="2.0 2.5", example="1.0 1.1 1.9 2.4", d2=lj_smooth_d2, see="LAMMPS manual, pair_style lj/smooth")
def lj_smooth(r2, epsilon: "energy", sigma: "distance", inner: "distance", outer: "distance", end, quadratic, cubic):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = epsilon * s6
    r = math.sqrt(r2)
    u = outer - r
    uu = u * u
    near = r <= inner
    far = end + uu * u * (0.33333333333333333 * quadratic + 0.25 * u * cubic)
    slope = -0.5 * uu * (quadratic + u * cubic) * r * r2inv
    return (4.0 * e * (s6 - 1.0) if near else far), (-12.0 * e * (2.0 * s6 - 1.0) * r2inv if near else slope)
