"""``box tilt small|large``: whether a strongly tilted box is worth a warning. Any tilt works here, so both are accepted."""
from __future__ import annotations

from asemd.errors import InputError


def run(session, args: list[str]) -> None:
    """Source: LAMMPS manual, box command."""
    if len(args) != 2 or args[0] != "tilt" or args[1] not in ("small", "large"):
        raise InputError(f"box needs: tilt small|large, got {' '.join(args) or 'nothing'}")
