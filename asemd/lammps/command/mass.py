"""``mass I value``"""
from __future__ import annotations

from asemd.atom_style import mass_by_type
from asemd.errors import InputError
from asemd.words import bounds, number


def run(session, args):
    system = session.scene.need_system("mass")
    if len(args) != 2:
        raise InputError(f"mass needs an atom type and a value, got {len(args)} words")
    first, last = bounds(args[0], 1, system.counts["ntypes"], "mass: atom type", system.labels["atom"])
    value = number(args[1], "mass")
    if value <= 0.0:
        raise InputError(f"mass: the mass of atom type {args[0]} must be positive, got {args[1]}")
    if system.rmass is not None and not mass_by_type(system.atom_style):
        raise InputError("mass: every atom has its own mass in this system, use set mass")
    system.mass[first:last + 1] = value
