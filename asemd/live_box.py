"""The box of a running simulation, which fixes may change, between the loop and the system."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from asemd.kernels.state import BoxState
from asemd.neighbor import IMAGES


def live(engine) -> BoxState:
    """The box as the loop has it; of one that fixes move, with the shifts of the present lists."""
    shifts, shifts4 = np.zeros((0, 3)), np.zeros((0, 4))
    if not engine.box_moves:
        old = engine.state.box if engine.state is not None else None
        if old is not None and old.vectors is engine.vectors and old.origin is engine.origin and old.cell is engine.cell:
            return old
    elif engine.mode == "cluster" and hasattr(engine.list, "shifts"):
        shifts, shifts4 = engine.list.shifts, engine.list.shifts4
    elif engine.mode == "plain" and hasattr(engine.list, "shifts"):
        shifts = engine.list.shifts
    reduction = np.rint(engine.cell.reduced @ np.linalg.inv(engine.vectors))
    return BoxState(engine.vectors, engine.origin, engine.periodic.astype(float), engine.cell, reduction,
                    np.rint(shifts @ np.linalg.inv(engine.vectors)), shifts, shifts4, IMAGES.copy(), engine.shifts27,
                    np.vstack([engine.origin, engine.vectors]), np.array([float(engine.system.box.triclinic)]))


def take(engine) -> None:
    """The box of the loop becomes that of the system."""
    box = engine.system.box
    if engine.state is not None and not (np.array_equal(box.cell, engine.vectors) and np.array_equal(box.origin, engine.origin)):
        engine.system.box = replace(box, origin=engine.origin, cell=engine.vectors)
