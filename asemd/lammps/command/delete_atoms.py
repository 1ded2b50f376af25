"""``delete_atoms style args keyword value ...``"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.topology import KINDS
from asemd.words import number, take, yes_no

ARGUMENTS = {"group": 1, "region": 1, "overlap": 3, "variable": 1}


def run(session, args):
    scene = session.scene
    system = scene.need_system("delete_atoms")
    scene.sync_groups()
    style = take(args, 1, "delete_atoms")[0]
    if style not in ARGUMENTS:
        raise InputError(f"delete_atoms: style {style!r} is unknown or not supported{nearest(style, ARGUMENTS)}; "
                         f"there are {' '.join(ARGUMENTS)}")
    what = f"delete_atoms {style}"
    values = take(args[1:], ARGUMENTS[style], what)
    options = {"compress": True, "bond": False, "mol": False, "condense": False}
    words = args[1 + len(values):]
    while words:
        if words[0] not in options:
            raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], options)}")
        options[words[0]] = yes_no(take(words[1:], 1, f"{what} {words[0]}")[0], f"{what} {words[0]}")
        words = words[2:]
    gone = _chosen(session, system, style, values, what)
    if options["mol"]:
        if not system.molecular:
            raise InputError(f"{what} mol: atom_style {system.atom_style} has no molecules")
        gone |= np.isin(system.molecule, system.molecule[gone & (system.molecule > 0)])
    items = _cut(system, gone)
    if any(items.values()) and not options["bond"]:
        torn = ", ".join(f"{n} {kind}s" for kind, n in items.items() if n)
        raise InputError(f"{what}: {torn} would lose some of their atoms; use bond yes to delete them or mol yes to delete whole molecules")
    order = _storage_order(gone)
    before = system.topology.counts()
    scene.groups.select(order)
    scene.system = new = system.select(order)
    if options["compress"]:
        if system.molecular:
            session.warn("Ignoring 'compress yes' for molecular system")
        else:
            new.id[:] = np.arange(1, new.n + 1)
    session.stale()
    session.print(f"Deleted {system.n - new.n} atoms, new total = {new.n}")
    if options["bond"]:
        for kind, n in new.topology.counts().items():
            if system.counts[f"n{kind}types"]:
                session.print(f"Deleted {before[kind] - n} {kind}s, new total = {n}")


def _chosen(session, system, style: str, values: list[str], what: str) -> np.ndarray:
    scene = session.scene
    if style == "group":
        return scene.groups.mask(values[0], what).copy()
    if style == "region":
        return scene.region(values[0], what).inside(system.x)
    if style == "variable":
        return session.variables.per_atom(values[0].removeprefix("v_"), system.n) != 0.0
    cutoff = number(values[0], f"{what}: cutoff")
    if cutoff <= 0.0:
        raise InputError(f"{what}: the cutoff must be positive, got {values[0]}")
    return _overlapping(scene, system, cutoff, scene.groups.mask(values[1], what), scene.groups.mask(values[2], what))


def _overlapping(scene, system, cutoff: float, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """One atom of every pair closer than the cutoff: the one of the first group.

    Atoms are visited by row; one that has a partner left goes. Of a pair across a periodic face whose atoms are both candidates
    the atom of the lower id goes.
    """
    from ase.neighborlist import primitive_neighbor_list
    x, image = system.x.copy(), system.image.copy()
    system.box.wrap(x, image)
    i, j, shift = primitive_neighbor_list("ijS", system.box.periodic, system.box.cell, x - system.box.origin, cutoff)
    keep = first[i] & second[j] & (i != j)
    i, j, across = i[keep], j[keep], shift[keep].any(axis=1)
    hidden = _hidden_pairs(scene, system)
    gone = np.zeros(system.n, bool)
    for a, b, face in sorted(zip(i.tolist(), j.tolist(), across.tolist())):
        if gone[a] or (min(a, b), max(a, b)) in hidden:
            continue
        if face:
            if second[a] and first[b] and system.id[a] > system.id[b]:
                continue
        elif gone[b]:
            continue
        gone[a] = True
    return gone


def _hidden_pairs(scene, system) -> set[tuple[int, int]]:
    """Bonded pairs whose weights in special_bonds are all zero: they are not seen as overlapping."""
    if system.topology.is_empty:
        return set()
    pairs, kind = system.topology.special(system.n)
    zero = [k for k in (1, 2, 3) if scene.interactions.special_lj[k - 1] == 0.0 and scene.interactions.special_coul[k - 1] == 0.0]
    return set(map(tuple, pairs[np.isin(kind, zero)].tolist()))


def _cut(system, gone: np.ndarray) -> dict[str, int]:
    """How many bonded items lose some, not all, of their atoms."""
    out = {}
    for kind in KINDS:
        atoms, _ = system.topology.items(kind)
        lost = gone[atoms].sum(axis=1) if len(atoms) else np.zeros(0, int)
        out[kind] = int(((lost > 0) & (lost < atoms.shape[1])).sum())
    return out


def _storage_order(gone: np.ndarray) -> np.ndarray:
    """Rows that stay, in the order that results when the last atom fills the place of every deleted one."""
    rows, state = list(range(len(gone))), gone.tolist()
    i = 0
    while i < len(rows):
        if state[i]:
            rows[i], state[i] = rows[-1], state[-1]
            rows.pop()
            state.pop()
        else:
            i += 1
    return np.array(rows, dtype=int)
