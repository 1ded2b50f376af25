"""``next variables...``"""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    take(args, 1, "next")
    session.exhausted = session.variables.advance(list(args)) or session.exhausted
