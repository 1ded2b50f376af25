r"""$$E = \epsilon \left[ \frac{\gamma}{n - \gamma} x^{-n} - \frac{n}{n - \gamma} x^{-\gamma} \right], \qquad
    n = \alpha x^2 + \beta, \;\; x = r / r_m \qquad r < r_c$$

The improved Lennard-Jones function, whose repulsive exponent depends on the distance; the minimum is at rm, its depth is epsilon.
Pirani, Brizi, Roncaratti, Casavecchia, Cappelletti and Vecchiocattivi, Phys. Chem. Chem. Phys. 10, 5489 (2008).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import pair


def check(coeff, settings):
    for name in ("gamma", "rm"):
        if not coeff[name] > 0.0:
            raise InputError(f"pair_coeff lj/pirani: {name} must be > 0, got {coeff[name]:g}")
    if coeff["epsilon"] < 0.0:
        raise InputError(f"pair_coeff lj/pirani: epsilon must not be negative, got {coeff['epsilon']:g}")


def lj_pirani_d2(r, alpha, beta, gamma, rm, epsilon):
    x = r / rm
    n, n1, n2, log = alpha * x * x + beta, 2.0 * alpha * x / rm, 2.0 * alpha / (rm * rm), math.log(x)
    d = 1.0 / (n - gamma)
    p, q = math.pow(x, -n), math.pow(x, -gamma)
    u, front = n / r + n1 * log, gamma * d
    du, dfront = n1 / r - n / (r * r) + n2 * log + n1 / r, -gamma * n1 * d * d
    ddfront = gamma * d * d * (2.0 * n1 * n1 * d - n2)
    p1, q1 = -p * u, -gamma * q / r
    p2, q2 = p * (u * u - du), gamma * (gamma + 1.0) * q / (r * r)
    return epsilon * (ddfront * (p - q) + 2.0 * dfront * (p1 - q1) + front * (p2 - q2) - q2)


@pair("lj/pirani", settings="cut", coeff="alpha beta gamma rm epsilon [cut]", settings_example="2.5", example="4.0 8.0 6.0 1.2 1.0 2.4",
      d2=lj_pirani_d2, check=check, splits=True, see="LAMMPS manual, pair_style lj/pirani")
def lj_pirani(r, alpha, beta, gamma, rm: "distance", epsilon: "energy"):
    x = r / rm
    n = alpha * x * x + beta
    rise = 2.0 * alpha * x / rm
    d = 1.0 / (n - gamma)
    log = math.log(x)
    p = math.pow(x, -n)
    q = math.pow(x, -gamma)
    front = epsilon * gamma * d
    return front * (p - q) - epsilon * q, front * ((n * q - n * p) / r - rise * (log * p + d * (p - q)))
