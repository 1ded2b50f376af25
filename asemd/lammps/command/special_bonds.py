"""``special_bonds keyword values ...``: how much of a pair interaction is left between atoms one, two and three bonds apart."""
from __future__ import annotations


def run(session, args):
    session.scene.interactions.set_special(args)
