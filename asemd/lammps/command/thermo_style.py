"""``thermo_style style keywords...``"""
from __future__ import annotations

import re

from asemd.compute import Compute
from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.thermo import Thermo, parse_reference
from asemd.words import take

NUMBERS = ("equal", "timer", "internal", "python")     # variables that are one number
RANGE = re.compile(r"([cfv])_(\w+)\[(\d*)\*(\d*)\]")


def run(session, args):
    scene = session.scene
    scene.need_system("thermo_style")
    take(args, 1, "thermo_style")
    words = [name for word in args[1:] for name in _expanded(session, word)]
    for word in words:
        reference = parse_reference(word)
        table = {"c": scene.computes, "f": scene.fixes}.get(reference[0]) if reference else None
        if table is not None and reference[1] not in table:
            kind, id = "compute" if reference[0] == "c" else "fix", reference[1]
            raise InputError(f"thermo_style: there is no {kind} {id}{nearest(id, table)}")
        if table is not None and len(reference[2]) < 2:
            _check_output(table[reference[1]], "vector" if reference[2] else "scalar")
        if reference and reference[0] == "v":
            style, fits = session.variables.find(reference[1]).style, ("vector",) if reference[2] else NUMBERS
            if style not in fits:
                raise InputError(f"thermo_style: {word} needs a variable of style {fits[0]}, {reference[1]} has style {style}")
    before = scene.thermo
    lost = before != Thermo(before.style, before.words, before.every, before.style if before.style in ("multi", "yaml") else "one")
    before.set_style(args[0], words)
    if lost:
        session.warn("new thermo_style command, previous thermo_modify settings are lost")


def _check_output(source, kind: str) -> None:
    """Say at once, with the line of ``thermo_style``, that a compute or fix never has a global scalar, or vector."""
    base = Fix if isinstance(source, Fix) else Compute
    if getattr(type(source), kind) is getattr(base, kind):
        raise InputError(f"thermo_style: {base.__name__.lower()} {source.id} (style {source.style}) has no global {kind}")


def _expanded(session, word: str) -> list[str]:
    """``c_ID[*]`` as all elements of the vector."""
    found = RANGE.fullmatch(word)
    if not found:
        return [word]
    kind, id, first, last = found.groups()
    return [f"{kind}_{id}[{k}]" for k in range(int(first or 1), int(last or session.variables.provider.vector_length(kind, id)) + 1)]
