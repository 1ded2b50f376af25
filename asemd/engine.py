"""The engine: atom data in slots, neighbour list, terms; energy, forces and virial of a `System`."""
from __future__ import annotations

import math
import time

import numpy as np
from numba import config

from asemd import atom_shares, faults, live_box
from asemd import units as unit_styles
from asemd.bond_term import Bonds, bond_terms
from asemd.cluster_term import PairTerm
from asemd.embedded_term import EmbeddedTerm
from asemd.errors import SimulationError
from asemd.exclusions import Exclusions
from asemd.kernels.hooks import BoundKernels
from asemd.kernels.rows import of_slots
from asemd.kernels.state import Meeting, aligned, cell_arrays, empty_state
from asemd.kernels.target import vector
from asemd.kernels.team import Team
from asemd.kspace import solve
from asemd.late import Late
from asemd.manybody_term import all_pairs, many_term
from asemd.neighbor import SMALL, BinCell, ClusterList, PlainList, Rows, close_images, kernels
from asemd.noise_term import list_term
from asemd.own_term import own_terms
from asemd.result import Result, Settings
from asemd.site_terms import made
from asemd.term import BONDED_KEY, PairListTerm, PairRowsTerm, bonded_terms, look, store_torques

SPARSE = 8            # neighbours per atom (half list) below which rows of single atoms beat packed clusters
SLOTTED = 9           # the first fields of a `State`, those by slot
TURNING = {"torque", "mu", "omega", "angmom"}      # atoms that have one of these feel torques
ENERGIES = ("evdwl", "ecoul", "ebond", "eangle", "edihed", "eimp", "elong", "etail")


