"""``uncompute ID``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take


def run(session, args):
    id = take(args, 1, "uncompute")[0]
    scene = session.scene
    if id not in scene.computes:
        raise InputError(f"uncompute: there is no compute {id}{nearest(id, scene.computes)}")
    if id in (scene.thermo.temp, scene.thermo.press, "thermo_pe"):
        raise InputError(f"uncompute: compute {id} is used by thermo output")
    del scene.computes[id]
    session.moment.forget()
