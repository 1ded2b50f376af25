"""``bond_coeff TYPE values``"""
from __future__ import annotations


def run(session, args):
    scene = session.scene
    scene.interactions.set_coeff("bond", args, scene.need_system("bond_coeff"))
