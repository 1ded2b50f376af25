"""``reset_timestep N [time T]``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import number, take, whole


def run(session, args):
    scene = session.scene
    step = whole(take(args, 1, "reset_timestep")[0], "reset_timestep")
    if step < 0:
        raise InputError(f"reset_timestep: the step must not be negative, got {step}")
    if len(args) not in (1, 3) or (len(args) == 3 and args[1] != "time"):
        raise InputError(f"reset_timestep takes a step and optionally time T, got {' '.join(args)}")
    if len(args) == 3:
        scene.time_base = (number(args[2], "reset_timestep time"), step)
    elif step < scene.time_base[1]:
        scene.time_base = (0.0, step)
    scene.step = step
    session.loop = None
