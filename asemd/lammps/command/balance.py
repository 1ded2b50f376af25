"""``balance ...``: without effect, since atoms are not spread over processors."""
from __future__ import annotations

from asemd.fix.balance import KEYWORDS, read_keywords, read_shift
from asemd.lammps.command.write_restart import settle
from asemd.words import choice, number, take


def run(session, args):
    session.scene.need_system("balance")
    number(take(args, 2, "balance thresh style")[0], "balance thresh")
    style, rest = choice(args[1], ("x", "y", "z", "shift", "rcb"), "balance style"), args[2:]
    if style == "shift":
        rest = read_shift(rest, "balance")
    while style in ("x", "y", "z"):
        if take(rest, 1, f"balance {style}")[0] != "uniform":
            number(rest[0], f"balance {style}")
        rest = rest[1:]
        while rest and rest[0] not in (*KEYWORDS, "x", "y", "z"):
            number(rest[0], f"balance {style}")
            rest = rest[1:]
        style, rest = (rest[0], rest[1:]) if rest and rest[0] in ("x", "y", "z") else ("", rest)
    read_keywords(rest, "balance")
    session.print("  balance: no effect, there is one process")
    settle(session)
