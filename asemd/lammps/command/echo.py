"""``echo none|screen|log|both``"""
from __future__ import annotations

from asemd.words import exactly


def run(session, args):
    session.log.set_echo(exactly(args, 1, "echo")[0])
