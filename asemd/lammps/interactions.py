"""The force field that LAMMPS commands describe, without atoms and without a box of their own."""
from __future__ import annotations

import re

import numpy as np

from asemd import units as unit_styles
from asemd.atom_style import fresh
from asemd.box import Box
from asemd.errors import InputError, nearest
from asemd.lammps import script
from asemd.lammps.live_coefficients import freeze
from asemd.lammps.session import Session
from asemd.scene import Scene
from asemd.system import System
from asemd.topology import ATOMS
from asemd.words import choice, take

KNOWN = (*(f"{category}_{word}" for category in (*ATOMS, "pair") for word in ("style", "coeff")), "pair_modify", "kspace_style",
         "kspace_modify", "special_bonds", "dielectric", "neigh_modify", "mass", "variable", "dimension")
NUMBERS = re.compile(r"^\s*(pair|bond|angle|dihedral|improper)_coeff\s+(\S+)(?:\s+(\S+))?", re.M)


def scene_of(text: str, units: str, types: int, compat: str = "") -> Scene:
    """A scene without atoms, with the interactions of some commands.

    Parameters
    ----------
    text : str
        Commands, one a line.
    units : str
        Unit style of their numbers.
    types : int
        Number of atom types, 0 for the largest one that a ``pair_coeff`` names; those of bonds, angles ... are always found in this way.
    compat : str

    Raises
    ------
    InputError
        A command that is no part of a force field, errors in commands, with their lines.
    """
    dimension = 3
    for command in script.parse(text):
        if command.name == "dimension":
            dimension = 2 if choice(take(command.text.split()[1:], 1, "dimension")[0], ("2", "3"), "dimension") == "2" else 3
        if command.name and command.name not in KNOWN:       # comments have no name
            raise InputError(f"{command.name} is not a command of a force field{nearest(command.name, KNOWN)}: for a whole script there "
                             "is asemd.read").at(command.where)
    counts = _counted(text)
    most, counts["ntypes"] = counts["ntypes"], types or counts["ntypes"]
    if most > counts["ntypes"]:
        raise InputError(f"the commands have coefficients for atom type {most}, but types has {types}")
    if not counts["ntypes"]:
        raise InputError("the commands do not say how many atom types there are: give types=, the elements in the order of their types")
    unit_styles.get(units)
    scene = Scene(units=units, atom_style="full", compat=compat)
    scene.set_units(units)
    scene.interactions.compat = compat
    scene.system = System(box=Box.from_lammps(np.zeros(3), np.ones(3)), x=np.zeros((0, 3)), type=np.zeros(0), counts=counts, units=units,
                          dimension=dimension, **fresh("full", 0))
    session = Session(scene, passive=True)
    session.commands(re.sub(r"^\s*dimension\s.*$", "", text, flags=re.M))     # a box is there already
    freeze(session)
    return scene


def _counted(text: str) -> dict[str, int]:
    """The largest types that lines of coefficients name."""
    counts = {"ntypes": 0, **{f"n{category}types": 0 for category in ATOMS}}
    for category, *words in NUMBERS.findall(text):
        name = "ntypes" if category == "pair" else f"n{category}types"
        found = [int(n) for word in words[:1 + (category == "pair")] if re.fullmatch(r"[\d*]+", word) for n in re.findall(r"\d+", word)]
        counts[name] = max([counts[name], *found])
    return counts
