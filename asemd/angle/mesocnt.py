r"""$$E = \begin{cases} K_H (\pi - \theta)^2 & \pi - \theta < \theta_B \\
    K_H \theta_B^2 + K_B (\pi - \theta - \theta_B) & \pi - \theta \ge \theta_B \end{cases}$$

Bending of a carbon nanotube, which buckles at $\theta_B$ (``buckling``) or does not (``harmonic``): ``buckling C n m r0`` and
``harmonic C n m r0`` compute the constants for the tube of chiral indices n and m and segments of length r0;
``buckling custom K_H K_B theta_B`` and ``harmonic custom K_H`` give them.
Source: Zhigilei, Wei and Srivastava, Phys. Rev. B 71, 165417 (2005); LAMMPS manual, angle_style mesocnt.
"""
from __future__ import annotations

import math

from asemd import nanotube
from asemd.errors import InputError, nearest
from asemd.style import Parameter, Style, angle

COEFF = (Parameter("mode", "word"), Parameter("preset", "word"), Parameter("K_H", "energy"), Parameter("K_B", "energy", True),
         Parameter("theta_B", "angle", True))
FORMS = {("buckling", "C"): nanotube.PRESET, ("harmonic", "C"): nanotube.PRESET, ("buckling", "custom"): COEFF[2:],
         ("harmonic", "custom"): COEFF[2:3]}
MODES, PRESETS = ("buckling", "harmonic"), ("C", "custom")


class Bend(Style):
    """The first two words say what follows them."""

    def parse_coeff(self, words, settings):
        for word, known, what in zip([*words[:2], *["nothing"] * (2 - len(words))], (MODES, PRESETS), ("mode", "preset")):
            if word not in known:
                raise InputError(f"angle_coeff mesocnt: the {what} must be {' or '.join(known)}, got {word}{nearest(word, known)}")
        mode, preset = words[:2]
        return {"mode": mode, "preset": preset, **nanotube.read(FORMS[mode, preset], words[2:], f"angle_coeff mesocnt {mode} {preset}")}

    def format_coeff(self, coeff):
        mode, preset = coeff["mode"], coeff["preset"]
        return [mode, preset, *(p.write(coeff[p.name]) for p in FORMS[mode, preset])]

    def pack(self, settings, coeffs, ntypes, units):
        return super().pack(settings, {t: {**c, **constants(c, units)} for t, c in coeffs.items()}, ntypes, units)


def constants(coeff, units) -> dict:
    """K_H and K_B in the units of the scene, theta_B in degrees (360: never)."""
    out = {"K_B": 0.0, "theta_B": 360.0}
    if coeff["preset"] == "custom":
        return out | {name: coeff[name] for name in ("K_H", "K_B", "theta_B") if name in coeff}
    electronvolt = nanotube.electronvolt(units, "angle_style mesocnt")
    bending = 63.8 * nanotube.radius(coeff["n"], coeff["m"]) ** 2.93 * electronvolt     # energy * Angstrom
    out["K_H"] = 0.5 * bending * units.angstrom / coeff["r0"]
    if coeff["mode"] == "buckling":
        out |= {"K_B": 0.7 * bending / 275.0, "theta_B": math.degrees(math.atan2(coeff["r0"], 275.0 * units.angstrom))}
    return out


def mesocnt_d2(theta, K_H, K_B, theta_B):
    return 2.0 * K_H if math.pi - theta < theta_B else 0.0


@angle("mesocnt", cls=Bend, coeff=COEFF, d2=mesocnt_d2, rest=lambda coeff: 180.0, example="buckling custom 400.0 50.0 15.0")
def mesocnt(theta, K_H: "energy", K_B: "energy", theta_B: "angle"):
    d = math.pi - theta
    if d < theta_B:
        return K_H * d * d, -2.0 * K_H * d
    return K_H * theta_B * theta_B + K_B * (d - theta_B), -K_B
