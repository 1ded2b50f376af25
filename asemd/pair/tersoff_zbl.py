r"""Tersoff potential that goes over into the screened repulsion of nuclei (Ziegler, Biersack, Littmark) at short distances.

$$V_{ij}=(1-f_F)V_{ij}^\mathrm{ZBL}+f_FV_{ij}^\mathrm{Tersoff},\quad f_F=\frac1{1+e^{-A_F(r_{ij}-r_C)}},\quad
V^\mathrm{ZBL}=\frac{Z_iZ_je^2}{4\pi\epsilon_0r}\phi(r/a),\quad a=\frac{0.8854a_0}{Z_i^{0.23}+Z_j^{0.23}}$$

The bond order is that of `pair tersoff`. The file has Z_i, Z_j, r_C and A_F (ZBLcut, ZBLexpscale) after Tersoff's numbers.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.kernels.eight_sites import coefficients8
from asemd.kernels.functions8 import exp8
from asemd.kernels.vectors8 import below8
from asemd.pair.tersoff import COLUMNS, OPTIONS, Tersoff, angular, longer, order, taper, tersoff
from asemd.pair.tersoff_eight import angular8, order8, taper8
from asemd.style import register


def fermi(r, p):
    """What is Tersoff's at a distance, and the derivative."""
    x = math.exp(-p[19] * (r - p[18]))
    f = 1.0 / (1.0 + x)
    return f, p[19] * x * f * f


def repulsion(r, p):
    fc, slope = taper(r, p)
    e = p[4] * math.exp(-p[5] * r)
    et = fc * e
    dt = (slope - fc * p[5]) * e
    x = r * p[17]
    a = 0.1818 * math.exp(-3.2 * x)
    b = 0.5099 * math.exp(-0.9423 * x)
    c = 0.2802 * math.exp(-0.4029 * x)
    d = 0.02817 * math.exp(-0.2016 * x)
    phi = a + b + c + d
    dphi = -p[17] * (3.2 * a + 0.9423 * b + 0.4029 * c + 0.2016 * d)
    ez = p[16] * phi / r
    dz = p[16] * (dphi - phi / r) / r
    f, df = fermi(r, p)
    return (1.0 - f) * ez + f * et, df * (et - ez) + (1.0 - f) * dz + f * dt


def attraction(r, p):
    fc, slope = taper(r, p)
    f, df = fermi(r, p)
    e = -p[6] * math.exp(-p[7] * r)
    return fc * f * e, (slope * f + fc * df - fc * f * p[7]) * e


def pair8(r, fc, dfc, table, types, at):
    """Repulsion and attraction of eight pairs, with their derivatives."""
    reach, _, _, _ = coefficients8(table, types, at, 0)
    ca, l1, cb, l2 = coefficients8(table, types, at, 4)
    coulomb, screening, middle, scale = coefficients8(table, types, at, 20)
    y = exp8(-1.0 * scale * (r - middle))
    f = 1.0 / (y + 1.0)
    df = scale * y * (f * f)
    x = screening * r
    a, b, c, d = 0.1818 * exp8(-3.2 * x), 0.5099 * exp8(-0.9423 * x), 0.2802 * exp8(-0.4029 * x), 0.02817 * exp8(-0.2016 * x)
    ir = 1.0 / r
    ez = coulomb * (a + b + c + d) * ir
    dz = (0.0 - coulomb * screening * (3.2 * a + 0.9423 * b + 0.4029 * c + 0.2016 * d) - ez) * ir
    et, e = ca * exp8(-1.0 * l1 * r), -1.0 * cb * exp8(-1.0 * l2 * r)
    dt, et = et * (dfc - l1 * fc), et * fc
    bare = below8(r, reach, 1.0 - f, 0.0)
    return bare * ez + f * et, df * (et - below8(r, reach, ez, 0.0)) + bare * dz + f * dt, fc * f * e, (dfc * f + fc * df - fc * f * l2) * e


class TersoffZBL(Tersoff):
    names = f"{Tersoff.names} Z_i Z_j ZBLcut ZBLexpscale"
    columns = (*COLUMNS, "coulomb", "screening", "ZBLcut", "ZBLexpscale")

    def numbers_of_eights(self, p):
        return [*super().numbers_of_eights(p)[:20], *(p[name] for name in ("coulomb", "screening", "ZBLcut", "ZBLexpscale"))]

    def check_entry(self, p, error):
        super().check_entry(p, error)
        for name, least in (("Z_i", 1.0), ("Z_j", 1.0), ("ZBLcut", 0.0), ("ZBLexpscale", 0.0)):
            if p[name] < least:
                raise error(f"{name} must be at least {least:g}, got {p[name]:g}")

    def row(self, p, units):
        if units is not None and units.name not in ("metal", "real", "ase"):
            raise InputError(f"pair style {self.name} needs units metal or real, got {units.name}")
        real = units is not None and units.name == "real"
        bohr, epsilon = 0.529, 0.00552635 * (0.043365121 if real else 1.0)
        e2 = 1.0
        return {**super().row(p, units), "coulomb": p["Z_i"] * p["Z_j"] * e2 / (4.0 * math.pi * epsilon),
                "screening": (p["Z_i"] ** 0.23 + p["Z_j"] ** 0.23) / (0.8854 * bohr)}


register(TersoffZBL("tersoff/zbl", site=tersoff, helpers=(taper, fermi, repulsion, attraction, angular, order, longer),
                    eight_helpers=(taper8, angular8, order8, pair8),
                    example="SiC.tersoff.zbl Si", doc=__doc__, see="LAMMPS manual, pair_style tersoff/zbl", **OPTIONS))
