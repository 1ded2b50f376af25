"""``timer style mode``: which times the table after a run shows; asemd always has those of style normal."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take

STYLES = ("off", "loop", "normal", "full")
MODES = ("sync", "nosync")


def run(session, args):
    style, mode, words = "normal", "nosync", list(args)
    while words:
        word = words.pop(0)
        if word in STYLES:
            style = word
        elif word in MODES:
            mode = word
        elif word in ("timeout", "every"):
            value = take(words, 1, f"timer {word}")[0]
            del words[0]
            if word == "timeout" and value not in ("off", "unlimited"):
                raise InputError("timer timeout is not supported: limit the steps of run, or stop the run with Ctrl-C")
        else:
            known = (*STYLES, *MODES, "timeout", "every")
            raise InputError(f"timer: unknown keyword {word!r}{nearest(word, known)}")
    session.print(f"New timer settings: style={style}  mode={mode}  timeout=off")
