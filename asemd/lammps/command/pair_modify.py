"""``pair_modify keyword value ...``: shift, mix, tail, compute, and settings of long-range styles."""
from __future__ import annotations


def run(session, args):
    session.scene.interactions.modify_pair(args)
