r"""Make bonds between atoms that come close.

Every Nevery steps pairs of an atom of type i and one of type j that are nearer than Rmin, and not bonded to each other, may bond. Each atom
names the nearest of its partners; a bond is made if both name each other, and both have fewer than their largest number of bonds of that
type. An atom that has reached it may become another type. With ``atype``, ``dtype`` and ``itype`` the angles, dihedrals and impropers that
the new bonds bring along are made, too.

Source: LAMMPS manual, fix bond/create. Units: distance. Output: a vector, bonds made at the last look and so far.
"""
from __future__ import annotations

import itertools

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix.atom_order import AtomOrder
from asemd.fix.bond_change import BondChange, mutual
from asemd.words import bounds, number, take, whole

KEYWORDS = {"iparam": 2, "jparam": 2, "prob": 2, "atype": 1, "dtype": 1, "itype": 1}
ITEMS = {"atype": "angle", "dtype": "dihedral", "itype": "improper"}


class BondCreate(BondChange):
    """Make bonds.

    Parameters
    ----------
    group, every, bond_type, distance, probability, seed
        As `BondChange`.
    types : (int, int)
        Types of the two atoms.
    most : (int, int)
        Largest number of bonds of this type of an atom of the one and the other type; 0: no limit.
    become : (int, int), optional
        Types that atoms with that many bonds get.
    items : mapping, optional
        ``angle``, ``dihedral``, ``improper`` -> type of those that come with a bond.

    Raises
    ------
    InputError
        Other limits or types for two atoms of the same type.
    """

    style = "bond/create"

    def __init__(self, group: str = "all", every: int = 1, types: tuple[int, int] = (1, 1), distance: float = 1.0, bond_type: int = 1,
                 most: tuple[int, int] = (0, 0), become: tuple[int, int] | None = None, probability: float = 1.0, seed: int = 12345,
                 items: dict[str, int] | None = None):
        super().__init__(group, every, bond_type, distance, probability, seed)
        self.types, self.most, self.become, self.items = tuple(types), tuple(most), tuple(become or types), dict(items or {})
        if min(self.most) < 0:
            raise InputError(f"fix bond/create: maxbond must not be negative, got {min(self.most)}")
        if self.types[0] == self.types[1] and (self.most[0] != self.most[1] or self.become[0] != self.become[1]):
            raise InputError("fix bond/create: for two atoms of one type iparam and jparam must be the same")

    @classmethod
    def from_lammps(cls, group, words, session):
        every, first, second, distance, kind = take(words, 5, "fix bond/create Nevery itype jtype Rmin bondtype")
        system, what = session.scene.system, "fix bond/create"

        def number_of(word: str, category: str, shown: str) -> int:
            counts = system.counts["ntypes" if category == "atom" else f"n{category}types"]
            return bounds(word, 1, counts, f"{what} {shown}", system.labels.get(category))[0]
        types = number_of(first, "atom", "itype"), number_of(second, "atom", "jtype")
        most, become, options, items = [0, 0], list(types), {}, {}
        rest = words[5:]
        while rest:
            key = rest[0]
            if key not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
            values, rest = take(rest[1:], KEYWORDS[key], f"{what} {key}"), rest[1 + KEYWORDS[key]:]
            if key in ("iparam", "jparam"):
                k = "ij".index(key[0])
                most[k], become[k] = whole(values[0], f"{what} {key} maxbond"), number_of(values[1], "atom", f"{key} newtype")
            elif key == "prob":
                options |= cls.read_probability(values)
            else:
                items[ITEMS[key]] = number_of(values[0], ITEMS[key], key)
        fix = cls(group, whole(every, f"{what} Nevery"), types, number(distance, f"{what} Rmin"), number_of(kind, "bond", "bond type"),
                  tuple(most), tuple(become), items=items, **options)
        fix.storage = AtomOrder(*session.scene.sort, session.scene.order)
        return fix

    def to_lammps(self) -> list[str]:
        words = [str(self.interval), *map(str, self.types), repr(self.distance), str(self.bond_type)]
        for k, key in enumerate(("iparam", "jparam")):
            words += [key, str(self.most[k]), str(self.become[k])]
        words += [w for key, kind in ITEMS.items() if kind in self.items for w in (key, str(self.items[kind]))]
        return words + (["prob", repr(self.probability), str(self.seed)] if self.probability < 1.0 else [])

    def setup(self, loop) -> None:
        super().setup(loop)
        self.resize(loop)

    def resize(self, loop) -> None:
        e = loop.engine
        if e.mode == "none":
            raise InputError("fix bond/create needs a pair style, whose neighbour list it looks for partners in")
        if self.distance > e.cutoff:
            raise InputError(f"fix bond/create: Rmin {self.distance:g} is longer than the cutoff of the pair style, {e.cutoff:g}")
        self.counts = self._count(loop.system)

    def _count(self, system) -> np.ndarray:
        """(n,) bonds of the type that each atom has."""
        bonds = system.topology.bonds[system.topology.bond_types == self.bond_type]
        return np.bincount(bonds.ravel(), minlength=system.n)

    def candidates(self, loop) -> tuple[np.ndarray, np.ndarray]:
        system, e = loop.system, loop.engine
        i, j, d = near(e, self.distance)
        kind, mask = system.type, loop.groups[self.group]
        right = ((kind[i] == self.types[0]) & (kind[j] == self.types[1])) | ((kind[i] == self.types[1]) & (kind[j] == self.types[0]))
        right &= mask[i] & mask[j]
        for atoms in (i, j):
            for k in (0, 1):
                if self.most[k]:
                    right &= (kind[atoms] != self.types[k]) | (self.counts[atoms] < self.most[k])
        i, j, d = i[right], j[right], d[right]
        key = np.sort(np.column_stack([i, j]), axis=1)
        pairs, kinds = system.topology.special(system.n)
        bonded = pairs[kinds == 1]
        n = system.n
        free = ~np.isin(key[:, 0].astype(np.int64) * n + key[:, 1], bonded[:, 0].astype(np.int64) * n + bonded[:, 1])
        return mutual(n, key[free], d[free])

    def change(self, loop, pairs) -> None:
        system = loop.system
        ids = system.id[pairs]
        pairs = np.where((ids[:, 0] > ids[:, 1])[:, None], pairs[:, ::-1], pairs)
        top = system.topology
        parts = {"bond": (np.concatenate([top.bonds, pairs]), np.append(top.bond_types, np.full(len(pairs), self.bond_type)))}
        for kind, new_type in self.items.items():
            new = list(new_items(kind, pairs, parts["bond"][0], system.n))
            if new:
                atoms, types = top.items(kind)
                parts[kind] = np.concatenate([atoms, np.array(new, atoms.dtype)]), np.append(types, np.full(len(new), new_type))
        system.topology = top.replaced(parts, True)
        self.counts = self._count(system)
        for atom in pairs.ravel():
            for k in (0, 1):
                if self.most[k] and system.type[atom] == self.types[k] and self.counts[atom] == self.most[k]:
                    system.type[atom] = self.become[k]
                    break


