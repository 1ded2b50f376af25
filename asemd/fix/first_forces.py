"""The first forces of a run once more, for a fix that has changed what they come from."""
from __future__ import annotations

from typing import TYPE_CHECKING

from asemd.term import rewind

if TYPE_CHECKING:
    from asemd.fix import Fix
    from asemd.loop import Loop


def forces_again(loop: Loop, fix: Fix) -> None:
    """Compute the first forces, and what the fixes before `fix` do to them, in its `setup`."""
    rewind(loop.engine)
    loop.engine.forces(True)
    loop.first_shares()
    for n in range(loop.fixes.index(fix)):
        if "post_force" in loop._kinds[n]:
            loop._call(n, "post_force")
    loop._collect()
    loop.sync_out()
