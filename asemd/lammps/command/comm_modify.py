"""``comm_modify keyword value ...``: checked and without effect, since atoms are not spread over processors."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take

KEYWORDS = {"mode": 1, "cutoff": 1, "cutoff/multi": 2, "group": 1, "reduce/multi": 0, "vel": 1}


def run(session, args):
    words = list(args)
    take(words, 1, "comm_modify")
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"comm_modify: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        del words[:len(take(words, KEYWORDS[key], f"comm_modify {key}"))]
