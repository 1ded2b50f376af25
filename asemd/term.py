"""Terms: the pieces of an energy, each a compiled kernel with its arguments per thread."""
from __future__ import annotations

from typing import Protocol

import numpy as np

from asemd.errors import ONE_PLACE, InputError, SimulationError
from asemd.kernels import pair as pair_kernels
from asemd.kernels.pair_list import ROOM
from asemd.kernels.pair_scaled import scaled
from asemd.kernels.state import aligned
from asemd.pairing import NO_REPULSION

BONDED_KEY = {"bond": "ebond", "angle": "eangle", "dihedral": "edihed", "improper": "eimp"}


class Term(Protocol):
    """What the engine asks of a term.

    `category` is the thermo column group (pair, bond, ...); `kernel` returns the compiled function and the module it lives in;
    `arguments` its arguments for one thread, valid until the next list build; `describe` the error for the item that `bad` names.
    """

    category: str

    def kernel(self, energy: bool, per_atom: bool): ...

    def virial_kernel(self):
        """For steps of which only the virial is wanted besides the forces."""
        return self.kernel(True, False)

    def rebuild(self, engine) -> None: ...

    # def relisted(self, engine) -> list[tuple[str, tuple]] | None: for a class whose `rebuild` compiled code can do, too, at least now:
    # functions of `asemd.kernels.relist` and their arguments; those of the term's kernels do not change

    # def look(self, engine) -> None: for a class whose kernels depend on time: Python is going to call them, not the time loop
    # def rewind(self) -> None: for a class whose kernels draw random numbers: the last ones once more

    def rename(self, new: np.ndarray) -> None:
        """Atoms that no item names left: the `new` number of each row."""

    def arguments(self, engine, tid: int) -> tuple: ...

    def describe(self, engine, item: int, value: float) -> SimulationError: ...


def look(engine) -> None:
    """Python is going to call the kernels: terms that depend on time see where the run is."""
    for t in engine.terms:
        if hasattr(t, "look"):
            t.look(engine)


def rewind(engine) -> None:
    """The next evaluation has the random numbers of the last one."""
    for t in engine.terms:
        if hasattr(t, "rewind"):
            t.rewind()


class BondedTerm(Term):
    """All items of one bonded style."""

    def __init__(self, category: str, use, items: np.ndarray, types: np.ndarray, ntypes: int, units, compat: str = ""):
        self.category, self.use, self.style = category, use, use.style.bind(use.settings, use.coeff, compat)
        order = np.argsort(items[:, 0], kind="stable")
        self.items, self.types = np.ascontiguousarray(items[order], np.int32), np.ascontiguousarray(types[order], np.int32)
        self.packed = self.style.pack(use.settings, use.coeff, ntypes, units)
        self.slots, self.slot_types, self.order = np.zeros_like(self.items), np.zeros_like(self.types), np.zeros_like(self.types)
        self.start, self.rooms = None, []

    def kernel(self, energy, per_atom):
        from asemd.kernels import bonded
        return bonded.loop(self.style, energy=energy, per_atom=per_atom, periodic=self.periodic, orthogonal=self.orthogonal)

    def rename(self, new):
        self.items, self.start = new[self.items], None

    def rebuild(self, engine):
        self.periodic, self.orthogonal = bool(engine.periodic.any()), engine.ortho
        engine.k.to_slots(engine.state.row, engine.ns, self._starts(engine.system.n), self.items, self.types, engine.slot_of, self.slots,
                          self.slot_types, self.order)

    def _starts(self, n: int) -> np.ndarray:
        """Where the items of each of `n` rows begin."""
        if self.start is None or len(self.start) != n + 1:
            self.start = np.searchsorted(self.items[:, 0], np.arange(n + 1)).astype(np.int32)
        return self.start

    def relisted(self, engine):
        return [("place_items", (engine.state.row, self._starts(engine.system.n), self.items, self.types, engine.slot_of, self.slots,
                                 self.slot_types, self.order))]

    def arguments(self, engine, tid):
        from asemd.kernels import bonded
        m, nth = len(self.items), engine.threads
        while len(self.rooms) < nth:
            self.rooms.append(bonded.room(self.style))
        return (engine.state.x, engine.buffers[tid], self.slots, self.slot_types, engine.cell, self.packed.coeff,
                bonded.arrays(self.style, self.packed.arrays), m * tid // nth, m * (tid + 1) // nth, engine.acc[tid, self.index],
                engine.atom_energy[tid], engine.atom_virial[tid], engine.bad[tid, self.index], bonded.functions(self.style),
                self.rooms[tid])

    def describe(self, engine, item, value):
        from asemd.kernels import bonded
        item = self.order[item]
        ids = [int(engine.system.id[r]) for r in self.items[item]]
        return SimulationError(bonded.describe(self.style, value, ids, int(self.types[item])))


