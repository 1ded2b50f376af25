"""Terms of bonds with a past (a reference length, breaking), and of bonds that are a pair interaction."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from asemd.errors import InputError
from asemd.kernels import pair as pair_kernels
from asemd.term import BondedTerm, PairListTerm

NOBODY = np.zeros((0, 2), np.int32)


class HistoryTerm(BondedTerm):
    """All bonds of a style that remembers or breaks them; what it remembers is in ``use.memory`` and outlives runs."""

    def __init__(self, use, at: np.ndarray, system, units, compat: str):
        atoms, types = system.topology.items("bond")
        super().__init__("bond", use, atoms[at], types[at], system.counts["nbondtypes"], units, compat)
        self.at = at[np.argsort(atoms[at][:, 0], kind="stable")]      # which bond of the topology each one is
        self.listed, self.released = False, []
        self.clock = use.memory.setdefault("clock", np.zeros(2))
        self.history, self.reference = np.zeros((len(at), 6)), None
        self.row = self.style.arguments.index("breaks") if "breaks" in self.style.arguments else -1
        self.limits = self.packed.coeff[self.row].copy()

    def hold(self, on: bool) -> None:
        """No bond breaks while this is on: styles with an argument `breaks` do not break bonds by the first forces of a run."""
        if self.row >= 0:
            self.packed.coeff[self.row] = 0.0 if on else self.limits

    def rebuild(self, engine):
        super().rebuild(engine)
        if "reference" in self.style.coordinates:
            if self.reference is None:
                self.reference = reference_lengths(self.use, engine.system, engine.state.x.T[engine.slot_of], self.items)
            self.history[:] = 0.0
            self.history[:, 0] = self.reference[self.order]
        self.listed = True
        for term in self.released:
            term.follow(engine)

    def arguments(self, engine, tid):
        x, out, slots, types, cell, coeff, arrays, *rest = super().arguments(engine, tid)
        if "reference" in self.style.coordinates:
            arrays = (*arrays, self.history, engine.state.v, self.clock)
        return (x, out, slots, types, cell, coeff, arrays, *rest)

    def carry_back(self, engine) -> np.ndarray:
        """Tell the topology which bonds broke since the last time; returns the pairs of rows that are to interact from now on."""
        if not self.listed or not self.style.breaks:
            return NOBODY
        dead = np.flatnonzero(self.slot_types == 0)
        dead = dead[self.types[self.order[dead]] != 0]
        if not len(dead):
            return NOBODY
        items = self.order[dead]
        self.types[items] = 0
        pairs, topology = self.items[items], engine.system.topology
        if self.style.breaks == "off":
            topology.bond_types[self.at[items]] = 0
            return pairs
        if "store/local" in self.use.settings:
            self._record(engine.system, pairs, self.history[dead, 2:])
        keep = np.ones(len(topology.bonds), bool)
        keep[self.at[items]] = False
        topology.bonds, topology.bond_types = topology.bonds[keep], topology.bond_types[keep]
        for term in engine.bonds.terms:
            term.at = (np.cumsum(keep) - 1)[term.at]
        if topology.frozen is not None:
            topology.frozen.forget(pairs)
        return pairs if self.released else NOBODY

    def _record(self, system, pairs: np.ndarray, where: np.ndarray) -> None:
        """Rows for ``store/local``: step, ids, middle, middle at the start; those of past intervals go."""
        memory = self.use.memory
        ids = np.sort(system.id[pairs], axis=1)
        start = start_positions(memory, ids, system.x[np.argsort(system.id)[np.searchsorted(np.sort(system.id), ids)]])
        d, _ = memory["box"].minimum_image(start[:, 1] - start[:, 0])
        rows = np.column_stack([where[:, 3], ids, where[:, :3], start[:, 0] + 0.5 * d])
        old = memory.get("broken", np.zeros((0, 9)))
        old = old[old[:, 0] > where[:, 3].max() - 2 * self.use.settings["store/local"][1]]
        memory["broken"] = np.concatenate([old, rows[np.lexsort((ids[:, 0], where[:, 3]))]])


class Bonds:
    """The bonds of an engine that can break: what the topology and the neighbour list must know of them."""

    def __init__(self, engine):
        self.engine, self.terms = engine, [t for t in engine.terms if isinstance(t, HistoryTerm)]
        self._broken: list[np.ndarray] = []      # pairs of rows that the next list must not leave out any more

    @property
    def pending(self) -> bool:
        """Whether the next list must know of broken bonds."""
        return bool(self._broken)

    def hold(self, on: bool) -> None:
        """See `HistoryTerm.hold`."""
        for t in self.terms:
            t.hold(on)

    def carry_back(self) -> None:
        """Tell the topology which bonds broke."""
        self._broken += [pairs for t in self.terms if len(pairs := t.carry_back(self.engine))]

    def release(self) -> None:
        """Before a list build: the pairs of broken bonds are like any others from now on."""
        self.carry_back()
        if self._broken:
            self.engine.exclusions.release(np.concatenate(self._broken))
        self._broken = []


class ReleasedPairTerm(PairListTerm):
    """The pair interaction of bonds that broke since the list was built: the list still leaves them out."""

    def __init__(self, term, bonds: HistoryTerm, lj: float, coul: float):
        super().__init__(term.style, term.tables, term.style.parts, "broken")
        self.bonds = bonds
        self.lj, self.coul = np.array([lj, 0.0, 0.0, 0.0]), np.array([coul, 0.0, 0.0, 0.0])
        bonds.released.append(self)

    def kernel(self, energy, per_atom):
        return pair_kernels.list_kernel(self.style, self.parts, wanted=energy or per_atom, broken=True)[0]

    def rebuild(self, engine):
        """Nothing yet: `follow` comes when the bonds are in their slots."""

    def follow(self, engine) -> None:
        """The pairs in the order of the bonds: kind 1 of those that hold, others never interact here."""
        b, rules = self.bonds, engine.exclusions
        self.i, self.j, self.code = closest_pairs(engine, b.items[b.order])
        self.shifts = engine.close_shifts
        self.code[b.slot_types == 0] += 1
        if len(rules.rules):
            left = np.arange(len(self.i), dtype=np.int32)
            n = engine.k.drop_excluded(engine.state.row, self.i.copy(), self.j.copy(), left, len(left), *rules.rule_arrays)
            self.code[np.setdiff1d(np.arange(len(self.i)), left[:n])] |= 3

    def arguments(self, engine, tid):
        return (*super().arguments(engine, tid), self.bonds.slot_types)


class WeightedBondTerm(PairListTerm):
    """Bonds that are a pair interaction with weights."""

    def __init__(self, term, pairs: np.ndarray, lj: float, coul: float):
        super().__init__(term.style, term.tables, term.style.parts, "bond")
        self.category, self.items = "bond", np.ascontiguousarray(pairs, np.int32)
        self.lj, self.coul = np.full(4, lj), np.full(4, coul)

    def rename(self, new):
        self.items = new[self.items]

    def rebuild(self, engine):
        self.i, self.j, self.code = closest_pairs(engine, self.items)
        self.shifts = engine.close_shifts


def closest_pairs(engine, pairs: np.ndarray) -> list[np.ndarray]:
    """Slots and codes of pairs of rows, with the image that is closest, all of kind 1."""
    out = [np.empty(len(pairs), np.int32) for _ in range(3)]
    engine.k.special_pairs(np.ascontiguousarray(pairs), np.ones(len(pairs), np.int32), engine.slot_of, engine.state.x, engine.close_shifts,
                           engine.close_periodic, *out)
    return out


def pair_keys(pairs: np.ndarray) -> np.ndarray:
    """One number for each pair of rows or ids, whatever their order."""
    p = np.sort(np.asarray(pairs, np.int64), axis=1)
    return (p[:, 0] << 31) + p[:, 1]


def start_positions(memory: dict, ids: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Positions (..., 3) that atoms had when the style was first used; `now (..., 3)` for those that came later."""
    order = np.argsort(memory["id"])
    at = order[np.minimum(np.searchsorted(memory["id"], ids, sorter=order), len(order) - 1)]
    return np.where((memory["id"][at] == ids)[..., None], memory["x"][at], now)


