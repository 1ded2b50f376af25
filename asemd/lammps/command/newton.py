"""``newton pair [bond]``: remembered for `write_data` and variables; every pair and bond is computed once, whatever it says."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import yes_no


def run(session, args):
    if len(args) not in (1, 2):
        raise InputError(f"newton needs one or two of on and off, got {len(args)} words")
    values = tuple(yes_no(w, "newton") for w in args)
    values = values if len(values) == 2 else values * 2
    if session.scene.system is not None and values[1] != session.scene.newton[1]:
        raise InputError("newton command after simulation box is defined: the bond flag cannot change any more")
    session.scene.newton = values
