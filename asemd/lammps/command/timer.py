"""``timer style mode timeout limit every N``: which times the table after a run shows, and how long runs may take altogether."""
from __future__ import annotations

import re

from asemd.errors import InputError, nearest
from asemd.lammps.timer import MODES, STYLES
from asemd.words import take, whole


def run(session, args):
    timer, words = session.timer, list(args)
    while words:
        word = words.pop(0)
        if word in STYLES:
            timer.style = word
        elif word in MODES:
            timer.mode = word
        elif word in ("timeout", "every"):
            value = take(words, 1, f"timer {word}")[0]
            del words[0]
            if word == "timeout":
                timer.limit(_seconds(value))
            else:
                timer.every = whole(value, "timer every")
                if timer.every < 1:
                    raise InputError(f"timer every: must be positive, got {value}")
        else:
            known = (*STYLES, *MODES, "timeout", "every")
            raise InputError(f"timer: unknown keyword {word!r}{nearest(word, known)}")
    session.print(f"New timer settings: {timer}")


def _seconds(word: str) -> float | None:
    """A limit as seconds: ``S``, ``M:S`` or ``H:M:S``; None for ``off``."""
    if word in ("off", "unlimited"):
        return None
    if not re.fullmatch(r"\d+(:\d+){0,2}", word):
        raise InputError(f"timer timeout: expected seconds, minutes:seconds, hours:minutes:seconds or off, got {word!r}")
    seconds = 0
    for part in word.split(":"):
        seconds = 60 * seconds + int(part)
    return float(seconds)
