"""``neighbor skin style``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import choice, exactly, number


def run(session, args):
    skin = number(exactly(args, 2, "neighbor")[0], "neighbor: skin")
    style = choice(args[1], ("bin", "nsq", "multi", "multi/old"), "neighbor: style")
    if skin < 0.0:
        raise InputError(f"neighbor: the skin must not be negative, got {args[0]}")
    session.scene.neighbor.skin, session.scene.list_style = skin, style