def reference_lengths(use, system, x: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """The reference length of each bond (rows `pairs` of positions `x`), from the memory of the style; what is new is remembered.

    A style with ``remembers="atoms"`` knows where the atoms were, so that a bond made later has the length its atoms had then; with
    ``"bonds"`` it knows the bonds, so that a bond made later has the length it has at its first force.
    """
    memory, ids = use.memory, system.id[pairs]
    if "id" not in memory:
        memory.update(id=system.id.copy(), x=x.copy(), box=system.box)
    if use.style.remembers == "atoms":
        start = start_positions(memory, ids, x[pairs])
        return _length(start[:, 0] - start[:, 1], memory["box"])
    keys, lengths = pair_keys(ids), _length(x[pairs[:, 0]] - x[pairs[:, 1]], system.box)
    old, known = memory.get("bonds", (np.zeros(0, np.int64), np.zeros(0)))
    if len(old):
        at = np.minimum(np.searchsorted(old, keys), len(old) - 1)
        lengths = np.where(old[at] == keys, known[at], lengths)
    memory["bonds"] = _merged(np.concatenate([old, keys]), np.concatenate([known, lengths]))
    return lengths


def present(use, system, pairs: np.ndarray) -> tuple[np.ndarray, ...]:
    """The last `arrays` of the kernel of a style that remembers, for bonds as they are now, each with two atoms of its own."""
    known = {name: use.memory[name] for name in ("id", "x", "box", "bonds") if name in use.memory}
    d = system.x[pairs[:, 0]] - system.x[pairs[:, 1]]
    d, v = system.box.minimum_image(d)[0], system.v[pairs[:, 0]] - system.v[pairs[:, 1]]
    r = np.sqrt((d * d).sum(axis=1))
    history = np.zeros((len(pairs), 6))
    history[:, 0] = reference_lengths(replace(use, memory=known), system, system.x, pairs)
    history[:, 1] = (d * v).sum(axis=1) / np.where(r > 0.0, r, 1.0)
    return history, np.zeros((3, 2 * len(pairs))), np.zeros(2)


def _merged(keys: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    keys, first = np.unique(keys, return_index=True)
    return keys, values[first]


def _length(d: np.ndarray, box) -> np.ndarray:
    x, y, z = box.minimum_image(d)[0].T
    return np.sqrt(x * x + y * y + z * z)


def bond_terms(system, interactions, pair_terms, units) -> list:
    """Terms of the bond styles that remember or break bonds, or are a pair interaction.

    Raises
    ------
    InputError
        The pair style is one of atoms with an orientation, and bonds break or are a pair interaction.
    """
    terms: list = []
    bonds, types = system.topology.items("bond")
    for use in interactions.uses["bond"]:
        style, at = use.style, np.flatnonzero(np.isin(types, list(use.coeff)))
        if not len(at):
            continue
        turning = next((t for t in pair_terms if t.style.oriented or t.style.dielectric), None)
        if turning is not None and (style.pair_weights or style.breaks):
            raise InputError(f"bond style {style.name} cannot be used with pair style {turning.style.name}: its forces are not "
                             "those of distances alone")
        if style.pair_weights:
            weights = {t: tuple(use.coeff[t][name] for name in style.pair_weights) for t in use.coeff}
            for lj, coul in sorted(set(weights.values())):
                mine = at[np.isin(types[at], [t for t, w in weights.items() if w == (lj, coul)])]
                if len(mine):
                    terms += [WeightedBondTerm(t, bonds[mine], lj, coul) for t in pair_terms]
        if not style.history:
            continue
        term = HistoryTerm(use, at, system, units, interactions.compat)
        if style.breaks == "off":        # the pair interaction is back in the very step
            terms += [term, *(ReleasedPairTerm(t, term, 1.0, 1.0) for t in pair_terms)]
            continue
        lj, coul = 1.0 - interactions.special_lj[0], 1.0 - interactions.special_coul[0]
        if style.breaks and (lj or coul):
            terms += [ReleasedPairTerm(t, term, lj, coul) for t in pair_terms]
        terms.append(term)
    return terms
