"""Atoms that Monte Carlo moves act on: copies in the order in which LAMMPS stores its atoms, so that the same random numbers choose them.

Moves change the copies only; `TrialAtoms.carry_over` brings what is left of them into the system at once.
"""
from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from weakref import WeakKeyDictionary

import numpy as np

from asemd import population
from asemd.errors import InputError
from asemd.fix.atom_order import AtomOrder
from asemd.kernels import trial
from asemd.kernels.rows import of_rows, of_slots
from asemd.own_term import OwnTerm

NOBODY = -1
_known: WeakKeyDictionary = WeakKeyDictionary()      # loop -> energies that were asked for
_arrays: WeakKeyDictionary = WeakKeyDictionary()     # loop -> copies by name; fresh memory would cost as much as filling it


class Energies:
    """Pair energies of atoms at trial positions.

    Parameters
    ----------
    loop : asemd.loop.Loop
    exact : bool
        All images count, and types that ``neigh_modify exclude`` separates do not interact. Otherwise, as LAMMPS has it without
        full_energy, only images that its list would know: those within cutoff and skin of the box.
    overlap : float
        Positions nearer to an atom are refused.
    pairs : bool
        Whether pairs have energies, or positions that are too near are all that is looked for.
    """

    def __init__(self, loop, exact: bool, overlap: float, what: str, pairs: bool = True):
        system, engine, units = loop.system, loop.engine, loop.units
        n = system.counts["ntypes"]
        terms = engine.pair_terms if exact else [t for t in loop.interactions.pair_terms(n, units) if t.style.parts]
        terms = terms if pairs else []
        if any(np.ndim(t.use.factor) > 0 for t in terms):
            raise InputError(f"{what}: a pair style whose factor differs from atom to atom has no energy")
        self.own_terms = [t for t in engine.terms if isinstance(t, OwnTerm)] if exact and pairs else []
        self.module = trial.kernel(tuple(t.style for t in terms))
        one = np.ones(5)
        self.tables = tuple((t.tables.rows, t.tables.constants, t.tables.arrays, np.array([w[0] for w in t.weights(one, one)]))
                            for t in terms)
        self.cut2 = np.zeros((n + 1, n + 1))
        for t in terms:
            for k in t.cut_rows:
                np.maximum(self.cut2, t.tables.rows[k], out=self.cut2)
        self.cutoff, self.overlap, self.exact = max(float(self.cut2.max()) ** 0.5, overlap), overlap, exact
        self.ghosts = float(self.cut2.max()) ** 0.5 + loop.settings.skin
        self.numbers = np.array([-1.0, -1.0, overlap**2, engine.qqr2e, float(not exact)])
        self.seen = b""

    @classmethod
    def of_loop(cls, loop, exact: bool, overlap: float, what: str, pairs: bool = True) -> Energies:
        """Those of a loop, made anew only where its coefficients are others."""
        known, terms, key = _known.setdefault(loop, {}), loop.engine.pair_terms, (exact, overlap, pairs)
        if known.get(key, (None, None))[0] is not terms:
            known[key] = terms, cls(loop, exact, overlap, what, pairs)
        return known[key][1]

    def see(self, box) -> None:
        """Take the present box."""
        now = box.cell.tobytes() + box.origin.tobytes() + bytes(box.periodic)
        if now == self.seen:
            return
        self.seen = now
        self.cell, self.inverse = np.ascontiguousarray(box.cell, float), np.ascontiguousarray(box.inverse)
        self.volume, self.edges, self.tilted = box.volume, np.diag(box.cell).copy(), box.triclinic or not box.is_lammps_frame
        self.aligned, self.closed = box.aligned, not box.periodic.all()
        heights = 1.0 / np.linalg.norm(self.inverse, axis=0)
        periodic = np.array(box.periodic)
        self.reach = np.where(periodic, self.cutoff / heights, -1.0)
        corner = box.origin @ self.inverse
        self.low, self.high = corner - self.ghosts / heights, corner + 1.0 + self.ghosts / heights
        self.narrow = bool((heights[periodic] < self.cutoff).any())     # an atom sees its own images

    def of(self, atoms: TrialAtoms, at, types, charges, skip: int = -1, molecule: int = NOBODY) -> float:
        """Energy of atoms at `at` (m, 3) with the others: without atom `skip`, without `molecule`."""
        self.numbers[0], self.numbers[1] = skip, molecule
        return self.module.trial_energy(at, types, charges, atoms.n, self.numbers, atoms.x, atoms.type, atoms.q, atoms.molecule, *self.box)

    @property
    def box(self) -> tuple:
        """What compiled code needs of the box and of the pair styles."""
        return self.inverse, self.cell, self.reach, self.low, self.high, self.cut2, self.tables


