"""``improper_style NAME args``, with the names of sub-styles after ``hybrid``."""
from __future__ import annotations


def run(session, args):
    session.scene.interactions.set_style("improper", args)
