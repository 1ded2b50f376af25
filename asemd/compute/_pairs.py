"""Pairs of atoms near each other at the present positions, as the neighbour list of the pair style has them.

Pairs that ``neigh_modify exclude`` forbids are not among them, nor are partners whose weights of ``special_bonds`` are all zero, but for
those that the list has on behalf of a long-range solver: see `ordinary`. The engine's list serves where it reaches far enough; otherwise
one is made.
"""
from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from asemd.errors import InputError
from asemd.exclusions import Exclusions
from asemd.items_term import ItemsTerm
from asemd.kernels import surroundings as loops
from asemd.kernels.hooks import bound
from asemd.kernels.rows import extent
from asemd.kernels.state import cell_arrays
from asemd.neighbor import BinCell, PlainList, kernels
from asemd.pairing import complete, make_terms


@dataclass
class Half:
    """Each pair once, one entry for each periodic image.

    Attributes
    ----------
    i, j : (m,) int
        Rows of the atoms.
    d : (m, 3)
        From atom j to atom i.
    r2 : (m,)
        Squared distance.
    kind : (m,) int
        0, or 1, 2, 3 of 1-2, 1-3 and 1-4 partners that keep a weight.
    """

    i: np.ndarray
    j: np.ndarray
    d: np.ndarray
    r2: np.ndarray
    kind: np.ndarray

    def take(self, keep: np.ndarray) -> Half:
        return Half(self.i[keep], self.j[keep], self.d[keep], self.r2[keep], self.kind[keep])

    def around(self, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The neighbours of each of n atoms, see `asemd.kernels.surroundings.surroundings`."""
        return loops.surroundings(n, self.i, self.j, self.d, self.r2)


def ordinary(state, code: np.ndarray) -> np.ndarray:
    """Which pairs, by their ``code`` or ``kind``, are there without a long-range solver, too."""
    if state.engine is None:
        return np.ones(len(code), bool)
    rules = state.engine.exclusions
    return ((rules.weight_lj != 0.0) | (rules.weight_coul != 0.0))[code & 3]


def type_cutoffs(state) -> np.ndarray:
    """(ntypes+1, ntypes+1) the distance at which the pair styles end; zeros without one."""
    n = state.system.counts["ntypes"]
    cut = np.zeros((n + 1, n + 1))
    for use, filled in complete(state.engine.interactions, n) if state.engine is not None else ():
        for (i, j), c in filled.items():
            cut[i, j] = cut[j, i] = max(cut[i, j], use.style.reach(c, use.settings))
    return cut


def force_cutoff(state, what: str) -> float:
    """The largest cutoff of the pair styles.

    Raises
    ------
    InputError
        There is no pair style.
    """
    if state.engine is None or not state.engine.interactions.uses["pair"]:
        raise InputError(f"{what} needs a pair style, whose neighbour list it uses")
    return float(type_cutoffs(state).max())


def in_slots(state, reach: float) -> SimpleNamespace:
    """All pairs within `reach` at least: slots ``i, j``, ``code``, ``shifts``, and ``x (3, cap)`` and ``row`` of the slots."""
    engine = state.engine
    if engine is not None and _serves(engine, state.system, reach):
        s = engine.state
        if engine.mode == "plain" or engine.expanded:
            (i, j, code), shifts = engine.plain, engine.plain_shifts
        else:
            shifts = engine.list.shifts
            i, j, code = engine.list.expand(engine.k, s, reach)
            i, j, code = engine.exclusions.mark(engine.k, s.x, s.row, i, j, code, shifts, engine.cell, engine.periodic)
        return SimpleNamespace(x=s.x, row=s.row, i=i, j=j, code=code, shifts=shifts, held=engine.held)
    return _own(state, reach)


def cluster_list(state, reach: float):
    """The engine's `asemd.neighbor.ClusterList`, if it has all pairs within `reach` and nothing is to be left out of it; else None."""
    engine = state.engine
    if engine is None or engine.mode != "cluster" or engine.expanded:
        return None
    left_out = engine.exclusions.partners is not None or len(engine.exclusions.rules)
    return engine.list if not left_out and _serves(engine, state.system, reach) else None


def of_slots(values: np.ndarray, row: np.ndarray) -> np.ndarray:
    """Values by atom row -> by slot; those of empty slots are 0."""
    return np.where(row >= 0, values[row], values.dtype.type(0))


def _serves(engine, system, reach: float) -> bool:
    """Whether the engine has a list of the present positions that reaches so far."""
    if engine.mode == "none" or engine.state is None or engine.system is not system:
        return False
    s, n = engine.state, system.n
    if len(engine.slot_of) != n or not np.array_equal(s.x[:, engine.slot_of], system.x.T):
        return False
    if reach <= engine.cutoff and not engine.settings.outdated:
        return True
    moved = engine.k.moved(s.x, engine.held, engine.ns)
    return not engine.box_moves and reach <= engine.reach - 2.0 * moved**0.5


def _own(state, reach: float) -> SimpleNamespace:
    """A list made for the purpose."""
    system, engine, n = state.system, state.engine, state.system.n
    box, x, image = system.box, system.x.copy(), system.image.copy()
    box.wrap(x, image)
    vectors, periodic = np.ascontiguousarray(box.cell, float), np.array(box.periodic, bool)
    if system.dimension == 2:
        periodic[2] = False
    ortho = not np.count_nonzero(vectors - np.diag(np.diag(vectors))) and bool((np.diag(vectors) > 0).all())
    k, row = kernels(ortho), np.arange(n, dtype=np.int32)
    s = SimpleNamespace(x=np.ascontiguousarray(x.T), row=row)
    origin, inverse = np.asarray(box.origin, float), np.ascontiguousarray(box.inverse)
    bins, made = BinCell(vectors, origin, inverse, periodic, extent(s.x, row, n, origin, inverse)), PlainList(reach)
    i, j, code = made.build(k, s, n, bins, vectors, periodic)
    if engine is not None:
        rules = engine.exclusions if engine.has_pairs else Exclusions(system, engine.interactions, engine.settings.exclude, True)
        i, j, code = rules.mark(k, s.x, row, i, j, code, made.shifts, cell_arrays(vectors, periodic), periodic)
    return SimpleNamespace(x=s.x, row=row, i=i, j=j, code=code, shifts=made.shifts, held=s.x)


def half(state, cutoff: float, *, own: bool = False) -> Half:
    """All pairs closer than `cutoff`.

    Parameters
    ----------
    state : asemd.result.Snapshot
    cutoff : float
        Distance units of the system.
    own : bool
        Types whose interaction ends before the cutoff (plus skin) count too, as in a list of its own; in that of the pair style they do
        not.
    """
    found = in_slots(state, cutoff)
    m = len(found.i)
    i, j, d, r2 = np.empty(m, np.int32), np.empty(m, np.int32), np.empty((m, 3)), np.empty(m)
    loops.separations(found.x, found.row, found.i, found.j, found.code, found.shifts, i, j, d, r2)
    keep = r2 < cutoff * cutoff
    limit = limits(state, cutoff, own)
    if limit is not None:
        t, held = state.system.type, found.held[:, found.i] - found.held[:, found.j] - found.shifts[found.code >> 2].T
        keep &= (held * held).sum(axis=0) <= limit[t[i], t[j]]       # what the list held when it was built
    out = Half(i, j, d, r2, found.code & 3)
    return out if keep.all() else out.take(keep)


def limits(state, cutoff: float, own: bool) -> np.ndarray | None:
    """(ntypes+1, ntypes+1) squared distances that the list reaches by type; None if it reaches `cutoff` for all."""
    engine = state.engine
    if engine is None:
        return None
    barred = [pair for kind, *pair in engine.settings.exclude if kind == "type"]
    if own or not engine.interactions.uses["pair"]:
        limit = np.full((state.system.counts["ntypes"] + 1,) * 2, np.inf)
    else:
        cut = type_cutoffs(state)
        limit = np.where(cut > 0.0, cut + engine.settings.skin, 0.0) ** 2
    for a, b in barred:
        limit[a, b] = limit[b, a] = 0.0
    return None if (limit[1:, 1:] >= cutoff * cutoff).all() else limit


def interactions(state, pairs: Half, only=None, beyond: bool = False, terms=None, charges=None,
                 single: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Energies (m,) of pairs and the force (m, 3) on the first atom of each, summed over the pair styles.

    Parameters
    ----------
    only : callable, optional
        Which terms (`asemd.pairing.PairTerm`) count.
    beyond : bool
        Formulas go on beyond the cutoff, where no list has a pair; not those of hybrid styles.
    terms, charges : optional
        Terms and charges (n,) other than those of the engine and the system.
    single : bool
        Energies are those of single pairs, where these differ from what is added up (`asemd.pairstyle.PairStyle.unweighted`).

    Raises
    ------
    InputError
        A style whose forces are not those of its energy (a factor for each atom).
    """
    engine, m = state.engine, len(pairs.i)
    check_pairwise(all_of(engine) if terms is None else terms)
    energy, force = np.zeros(m), np.zeros((m, 3))
    x, q = np.zeros((3, 2 * m)), np.zeros(2 * m)
    x[:, :m] = pairs.d.T
    rows = np.concatenate([pairs.i, pairs.j])
    types = np.ascontiguousarray(state.system.type[rows], np.int32)
    if state.system.q is not None:
        q[:] = (state.system.q if charges is None else charges)[rows]
    first, second = np.arange(m, dtype=np.int32), np.arange(m, 2 * m, dtype=np.int32)
    rules = engine.exclusions
    for term in acting(engine) if terms is None else terms:
        if only is not None and not only(term):
            continue
        if np.ndim(term.use.factor) > 0:
            raise InputError(f"pair style {term.label} has a factor for each atom, so that its pairs have no energy: leave it out")
        code = np.ascontiguousarray(pairs.kind, np.int32)
        lj, coul = term.weights(rules.weight_lj, rules.weight_coul, rules.keep)
        f, e, bad, rows_of_tables = np.zeros((3, 2 * m)), np.zeros(2 * m), np.zeros(4), term.tables.rows
        if beyond and len(engine.interactions.uses["pair"]) == 1:
            rows_of_tables = rows_of_tables.copy()
            rows_of_tables[term.cut_rows] = np.inf
        chosen = slice(None)
        if term.molecules:
            same = rules.molecule[pairs.i] == rules.molecule[pairs.j]
            chosen = np.flatnonzero(same == (term.molecules == "same"))
        a, b, c = first[chosen], second[chosen], code[chosen]
        radii = [state.system.extra["radius"][rows]] if term.style.sized else []
        style = term.style.unweighted if single and term.style.unweighted else term.style
        bound(_kernel(style), (x, f, q, types, a, b, c, np.zeros((1, 3)), lj, coul, 0, len(a), rows_of_tables, term.tables.constants,
                              (*term.tables.arrays, *radii), engine.qqr2e, np.zeros(8), e, np.zeros((6, 2 * m)), bad), 2)()
        energy += e[:m] + e[m:]
        force += f[:, :m].T
    return energy, force


def acting(engine) -> list:
    """The terms of the pair styles, those of ``pair_modify compute no`` too: as in LAMMPS, their pairs have energies and forces."""
    inter = engine.interactions
    if all(inter.modified(use, "compute") for use in inter.uses["pair"]):
        return engine.pair_terms
    return [t for t in make_terms(inter, engine.system.counts["ntypes"], engine.units, idle=True) if t.style.parts]


def all_of(engine) -> list:
    """What has the pair styles of an engine, those too whose pairs are no matter of distance."""
    named = [t.owner.use for t in engine.terms if isinstance(t, ItemsTerm)]
    return [*engine.many_terms, *engine.pair_terms, *named]


def check_pairwise(terms) -> None:
    """Refuse pair styles without energies of single pairs that are functions of the distance.

    Raises
    ------
    InputError
        The message names the style.
    """
    for term in terms:
        if term.style.many:
            raise InputError(f"pair style {term.style.name} is a many-body potential: there is no energy or force of a single pair of "
                             "atoms")
        if term.style.oriented:
            raise InputError(f"pair style {term.style.name} depends on the orientation of atoms: single pairs are not available")
        if term.style.on_sites:
            raise InputError(f"pair style {term.style.name} has charges that are not on atoms: single pairs of atoms are not available")
        if hasattr(term.style, "items_style"):
            raise InputError(f"pair style {term.style.name} names its pairs one by one: these are not available, use compute pair")
        if term.style.dielectric:
            raise InputError(f"pair style {term.style.name} depends on dielectric constants of atoms: single pairs are not available")


def _kernel(style):
    from asemd.kernels.pair import list_kernel
    return list_kernel(style, style.parts, wanted=True)[0]


def within_force_cutoff(state, cutoff: float, what: str) -> float:
    """The cutoff, which a list of the pair style must reach.

    Raises
    ------
    InputError
        There is no pair style, or its cutoff is smaller.
    """
    longest = force_cutoff(state, what)
    if cutoff > longest:
        raise InputError(f"{what}: cutoff {cutoff:g} is longer than that of the pair style, {longest:g}")
    return cutoff
