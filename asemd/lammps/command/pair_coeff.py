"""``pair_coeff I J values``"""
from __future__ import annotations

from asemd.lammps.live_coefficients import fill


def run(session, args):
    scene = session.scene
    with session.passing_warnings():
        scene.interactions.set_coeff("pair", args, scene.need_system("pair_coeff"))
    fill(session, "pair")
