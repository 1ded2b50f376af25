"""``restart N file [file2]``: write restart files during runs, a series or two in turn; ``restart 0``: no more."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps.command.write_restart import no_pieces
from asemd.lammps.restart import Schedule
from asemd.words import take, whole

KEYWORDS = ("fileper", "nfile")


def run(session, args):
    every, names = take(args, 1, "restart")[0], list(args[1:])
    if every == "0":
        if names:
            raise InputError(f"restart 0 turns restart files off and takes no file, got {' '.join(names)}")
        session.scene.restarts.clear()
        return
    if every.startswith("v_"):
        steps = every[2:]
        session.remember("restart")
    else:
        steps = whole(every, "restart: every N")
        if steps < 1:
            raise InputError(f"restart: N must be positive, or 0 for no restart files, got {every}")
    count = next((k for k, w in enumerate(names) if w in KEYWORDS), len(names))
    if count not in (1, 2):
        raise InputError(f"restart {every} needs the name of one file, to which the step is added, or of two files written in turn, "
                         f"got {count}")
    no_pieces(names[count:], names[:count], "restart")
    session.scene.restarts[count] = Schedule(steps, tuple(names[:count]))
