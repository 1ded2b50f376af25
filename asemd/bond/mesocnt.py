r"""$$E = K (r - r_0)^2$$

Segment of a carbon nanotube: ``C n m r0`` computes K for the tube of chiral indices n and m, ``custom K r0`` gives it.
Source: Zhigilei, Wei and Srivastava, Phys. Rev. B 71, 165417 (2005); LAMMPS manual, bond_style mesocnt.
"""
from __future__ import annotations

from asemd import nanotube
from asemd.errors import InputError, nearest
from asemd.style import Parameter, Style, bond

COEFF = (Parameter("preset", "word"), Parameter("K", "energy/distance^2"), Parameter("r0", "distance"))
PRESETS = {"C": nanotube.PRESET, "custom": COEFF[1:]}


class Segment(Style):
    """The first word says what follows it."""

    def parse_coeff(self, words, settings):
        if not words or words[0] not in PRESETS:
            got = f"{words[0]!r}{nearest(words[0], PRESETS)}" if words else "nothing"
            raise InputError(f"bond_coeff mesocnt needs the preset C or custom first, got {got}")
        return {"preset": words[0], **nanotube.read(PRESETS[words[0]], words[1:], f"bond_coeff mesocnt {words[0]}")}

    def format_coeff(self, coeff):
        return [coeff["preset"], *(p.write(coeff[p.name]) for p in PRESETS[coeff["preset"]])]

    def pack(self, settings, coeffs, ntypes, units):
        return super().pack(settings, {t: {**c, "K": stiffness(c, units)} for t, c in coeffs.items()}, ntypes, units)


def stiffness(coeff, units) -> float:
    """K in the units of the scene."""
    if coeff["preset"] == "custom":
        return coeff["K"]
    force = 0.5 * (86.64 + 100.56 * nanotube.radius(coeff["n"], coeff["m"]))      # eV/Angstrom
    return force * nanotube.electronvolt(units, "bond_style mesocnt") / units.angstrom / coeff["r0"]


def mesocnt_d2(r, K, r0):
    return 2.0 * K


@bond("mesocnt", cls=Segment, coeff=COEFF, example="custom 800.0 1.1", equilibrium="r0", d2=mesocnt_d2)
def mesocnt(r, K: "energy/distance^2", r0: "distance"):
    d = r - r0
    return K * d * d, 2.0 * K * d
