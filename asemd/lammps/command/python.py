"""``python func keyword args...``, ``python func invoke``, ``python source file``"""
from __future__ import annotations


def run(session, args):
    session.refuse_if_safe("python")
    if not session.passive:
        session.python.command(list(args))
