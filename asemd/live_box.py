"""The box of a running simulation, which fixes may change, between the loop and the system."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from asemd.errors import LostAtoms
from asemd.kernels.rows import extent
from asemd.kernels.state import BoxState

INSIDE = 1e-9       # of the box: whoever is that far from its faces is inside, whatever rounding does


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
                    np.rint(shifts @ np.linalg.inv(engine.vectors)), shifts, shifts4, engine.close_images, engine.close_shifts,
                    np.vstack([engine.origin, engine.vectors]), np.array([float(engine.system.box.triclinic)]))


def take(engine) -> None:
    """The box of the loop becomes that of the system."""
    box = engine.system.box
    if engine.state is not None and not (np.array_equal(box.cell, engine.vectors) and np.array_equal(box.origin, engine.origin)):
        engine.system.box = replace(box, origin=engine.origin, cell=engine.vectors)


def shrunk(engine) -> None:
    """The box of the loop becomes that of the engine; a cell that has become too narrow for clusters gets a plain list."""
    take(engine)
    engine.set_box()
    if engine.mode == "cluster" and (engine.widths[engine.periodic] <= engine.reach).any():
        engine.store()
        engine.update(engine.system, engine.solver)
        engine.load(listed=False)


def faces(engine) -> np.ndarray:
    """Shrink-wrapped faces follow the atoms; an atom beyond a fixed face is lost.

    Returns
    -------
    (2, 3)
        Smallest and largest fractional coordinates in the box that there is then; those along periodic directions are within the cell.
    """
    box, s = engine.system.box, engine.state
    shares = np.array([[0.0] * 3, [1.0] * 3]) if engine.periodic.all() else extent(s.x, s.row, engine.ns, engine.origin, engine.inverse)
    if not box.is_lammps_frame or engine.periodic.all():
        return shares
    if "s" not in (fixed := "".join(box.boundary)) and "m" not in fixed:
        low, high = shares.tolist()
        if all(p or (a > INSIDE and b < 1.0 - INSIDE) for p, a, b in zip(engine.periodic.tolist(), low, high)):
            return shares
    rows = s.row[:engine.ns]
    inside = rows >= 0
    x, rows = s.x[:, :engine.ns].T[inside], rows[inside]
    new = box.shrink_wrapped(x)
    if new is not box:
        engine.system.box = box = new
        engine.set_box()
    out = box.beyond(x)[:, :engine.system.dimension]
    lost = np.flatnonzero(out.any(axis=1))
    if len(lost):
        ids = engine.system.id[rows[lost]]
        first = lost[np.argmin(ids)]
        a = int(np.flatnonzero(out[first])[0])
        raise LostAtoms(f"{len(lost)} atom{'s' * (len(lost) > 1)} lost: atom {ids.min()} at {'xyz'[a]} = {x[first, a]:g} left the box "
                        f"[{box.lo[a]:g}, {box.hi[a]:g}] through a fixed boundary; use a shrink-wrapped boundary, a wall, "
                        "or a shorter time step", np.sort(rows[lost]))
    return extent(s.x, s.row, engine.ns, engine.origin, engine.inverse)
