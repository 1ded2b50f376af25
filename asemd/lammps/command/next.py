"""``next variables...``"""
from __future__ import annotations

from asemd.variable import UNIVERSE
from asemd.words import take


def run(session, args):
    names, table = take(args, 1, "next") and list(args), session.variables.table
    if session.variables.advance(names):
        session.exhausted = True
    elif table[names[0]].style in UNIVERSE:
        session.print(f"Increment via next: value {table[names[0]].current + 1} on partition 0")
