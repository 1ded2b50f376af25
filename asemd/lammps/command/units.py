"""``units style``"""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    take(args, 1, "units")
    session.scene.set_units(args[0])
