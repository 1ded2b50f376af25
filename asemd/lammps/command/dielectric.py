"""``dielectric VALUE``: Coulomb interactions are divided by it."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import number


def run(session, args):
    if len(args) != 1:
        raise InputError(f"dielectric needs one value, got {len(args)}")
    value = number(args[0], "dielectric")
    if value == 0.0:
        raise InputError("dielectric must not be 0")
    session.scene.interactions.dielectric = value