class DipoleTerm(BondedTerm):
    """Angles that hold dipoles, which fixes may turn: kernels read them where they are, by row.

    Raises
    ------
    InputError
        The atoms have no dipoles.
    """

    def rebuild(self, engine):
        super().rebuild(engine)
        if "mu" not in engine.system.extra:
            raise InputError(f"angle_style {self.style.name} needs atoms with dipoles: use atom_style dipole, or hybrid with it")

    def arguments(self, engine, tid):
        x, out, slots, types, cell, coeff, arrays, *rest = super().arguments(engine, tid)
        turning = (engine.state.row, engine.system.extra["mu"], engine.buffers[tid, 3:])
        return (x, out, slots, types, cell, coeff, (*arrays, *turning), *rest)

    def describe(self, engine, item, value):
        row = self.items[self.order[item]][0]
        if not engine.system.extra["mu"][row].any():
            return SimulationError(f"angle_style {self.style.name}: atom {engine.system.id[row]} has no dipole, set its length first")
        return super().describe(engine, item, value)


def store_torques(state, slots: int, system) -> None:
    """The torques of the last evaluation, as ``system.extra["torque"]`` (n, 3)."""
    if len(state.torque):
        rows = state.row[:slots]
        system.extra.setdefault("torque", np.zeros((system.n, 3)))[rows[rows >= 0]] = state.torque[:, :slots][:, rows >= 0].T


class FactorTerm(Term):
    """What pair terms with one factor for all their forces have in common: their kernel writes to arrays of its own, see `scaled`."""

    owner = None
    factor: np.ndarray | None = None

    def _scaled(self, kernel, energy: bool):
        return kernel if self.owner.is_plain else scaled(kernel, energy)

    def _sums(self, engine, tid: int) -> tuple[np.ndarray, np.ndarray]:
        """Where the kernel adds its forces, energies and virial."""
        if self.owner.is_plain:
            return self._view("f", engine.buffers, tid), self._view("acc", engine.acc, tid, self.index)
        if self.factor is None or self.own.shape != engine.buffers.shape:
            self.own, self.own_acc = aligned(engine.buffers.shape), np.zeros((engine.threads, 8))
            self.factor = np.array([float(self.owner.use.factor)])
        return self.own[tid], self.own_acc[tid]

    def _view(self, name: str, array: np.ndarray, *at: int) -> np.ndarray:
        """``array[at]``, the same view as long as the array is the same: new ones take time to be packed."""
        views = vars(self).setdefault("views", {})
        known = views.get((name, at))
        if known is None or known[0] is not array:
            known = views[name, at] = array, array[at]
        return known[1]

    def _with_factor(self, engine, tid: int, arguments: tuple) -> tuple:
        if self.owner.is_plain:
            return arguments
        return engine.buffers[tid], engine.acc[tid, self.index], self.factor, *self._sums(engine, tid), arguments

    def scale(self, engine) -> None:
        """Take up the present factor of the pair style."""
        if self.factor is not None:
            self.factor[0] = self.owner.use.factor


class PairRowsTerm(FactorTerm):
    """A pair style over rows of single atoms: where an atom has so few neighbours that packing clusters does not pay, for tables, and for
    pairs that are chosen by molecule."""

    category = "pair"
    piece = ""

    def __init__(self, term):
        self.owner, self.style, self.tables = term, term.style, term.tables
        self.uniform = pair_kernels.uniform_rows(self.tables.rows)
        self.room = ()
        self.take_tables()

    def fits(self, tables) -> bool:
        """As of `PairTerm`."""
        return pair_kernels.uniform_rows(tables.rows) == self.uniform

    def take_tables(self) -> None:
        """As of `PairTerm`; the kernel takes the table of coefficients itself."""
        self.p = pair_kernels.cluster_tuple(self.tables.rows, self.tables.constants, self.uniform, False)

    def kernel(self, energy, per_atom):
        return self._scaled(pair_kernels.rows_kernel(self.style, self.uniform, energy=energy, piece=self.piece)[0], energy)

    def rebuild(self, engine):
        if len(self.room) != engine.threads:
            self.room, self.who = aligned((engine.threads, 7 * ROOM)), np.zeros((engine.threads, 2, ROOM), np.int32)

    def relisted(self, engine):
        return []

    def arguments(self, engine, tid):
        s, c = engine.state, engine.list
        rows = engine.rows[self.owner.molecules]
        f, acc = self._sums(engine, tid)
        return self._with_factor(engine, tid, (
            s.x, f, s.q, s.type, rows.start[tid], rows.owners[tid], rows.neighbors[tid], c.shifts,
            rows.ranges[tid], self.p, self.tables.rows, self.tables.arrays, engine.qqr2e, acc, engine.bad[tid, self.index],
            self.room[tid], self.who[tid]))

    def describe(self, engine, item, value):
        j, i = divmod(int(item), 1 << 26)
        return not_finite(engine, self.style, i, j, value)


