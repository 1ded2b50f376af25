"""``atom_modify map|sort|first|id value``: accepted; atoms always have ids and are found by them, and sorted by the engine as it needs."""
from __future__ import annotations

from asemd.atom_style import BONDED
from asemd.errors import InputError, nearest
from asemd.words import choice, number, take, whole, yes_no

KEYWORDS = ("id", "map", "first", "sort")


def run(session, args):
    words = take(args, 1, "atom_modify") and list(args)
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"atom_modify: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        values = take(words, 2 if key == "sort" else 1, f"atom_modify {key}")
        del words[:len(values)]
        if key in ("id", "map") and session.scene.system is not None:
            raise InputError(f"atom_modify {key} must stand before the box is defined")
        if key == "map":
            session.scene.map_style = choice(values[0], ("array", "hash", "yes"), "atom_modify map")
        elif key == "id":
            if not yes_no(values[0], "atom_modify id"):
                if session.scene.atom_style in BONDED:
                    raise InputError(f"atom_modify id no: atom_style {session.scene.atom_style} needs atom ids for its bonds")
                session.warn("atom_modify id no: atoms keep their ids, which need no more time here; files show them where LAMMPS writes 0")
        elif key == "sort":
            sort = whole(values[0], "atom_modify sort"), number(values[1], "atom_modify sort")
            if min(sort) < 0:
                raise InputError(f"atom_modify sort: must not be negative, got {' '.join(values)}")
            session.scene.sort = sort
        else:
            if session.scene.system is not None:
                session.scene.groups.mask(values[0], "atom_modify first")
            session.scene.first_group = "" if values[0] == "all" else values[0]
