"""``include file``"""
from __future__ import annotations

from asemd.words import exactly


def run(session, args):
    session.file(exactly(args, 1, "include")[0])
