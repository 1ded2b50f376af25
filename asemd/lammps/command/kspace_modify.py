"""``kspace_modify keyword value ...``: settings of the long-range solver; they go when another ``kspace_style`` is chosen."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.kspace_settings import parse


def run(session, args):
    settings, interactions = parse(args), session.scene.interactions
    if interactions.kspace == "none":
        raise InputError("kspace_modify command before a kspace_style other than none is set: there is no long-range solver to modify")
    interactions.kspace_modify.update(settings)
