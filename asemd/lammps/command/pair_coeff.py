"""``pair_coeff I J values``"""
from __future__ import annotations


def run(session, args):
    scene = session.scene
    scene.interactions.set_coeff("pair", args, scene.need_system("pair_coeff"))
