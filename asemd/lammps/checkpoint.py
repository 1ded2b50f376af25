"""The state of a run between two steps: what makes a continued run equal the uninterrupted one bit for bit.

At a step whose state is kept the neighbour list is built afresh from the atoms in the order of their rows, in the run that goes on as in
the one that is continued from a file: from there on both add the same numbers in the same order. Forces are kept because some depend on
velocities, which are half a step behind when forces are computed.
"""
from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from asemd.loop import Loop

CLOSE = 1e-9        # forces that differ by less (relative to the largest one) come from the same interactions


def renew(loop: Loop) -> np.ndarray:
    """A fresh list at the present step; ``loop.result`` gets the energies by it, the forces of the step stay.

    Returns
    -------
    (n, 3) array
        Forces of the interactions alone, without the part of fixes.
    """
    e, system = loop.engine, loop.system
    if hasattr(loop, "levels"):         # respa: the forces of each level are made afresh, here as in the continued run
        counters = e.builds, e.dangerous, e.timings
        loop.setup(loop.begin, loop.end)
        e.builds, e.dangerous, e.timings = counters
        return system.f.copy()
    for name in ("pre_exchange", "pre_neighbor"):
        loop._hook(name)
    e.store()
    loop._with_lost(e.load)
    if e.changed:
        loop._make_module()
    loop._ago = 0
    loop._hook("post_neighbor")
    kept, virial = system.f.copy(), e.state.virial.copy()
    e.bonds.hold(True)
    e.forces(True)
    e.bonds.hold(False)
    e.state.virial[:] = virial      # of fixes
    loop.result = e.collect()
    alone = system.f.copy()
    set_forces(loop, kept)
    return alone


def set_forces(loop: Loop, forces: np.ndarray) -> None:
    """Forces (n, 3) for the next half step, by row."""
    loop.system.f[:] = forces
    loop.state.f[:, loop.engine.slot_of] = forces.T


def describe(fixes) -> list[list]:
    """What must be the same of the fixes for their numbers to be taken over."""
    return [[f.id, f.style, f.group, [str(w) for w in f.to_lammps()]] for f in fixes]


def digest(system) -> str:
    """A number for atoms and box."""
    h = hashlib.sha256()
    for array in (system.x, system.v, system.type, system.atom_masses(), system.box.cell, system.box.origin, system.q):
        if array is not None:
            h.update(np.ascontiguousarray(array).tobytes())
    return h.hexdigest()


def arrays_of(a: np.ndarray | tuple[np.ndarray, ...]) -> tuple[np.ndarray, ...]:
    """The arrays of a fix, which may have one or several."""
    return (a,) if isinstance(a, np.ndarray) else a


def take(loop: Loop, alone: np.ndarray) -> dict[str, Any] | None:
    """The state of a run; `alone` is what `renew` returned at this step. None for respa, which begins afresh."""
    if hasattr(loop, "levels"):
        return None
    numbers = [{"p": p.copy(), "a": [array.copy() for array in arrays_of(a)]} for p, a in loop.fix_data]
    return {"forces": loop.system.f.copy(), "alone": alone, "dt": loop.dt, "atoms": digest(loop.system), "fixes": describe(loop.fixes),
            "numbers": numbers, "velocities": loop.system.v.copy()}


def resume(loop: Loop, kept: dict[str, Any]) -> bool:
    """After ``loop.setup``: go on from the state `kept` if interactions and fixes are those of that run."""
    if loop.dt != kept["dt"] or len(loop.fixes) != len(kept["fixes"]):
        return False
    for fix, (*name, words), numbers in zip(loop.fixes, kept["fixes"], kept["numbers"], strict=True):
        if [fix.id, fix.style, fix.group] != name or not fix.goes_on(words, numbers["a"]):
            return False
    alone = renew(loop)
    largest = float(np.abs(kept["alone"]).max(initial=0.0))
    if alone.shape != kept["alone"].shape or not np.abs(alone - kept["alone"]).max(initial=0.0) <= CLOSE * largest:
        return False
    for (p, a), old in zip(loop.fix_data, kept["numbers"], strict=True):
        if p.shape == old["p"].shape:
            p[:] = old["p"]
        kept_arrays = [old["a"]] if isinstance(old["a"], np.ndarray) else old["a"]
        if [array.shape for array in arrays_of(a)] == [array.shape for array in kept_arrays]:
            for array, before in zip(arrays_of(a), kept_arrays, strict=True):
                array[:] = before
    set_forces(loop, kept["forces"])
    v = kept.get("velocities", loop.system.v)       # the set-up of fixes may have changed them
    loop.system.v[:] = v
    loop.state.v[:, loop.engine.slot_of] = v.T
    return True
