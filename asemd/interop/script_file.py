"""``ase.io.read("in.script", format="lammps-script")``."""
from __future__ import annotations

import os

from asemd.lammps import read


def read_lammps_script(path: str | os.PathLike):
    """`asemd.Atoms` of a LAMMPS script, up to its first run, with the calculator, see `asemd.read`."""
    return read.read(path)
