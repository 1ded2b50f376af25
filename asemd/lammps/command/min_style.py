"""``min_style style``"""
from __future__ import annotations

from asemd.lammps import catalog
from asemd.minimize import Options
from asemd.registry import plain_name
from asemd.words import take


def run(session, args):
    session.scene.need_system("min_style")
    style = plain_name(take(args, 1, "min_style")[0])
    if not catalog.exists("minimize", style):
        raise catalog.unknown("minimize", args[0])
    session.scene.min_style, session.scene.min_modify = style, Options()     # settings of min_modify go with the old style
