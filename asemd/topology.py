"""Bonds, angles, dihedrals and impropers as index arrays, and the 1-2, 1-3, 1-4 pairs that follow from the bonds."""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

ATOMS = {"bond": 2, "angle": 3, "dihedral": 4, "improper": 4}
KINDS = tuple(ATOMS)
CROSSTERM = "crossterm"
WIDTHS = {**ATOMS, CROSSTERM: 5}      # kinds with what no style acts on, but `asemd.fix.CMAP`


def rows_of(index, n: int) -> np.ndarray:
    """Row numbers that a slice, mask, integer or list of integers (negative ones count from the end) picks of `n` atoms."""
    index = np.asarray(index) if not isinstance(index, slice) else index
    if not isinstance(index, slice) and index.size == 0 and index.dtype != bool:
        return np.zeros(0, np.int64)
    return np.atleast_1d(np.arange(n)[index])


@dataclass(eq=False)
class Partners:
    """Pairs one, two and three bonds apart as they are listed, whatever has become of the bonds since.

    Parameters
    ----------
    pairs : (m, 2) int32
        Rows i < j, sorted.
    kinds : (m,) int8
        1, 2, 3 for 1-2, 1-3, 1-4.
    """

    pairs: np.ndarray
    kinds: np.ndarray

    def __post_init__(self):
        self.pairs, self.kinds = np.array(self.pairs, np.int32).reshape(-1, 2), np.array(self.kinds, np.int8)

    def __eq__(self, other) -> bool:
        return isinstance(other, Partners) and np.array_equal(self.pairs, other.pairs) and np.array_equal(self.kinds, other.kinds)

    __hash__ = None

    def as_dict(self) -> dict:
        """The arguments that make it again."""
        return {"pairs": self.pairs, "kinds": self.kinds}

    def special(self, n: int, angle: bool = False, dihedral: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """See `Topology.special`."""
        return self.pairs, self.kinds

    def select(self, index, n: int) -> Partners:
        """The pairs among chosen atoms, in their new order."""
        rows = rows_of(index, n)
        new = np.full(n, -1, np.int64)
        new[rows[::-1]] = np.arange(len(rows))[::-1]
        renamed = new[self.pairs]
        keep = (renamed >= 0).all(axis=1)
        pairs = np.sort(renamed[keep], axis=1)
        order = np.lexsort((pairs[:, 1], pairs[:, 0]))
        return Partners(pairs[order], self.kinds[keep][order])

    def shift(self, n: int) -> Partners:
        """All row numbers plus `n`."""
        return Partners(self.pairs + n, self.kinds)

    def concatenate(self, *others) -> Partners | None:
        """With atoms that have no bonds the list stays; with others it is made anew from the bonds (None)."""
        return self if all(isinstance(o, Topology) and o.is_empty for o in others) else None

    def repeat(self, n: int, copies: int) -> Partners:
        """The pairs of `copies` copies of `n` atoms each."""
        offset = np.repeat(np.arange(copies) * n, len(self.pairs))
        return Partners(np.tile(self.pairs, (copies, 1)) + offset[:, None], np.tile(self.kinds, copies))

    def repeat_periodic(self, *_) -> None:
        """None: for a repeated cell the list is made anew from the bonds."""

    def forget(self, pairs: np.ndarray) -> None:
        """Bonds (m, 2) that do not count any more."""
        p = np.sort(np.asarray(pairs, np.int64), axis=1)
        gone = np.isin((self.pairs.astype(np.int64) << 31)[:, 0] + self.pairs[:, 1], (p[:, 0] << 31) + p[:, 1])
        self.pairs, self.kinds = self.pairs[~gone], self.kinds[~gone]


@dataclass(eq=False)
class Topology:
    """Bonded items by atom row, counted from 0, with their types, counted from 1.

    Parameters
    ----------
    bonds, angles, dihedrals, impropers : (m, 2), (m, 3), (m, 4), (m, 4) int
        Atom rows; in an angle the middle atom is the second one.
    bond_types, angle_types, dihedral_types, improper_types : (m,) int, optional
        Types; 1 for all if not given. The negative of a type: the item is turned off, its atoms still count as bonded; 0: a bond that
        broke.
    frozen : Topology or Partners, optional
        The state from which the 1-2, 1-3 and 1-4 pairs follow instead of the present one, or these pairs.
    crossterms, crossterm_types : (m, 5) and (m,) int, optional
        Pairs of torsions that follow each other, for the correction maps of `asemd.fix.CMAP`; types count its maps from 1.

    Raises
    ------
    ValueError
        Arrays of the wrong shape, numbers that are not whole, an atom twice in one item.
    """

    bonds: np.ndarray = ()
    bond_types: np.ndarray | None = None
    angles: np.ndarray = ()
    angle_types: np.ndarray | None = None
    dihedrals: np.ndarray = ()
    dihedral_types: np.ndarray | None = None
    impropers: np.ndarray = ()
    improper_types: np.ndarray | None = None
    frozen: Topology | Partners | None = None
    crossterms: np.ndarray = ()
    crossterm_types: np.ndarray | None = None

    def __post_init__(self):
        for kind, width in WIDTHS.items():
            atoms, types = getattr(self, kind + "s"), getattr(self, kind + "_types")
            if isinstance(atoms, tuple) and not atoms and (types is None or np.size(types) == 0):
                setattr(self, kind + "s", np.zeros((0, width), np.int32))
                setattr(self, kind + "_types", np.zeros(0, np.int32))
                continue
            atoms = _whole(atoms, f"{kind}s must be rows of {width} atom numbers")
            if atoms.size == 0:
                atoms = atoms.reshape(0, width)
            if atoms.ndim != 2 or atoms.shape[1] != width:
                raise ValueError(f"{kind}s must have the shape (m, {width}), got {atoms.shape}")
            twice = np.flatnonzero(np.any([atoms[:, a] == atoms[:, b] for a in range(width) for b in range(a)], axis=0))
            if len(twice):
                raise ValueError(f"{kind} {twice[0]} names an atom twice: {' '.join(map(str, atoms[twice[0]]))} (atoms count from 0)")
            types = _whole(1 if types is None else types, f"{kind}_types must be whole numbers")
            if types.ndim > 1 or types.size not in (1, len(atoms)) or types.size != len(atoms) and types.ndim:
                raise ValueError(f"{kind}_types must be one number, or one for each of the {len(atoms)} {kind}s, got {types.size}")
            types = np.array(np.broadcast_to(types, len(atoms)), np.int32)
            setattr(self, kind + "s", atoms)
            setattr(self, kind + "_types", types)
        if isinstance(self.frozen, dict):
            self.frozen = (Partners if "pairs" in self.frozen else Topology)(**self.frozen)

    def as_dict(self) -> dict:
        """The arguments that make it again."""
        kept = [item for item in self.every() if item[0] != CROSSTERM or len(item[1])]
        out = {f"{kind}s": atoms for kind, atoms, _ in kept} | {f"{kind}_types": types for kind, _, types in kept}
        return out | ({"frozen": self.frozen.as_dict()} if self.frozen is not None else {})

    def items(self, kind: str) -> tuple[np.ndarray, np.ndarray]:
        """Atoms (m, k) and types (m,) of ``bond``, ``angle``, ``dihedral``, ``improper`` or ``crossterm``."""
        return getattr(self, kind + "s"), getattr(self, kind + "_types")

    def __iter__(self) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
        return ((kind, *self.items(kind)) for kind in KINDS)

    def every(self) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
        """Kind, atoms and types as by iteration, and then the cross terms."""
        return ((kind, *self.items(kind)) for kind in WIDTHS)

    @classmethod
    def _made(cls, parts: dict[str, tuple[np.ndarray, np.ndarray]], frozen: Topology | None = None) -> Topology:
        return cls(**{f"{kind}s": atoms for kind, (atoms, _) in parts.items()},
                   **{f"{kind}_types": types for kind, (_, types) in parts.items()}, frozen=frozen)

    def replaced(self, parts: dict[str, tuple[np.ndarray, np.ndarray]], special: bool) -> Topology:
        """The same with the items of some kinds replaced; the 1-2, 1-3 and 1-4 pairs follow only if `special`."""
        frozen = None if special else self.frozen if self.frozen is not None else self
        return Topology._made({kind: parts.get(kind, (atoms, types)) for kind, atoms, types in self.every()}, frozen)

    @property
    def is_empty(self) -> bool:
        return self.frozen is None and not (len(self.bond_types) or len(self.angle_types) or len(self.dihedral_types)
                                            or len(self.improper_types) or len(self.crossterm_types))

    def counts(self) -> dict[str, int]:
        """Number of items by kind."""
        return {kind: len(types) for kind, _, types in self}

    def __eq__(self, other) -> bool:
        return isinstance(other, Topology) and all(
            np.array_equal(a, b) for kind in WIDTHS for a, b in zip(self.items(kind), other.items(kind))) and self.frozen == other.frozen

    __hash__ = None

    def __repr__(self) -> str:
        return "Topology(" + ", ".join(f"{len(types)} {kind}s" for kind, _, types in self.every() if len(types)) + ")"

    def copy(self) -> Topology:
        return Topology._made({kind: (atoms, types) for kind, atoms, types in self.every()}, self.frozen)

    def select(self, index, n: int) -> Topology:
        """The items among chosen atoms; an item that loses an atom goes.

        Parameters
        ----------
        index : slice, mask or rows
            The atoms that stay, in their new order; of an atom chosen twice the first copy keeps the items.
        n : int
            Number of atoms before.
        """
        rows = rows_of(index, n)
        new = np.full(n, -1, np.int64)
        new[rows[::-1]] = np.arange(len(rows))[::-1]
        parts = {}
        for kind, atoms, types in self.every():
            renamed = new[atoms]
            keep = (renamed >= 0).all(axis=1)
            parts[kind] = renamed[keep], types[keep]
        return Topology._made(parts, self.frozen and self.frozen.select(index, n))

    def rename(self, new: np.ndarray) -> None:
        """Other row numbers in place: `new` of each old one, for rows of items."""
        for kind, atoms, _ in self.every():
            if len(atoms):
                setattr(self, kind + "s", np.ascontiguousarray(new[atoms], np.int32))

    def forget(self, pairs: np.ndarray) -> None:
        """Bonds (m, 2) that do not count any more."""
        stay = ~np.isin(_keys(1 << 31, self.bonds), _keys(1 << 31, pairs))
        self.bonds, self.bond_types = self.bonds[stay], self.bond_types[stay]

    def add_crossterms(self, atoms: np.ndarray, types: np.ndarray) -> None:
        """Further cross terms (m, 5) with their types, in place."""
        self.crossterms = np.concatenate([self.crossterms, np.asarray(atoms, np.int32).reshape(-1, 5)])
        self.crossterm_types = np.concatenate([self.crossterm_types, np.asarray(types, np.int32)])

    def drop_crossterms(self) -> None:
        """Take all cross terms away, in place."""
        self.crossterms, self.crossterm_types = self.crossterms[:0], self.crossterm_types[:0]

    def shift(self, n: int) -> Topology:
        """All row numbers plus `n`."""
        return Topology._made({kind: (atoms + n, types) for kind, atoms, types in self.every()}, self.frozen and self.frozen.shift(n))

    def concatenate(self, *others: Topology) -> Topology:
        """Items of this and the others, one after the other; the rows stay as they are (see `shift`)."""
        tops = (self, *others)
        frozen = None
        if any(t.frozen is not None for t in tops):
            first, *rest = (t if t.frozen is None else t.frozen for t in tops)
            frozen = None if any(isinstance(t, Partners) for t in rest) else first.concatenate(*rest)
        return Topology._made({kind: (np.concatenate([t.items(kind)[0] for t in tops]), np.concatenate([t.items(kind)[1] for t in tops]))
                               for kind in WIDTHS}, frozen)

    def repeat(self, n: int, copies: int) -> Topology:
        """The items of `copies` copies of `n` atoms each; no item goes from one copy to another."""
        parts = {}
        for kind, atoms, types in self.every():
            offset = np.repeat(np.arange(copies) * n, len(atoms))
            parts[kind] = np.tile(atoms, (copies, 1)) + offset[:, None], np.tile(types, copies)
        return Topology._made(parts, self.frozen and self.frozen.repeat(n, copies))

    def repeat_periodic(self, n: int, times, box, x: np.ndarray) -> Topology:
        """The items of a repeated periodic cell: what crosses a periodic face is connected with the neighbouring copy.

        Parameters
        ----------
        n : int
            Number of atoms of one copy.
        times : (int, int, int)
            Copies along a, b, c; copy (i, j, k) is number ``(i * times[1] + j) * times[2] + k``.
        box : asemd.box.Box
            The cell before.
        x : (n, 3)
            Positions before. Each bond is its shortest image.
        """
        times = np.asarray(times)
        grid = np.stack(np.meshgrid(*map(np.arange, times), indexing="ij"), -1).reshape(-1, 3)
        parts = {}
        for kind, atoms, types in self.every():
            copy = (grid[:, None, None] + cells_apart(kind, atoms, box, x)[None]) % times
            number = (copy[..., 0] * times[1] + copy[..., 1]) * times[2] + copy[..., 2]
            parts[kind] = (number * n + atoms).reshape(-1, atoms.shape[1]), np.tile(types, len(grid))
        return Topology._made(parts, self.frozen and self.frozen.repeat_periodic(n, times, box, x))

    def partners(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Bonded pairs in both directions: where those of each of `n` atoms start (n+1,), pairs (m, 2) sorted; each once."""
        ends = self.bonds[self.bonds[:, 0] != self.bonds[:, 1]].astype(np.int64)
        key = _sorted(np.concatenate([ends[:, 0] * n + ends[:, 1], ends[:, 1] * n + ends[:, 0]]))
        both = np.column_stack(np.divmod(key, max(n, 1)))
        return np.searchsorted(both[:, 0], np.arange(n + 1)), both

    def special(self, n: int, angle: bool = False, dihedral: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """The pairs one, two and three bonds apart.

        Parameters
        ----------
        n : int
            Number of atoms.
        angle : bool
            As ``special_bonds angle yes``: a 1-3 pair counts only if it is 1-3 of an angle, or 1-3 or 2-4 of a dihedral.
        dihedral : bool
            As ``special_bonds dihedral yes``: a 1-4 pair counts only if it is 1-4 of a dihedral.

        Returns
        -------
        pairs : (m, 2) int32
            Rows i < j, sorted; each pair once.
        kind : (m,) int8
            1, 2, 3 for 1-2, 1-3, 1-4; the nearest counts.
        """
        if self.frozen is not None:
            return self.frozen.special(n, angle, dihedral)
        first, both = self.partners(n)

        def walk(paths):
            """Every path longer by one bond."""
            start, count = first[paths[:, -1]], np.diff(first)[paths[:, -1]]
            row = np.repeat(np.arange(len(paths)), count)
            at = start[row] + np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
            out = np.column_stack([paths[row], both[at, 1]])
            return out[out[:, -1] != out[:, -3]]                   # not straight back

        keys = []
        paths = both
        for hop in range(3):
            paths = walk(paths) if hop else both
            near, far = paths[:, 0], paths[:, -1]
            key = _sorted((near * n + far)[near < far])
            if hop == 1 and angle:
                key = key[np.isin(key, _keys(n, self.angles[:, [0, 2]], self.dihedrals[:, [0, 2]], self.dihedrals[:, [1, 3]]))]
            if hop == 2 and dihedral:
                key = key[np.isin(key, _keys(n, self.dihedrals[:, [0, 3]]))]
            keys.append(key)
        key, index = np.unique(np.concatenate(keys), return_index=True)     # the first occurrence is the nearest
        kind = np.repeat(np.array([1, 2, 3], np.int8), [len(k) for k in keys])[index]
        return np.column_stack(np.divmod(key, max(n, 1))).astype(np.int32), kind


def cells_apart(kind: str, atoms: np.ndarray, box, x: np.ndarray) -> np.ndarray:
    """Cells (m, k, 3) between the atoms (m, k) of periodic items, counted from one of them; every bond is its shortest image."""
    at = np.zeros((*atoms.shape, 3), np.int64)
    chain = {"angle": ((1, 0), (1, 2)), "bond": ((0, 1),)}.get(kind, ((1, 0), (1, 2), (2, 3), (3, 4))[:WIDTHS[kind] - 1])
    for known, new in chain:
        _, shift = box.minimum_image(x[atoms[:, new]] - x[atoms[:, known]])
        at[:, new] = at[:, known] + shift
    return at


def _whole(values, what: str) -> np.ndarray:
    """Numbers as int32; raises `ValueError` for others."""
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{what}, got rows of different lengths") from None
    flat = array.ravel()
    wrong = flat[(flat != np.rint(flat)) | (np.abs(flat) >= 2**31)] if array.dtype.kind in "iuf" else flat
    if len(wrong):
        raise ValueError(f"{what}, got {wrong.tolist()[0]!r}")
    return array.astype(np.int32)


def _sorted(keys: np.ndarray) -> np.ndarray:
    """The values, each once, in order; ten times faster than `np.unique`, which hashes."""
    keys = np.sort(keys, kind="stable")
    return keys[np.append(True, keys[1:] != keys[:-1])] if len(keys) else keys


def _keys(n: int, *pairs: np.ndarray) -> np.ndarray:
    """i * n + j of pairs, smaller row first."""
    p = np.sort(np.concatenate(pairs).astype(np.int64), axis=1)
    return p[:, 0] * n + p[:, 1]
