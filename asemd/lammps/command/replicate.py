"""``replicate nx ny nz keyword ...``"""
from __future__ import annotations

import math
import time
import warnings

import numpy as np

from asemd.errors import InputError, InputWarning, nearest
from asemd.lammps.command.create_box import check_number, describe
from asemd.lammps.setup_log import report_special
from asemd.words import take, whole


def run(session, args):
    started = time.perf_counter()
    scene, system = session.scene, session.scene.need_system("replicate")
    times = [whole(w, "replicate") for w in take(args, 3, "replicate")]
    periodic = False
    for word in args[3:]:
        if word == "bond/periodic":
            periodic = True
        elif word != "bbox":       # only another way to the same atoms
            raise InputError(f"replicate: unknown keyword {word!r}{nearest(word, ('bbox', 'bond/periodic'))}")
    check_number(math.prod(max(n, 0) for n in times) * system.n, "replicate")
    for axis, count, along in zip("xyz", times, system.box.periodic):
        if count > 1 and not along:
            session.warn(f"replicate in the non-periodic direction {axis}")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InputWarning)
        new = system.replicate(*times, bond_periodic=periodic)
    for warning in caught:
        session.warn(f"replicate: {warning.message}")
    masks = {name: np.tile(mask, new.n // system.n if system.n else 1) for name, mask in scene.groups.items()}
    new.box, new.topology.frozen = new.box.shrink_wrapped(new.x), None
    for _, _, types in new.topology:      # LAMMPS replicates items that are turned off as if they were on
        np.abs(types, out=types)
    scene.system = new
    scene.groups.resize(new.n)
    for name, mask in masks.items():
        scene.groups[name] = mask
    session.stale()
    session.print(f"Replication is creating a {times[0]}x{times[1]}x{times[2]} = {np.prod(times)} times larger system...")
    session.print(f"  {describe(new.box)}")
    session.print(f"  1 by 1 by 1 MPI processor grid\n  {new.n} atoms")
    for kind, count in new.topology.counts().items():
        if count:
            session.print(f"  {count} {kind}s")
    report_special(session)
    session.print(f"  replicate CPU = {time.perf_counter() - started:.3f} seconds")
