"""``comm_modify keyword value ...``: checked and without effect, since atoms are not spread over processors."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import choice, number, take, yes_no

KEYWORDS = {"mode": 1, "cutoff": 1, "cutoff/multi": 2, "group": 1, "reduce/multi": 0, "vel": 1}


def run(session, args):
    words = list(args)
    take(words, 1, "comm_modify")
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"comm_modify: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        what = f"comm_modify {key}"
        values = take(words, KEYWORDS[key], what)
        del words[:len(values)]
        if key == "mode":
            choice(values[0], ("single", "multi", "multi/old"), what)
        elif key == "vel":
            yes_no(values[0], what)
        elif key == "cutoff" and number(values[0], what) < 0.0:
            raise InputError(f"{what}: must not be negative, got {values[0]}")
        elif key == "group":
            session.scene.groups.mask(values[0], what)
