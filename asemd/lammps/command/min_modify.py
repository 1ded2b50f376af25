"""``min_modify keyword value ...``"""
from __future__ import annotations


def run(session, args):
    session.scene.min_modify.modify(list(args))
