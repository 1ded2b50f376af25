"""Pairs that interact with a weight, or not at all: ``special_bonds`` and ``neigh_modify exclude``."""
from __future__ import annotations

import numpy as np

RULES = {"group": 0, "molecule/intra": 1, "molecule/inter": 2}
EVERYWHERE = 1 << 62        # the bit of all atoms


class Exclusions:
    """What a neighbour list must leave out or mark.

    Parameters
    ----------
    system : asemd.system.System
    interactions : asemd.forcefield.Interactions
    exclude : list
        As in `asemd.result.Settings`; ``type`` is not for the list but for the pair tables and is passed over.
    pairs : bool
        False: no pair interactions, so that bonded partners do not matter.

    Attributes
    ----------
    weight_lj, weight_coul : (5,) arrays
        Factors of ordinary pairs (1), of 1-2, 1-3, 1-4 partners, and of pairs whose interaction a bond replaces (0).
    partners : (start, partner, kind) or None
        For each atom row the rows whose factor is not 1, see `partner_table`.
    keep : (5,) bool
        Kinds that interact with a weight, not 0.
    weighted, weighted_kinds : (m, 2), (m,) int32 arrays
        The pairs of such kinds.
    rules : (m, 3) int64
        Rules of neigh_modify exclude: number of the kind, bits of the masks.
    """

    def __init__(self, system, interactions, exclude: list, pairs: bool):
        self.weight_lj = np.array([1.0, *interactions.special_lj, 0.0])
        self.weight_coul = np.array([1.0, *interactions.special_coul, 0.0])
        self.keep = np.array([True, *((self.weight_lj[1:] != 0.0) | (self.weight_coul[1:] != 0.0))])
        parts = (part for use in interactions.uses["pair"] for part in use.style.parts)
        if any(part.long and not getattr(part.function, "leaves_out", False) for part in parts):
            self.keep[1:4] = True         # the solver has the whole interaction of these pairs, which is to be taken off
        self.partners = None
        self.weighted, self.weighted_kinds = np.zeros((0, 2), np.int32), np.zeros(0, np.int32)
        if pairs and not system.topology.is_empty:
            special, kinds = interactions.special_pairs(system)
            replaced = replaced_pairs(system, interactions)
            if len(replaced):
                other = ~np.isin(_keys(special), _keys(replaced))
                special, kinds = np.concatenate([special[other], replaced]), np.append(kinds[other], np.full(len(replaced), 4))
            self._find_partners(system.n, special, kinds)
        self._set_rules(system, [rule for rule in exclude if rule[0] != "type"])

    def _find_partners(self, n: int, pairs: np.ndarray, kinds: np.ndarray) -> None:
        changed = (self.weight_lj[kinds] != 1.0) | (self.weight_coul[kinds] != 1.0)
        self._set_partners(n, pairs[changed], kinds[changed].astype(np.int32))

    def _set_partners(self, n: int, pairs: np.ndarray, kinds: np.ndarray) -> None:
        self.n, self.pairs, self.kinds = n, pairs, kinds
        if len(pairs) or self.partners is not None:
            self.partners = partner_table(n, pairs, kinds)
            kept = self.keep[kinds]
            self.weighted, self.weighted_kinds = np.ascontiguousarray(pairs[kept], np.int32), np.ascontiguousarray(kinds[kept])

    def follow(self, system, exclude: list, gone: np.ndarray, more: int) -> None:
        """Atoms without partners left (rows `gone`) and `more` joined."""
        if self.partners is not None:
            start, partner, kind = self.partners
            new = np.cumsum(~np.isin(np.arange(self.n), gone), dtype=np.int32) - np.int32(1)
            start = np.delete(start, gone)
            self.partners = np.append(start, np.full(more, start[-1], np.int32)), new[partner], kind
            self.n, self.pairs, self.weighted = system.n, new[self.pairs], new[self.weighted]
        self._set_rules(system, [rule for rule in exclude if rule[0] != "type"])

    def release(self, pairs: np.ndarray) -> None:
        """Pairs of rows (m, 2) that interact like any other pair from the next list on: their bond broke."""
        if self.partners is not None:
            stay = ~np.isin(_keys(self.pairs), _keys(pairs))
            self._set_partners(self.n, self.pairs[stay], self.kinds[stay])

    def _set_rules(self, system, rules: list) -> None:
        self.rules = np.zeros((len(rules), 3), np.int64)
        self.rule_mask = np.zeros(system.n, np.int64)
        self._nobody = np.zeros(system.n + 1, np.int32), np.zeros(0, np.int32)
        bit = 1
        for k, (kind, *masks) in enumerate(rules):
            self.rules[k, 0] = RULES[kind]
            for m, mask in enumerate(masks):
                self.rule_mask[mask] |= bit
                self.rules[k, 1 + m] = bit
                bit <<= 1
        self.molecule = np.asarray(system.molecule, np.int64) if system.molecule is not None else np.zeros(system.n, np.int64)

    @property
    def left_out(self) -> tuple[np.ndarray, np.ndarray]:
        """`start` and `partner` of the partners, where there are none, too."""
        return self._nobody if self.partners is None else self.partners[:2]

    @property
    def rule_arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What compiled code needs of the rules: bits and molecules of the atoms, rules."""
        return self.rule_mask, self.molecule, self.rules

    def rules_within(self, molecules: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The same, and only pairs of atoms of the ``same`` molecule or of an ``other`` one remain; empty: both."""
        if not molecules:
            return self.rule_arrays
        rule = (RULES["molecule/inter" if molecules == "same" else "molecule/intra"], EVERYWHERE, 0)
        return self.rule_mask | EVERYWHERE, self.molecule, np.concatenate([self.rules, np.array([rule], np.int64)])

    def mark(self, k, x, row, i, j, code, shifts, cell, periodic) -> list[np.ndarray]:
        """The pairs (i, j, code) of a plain list without those that a rule forbids, the partners among them marked by their kind.

        `k` are the compiled list functions, `x (3, cap)` and `row` those of the slots.
        """
        n = len(i)
        if len(self.rules):
            n = k.drop_excluded(row, i, j, code, n, *self.rule_arrays)
        if self.partners is not None:
            n = k.mark_special(x, row, i, j, code, n, shifts, *self.partners, self.keep, cell.reduced * periodic[:, None],
                               cell.reduced_inverse)
        return [i[:n], j[:n], code[:n]]


