"""Scenes with constraints: forces are compared without those that hold distances, and what is held counts nowhere."""
from __future__ import annotations

import numpy as np

from asemd.fix import constraint_clusters as clusters
from asemd.kernels.rows import of_slots
from asemd.loop import Loop
from asemd.scene import Scene


def holding(scene: Scene) -> list:
    """The fixes that hold distances between atoms: shake and rattle, rigid bodies."""
    return [f for f in scene.fixes.values() if hasattr(f, "constraint_error") or f.style.startswith("rigid")]


def named(fixes) -> str:
    """These fixes in words."""
    return ", ".join(f"fix {f.id} ({f.style})" for f in fixes)


def switch_off(scene: Scene) -> None:
    """Turn off the bonds and angles that fixes of a scene of one's own will hold; fixes of a script have done so already."""
    for fix in scene.fixes.values():
        if hasattr(fix, "constraint_error") and not fix.lasting:
            found = clusters.find(scene.system, scene.groups.mask(fix.group), fix.chosen, f"fix {fix.style}")
            fix.clusters, fix.ids, fix.lasting = found, clusters.by_id(found, scene.system), True
            clusters.switch(scene.system, found, False)


def held(scene: Scene, kind: str) -> str:
    """The fix that holds bonds or angles, in words; empty if none does."""
    _, types = scene.system.topology.items(kind)
    fixes = [f for f in scene.fixes.values() if hasattr(f, "constraint_error")]
    return named(fixes) if fixes and (types < 0).any() else ""


def field_forces(loop: Loop) -> np.ndarray:
    """(n, 3) forces of the force field at the end of a step, with the lists of the run: without the forces of constraints."""
    if not any(hasattr(f, "constraint_error") for f in loop.fixes):
        return loop.system.f
    e = loop.engine
    kept = e.buffers.copy(), e.state.virial.copy(), e.acc.copy()
    e.forces(True)
    found = np.empty((loop.system.n, 3))
    of_slots(e.slot_of, e.state.f, found)
    for array, old in zip((e.buffers, e.state.virial, e.acc), kept):
        array[:] = old
    return found
