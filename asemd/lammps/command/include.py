"""``include file``"""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    session.file(take(args, 1, "include")[0])
