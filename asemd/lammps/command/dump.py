"""``dump ID group style N file words...``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.words import take, whole


def run(session, args):
    id, group, style, every, file = take(args, 5, "dump")[:5]
    scene = session.scene
    scene.need_system("dump")
    if id in scene.dumps:
        raise InputError(f"dump {id} exists already: undump it or choose another ID")
    scene.groups.mask(group, f"dump {id}")
    steps = whole(every, "dump: every N")
    if steps <= 0:
        raise InputError(f"dump {id}: N must be positive, got {every}")
    scene.dumps[id] = catalog.load("dump", style).from_lammps(id, group, steps, file, list(args[5:]), session)
