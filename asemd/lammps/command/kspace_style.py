"""``kspace_style NAME ...``: the solver of long-range interactions, see `asemd.kspace`."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.kspace import KSpace
from asemd.registry import class_of, plain_name


def run(session, args):
    if not args:
        raise InputError("kspace_style needs the name of a style")
    interactions, name = session.scene.interactions, plain_name(args[0])
    if name == "none":
        if len(args) > 1:
            raise InputError(f"kspace_style none takes no arguments, got {' '.join(args[1:])}")
    else:
        class_of("kspace", name, KSpace).from_words(args[1:])
    interactions.kspace, interactions.kspace_modify, interactions.long_range = " ".join([name, *args[1:]]), {}, {}
