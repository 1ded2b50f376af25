"""``timestep dt``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import number


def run(session, args):
    if len(args) != 1:
        raise InputError(f"timestep needs one value, got {len(args)}")
    session.scene.set_dt(number(args[0], "timestep"))
