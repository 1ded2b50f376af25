"""``create_bonds many group1 group2 type rmin rmax``, ``create_bonds single/bond type id id [special yes|no]`` and its relatives.

Source: LAMMPS manual, create_bonds.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.lammps.setup_log import report_mixing, report_special
from asemd.topology import ATOMS
from asemd.words import bounds, number, take, whole, yes_no

STYLES = ("many", *(f"single/{kind}" for kind in ATOMS))


def run(session, args):
    system = session.scene.need_system("create_bonds")
    if not system.molecular:
        raise InputError(f"create_bonds: atom_style {system.atom_style} has no bonds")
    style = take(args, 1, "create_bonds")[0]
    if style not in STYLES:
        raise InputError(f"create_bonds: unknown style {style!r}{nearest(style, STYLES)}; there are {' '.join(STYLES)}")
    what = f"create_bonds {style}"
    if style == "many":
        special = True
        _many(session, system, args[1:], what)
    else:
        special = _single(system, style.removeprefix("single/"), args[1:], what)
    if special:
        report_special(session)
    session.changed()


def _type(system, kind: str, word: str, what: str) -> int:
    first, last = bounds(word, 1, system.counts[f"n{kind}types"], f"{what}: {kind} type", system.labels.get(kind))
    if first != last:
        raise InputError(f"{what}: expected one {kind} type, got {word}")
    return first


def _append(system, kind: str, atoms: np.ndarray, type_: int, special: bool) -> None:
    old, types = system.topology.items(kind)
    new = np.concatenate([old, atoms]), np.concatenate([types, np.full(len(atoms), type_)])
    system.topology = system.topology.replaced({kind: new}, special)


def _single(system, kind: str, words: list[str], what: str) -> bool:
    """One item; whether partners of atoms are to be found anew."""
    width = ATOMS[kind]
    type_word, *ids = take(words, 1 + width, what)[:1 + width]
    special, words = True, words[1 + width:]
    while words:
        if words[0] != "special":
            raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], ('special',))}")
        special = yes_no(take(words[1:], 1, f"{what} special")[0], f"{what} special")
        words = words[2:]
    type_, numbers = _type(system, kind, type_word, what), [whole(w, f"{what}: atom ID") for w in ids]
    if len(set(numbers)) < width:
        raise InputError(f"{what}: the atoms must be different, got {' '.join(ids)}")
    for n in numbers:
        if n not in system.id:
            raise InputError(f"{what}: there is no atom with ID {n}")
    _append(system, kind, system.index_of(np.array(numbers))[None], type_, special)
    return special


def _many(session, system, words: list[str], what: str) -> None:
    """A bond for every pair of the two groups at a distance from rmin to rmax that the pair style may see."""
    from ase.neighborlist import primitive_neighbor_list
    if len(words) > 5:
        raise InputError(f"{what} takes no keywords, got {' '.join(words[5:])}")
    one, two, type_word, low, high = take(words, 5, what)
    groups = session.scene.groups
    first, second, type_ = groups.mask(one, what), groups.mask(two, what), _type(system, "bond", type_word, what)
    rmin, rmax = number(low, f"{what}: rmin"), number(high, f"{what}: rmax")
    if rmin > rmax:
        raise InputError(f"{what}: rmin must not exceed rmax, got {low} {high}")
    interactions = session.scene.interactions
    if interactions.special_lj[0] != 0.0 or interactions.special_coul[0] != 0.0:
        raise InputError(f"{what}: special_bonds must give 1-2 pairs the weight 0.0, or bonded pairs would get a second bond")
    report_mixing(session)
    system.box.wrap(system.x, system.image)
    i, j, d = primitive_neighbor_list("ijd", system.box.periodic, system.box.cell, system.x - system.box.origin, max(rmax, 0.0))
    keep = (d >= rmin) & (d <= rmax) & (first[i] & second[j] | second[i] & first[j]) & (system.id[i] < system.id[j])
    pairs = np.unique(np.column_stack([i, j])[keep], axis=0)      # by two images of a periodic box: once
    near, kind = interactions.special_pairs(system)
    weights = zip((1, 2, 3), interactions.special_lj, interactions.special_coul)
    hidden = near[np.isin(kind, [k for k, lj, coul in weights if lj == coul == 0.0])]
    pairs = pairs[~np.isin(np.sort(pairs, axis=1) @ (system.n, 1), hidden.astype(np.int64) @ (system.n, 1))]
    _append(system, "bond", pairs, type_, True)
    session.print(f"Added {len(pairs)} bonds, new total = {len(system.topology.bonds)}")
