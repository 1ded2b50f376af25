"""``thermo N`` or ``thermo v_name``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import exactly, whole


def run(session, args):
    word = exactly(args, 1, "thermo")[0]
    if word.startswith("v_"):
        session.scene.thermo.every = word[2:]
        session.remember("thermo")
        return
    every = whole(word, "thermo")
    if every < 0:
        raise InputError(f"thermo: the number of steps must not be negative, got {word}")
    session.scene.thermo.every = every