def near(engine, distance: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of the neighbour list closer than a distance: rows i and j, squared distance; without special pairs of weight 0."""
    state = engine.state
    if engine.mode == "cluster" and not engine.expanded:
        i, j, code = engine.list.expand(engine.k, state, distance)
        shifts = engine.list.shifts
        i, j, code = engine.exclusions.mark(engine.k, state.x, state.row, i, j, code, shifts, engine.cell, engine.periodic)
    else:
        (i, j, code), shifts = engine.plain, engine.plain_shifts
    d = state.x[:, i] - state.x[:, j] - shifts[code >> 2].T
    square = (d * d).sum(axis=0)
    close = square < distance**2
    return state.row[i[close]], state.row[j[close]], square[close]


def new_items(kind: str, pairs: np.ndarray, bonds: np.ndarray, n: int):
    """Rows of the angles, dihedrals or impropers that hold one of the new bonds `pairs`."""
    partners: dict[int, list[int]] = {}
    for a, b in bonds.tolist():
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    fresh = {frozenset(pair) for pair in pairs.tolist()}

    def has(*ends) -> bool:
        return any(frozenset(e) in fresh for e in ends)
    around = sorted({a for pair in pairs.tolist() for a in pair})
    if kind == "angle":
        for b in sorted({*around, *(p for a in around for p in partners[a])}):
            for a, c in itertools.combinations(sorted(partners[b]), 2):
                if has((a, b), (b, c)):
                    yield a, b, c
    elif kind == "dihedral":
        centres = {frozenset((a, b)) for a in {*around, *(p for q in around for p in partners[q])} for b in partners[a]}
        for b, c in sorted(tuple(sorted(pair)) for pair in centres):
            for a in partners[b]:
                for d in partners[c]:
                    if len({a, b, c, d}) == 4 and has((a, b), (b, c), (c, d)):
                        yield a, b, c, d
    else:
        for b in around:
            for a, c, d in itertools.combinations(partners[b], 3):      # in the order in which they were bonded
                if has((a, b), (c, b), (d, b)):
                    yield b, a, c, d
