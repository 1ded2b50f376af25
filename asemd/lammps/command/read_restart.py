"""``read_restart file [remap]``: go on from a restart file; ``*`` in the name stands for the largest step there is."""
from __future__ import annotations

import time

from asemd.errors import InputError
from asemd.lammps import binary_restart, restart, restart_file
from asemd.words import take


def run(session, args):
    started = time.perf_counter()
    name = take(args, 1, "read_restart")[0]
    if args[1:] not in ([], ["remap"]):         # atoms are wrapped into the box anyway
        raise InputError(f"read_restart takes one file, got {' '.join(args)}")
    if session.scene.system is not None:
        raise InputError("read_restart: the simulation box is defined already, use clear first")
    path = restart.newest(name)
    session.print("Reading restart file ...")
    if restart_file.is_of_lammps(path):
        binary_restart.read(session, path)
    else:
        restart.take_up(session, restart_file.load(path))
    session.stale()
    session.print(f"  read_restart CPU = {time.perf_counter() - started:.3f} seconds")
