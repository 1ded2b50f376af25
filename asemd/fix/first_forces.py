"""The first forces of a run, once more where a fix has changed what they come from."""
from __future__ import annotations

from typing import TYPE_CHECKING

from asemd.term import rewind

if TYPE_CHECKING:
    from asemd.loop import Loop


def settle(loop: Loop) -> None:
    """Let fixes change what the first forces come from, before any of them is set up: some move atoms then."""
    loop.first_shares()
    if any([fix.setup_pre_force(loop) for fix in loop.fixes]):
        rewind(loop.engine)
        loop.engine.forces(True)
        loop.first_shares()
        loop._collect()
        loop.sync_out()
