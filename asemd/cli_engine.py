"""``asemd run --engine lammps``: the script runs on real LAMMPS, in processes of its own."""
from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from asemd.errors import InputError
from asemd.lammps.switches import Switches


def run_lammps(script: str | None, switches: Switches, ranks: int, check: bool, quiet: bool, ours: dict[str, object]) -> int:
    """Hand a script over; returns the exit status.

    Parameters
    ----------
    ours : dict
        Options of asemd -> whether they were given; LAMMPS knows none of them.

    Raises
    ------
    InputError
        One of them was given, or there is no script.
    """
    from asemd.cli import INTERRUPTED, complain, make_watcher
    from asemd.lammps_run import run_lammps as hand_over
    for option, given in ours.items():
        if given:
            raise InputError(f"{option} is an option of asemd that LAMMPS does not know: leave it out, or leave out --engine lammps")
    if script is None or switches.convert:
        raise InputError("--engine lammps needs a script")
    if not check:
        switches.compat = ""
    watcher = make_watcher(quiet or switches.screen is not None)
    if quiet:
        switches.screen = "none"
    with tempfile.TemporaryDirectory(prefix="asemd-run-") as folder:
        if script == "-":
            script = os.fspath(Path(folder) / "in.standard-input")
            Path(script).write_text(sys.stdin.read(), encoding="utf-8")
        try:
            return hand_over(script, ranks, check=check, switches=switches, atoms=False, watcher=None if watcher.silent else watcher).status
        except KeyboardInterrupt:
            return complain("interrupted", INTERRUPTED)
