"""``dump ID group xtc N file``: GROMACS's compressed trajectory format, written by MDAnalysis."""
from __future__ import annotations

import os
import tempfile

import numpy as np

from asemd import units
from asemd.dump._trajectory import Trajectory, library
from asemd.errors import InputError
from asemd.words import number, whole

PRECISION = tuple(10**k for k in range(1, 7))


class XTC(Trajectory):
    """Positions rounded to 1/precision nm, the cell, step and time.

    Lengths go from Angstrom to nm and times from fs to ps; ``dump_modify sfactor`` and ``tfactor`` are other factors. Units lj are written
    as they are.
    """

    style = "xtc"
    KEYWORDS = {**Trajectory.KEYWORDS, "precision": 1, "sfactor": 1, "tfactor": 1}

    def __init__(self, group: str, every: int, path: str, *, variables=None, regions=None):
        super().__init__(group, every, path, variables=variables, regions=regions)
        self.precision, self.sfactor, self.tfactor = 1000, 0.0, 0.0       # 0: by the units

    def _factors(self, name: str) -> tuple[float, float]:
        u = units.get(name)
        known = (1.0, 1.0) if name == "lj" else (0.1 / u.angstrom, 0.001 / u.femtosecond)
        return self.sfactor or known[0], self.tfactor or known[1]

    def start(self, path, n, step, dt):
        self._file = open(path, "wb")

    def write_view(self, snapshot, step, view):
        self.scales = self._factors(snapshot.system.units)
        super().write_view(snapshot, step, view)

    def frame(self, positions, cell, step, dt):
        scale, tick = self.scales
        # the library keeps frames back until its file is closed: a file for each, joined to the others
        with tempfile.TemporaryDirectory(prefix="asemd-xtc-") as folder:
            path = os.path.join(folder, "frame.xtc")
            with library()[1].XTCFile(path, "w") as out:
                out.write((scale * positions).astype(np.float32), (scale * cell).astype(np.float32), step, np.float32(tick * step * dt),
                          self.precision)
            with open(path, "rb") as f:
                self._file.write(f.read())
        if self.flush:
            self._file.flush()

    def _modify_precision(self, values, what, session):
        precision = whole(values[0], what)
        if precision not in PRECISION:
            raise InputError(f"{what}: expected one of {' '.join(map(str, PRECISION))}, got {values[0]}")
        self.precision = precision

    def _factor(self, name, values, what) -> None:
        value = number(values[0], what)
        if value <= 0.0:
            raise InputError(f"{what}: must be positive, got {values[0]}")
        setattr(self, name, value)

    def _modify_sfactor(self, values, what, session):
        self._factor("sfactor", values, what)

    def _modify_tfactor(self, values, what, session):
        self._factor("tfactor", values, what)
