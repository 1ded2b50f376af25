"""``units style``"""
from __future__ import annotations

from asemd.words import exactly


def run(session, args):
    exactly(args, 1, "units")
    session.scene.set_units(args[0])
