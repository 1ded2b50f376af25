"""``write_restart file``: everything a run needs to go on, see `asemd.lammps.restart`; ``*`` stands for the step."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.lammps import restart
from asemd.lammps.setup_log import report_mixing
from asemd.words import take, whole


def run(session, args):
    name = take(args, 1, "write_restart")[0]
    session.scene.need_system("write_restart")
    no_pieces(args[1:], [name], "write_restart")
    report_mixing(session, "write_restart")
    restart.write(session, restart.file_name(name, session.scene.step))
    settle(session)


def settle(session) -> None:
    """Atoms go into the periodic box and open faces to them, as for a file; the next run begins as one that is continued from it."""
    system = session.scene.system
    system.box.wrap(system.x, system.image)
    system.box = system.box.shrink_wrapped(system.x)
    session.loop = None


def no_pieces(words: list[str], names: list[str], command: str) -> None:
    """Read ``fileper N`` and ``nfile N``, which have no effect: there is one process, one file."""
    words = list(words)
    while words:
        key = words.pop(0)
        if key not in ("fileper", "nfile"):
            raise InputError(f"{command}: unknown keyword {key!r}{nearest(key, ('fileper', 'nfile'))}")
        if not any("%" in name for name in names):
            raise InputError(f"{command} {key} needs a file name with %")
        if whole(take(words, 1, f"{command} {key}")[0], f"{command} {key}") < 1:
            raise InputError(f"{command} {key} must be positive, got {words[0]}")
        del words[0]
