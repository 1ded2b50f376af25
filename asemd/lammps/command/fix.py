"""``fix ID group style words...``"""
from __future__ import annotations

import re

from asemd.errors import InputError
from asemd.lammps import catalog, restart
from asemd.registry import plain_name
from asemd.words import take


def run(session, args):
    id, group, style = take(args, 3, "fix")[:3]
    scene = session.scene
    if scene.system is None and not getattr(catalog.load("fix", style), "before_box", False):
        scene.need_system(f"fix {style}")
    if not re.fullmatch(r"\w+", id, re.ASCII):
        raise InputError(f"fix: ID {id!r} must have only letters, numbers and underscores")
    scene.groups.mask(group, f"fix {id}")
    old = scene.fixes.get(id)
    if old is not None and old.style != plain_name(style):
        raise InputError(f"fix {id} exists with style {old.style}: unfix it before it becomes {style}")
    if old is not None:
        old.detach(scene.system)
    session.defining, session.awaited = id, []
    try:
        new = catalog.load("fix", style).from_lammps(group, list(args[3:]), session)
    finally:
        awaited, session.awaited = session.awaited, None
    new.id, new.awaited = id, tuple(awaited)
    scene.add_fix(new)
    restart.restore_fix(session, new)
    session.remember(f"fix {id}")
    session.loop = None
