"""``compute ID group style words...``"""
from __future__ import annotations

import re

from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.words import take


def run(session, args):
    id, group, style = take(args, 3, "compute")[:3]
    scene = session.scene
    if not re.fullmatch(r"\w+", id, re.ASCII):
        raise InputError(f"compute: ID {id!r} must have only letters, numbers and underscores")
    if id in scene.computes:
        raise InputError(f"compute {id} exists already: uncompute it or choose another ID")
    scene.groups.mask(group, f"compute {id}")
    new = catalog.load("compute", style).from_lammps(group, list(args[3:]), session)
    new.id = id
    scene.computes[id] = new
