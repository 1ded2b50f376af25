"""``kspace_modify``: refused, since only ``kspace_style none`` exists."""
from __future__ import annotations

from asemd.errors import InputError


def run(session, args):
    raise InputError("kspace_modify command before a kspace_style other than none is set")
