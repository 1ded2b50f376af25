"""``write_dump group-ID style file dump-words... [modify dump_modify-words...]``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.result import Snapshot
from asemd.words import take

ID = "WRITE_DUMP"


def run(session, args):
    scene = session.scene
    scene.need_system("write_dump")
    scene.sync_groups()
    group, style, file = take(args, 3, "write_dump")[:3]
    scene.groups.mask(group, "write_dump")
    words, modify = list(args[3:]), []
    if "modify" in words:
        at = words.index("modify")
        words, modify = words[:at], words[at + 1:]
        if not modify:
            raise InputError("write_dump modify needs words of dump_modify")
    if not catalog.exists("dump", style):
        raise catalog.unknown("dump", style)
    dump = catalog.load("dump", style).from_lammps(ID, group, 1, file, words, session)
    if modify:
        dump.modify(modify, session)
    try:
        dump.write(_state(session), scene.step)
    finally:
        dump.close()


def _state(session) -> Snapshot:
    """The last step that was evaluated, or before the first one the atoms alone."""
    scene = session.scene
    try:
        return session.moment.snapshot
    except InputError:
        return Snapshot(scene.system, None, scene.groups, scene.dt, scene.step)
