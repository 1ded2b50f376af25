r"""$$E = K [1 + c \cos(n \theta)]$$

Angle of the universal force field (UFF) for linear, trigonal and octahedral centres; n need not be whole.

LAMMPS takes its expansion around a straight angle at every angle, so its force is not minus the gradient of its energy: right for n = 1
and 2; for n = 3 it is off by 0.03 % at 170 and 4 % at 150 degrees, and five times too large at 90. Here it is the gradient;
``compat="lammps"`` gives LAMMPS's force. Source: LAMMPS manual, angle_style fourier/simple.
"""
from __future__ import annotations

import math

from asemd.style import angle


def fourier_simple_lammps(theta, K: "energy", c, n):
    cosine = math.cos(theta)
    rest, sign = 1.0 - cosine, 1.0
    if cosine < 0.0:
        rest, sign = 1.0 + cosine, -1.0 if n % 2.0 == 0.0 else 1.0
    ratio = sign * n * (1.0 + (1.0 - n * n) * rest / 3.0)       # stands for sin(n theta) / sin(theta)
    return K * (1.0 + c * math.cos(n * theta)), -K * c * n * ratio * math.sin(theta)


def fourier_simple_d2(theta, K, c, n):
    return -K * c * n * n * math.cos(n * theta)


@angle("fourier/simple", example="100.0 -1.0 3.0", rest=lambda coeff: 180.0 / coeff["n"], lammps=fourier_simple_lammps,
       d2=fourier_simple_d2)
def fourier_simple(theta, K: "energy", c, n):
    a = n * theta
    return K * (1.0 + c * math.cos(a)), -K * c * n * math.sin(a)
