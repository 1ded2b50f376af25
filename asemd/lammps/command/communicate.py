"""``communicate single|multi keyword value ...``: the older form of ``comm_modify``, checked and without effect."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.lammps.command import comm_modify
from asemd.words import choice, take

KEYWORDS = ("cutoff", "group", "vel")


def run(session, args):
    style = choice(take(args, 1, "communicate")[0], ("single", "multi"), "communicate")
    words = list(args[1:])
    for key in words[::2]:
        if key not in KEYWORDS:
            raise InputError(f"communicate: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
    comm_modify.run(session, ["mode", style, *words])
