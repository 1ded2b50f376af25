"""``comm_style brick|tiled``: checked and without effect."""
from __future__ import annotations

from asemd.words import choice, exactly


def run(session, args):
    choice(exactly(args, 1, "comm_style")[0], ("brick", "tiled"), "comm_style")
