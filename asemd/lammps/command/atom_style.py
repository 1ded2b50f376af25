"""``atom_style style``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.words import take


def run(session, args):
    take(args, 1, "atom_style")
    style = catalog.plain(args[0])
    if not catalog.exists("atom", style):
        raise catalog.unknown("atom", args[0])
    if len(args) > 1:
        raise InputError(f"atom_style {style} takes no arguments, got {' '.join(args[1:])}")
    session.scene.atom_style = style
