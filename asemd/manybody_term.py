"""Terms of many-body pair styles: rows of all neighbours of each atom, and the kernel over them."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.hydrogen_bond import HydrogenBond
from asemd.kernels import eight_sites, manybody
from asemd.kernels.eight_sites import EIGHT, PLACES
from asemd.kernels.state import aligned
from asemd.neighbor import IMAGES
from asemd.term import FactorTerm


def all_pairs(engine) -> tuple[np.ndarray, ...]:
    """The present list as plain pairs: slots i and j, code (image * 4 + kind), shifts of the images, the image opposite to each.

    Pairs of special atoms are there unless their weights are 0.
    """
    if engine.listed is None:
        mine = engine.list
        if engine.mode == "plain" or engine.expanded:
            pairs = engine.plain
        else:
            found = mine.expand(engine.k, engine.state, engine.reach)
            pairs = engine.exclusions.mark(engine.k, engine.state.x, engine.state.row, *found, mine.shifts, engine.cell, engine.periodic)
        opposite = mine.opposite if engine.mode == "plain" else np.arange(len(IMAGES), dtype=np.int32)[::-1].copy()
        engine.listed = *pairs, mine.shifts, opposite
    return engine.listed


class ManyBodyTerm(FactorTerm):
    """A many-body pair style over rows of neighbours, see `asemd.kernels.manybody`; each thread owns a range of slots.

    Attributes
    ----------
    first, middle, last (cap,), neighbors, codes (m,)
        The rows of the present list.
    """

    category = "pair"

    def __init__(self, term):
        self.owner, self.style, self.tables = term, term.style, term.tables
        if np.ndim(term.use.factor) > 0:
            raise InputError(f"pair_style hybrid/scaled: the factor of {term.label} cannot differ from atom to atom")
        cut2 = self.tables.rows[0]
        self.uniform = bool((cut2[1:, 1:] == cut2[1, 1]).all())
        self.first = self.middle = self.last = np.zeros(0, np.int64)
        self.neighbors, self.codes = np.zeros(0, np.int32), np.zeros(0, np.uint8)
        self.width, self.eights = 0, self.style.eight is not None and bool(self.style.fits(self.tables))

    def kernel(self, energy, per_atom):
        if self.eights and not per_atom:
            made = eight_sites.kernel(self.style, energy=energy, uniform=self.uniform, width=self.width,
                                      alike=self.style.alike(self.tables))
        else:
            made = manybody.kernel(self.style, energy=energy or self.style.whole, per_atom=per_atom, uniform=self.uniform)
        return made if per_atom else self._scaled(made, energy)

    def rebuild(self, engine):
        s, capacity = engine.state, engine.state.x.shape[1]
        i, j, code, shifts, opposite = all_pairs(engine)
        cut2, skin = self.tables.rows[0], engine.settings.skin
        reach2 = np.where(cut2 > 0.0, (np.sqrt(cut2) + skin) ** 2, 0.0)
        if len(self.first) < capacity:
            self.first, self.middle, self.last = (np.zeros(capacity, np.int64) for _ in range(3))
        kind = np.uint8 if len(opposite) <= 256 else np.int32
        if self.codes.dtype != kind:
            self.neighbors, self.codes = np.zeros(0, np.int32), np.zeros(0, kind)
        while True:
            n = manybody.rows_module().fill_rows(engine.ns, i, j, code, opposite, s.x, shifts, s.type, s.row, engine.system.id, reach2,
                                                 self.first, self.middle, self.last, self.neighbors, self.codes)
            if n <= len(self.neighbors):
                break
            self.neighbors, self.codes = np.zeros(n + n // 8, np.int32), np.zeros(n + n // 8, kind)
        self.shifts, self.ns = shifts, engine.ns
        lengths = self.last[:self.ns] - self.first[:self.ns]
        self.edges = np.searchsorted(self.first[:self.ns], np.arange(engine.threads + 1) * n / engine.threads)
        self.edges[0], self.edges[-1] = 0, self.ns
        longest = int(lengths.max(initial=0)) + 1
        if longest > self.width or len(self.near) != engine.threads:
            if self.eights:       # kernels know how wide it is; an odd number, to spare the cache's sets
                self.width = next((w for w in (41, 73, 137, 265, 521, 1033, 2057, 4105, 8201, 16393) if w > longest), 0)
                if not self.width:
                    raise InputError(f"pair style {self.style.name}: an atom has {longest - 1} neighbours within cutoff plus skin, more "
                                     "than 16380: are positions and cutoff in the units of the scene?")
                engine.changed = True
            else:
                self.width = longest + longest // 4 + 7 & -8
            nth = engine.threads
            work = aligned((nth, 7 + self.style.room_for(self.tables, self.width), self.width))
            self.near, self.grad, self.room = work[:, :4], work[:, 4:7], work[:, 7:]
            self.flat = work.reshape(nth, -1)[:, 7 * self.width:]
            self.types = np.zeros((nth, self.width if not self.eights else PLACES + 3 * EIGHT * self.width), np.int32)
            self.slots = np.zeros_like(self.types)
            if self.eights:
                self.flat = aligned((nth, self.style.eight_rows * EIGHT * self.width))
        if self.style.shares and getattr(self, "shared", np.zeros((0, 0))).shape[1] != capacity:
            self.shared = aligned((self.style.shares, capacity))
        elif not self.style.shares:
            self.shared = np.zeros((0, 0))

    def extra(self) -> np.ndarray:
        """Numbers for compute pair: sums over the atoms of the last rows that all threads share."""
        return self.shared[-self.style.extra:, :self.ns].sum(axis=1)

    @property
    def entries(self) -> int:
        """Pairs in the rows, each counted once."""
        return int((self.middle[:self.ns] - self.first[:self.ns]).sum())

    def arguments(self, engine, tid, shares: bool = False):
        s = engine.state
        f, acc = (engine.buffers[tid], engine.acc[tid, self.index]) if shares else self._sums(engine, tid)
        room = self.flat[tid] if self.eights and not shares or self.style.flat_room else self.room[tid]
        arguments = (
            s.x, f, s.q, s.type, self.first, self.middle, self.last, self.neighbors, self.codes, self.shifts, int(self.edges[tid]),
            int(self.edges[tid + 1]), self.tables.rows[0], self.tables.constants, self.tables.arrays, self.near[tid], self.types[tid],
            self.slots[tid], self.grad[tid], room, self.shared, engine.qqr2e, acc, engine.atom_energy[tid],
            engine.atom_virial[tid], engine.bad[tid, self.index], engine.meeting)
        return arguments if shares else self._with_factor(engine, tid, arguments)

    def describe(self, engine, item, value):
        atom = int(engine.system.id[engine.state.row[int(item)]])
        return SimulationError(f"pair style {self.style.name}: the energy of atom {atom} with its neighbours is not finite: "
                               f"{self.style.domain or 'atoms coincide, or are outside of what the potential is for'}")


def many_term(owner):
    """The term of a pair style that is no sum over pairs."""
    from asemd.hydrogen_bond_term import HydrogenBondTerm
    return (HydrogenBondTerm if isinstance(owner.style, HydrogenBond) else ManyBodyTerm)(owner)
