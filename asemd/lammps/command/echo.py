"""``echo none|screen|log|both``"""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    session.log.set_echo(take(args, 1, "echo")[0])
