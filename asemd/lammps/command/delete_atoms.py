"""``delete_atoms style args keyword value ...``"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.lammps import torn
from asemd.lammps.setup_log import report_mixing
from asemd.marsaglia import Marsaglia
from asemd.topology import KINDS, Partners
from asemd.words import choice, number, take, whole, yes_no

ARGUMENTS = {"group": 1, "region": 1, "overlap": 3, "variable": 1, "random": 6, "porosity": 4}


def run(session, args):
    scene = session.scene
    system = scene.need_system("delete_atoms")
    scene.sync_groups()
    style = take(args, 1, "delete_atoms")[0]
    if style not in ARGUMENTS:
        raise InputError(f"delete_atoms: style {style!r} is unknown or not supported{nearest(style, ARGUMENTS)}; "
                         f"there are {' '.join(ARGUMENTS)}")
    what = f"delete_atoms {style}"
    values = take(args[1:], 3 if style == "porosity" and _is_number(args[2:3]) else ARGUMENTS[style], what)
    options = {"compress": True, "bond": False, "mol": False, "condense": False}
    words = args[1 + len(values):]
    while words:
        if words[0] not in options:
            raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], options)}")
        options[words[0]] = yes_no(take(words[1:], 1, f"{what} {words[0]}")[0], f"{what} {words[0]}")
        words = words[2:]
    if style == "overlap":
        report_mixing(session, "delete_atoms")
    gone = _chosen(session, system, style, values, what)
    if options["mol"]:
        if not system.molecular:
            raise InputError(f"{what} mol: atom_style {system.atom_style} has no molecules")
        gone |= np.isin(system.molecule, system.molecule[gone & (system.molecule > 0)])
    items = _cut(system, gone)
    left = torn.left(system, gone, scene.newton[1], options["bond"])
    if any(items.values()) and not options["bond"]:
        lost = ", ".join(f"{n} {kind}s" for kind, n in items.items() if n)
        session.warn(f"{what}: {lost} lose some of their atoms, which stops the next run; use bond yes to delete them or mol yes to delete "
                     "whole molecules")
    order = _storage_order(gone)
    before = torn.counts(system)
    partners = Partners(*scene.interactions.special_pairs(system)) if any(items.values()) else None
    scene.groups.select(order)
    scene.system = new = system.select(order)
    new.torn = left
    if partners is not None:        # atoms two or three bonds apart stay partners when one between them goes
        new.topology.frozen = partners.select(order, system.n)
    if options["compress"]:
        if system.molecular:
            session.warn("Ignoring 'compress yes' for molecular system")
        else:
            new.id[:] = np.arange(1, new.n + 1)
    session.stale()
    session.print(f"Deleted {system.n - new.n} atoms, new total = {new.n}")
    if options["bond"] or options["mol"]:
        for kind, n in torn.counts(new).items():
            if before[kind]:
                session.print(f"Deleted {before[kind] - n} {kind}s, new total = {n}")


def _chosen(session, system, style: str, values: list[str], what: str) -> np.ndarray:
    scene = session.scene
    if style == "group":
        return scene.groups.mask(values[0], what).copy()
    if style == "region":
        return scene.region(values[0], what).inside(system.x)
    if style == "variable":
        variable = values[0].removeprefix("v_")
        if session.variables.find(variable).style not in ("atom", "atomfile"):
            raise InputError(f"{what}: variable {variable} must be of style atom or atomfile")
        return session.variables.per_atom(variable, system.n) != 0.0
    if style in ("random", "porosity"):
        return _random(session, system, values if style == "random" else _as_random(values), what)
    cutoff = number(values[0], f"{what}: cutoff")
    if cutoff < 0.0:
        raise InputError(f"{what}: the cutoff must not be negative, got {values[0]}")
    return _overlapping(scene, system, cutoff, scene.groups.mask(values[1], what), scene.groups.mask(values[2], what))


def _is_number(words: list[str]) -> bool:
    try:
        return bool(words) and float(words[0]) == float(words[0])
    except ValueError:
        return False


def _as_random(values: list[str]) -> list[str]:
    """The words of ``porosity [group] region fraction seed``, older LAMMPS's name, as those of ``random``."""
    group, region, fraction, seed = values if len(values) == 4 else ("all", *values)
    return ["fraction", fraction, "no", group, region, seed]


def _random(session, system, values: list[str], what: str) -> np.ndarray:
    """``fraction|count amount exact group region seed``."""
    kind = choice(values[0], ("fraction", "count"), what)
    amount = number(values[1], what) if kind == "fraction" else whole(values[1], what)
    exact = yes_no(values[2], what)
    if amount < 0 or (kind == "fraction" and amount > 1.0):
        raise InputError(f"{what}: the fraction must be from 0 to 1, got {values[1]}" if kind == "fraction" else
                         f"{what}: the number of atoms must not be negative, got {values[1]}")
    able = session.scene.groups.mask(values[3], what).copy()
    if values[4] != "NULL":
        able &= session.scene.region(values[4], what).inside(system.x)
    seed = whole(values[5], f"{what}: seed")
    if not 0 < seed <= 900_000_000:
        raise InputError(f"{what}: the seed must be from 1 to 900000000, got {values[5]}")
    generator, rows, gone = Marsaglia(seed), np.flatnonzero(able), np.zeros(system.n, bool)
    if kind == "fraction" and not exact:
        gone[rows] = [generator.uniform() <= amount for _ in rows]
        return gone
    count = int(amount * len(rows)) if kind == "fraction" else amount
    if count > len(rows):
        message = f"{what}: count of {count} exceeds number of eligible atoms {len(rows)}"
        if exact:
            raise InputError(message)
        session.warn(message)
    gone[rows[generator.subset(len(rows), min(count, len(rows)))]] = True
    return gone


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
    pairs, kind = scene.interactions.special_pairs(system)
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
