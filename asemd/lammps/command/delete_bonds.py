"""``delete_bonds group style args keyword ...``: turn bonds, angles, dihedrals and impropers off or on, or remove them for good.

``remove`` takes away all of the group that is off, of any kind, also what earlier commands turned off.
Source: LAMMPS manual, delete_bonds.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.lammps.setup_log import report_mixing, report_special
from asemd.topology import KINDS
from asemd.words import bounds, take

STYLES = ("multi", "atom", *KINDS, "stats")
KEYWORDS = ("any", "undo", "remove", "special")


def run(session, args):
    scene = session.scene
    system = scene.need_system("delete_bonds")
    if not system.molecular:
        raise InputError(f"delete_bonds: atom_style {system.atom_style} has no bonds")
    group, style = take(args, 2, "delete_bonds")[:2]
    mask = scene.groups.mask(group, "delete_bonds")
    if style not in STYLES:
        raise InputError(f"delete_bonds: unknown style {style!r}{nearest(style, STYLES)}; there are {' '.join(STYLES)}")
    what, words, types = f"delete_bonds {style}", args[2:], None
    if style not in ("multi", "stats"):
        types, words = _types(system, style, take(words, 1, what)[0], what), words[1:]
    for word in words:
        if word not in KEYWORDS:
            raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
    if style == "stats" and words:
        raise InputError(f"{what} changes nothing and takes no keywords, got {' '.join(words)}")
    topology = system.topology
    kinds = () if style == "stats" else KINDS if style in ("multi", "atom") else (style,)
    parts = {}
    for kind, atoms, now in topology:
        new, member = now.copy(), mask[atoms].any(axis=1) if "any" in words else mask[atoms].all(axis=1)
        if kind in kinds:
            chosen = member.copy()
            if style == "atom":
                chosen &= types[system.type[atoms]].any(axis=1)
            elif style != "multi":
                chosen &= types[np.abs(new)]
            new[chosen & ((new < 0) if "undo" in words else (new > 0))] *= -1
        stays = (new > 0) | ~member if "remove" in words else np.ones(len(new), bool)
        parts[kind] = atoms[stays], new[stays]
    system.topology = topology.replaced(parts, "special" in words)
    report_mixing(session, "delete_bonds")
    session.print("Deleting bonds ...")
    for kind, _, new in system.topology:
        session.print(f"  {len(new)} total {kind}s, {(new > 0).sum()} turned on, {(new <= 0).sum()} turned off")
    if "special" in words:
        report_special(session)
    if style != "stats":
        session.changed()


def _types(system, style: str, word: str, what: str) -> np.ndarray:
    """Which types are meant, from 0 on; 0 are bonds that broke."""
    kind = style
    most = system.counts["ntypes" if kind == "atom" else f"n{kind}types"]
    if kind == "bond" and word == "0":
        first = last = 0
    else:
        first, last = bounds(word, 1, most, f"{what} type", system.labels.get(kind))
    chosen = np.zeros(most + 1, bool)
    chosen[first:last + 1] = True
    return chosen
