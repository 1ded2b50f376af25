"""``comm_style brick|tiled``: checked and without effect."""
from __future__ import annotations

from asemd.words import choice, take


def run(session, args):
    choice(take(args, 1, "comm_style")[0], ("brick", "tiled"), "comm_style")
