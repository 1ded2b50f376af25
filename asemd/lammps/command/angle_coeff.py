"""``angle_coeff TYPE values``"""
from __future__ import annotations

from asemd.lammps.live_coefficients import fill


def run(session, args):
    scene = session.scene
    with session.passing_warnings():
        scene.interactions.set_coeff("angle", args, scene.need_system("angle_coeff"))
    fill(session, "angle")
