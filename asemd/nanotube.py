"""Stretching and bending of single-walled carbon nanotubes for the styles mesocnt, from their chiral indices.

Source: Zhigilei, Wei and Srivastava, Phys. Rev. B 71, 165417 (2005); numbers as LAMMPS has them.
"""
from __future__ import annotations

import math
from collections.abc import Sequence

from asemd.errors import InputError
from asemd.style import Parameter

PRESET = (Parameter("n", "integer"), Parameter("m", "integer"), Parameter("r0", "distance"))
BOND_LENGTH = 1.421      # of graphene, in Angstrom
# one eV in the energy unit of each unit style, the digits of LAMMPS
ELECTRONVOLT = {"real": 23.06054966, "metal": 1.0, "si": 1.6021765e-19, "cgs": 1.6021765e-12, "electron": 0.03674932248,
                "micro": 1.6021765e-4, "nano": 160.21765, "ase": 1.0}


def read(parameters: Sequence[Parameter], words: Sequence[str], what: str) -> dict:
    """Words behind a preset -> values by name."""
    if len(words) != len(parameters):
        raise InputError(f"{what} needs {' '.join(p.name for p in parameters)}, got {len(words)} value{'s' * (len(words) != 1)}")
    values = {p.name: p.read(w, what) for p, w in zip(parameters, words)}
    if parameters is PRESET and not values["r0"] > 0.0:
        raise InputError(f"{what}: r0 must be > 0, got {values['r0']:g}")
    return values


def radius(n: int, m: int) -> float:
    """Radius of the tube with chiral indices (n, m), in Angstrom."""
    return math.sqrt(3.0 * (n * n + n * m + m * m)) * BOND_LENGTH / (2.0 * math.pi)


def electronvolt(units, what: str) -> float:
    """One eV in the units of the scene."""
    if units.name not in ELECTRONVOLT:
        raise InputError(f"{what}: preset C does not know units {units.name}, use preset custom")
    return ELECTRONVOLT[units.name]
