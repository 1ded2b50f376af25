"""``print text [file name] [append name] [screen yes|no] [universe yes|no]``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take, yes_no

KEYWORDS = ("file", "append", "screen", "universe")


def run(session, args):
    text = session.substitute(take(args, 1, "print")[0])
    screen, universe, words = True, False, list(args[1:])
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"print: unknown keyword {key!r}{nearest(key, KEYWORDS)}; text with spaces needs quotes")
        value = take(words, 1, f"print {key}")[0]
        del words[0]
        if key == "screen":
            screen = yes_no(value, "print screen")
        elif key == "universe":
            universe = yes_no(value, "print universe")
        elif not session.passive:
            try:
                with open(value, "w" if key == "file" else "a", encoding="utf-8") as f:
                    f.write(text + "\n")
            except OSError as e:
                raise InputError(f"print: cannot write {value}: {e.strerror}") from None
    if screen:
        session.print(text)
    if universe:        # there is one partition, whose log is also that of the universe
        session.print(text)
