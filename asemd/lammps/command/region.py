"""``region ID style args keyword arg ...`` and ``region ID delete``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.lammps import catalog
from asemd.words import take


def run(session, args):
    name, style = take(args, 2, "region")[:2]
    regions = session.scene.regions
    if style == "delete":
        if name not in regions:
            raise InputError(f"region {name} delete: there is no such region{nearest(name, regions)}")
        del regions[name]
        return
    if name in regions:
        raise InputError(f"region {name} is defined already: delete it first or choose another name")
    region = catalog.load("region", style).from_lammps(args[2:], session)
    region.id = name
    regions[name] = region
