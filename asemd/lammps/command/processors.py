"""``processors Px Py Pz keyword args ...``: checked and without effect; threads are chosen with ``--threads``."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import choice, take, whole

GRIDS = {"onelevel": 0, "twolevel": 4, "numa": 0, "custom": 1}
MAPS = ("cart", "cart/reorder", "xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
KEYWORDS = {"grid": 1, "map": 1, "part": 3, "file": 1, "numa": 0, "numa_nodes": 1}


def run(session, args):
    for word in take(args, 3, "processors"):
        if word != "*" and whole(word, "processors") < 1:
            raise InputError(f"processors: expected a positive number or *, got {word}")
    words = args[3:]
    while words:
        key, what = words[0], f"processors {words[0]}"
        if key not in KEYWORDS:
            raise InputError(f"processors: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        values = take(words[1:], KEYWORDS[key], what)
        words = words[1 + len(values):]
        if key == "map":
            choice(values[0], MAPS, what)
        elif key == "grid":
            more = take(words, GRIDS[choice(values[0], GRIDS, what)], f"{what} {values[0]}")
            words = words[len(more):]
    session.print("  1 by 1 by 1 MPI processor grid asked for by asemd; the processors command has no effect")
