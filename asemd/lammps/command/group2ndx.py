"""``group2ndx file group-ID ...``: write groups as an index file of GROMACS; no group named: all of them.

Source: LAMMPS manual, group2ndx.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import take

LONGEST = 80      # characters of a line


def run(session, args):
    system = session.scene.need_system("group2ndx")
    session.scene.sync_groups()
    path, groups = take(args, 1, "group2ndx")[0], session.scene.groups
    names = args[1:] or list(groups)
    blocks, width = [], len(str(system.id.max(initial=0)))
    columns = LONGEST // (width + 1)
    session.print(f"Writing groups to index file {path}:")
    for name in names:
        ids = sorted(system.id[groups.mask(name, "group2ndx")].tolist())
        lines = ["".join(f" {i:>{width}}" for i in ids[k:k + columns]) for k in range(0, len(ids), columns)]
        blocks.append("\n".join([f"[ {'System' if name == 'all' else name} ]", *lines]) + "\n")
        session.print(f" writing group {name}...done")
    if session.passive:
        return
    try:
        with open(path, "w", encoding="utf-8") as f:
            f.writelines(blocks)
    except OSError as e:
        raise InputError(f"group2ndx: cannot write {path}: {e.strerror}") from None
