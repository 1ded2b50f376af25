"""``reset_atoms id|mol|image args``: number atoms and molecules anew, image flags near zero."""
from __future__ import annotations

import time

import numpy as np

from asemd.errors import InputError, nearest
from asemd.lammps.command.write_restart import settle
from asemd.lammps.setup_log import report_mixing, report_special
from asemd.words import take, whole, yes_no

PER_BIN = 10        # atoms of a bin of `id sort yes`


def run(session, args):
    style = take(args, 1, "reset_atoms")[0]
    styles = {"id": reset_ids, "mol": reset_molecules, "image": reset_images}
    if style not in styles:
        raise InputError(f"reset_atoms: unknown property {style!r}{nearest(style, styles)}; there are {' '.join(styles)}")
    session.scene.need_system("reset_atoms")
    session.scene.sync_groups()
    styles[style](session, list(args[1:]))


def reset_ids(session, words: list[str]) -> None:
    """``id [sort yes|no]``: ids from 1 in the order of storage, or of places."""
    system, sort = session.scene.system, False
    while words:
        if words[0] != "sort":
            raise InputError(f"reset_atoms id: unknown keyword {words[0]!r}, there is sort")
        sort, words = yes_no(take(words[1:], 1, "reset_atoms id sort")[0], "reset_atoms id sort"), words[2:]
    if system.torn:
        kind, _, ids = system.torn[0]
        raise InputError(f"reset_atoms id: {len(system.torn)} bonded items lack atoms, the first one is the {kind} of atoms "
                         f"{' '.join(map(str, ids))}: delete atoms with bond yes or mol yes")
    session.print("Resetting atom IDs ...")
    report_mixing(session)
    settle(session)
    order = _places(system) if sort else np.arange(system.n)
    system.id[order] = np.arange(1, system.n + 1)
    system.topology.frozen = None       # partners are listed anew
    report_special(session)
    session.changed()


def _places(system) -> np.ndarray:
    """Rows sorted by bins of about ten atoms, x fastest, within a bin by x, y, z."""
    x, d = system.x, system.dimension
    if not system.n:
        return np.zeros(0, int)
    lo, extent = x.min(axis=0), np.ptp(x, axis=0)
    wide = extent.copy()
    wide[extent == 0.0] = 1.0
    size = (np.prod(wide[:d]) / (system.n // PER_BIN + 1)) ** (1.0 / d)
    count = (wide / size).astype(int) + 1
    if d == 2:
        count[2] = 1
    bins = np.minimum(((x - lo) * (count / wide)).astype(int), count - 1)
    key = bins[:, 0] + count[0] * (bins[:, 1] + count[1] * bins[:, 2])
    return np.lexsort((system.id, x[:, 2], x[:, 1], x[:, 0], key))


def fragments(system, mask: np.ndarray) -> np.ndarray:
    """(n,) the smallest atom id that each atom is bonded with through atoms of `mask`; 0 for atoms outside."""
    label = np.where(mask, system.id, 0)
    bonds = system.topology.bonds
    bonds = bonds[mask[bonds].all(axis=1)] if len(bonds) else bonds
    while len(bonds):
        low = np.minimum(label[bonds[:, 0]], label[bonds[:, 1]])
        before = label.copy()
        for end in (0, 1):
            np.minimum.at(label, bonds[:, end], low)
        index = np.flatnonzero(mask)
        order = np.argsort(system.id[index], kind="stable")     # every atom goes straight to where its label points
        ids = system.id[index][order]
        label[index] = label[index[order[np.searchsorted(ids, label[index])]]]
        if np.array_equal(before, label):
            break
    return label


def _need_bonds(system, what: str) -> None:
    if not system.molecular:
        raise InputError(f"{what}: atom_style {system.atom_style} has no molecules")


def _group(session, words: list[str], what: str) -> np.ndarray:
    return session.scene.groups.mask(take(words, 1, what)[0], what)


def reset_molecules(session, words: list[str]) -> None:
    """``mol group [compress yes|no] [offset N] [single yes|no]``: a molecule is what bonds hold together."""
    started = time.perf_counter()
    system, what = session.scene.system, "reset_atoms mol"
    _need_bonds(system, what)
    mask, words = _group(session, words, what), words[1:]
    options = {"compress": True, "single": False, "offset": -1}
    while words:
        key = words[0]
        if key not in options:
            raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, options)}")
        value = take(words[1:], 1, f"{what} {key}")[0]
        options[key] = whole(value, f"{what} offset") if key == "offset" else yes_no(value, f"{what} {key}")
        words = words[2:]
    if options["offset"] < -1:
        raise InputError(f"{what} offset: must not be negative (-1: the largest molecule of other atoms), got {options['offset']}")
    session.print("Resetting molecule IDs ...")
    report_mixing(session)
    label = fragments(system, mask)
    members, inverse = np.unique(label[mask], return_inverse=True)
    wanted = np.full(len(members), options["single"])
    bonded = np.zeros(system.n, bool)
    bonded[system.topology.bonds.ravel()] = True        # also with an atom outside the group
    wanted[inverse[bonded[mask]]] = True
    if options["compress"]:
        offset = options["offset"]
        if offset < 0:
            offset = int(system.molecule[~mask].max(initial=0))
        number = np.where(wanted, np.cumsum(wanted) + offset, 0)
    else:
        number = np.where(wanted, members, 0)
    system.molecule[mask] = number[inverse]
    session.changed()
    session.print(f"  number of new molecule IDs = {int(wanted.sum()) if options['compress'] else 'unknown'}")
    session.print(f"  reset_atoms mol CPU = {time.perf_counter() - started:.3f} seconds")


def reset_images(session, words: list[str]) -> None:
    """``image group``: image flags of what bonds hold together are moved so that they lie about zero."""
    started = time.perf_counter()
    system, what = session.scene.system, "reset_atoms image"
    _need_bonds(system, what)
    mask = _group(session, words, what)
    if len(words) > 1:
        raise InputError(f"{what} takes a group and no more words, got {' '.join(words[1:])}")
    session.print("Resetting image flags ...")
    report_mixing(session)
    members, inverse = np.unique(fragments(system, np.ones(system.n, bool)), return_inverse=True)    # whole ones, also for a group
    image = system.image
    low, high = np.full((len(members), 3), 2**30), np.full((len(members), 3), -(2**30))
    np.minimum.at(low, inverse, image)
    np.maximum.at(high, inverse, image)
    system.image[mask] -= ((low + high) // 2)[inverse][mask].astype(np.int32)
    session.changed()
    session.print(f"  reset_atoms image CPU = {time.perf_counter() - started:.3f} seconds")
