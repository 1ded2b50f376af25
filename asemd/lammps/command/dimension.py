"""``dimension N``"""
from __future__ import annotations

from asemd.words import choice, take


def run(session, args):
    take(args, 1, "dimension")
    session.scene.dimension = int(choice(args[0], ("2", "3"), "dimension"))