class PairListTerm(Term):
    """A pair style over plain pairs: all pairs, or the special pairs the cluster kernel leaves out.

    Parameters
    ----------
    pairs : str
        ``all``, ``special``, or pairs that bonded styles ask for, given by `one_four` as pairs (m, 2), kinds (m,) and the weights of the
        kinds: ``one_four`` (dihedral charmm) and ``ends`` (angle spica, whose energy they are part of).
    owner : asemd.pairing.PairTerm, optional
        The pair style with its own weights of kinds of pairs and its factor.
    """

    piece = ""

    def __init__(self, style, tables, parts, pairs: str, one_four=None, owner=None):
        self.style, self.tables, self.parts, self.pairs, self.owner = style, tables, parts, pairs, owner
        self.one_four, self.category = one_four, "angle" if pairs == "ends" else "pair"
        self.sized = any(part.sized for part in parts)
        self.by_atom = owner is not None and np.ndim(owner.use.factor) > 0

    def kernel(self, energy, per_atom):
        return pair_kernels.list_kernel(self.style, self.parts, wanted=energy or per_atom, factor=self.by_atom, piece=self.piece)[0]

    def rename(self, new):
        if self.one_four is not None:
            self.one_four = new[self.one_four[0]], *self.one_four[1:]

    def rebuild(self, engine):
        if self.pairs in ("all", "special"):
            found = (*engine.plain, engine.plain_shifts) if self.pairs == "all" else (*engine.special, engine.close_shifts)
            self.i, self.j, self.code, self.shifts = found
            rules = engine.exclusions
            self.lj, self.coul = self.owner.weights(rules.weight_lj, rules.weight_coul, rules.keep)
            if self.sized:
                self.radii = np.zeros(engine.state.x.shape[1])
                self.take_radii(engine)
            if self.owner.molecules:
                molecule = rules.molecule[engine.state.row]
                chosen = (molecule[self.i] == molecule[self.j]) == (self.owner.molecules == "same")
                self.i, self.j, self.code = self.i[chosen], self.j[chosen], self.code[chosen]
            if self.by_atom:
                self.factor = np.zeros(engine.state.x.shape[1])
                self.scale(engine)
        else:
            pairs, kinds, weights = self.one_four
            out = [np.empty(len(pairs), np.int32) for _ in range(3)]
            engine.k.special_pairs(pairs, kinds, engine.slot_of, engine.state.x, engine.close_shifts, engine.close_periodic, *out)
            self.i, self.j, self.code = out
            self.shifts, self.lj, self.coul = engine.close_shifts, weights, weights

    def take_radii(self, engine) -> None:
        """Take up the present radii of atoms; the array that kernels work on stays the same."""
        row = engine.state.row
        self.radii[:] = np.where(row >= 0, engine.system.extra["radius"][row], 0.0)

    def relisted(self, engine):
        if self.pairs == "one_four":
            pairs, kinds, _ = self.one_four
        elif self.pairs == "special" and not (self.owner.molecules or self.sized or self.by_atom):
            pairs, kinds = engine.exclusions.weighted, engine.exclusions.weighted_kinds
        else:
            return None
        return [("place_pairs", (pairs, kinds, engine.slot_of, engine.state.x, engine.close_shifts, engine.close_periodic, self.i, self.j,
                                 self.code))]

    def scale(self, engine) -> None:
        """Take up the present factor of the pair style; the arrays that kernels work on stay the same."""
        if self.by_atom:
            row = engine.state.row
            self.factor[row >= 0] = self.owner.use.factor[row[row >= 0]]
        elif self.owner is not None:
            rules = engine.exclusions
            self.lj[:], self.coul[:] = self.owner.weights(rules.weight_lj, rules.weight_coul, rules.keep)

    def arguments(self, engine, tid):
        s, m, nth = engine.state, len(self.i), engine.threads
        arrays = (*self.tables.arrays, *([self.factor] if self.by_atom else []), *([self.radii] if self.sized else []))
        return (s.x, engine.buffers[tid], s.q, s.type, self.i, self.j, self.code, self.shifts, self.lj, self.coul, m * tid // nth,
                m * (tid + 1) // nth, self.tables.rows, self.tables.constants, arrays, engine.qqr2e,
                engine.acc[tid, self.index], engine.atom_energy[tid], engine.atom_virial[tid], engine.bad[tid, self.index])

    def describe(self, engine, item, value):
        return not_finite(engine, self.style, self.i[item], self.j[item], value)