class Engine:
    """Compiled forces of a system.

    Parameters
    ----------
    system : asemd.system.System
    interactions : asemd.forcefield.Interactions
    settings : Settings
    box_moves : str
        Whether the box changes within a run: ``size`` (a box along the axes stays one), ``shape`` (it may be tilted), or empty.
    solver : KSpace, optional
        A long-range solver whose parameters stay.

    Attributes
    ----------
    mode : str
        ``cluster``, ``plain`` or ``none``: which neighbour list the scene needs; `why` says why.
    """

    def __init__(self, system, interactions, settings: Settings | None = None, box_moves: str = "", solver=None):
        self.system, self.interactions, self.settings, self.box_moves = system, interactions, settings or Settings(), box_moves
        self.threads = 1 if config.DISABLE_JIT else max(1, self.settings.threads)     # uncompiled threads cannot wait for each other
        self.builds = self.dangerous = 0
        self.slot_of, self.sparse = np.zeros(0, np.int32), False
        self.timings = dict.fromkeys(("Pair", "Bond", "Kspace", "Neigh", "Comm", "Output", "Modify", "Other"), 0.0)
        self.parallel = Team(self.threads)
        self.meeting = Meeting(self.threads, np.zeros(8, np.int64))      # for terms whose threads wait for each other
        self.groups, self.bits = {}, {"all": 1}
        self.result: Result | None = None
        self._bound = BoundKernels(0), BoundKernels(1)
        self.units = unit_styles.get(system.units)
        self.qqr2e, self.shares = interactions.coulomb_constant(self.units) / interactions.dielectric, None      # of `asemd.atom_shares`
        self.update(system, solver)

    # ---- set-up -------------------------------------------------------------------------------------------------------------------------
    def update(self, system, solver=None) -> None:
        """Take over types, charges, topology, box and groups after they changed; coefficients too. A `solver` that is given stays."""
        self.system, s, inter = system, self.settings, self.interactions
        self.set_box()
        self.solver = solve(system, inter, self.units, s.skin, solver) if inter.kspace != "none" or inter.needs_solver else None
        inter.learn(system)
        terms = [t for t in inter.pair_terms(system.counts["ntypes"], self.units) if t.style.parts or t.style.many]
        for kind, *pair in s.exclude:
            if kind == "type":
                for t in terms:
                    t.exclude(*pair)
        self.pair_terms, self.many_terms = [t for t in terms if t.style.parts], [t for t in terms if not t.style.parts]
        self.has_pairs = bool(terms)
        self.cutoff = max((float(t.tables.rows[t.cut_rows].max()) ** 0.5 + t.margin for t in terms), default=0.0)
        self.reach = self.cutoff + s.skin
        self.exclusions = Exclusions(system, inter, s.exclude, self.has_pairs)
        self.mode, self.expanded, self.sparse, self.packed, self.why = self.list_for(system.n)
        self.k = kernels(self.ortho, s.outdated or self.sparse, not self.sparse)
        self.terms = self._make_terms()
        self.bonds = Bonds(self)
        self.changed = True      # loops look whether their kernels are still the right ones
        for k, t in enumerate(self.terms):
            t.index = k
        self.acc, self.bad = (np.zeros((self.threads, max(1, len(self.terms)), m)) for m in (8, 4))
        self.farthest = np.zeros(self.threads)      # largest of `moved`, for each thread to read
        self._rows()
        self.list = (ClusterList(self.threads, self.reach, vector(s.precision == "mixed"), s.outdated or self.sparse)
                     if self.mode == "cluster" else PlainList(self.reach))
        self.rows = {t.molecules: Rows(self.threads) for t in self.pair_terms} if self.sparse else {}
        self.state, self._offset, self.ns = None, None, 0
        self.listed: tuple | None = None      # the present list as plain pairs, if anything asked for it

    def list_for(self, n: int) -> tuple[str, bool, bool, bool, str]:
        """The neighbour list that `n` such atoms need: mode, whether pairs are written out, in rows, packed; and why."""
        table = any(part.arrays for t in self.pair_terms for part in t.style.parts)
        rules, chosen = len(self.exclusions.rules) > 0, any(t.molecules for t in self.pair_terms)
        few, partners = self.few(n), self.exclusions.partners is not None
        # where two images of an atom are in reach, rows of atoms cannot tell which one is special
        room = 2 if self.many_terms or partners and (table or few or rules or chosen) else 1
        mode, why = "cluster", "half list of clusters of 8 atoms"
        if not self.has_pairs:
            mode, why = "none", "no pair interactions"
        elif n < SMALL:
            mode, why = "plain", f"fewer than {SMALL} atoms"
        elif (self.widths[self.periodic] <= room * self.reach).any():
            mode, why = "plain", f"a periodic cell width is not above {'twice ' * (room == 2)}cutoff plus skin"
        expanded = mode == "cluster" and any(np.ndim(t.use.factor) > 0 or t.style.listed for t in self.pair_terms)
        plain = mode != "cluster" or expanded
        packed = not (plain or partners or rules) and all(getattr(t.style, "packable", False) for t in self.many_terms)
        sparse = not plain and (few or table or rules or chosen or not (self.pair_terms or packed))
        if sparse:
            reasons = (("only many-body styles", not self.pair_terms), ("tables", table), ("neigh_modify exclude", rules),
                       ("pairs are chosen by molecule", chosen), (f"fewer than {SPARSE} neighbours per atom", True))
            why = f"{next(text for text, holds in reasons if holds)}: rows of single atoms"
        return mode, expanded, sparse, packed, why

    def few(self, n: int) -> bool:
        return 2.1 * self.reach * self.reach * self.reach * n < SPARSE * self.volume

    def _make_terms(self) -> list:
        terms, single, weighted = [], self.settings.precision == "mixed", bool(len(self.exclusions.weighted))
        for t in self.pair_terms:
            if self.mode == "cluster" and not self.expanded:
                rows = (PairRowsTerm, t.sites, t) if self.sparse else (PairTerm, t.sites, t, single)
                terms += [] if t.style.special_only else [made(*rows)]
                if weighted:
                    terms.append(made(PairListTerm, t.sites, t.style, t.tables, t.style.parts, "special", owner=t))
            else:
                terms.append(list_term(t) if t.sites is None else
                             made(PairListTerm, t.sites, t.style, t.tables, t.style.parts, "all", owner=t))
        terms += [EmbeddedTerm(t) if self.packed else many_term(t) for t in self.many_terms]
        terms += own_terms(self.pair_terms, self.system.counts["ntypes"], self.qqr2e)
        if self.solver is not None and self.solver.modify["compute"]:
            terms += self.solver.terms(self)
        return terms + [t for f in (bonded_terms, bond_terms) for t in f(self.system, self.interactions, self.pair_terms, self.units)]

    def set_box(self) -> None:
        box = self.system.box
        self.vectors = np.ascontiguousarray(box.cell, float)
        self.origin = np.asarray(box.origin, float).copy()
        self.periodic = np.array(box.periodic, bool)
        if self.system.dimension == 2:
            self.periodic[2] = False
        off = self.vectors - np.diag(np.diag(self.vectors))
        self.ortho = not np.count_nonzero(off) and bool((np.diag(self.vectors) > 0).all()) and self.box_moves != "shape"
        self.inverse = np.ascontiguousarray(box.inverse)
        self.widths, self.volume = 1.0 / np.linalg.norm(self.inverse, axis=0), abs(float(np.linalg.det(self.vectors)))
        self.cell = cell_arrays(self.vectors, self.periodic)
        self.close_images, self.close_shifts = close_images(self.cell.reduced, self.vectors)
        self.close_periodic = (self.close_images[:, ~self.periodic] == 0).all(axis=1)
        self.k = kernels(self.ortho, self.settings.outdated or self.sparse, not self.sparse)

    def set_groups(self, groups, bits) -> None:
        """Masks of groups (n,) and their bits, for the masks of the slots from the next list on."""
        self.groups, self.bits = dict(groups), dict(bits)
        self._rows()

    def _rows(self) -> None:
        """Per-atom constants by row, from which slots are filled at each build."""
        s, n = self.system, self.system.n
        self.type_row = np.ascontiguousarray(s.type, np.int32)
        mass = s.atom_masses()
        self.mass_row = np.where(np.isnan(mass), 1.0, mass)
        self.inverse_row = self.units.ftm2v / self.mass_row
        self.q_row = np.ascontiguousarray(s.q, float) if s.q is not None else np.zeros(n)
        self.mask_row = np.ones(n, np.int32)
        for name, mask in self.groups.items():
            if name != "all":
                self.mask_row[mask] |= np.array(self.bits[name]).astype(np.int32)
        self.varies = np.array([len(a) > 0 and bool((a != a[0]).any()) for a in (self.type_row, self.mass_row, self.q_row, self.mask_row)])
        self.slot_of = self.slot_of if len(self.slot_of) == n else np.zeros(n, np.int32)

    def _allocate(self, capacity: int) -> None:
        old, capacity = self.state, -(-capacity // 8) * 8      # rows of whole cache lines
        new = empty_state(capacity, self.slot_of, self.system.image, self.acc, live_box.live(self))
        if old is not None:
            m = self.ns
            for a, b in zip(new[:SLOTTED], old[:SLOTTED]):
                a[..., :m] = b[..., :m]
        turning = not TURNING.isdisjoint(self.system.extra)
        self.buffers = aligned((self.threads, 6 if turning else 3, capacity))      # forces, then torques
        self.state = new._replace(f=self.buffers[0, :3], torque=self.buffers[0, 3:])
        # positions when the list was built; squared displacements of the slots since then, for lists that may be outdated
        self.held, self.moved = aligned((3, capacity)), aligned((capacity,))
        self.atom_energy, self.atom_virial = np.zeros((self.threads, 1)), np.zeros((self.threads, 6, 1))

    def __getstate__(self):
        raise TypeError("an Engine holds compiled code and is made anew from its scene")

    # ---- lists --------------------------------------------------------------------------------------------------------------------------
    def load(self, listed: bool = True) -> None:
        """Positions and velocities of the system into slots, and a fresh list, unless one is made anyway before the next forces."""
        n = self.system.n
        if self.state is None or self.state.x.shape[1] < n + 8:
            self.ns, self.state = 0, None
            self._allocate(n + 8 + n // 8)
        self.ns, s = n, self.state
        s.row[:] = -1
        s.row[:n] = np.arange(n, dtype=np.int32)
        s.x[:, :n], s.v[:, :n] = self.system.x.T, self.system.v.T
        self._offset, self.slot_of[:], self.held[:, :n] = None, np.arange(n), s.x[:, :n]
        if self.mode == "cluster":
            self.list.gaps = True
        if listed:
            self.rebuild()

    def rebuild(self) -> None:
        """Wrap, sort, list: the slots keep their atoms' data but change order."""
        began = time.perf_counter()
        self.bonds.release()
        if self.box_moves:
            live_box.shrunk(self)
        k, s = self.k, self.state
        bad = k.wrap(s.x, self.system.image, s.row, 0, self.ns, self.origin, self.vectors, self.inverse, self.periodic)
        if bad >= 0:
            raise SimulationError(f"atom {self.system.id[s.row[bad]]}: position is not finite")
        shares = live_box.faces(self)
        if self.mode == "cluster":
            bins = BinCell(self.vectors, self.origin, self.inverse, self.periodic, shares)
            if self.list.gaps:      # where atoms fill a box that stays, once in a run
                bins.squeeze(s, self.ns, self.system.n, self.reach, self.ortho, self.list.marked, not self.sparse)
                self.list.gaps = bins.k is not None or bool(self.box_moves) or not self.periodic.all()
            found = -1
            while found < 0:
                self.list.shape(bins, self.system.n)
                if s.x.shape[1] < self.list.capacity:
                    self._allocate(self.list.capacity)
                    s = self.state
                found = self.list.sort(k, s, self.ns, bins, self.parallel)
            self.ns = found
        k.gather(0, self.ns + 8, s.row, self.slot_of, self.varies, self.type_row, self.mass_row, self.inverse_row, self.q_row,
                 self.mask_row, s.type, s.mass, s.inverse_mass, s.q, s.mask, s.x, self.held)
        if self.mode == "cluster":
            hide = None if self.expanded or self.sparse else self.exclusions.partners
            if not (self.expanded and self.in_order()):
                self.list.build(k, s, self.ns, self.cell, self.periodic, hide, self.slot_of, self.parallel)
                if self.expanded:
                    self.mark(*self.list.expand(k, s, self.reach), self.list.shifts)
            for molecules, rows in self.rows.items():
                self.list.fill(rows, k, s, self.ns, self.slot_of, self.exclusions.left_out, self.exclusions.rules_within(molecules),
                               self.parallel)
            weighted, kinds = self.exclusions.weighted, self.exclusions.weighted_kinds
            self.special = [np.empty(len(weighted), np.int32) for _ in range(3)]
            if len(weighted) and not self.expanded:
                k.special_pairs(weighted, kinds, self.slot_of, s.x, self.close_shifts, self.close_periodic, *self.special)
                left = k.drop_excluded(s.row, *self.special, len(weighted), *self.exclusions.rule_arrays)
                self.special = [a[:left] for a in self.special]
        elif self.mode == "plain":
            bins = BinCell(self.vectors, self.origin, self.inverse, self.periodic, shares)
            self.mark(*self.list.build(k, s, self.ns, bins, self.vectors, self.periodic), self.list.shifts)
            self.in_order()
        self.moved[:], self.listed = 0.0, None
        new = self.state._replace(slot=self.slot_of, image=self.system.image, box=live_box.live(self))
        self.state = new if any(a is not b for a, b in zip(new, self.state)) else self.state      # the same one is packed in memory
        for t in self.terms:
            t.rebuild(self)
        self.thread_arguments = None
        self.builds += 1
        self.timings["Neigh"] += time.perf_counter() - began

    def in_order(self) -> bool:
        """Whether the loop has made the plain list, with the pairs in an order that pair styles need on one thread."""
        order = getattr(getattr(self, "loop", None), "pair_order", None)
        return order is not None and self.threads == 1 and order.arrange(self.loop)

    def mark(self, i, j, code, shifts) -> None:
        """Keep a plain list, special pairs and exclusions marked."""
        s = self.state
        self.plain = self.exclusions.mark(self.k, s.x, s.row, i, j, code, shifts, self.cell, self.periodic)
        self.plain_shifts = shifts

    @property
    def pairs(self) -> int:
        """Pairs in the list, as LAMMPS counts them: within reach when it was built, without special pairs of no weight."""
        if self.mode == "cluster" and not self.pair_terms and not self.packed:
            return len(all_pairs(self)[0])
        if self.mode == "cluster" and not self.expanded:
            i, j, code = self.special
            d = self.held[:, i] - self.held[:, j] - self.close_shifts[code >> 2].T
            others = (sum(rows.entries for rows in self.rows.values()) if self.sparse else
                      self.list.count(self.k, self.state, self.held, self.exclusions.left_out))
            return others + int(((d * d).sum(axis=0) <= self.reach**2).sum())
        return len(self.plain[0]) if self.mode != "none" else 0

    def arguments(self) -> list[tuple]:
        """Arguments of all terms, for each thread."""
        if self.thread_arguments is None:
            self.thread_arguments = [tuple(t.arguments(self, i) for t in self.terms) for i in range(self.threads)]
        return self.thread_arguments

    # ---- forces -------------------------------------------------------------------------------------------------------------------------
    def forces(self, energy: bool = True) -> None:
        """Forces of the present slots into ``state.f``; energies and virials into `acc`."""
        self.state.virial[:] = 0.0
        if energy:
            self.acc[:] = 0.0
        if self.settings.outdated:
            self.farthest[:] = self.k.displacements(self.state.x, self.held, self.ns, self.moved)
        spent = np.zeros(len(self.terms))
        look(self)
        calls = self._bound[energy].calls([t.kernel(energy, False) for t in self.terms], self.arguments())

        def work(tid):
            self.k.clear(self.buffers[tid], self.ns)
            for n, call in enumerate(calls[tid]):
                began = time.perf_counter()
                call()
                if tid == 0:
                    spent[n] += time.perf_counter() - began
        self.parallel(work)
        if self.threads > 1:
            self.k.add_buffers(self.buffers, self.ns)
        for t, seconds in zip(self.terms, spent):
            self.timings[{"pair": "Pair", "kspace": "Kspace"}.get(t.category, "Bond")] += seconds
        self.check()

    def check(self) -> None:
        """Raise for the first item outside its style's domain."""
        for tid, n in np.argwhere(self.bad[:, :, 0]).tolist():
            item, value = int(self.bad[tid, n, 1]), float(self.bad[tid, n, 2])
            self.bad[:] = 0.0
            raise self.terms[n].describe(self, item, value)

    def collect(self, late: bool = False) -> Result:
        """The result of the last evaluation with energies; `late` as for `store`."""
        acc, energy, virial_of = self.acc.sum(axis=0), dict.fromkeys(ENERGIES, 0.0), {}
        for t in self.terms:
            a = acc[t.index]
            if t.category == "pair":
                energy["evdwl"] += float(a[0])
                energy["ecoul"] += float(a[1])
            elif t.category == "kspace":
                energy["elong"] += float(a[0])
            else:
                energy[BONDED_KEY[t.category]] += float(a[0] + a[1])
            virial_of[t.category] = virial_of.get(t.category, 0.0) + a[2:8]
        if self.state.virial.any():
            virial_of["fix"] = self.state.virial.sum(axis=0)
        virial = sum(virial_of.values(), np.zeros(6))
        self.store(late)        # the box too, which the tail depends on
        if self.interactions.tail:
            energy["etail"], p = self.interactions.tail_correction(self.system, self.units)
            p *= abs(np.linalg.det(self.vectors)) / self.units.nktv2p
            virial_of["tail"] = np.array([p, p, p, 0.0, 0.0, 0.0])
        if not np.isfinite(acc).all() or not (math.isfinite(self.state.f[:, :self.ns].sum()) or np.isfinite(self.system.f).all()):
            raise faults.not_finite(self)
        self.result = Result(energy, virial, virial_of, self.system)
        return self.result

    def store(self, late: bool = False) -> None:
        """Slots back into the system: positions, velocities, forces; if `late`, each of them when somebody reads it."""
        s, y = self.state, self.system
        if self.box_moves:
            live_box.take(self)
        y.late = Late(lambda name, out: of_slots(self.slot_of, getattr(self.state, name), out), "xvf") if late else None
        if not late:
            self.k.store(s.x, s.v, s.f, s.row, self.ns, y.x, y.v, y.f)
        store_torques(s, self.ns, y)
        self.bonds.carry_back()

    def per_atom(self, result: Result, needs=("energies", "virials")) -> Result:
        """Add each atom's share of energy and virial to `result`, those of them that `needs` names; runs kernels for what is not there."""
        return atom_shares.add(self, result, "energies" in needs, "virials" in needs)

    def move(self, x: np.ndarray) -> None:
        """Forces at other positions of the same atoms in the same cell; keeps the list while nobody has moved by half the skin.

        Parameters
        ----------
        x : (n, 3) array
            Positions, wrapped or not.
        """
        e = self.system
        fresh = self.state is None or self._offset is None
        if not fresh:
            self.k.load(x, e.v, self._offset, self.state.x, self.state.v, self.state.row, self.ns, True)
            fresh = not self.k.moved(self.state.x, self.held, self.ns) <= (0.5 * self.settings.skin) ** 2
        if fresh:
            e.x[:], e.image[:] = x, 0
            self.load()
            self._offset = e.image @ self.vectors
        self.forces(True)

    def compute(self, virial: bool = True, energies: bool = False, virials: bool = False) -> Result:
        """Energy, forces and virial at the system's positions; per-atom shares when asked for."""
        self.load()
        self.forces(True)
        return self.per_atom(self.collect(), ["energies"] * energies + ["virials"] * virials)
