"""``dump ID group dcd N file``: the trajectory format of CHARMM and NAMD, written by MDAnalysis."""
from __future__ import annotations

import numpy as np

from asemd.dump._trajectory import Trajectory, library
from asemd.errors import InputError


class DCD(Trajectory):
    """Positions in single precision with the cell; ``dump_modify unwrap yes`` undoes the wrapping into the box."""

    style = "dcd"
    _frames = 0

    def start(self, path, n, step, dt):
        self._file = library()[0].DCDFile(path, "w")
        self._file.write_header(remarks="Written by asemd", natoms=n, istart=step, nsavc=self.every, delta=dt, is_periodic=1)

        self._frames = 0

    def frame(self, positions, cell, step, dt):
        lengths = np.linalg.norm(cell, axis=1)
        a, b, c = cell / lengths[:, None]
        box = [lengths[0], a @ b, lengths[1], a @ c, b @ c, lengths[2]]     # the order of the file, cosines for angles
        self._file.write(positions.astype(np.float32), np.asarray(box))
        self._frames += 1

    def close(self):
        """Close the file, and see whether everything arrived: its writer says nothing of a full disk."""
        written, was_open = self._frames, self._file is not None
        super().close()
        if was_open:
            try:
                with library()[0].DCDFile(self.path) as found:
                    arrived = len(found)
            except OSError:
                arrived = 0
            if arrived != written:
                raise InputError(f"dump {self.id}: cannot write {self.path}: {arrived} of {written} snapshots arrived; is there room?")

    def _modify_every(self, values, what, session):
        if values[0].startswith("v_"):
            raise InputError(f"{what}: dcd files need equal intervals, give a number of steps")
        if self._file is not None:
            raise InputError(f"{what}: the interval of a dcd file cannot change after the first snapshot")
        super()._modify_every(values, what, session)

    def _modify_every_time(self, values, what, session):
        raise InputError(f"{what}: dcd files need equal intervals of steps, use every")