def replaced_pairs(system, interactions) -> np.ndarray:
    """Pairs of rows (m, 2) whose pair interaction a bond replaces until it breaks."""
    bonds, types = system.topology.items("bond")
    on = [t for use in interactions.uses["bond"] if use.style.breaks == "off" for t in use.coeff]
    return bonds[np.isin(types, on)]


def _keys(pairs: np.ndarray) -> np.ndarray:
    """One number for each pair of rows, whatever their order."""
    p = np.sort(np.asarray(pairs, np.int64), axis=1)
    return (p[:, 0] << 31) + p[:, 1]


def partner_table(n: int, pairs: np.ndarray, kinds: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Special pairs (m, 2) as partners of each atom row: start (n+1,), partner (2m,), kind (2m,)."""
    both = np.concatenate([pairs, pairs[:, ::-1]]) if len(pairs) else np.zeros((0, 2), np.int32)
    kind = np.concatenate([kinds, kinds]) if len(pairs) else np.zeros(0, np.int8)
    order = np.argsort(both[:, 0], kind="stable")
    start = np.zeros(n + 1, np.int32)
    start[1:] = np.cumsum(np.bincount(both[:, 0], minlength=n)) if len(both) else 0
    return start, np.ascontiguousarray(both[order, 1], np.int32), np.ascontiguousarray(kind[order], np.int32)
