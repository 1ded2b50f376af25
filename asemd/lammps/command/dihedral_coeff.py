"""``dihedral_coeff TYPE values``"""
from __future__ import annotations

from asemd.lammps.live_coefficients import fill


def run(session, args):
    scene = session.scene
    scene.interactions.set_coeff("dihedral", args, scene.need_system("dihedral_coeff"))
    fill(session, "dihedral")