def not_finite(engine, style, i: int, j: int, distance: float) -> SimulationError:
    """The error of two slots whose pair energy or force is not finite."""
    first, second = sorted(int(engine.system.id[engine.state.row[slot]]) for slot in (i, j))
    why = f"the atoms coincide; {ONE_PLACE}" if distance == 0 else style.domain or "outside the style's domain"
    return SimulationError(f"pair style {style.name}: energy or force between atoms {first} and {second} at distance {distance:.6g} "
                           f"is not finite: {why}")


def bonded_terms(system, interactions, pair_terms, units) -> list:
    """The terms of all bonded styles in use, and the weighted 1-4 pairs that dihedral styles ask for."""
    from asemd.items_term import ItemsTerm
    terms: list = [ItemsTerm(use, system, interactions, units) for use in interactions.uses["pair"] if hasattr(use.style, "items_style")]
    for category, items, types in system.topology:
        for use in interactions.uses.get(category, []):
            mine = np.isin(types, list(use.coeff))
            if use.style.function is not None and not use.style.history and mine.any():
                kind = DipoleTerm if use.style.coordinates == ("gamma",) else BondedTerm
                terms.append(kind(category, use, items[mine], types[mine], system.counts[f"n{category}types"], units, interactions.compat))
                terms += one_four_terms(use, items[mine], types[mine], pair_terms, system.counts["ntypes"], units)
                terms += end_terms(use, items[mine], types[mine], pair_terms, system.counts["ntypes"])
    return terms


def end_terms(use, items: np.ndarray, types: np.ndarray, pair_terms, ntypes: int) -> list[PairListTerm]:
    """Repulsion of the first and the third atom of angles of style spica, with the pair style's coefficients.

    Raises
    ------
    InputError
        No pair style in use has such coefficients.
    """
    switch = getattr(use.style, "repulsion", "")
    on = {t for t, c in use.coeff.items() if switch and c[switch] > 0.0}
    pairs = np.ascontiguousarray(items[np.isin(types, list(on))][:, [0, -1]], np.int32)
    if not len(pairs):
        return []
    owner = next((t for t in pair_terms if hasattr(t.style, "repulsion")), None)
    if owner is None:
        raise InputError(NO_REPULSION.format(use.style.name))
    return [PairListTerm(owner.style, owner.style.repulsion(owner.filled, ntypes), owner.style.repulsion_parts, "ends",
                         (pairs, np.full(len(pairs), 1, np.int32), np.ones(4)))]


def one_four_terms(use, items: np.ndarray, types: np.ndarray, pair_terms, ntypes: int, units) -> list[PairListTerm]:
    """Weighted 1-4 pairs of dihedral style charmm, computed with the pair style's 1-4 coefficients.

    Raises
    ------
    InputError
        No pair style in use has such coefficients.
    """
    weight = getattr(use.style, "weight_14", "")
    if not weight:
        return []
    w = np.array([0.0] + [float(use.coeff.get(t, {}).get(weight, 0.0)) for t in range(1, int(types.max()) + 1)])[types]
    values = np.unique(w[w != 0.0])
    if not len(values):
        return []
    name = use.style.one_four
    owner = next((t for t in pair_terms if hasattr(t.style, name)), None)
    if owner is None:
        raise InputError(use.style.needs_pairs())
    tables, parts = getattr(owner.style, name)(owner.use.settings, owner.filled, ntypes, units), getattr(owner.style, f"{name}_parts")
    terms = []
    for value in values:
        pairs = np.ascontiguousarray(items[w == value][:, [0, 3]], np.int32)
        terms.append(PairListTerm(owner.style, tables, parts, "one_four",
                                  (pairs, np.full(len(pairs), 1, np.int32), np.array([1.0, value, value, value]))))
    return terms