class TrialAtoms:
    """Copies of all atoms of a loop.

    Parameters
    ----------
    loop : asemd.loop.Loop
    storage : AtomOrder
    group : str
        Whose atoms are the gas.
    wrap : callable
        Brings positions and images (n, 3) into the box, in place.

    Attributes
    ----------
    n : int
        How many there are now; the arrays are longer.
    row : (cap,) int
        Row in the system, -1 for those that are not in it yet.
    """

    def __init__(self, loop, storage: AtomOrder, group: str, wrap: Callable[[np.ndarray, np.ndarray], None]):
        self.loop, self.storage, self.wrap = loop, storage, wrap
        system, rows = loop.system, storage.rows(loop.system)
        n = self.n = len(rows)
        kept = _arrays.setdefault(loop, {})
        cap = max([n + 64, *map(len, kept.values())])
        s = SimpleNamespace(x=loop.state.x, image=system.image, type=np.asarray(system.type, np.int64), v=loop.state.v, id=system.id,
                            q=np.zeros(n) if system.q is None else system.q, molecule=np.asarray(system.molecule, np.int64),
                            mass=system.atom_masses(), gas=loop.groups[group], row=np.arange(n))
        slots = loop.engine.slot_of[rows]
        for name, values in vars(s).items():
            array, wide = kept.get(name), (3,) * (values.ndim - 1)
            if array is None or len(array) < cap or array.dtype != values.dtype:
                array = kept[name] = np.zeros((cap, *wide), values.dtype, order="F")      # each column in one piece, for vectors
            if name in ("x", "v"):
                of_slots(slots, values, array)
            else:
                values.take(rows, out=array[:n], mode="clip") if values.ndim == 1 else of_rows(values, rows, array.T)
            setattr(self, name, array)
        self.moved = np.zeros(len(self.x), bool)
        self.names = (*vars(s), "moved")
        self.wrap(self.x[:n], self.image[:n])
        self.removed = False

    def delete(self, i: int) -> None:
        """The last one takes the place of atom i."""
        self.n -= 1
        self.removed |= bool(self.row[i] >= 0)
        for name in self.names:
            array = getattr(self, name)
            array[i] = array[self.n]

    def add(self, **values) -> int:
        """One more atom, the last one."""
        self.room(1)
        i, self.n = self.n, self.n + 1
        for name, value in ({"image": 0, "row": -1, "gas": True, "moved": False, "molecule": 0, "q": 0.0} | values).items():
            getattr(self, name)[i] = value
        return i

    def room(self, more: int) -> None:
        """Make the arrays so long that some more atoms fit."""
        if self.n + more > len(self.x):
            for name in self.names:
                array = getattr(self, name)
                longer = np.zeros((max(self.n + more, 2 * len(array)), *array.shape[1:]), array.dtype, order="F")
                longer[:len(array)] = array
                setattr(self, name, longer)

    def members(self, molecule: int) -> np.ndarray:
        """The atoms of a molecule."""
        return np.flatnonzero(self.molecule[:self.n] == molecule)

    def place(self, i, x, image) -> None:
        """Atoms are elsewhere, maybe outside the box: they are wrapped."""
        x, image = np.array(x, float), np.array(image)
        self.wrap(x, image)
        self.x[i], self.image[i], self.moved[i] = x, image, True

    def centres(self, mass: float) -> np.ndarray:
        """(largest molecule number + 1, 3) sums of mass times unwrapped position, divided by `mass`, in the box."""
        n, box = self.n, self.loop.system.box
        out = np.zeros((int(self.molecule[:n].max(initial=0)) + 1, 3))
        np.add.at(out, self.molecule[:n], self.mass[:n, None] * (self.x[:n] + self.image[:n] @ box.cell))
        out /= mass
        box.wrap(out, np.zeros(out.shape, np.int32))
        return out

    def carry_over(self, make, members) -> None:
        """The system becomes what the copies are.

        Parameters
        ----------
        make : callable
            Indices of new atoms -> a `asemd.system.System` of them, in some order, with their ids.
        members : callable
            That system -> the groups that they join, see `asemd.population.insert`.
        """
        loop, system, n = self.loop, self.loop.system, self.n
        self.storage.ids = self.id[:n].copy()
        old, moved = self.row[:n] >= 0, np.flatnonzero(self.moved[:n] & (self.row[:n] >= 0))
        if len(moved):
            rows = self.row[moved]
            slots = loop.engine.slot_of[rows]       # it is no motion that a list would have to follow
            loop.state.x[:, slots] = loop.engine.held[:, slots] = self.x[moved].T
            system.image[rows] = self.image[moved]
        new, gone = np.flatnonzero(~old), ()
        if self.removed:
            left = np.zeros(system.n, bool)
            left[self.row[:n][old]] = True
            gone = np.flatnonzero(~left)
        if len(new):
            atoms = make(new)
            population.exchange(loop, gone, atoms, members(atoms))
        elif len(gone):
            population.remove(loop, gone, lost=False, listed=False)
