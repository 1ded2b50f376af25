r"""Monte Carlo moves that exchange bonds between two chains, so that long chains relax faster than by dynamics alone.

Every N steps a fraction of the atoms is looked at, in random order. Atom A1 and a neighbour B1 of the same molecule number, bonded to A2
and B2 that have the same molecule number too, may exchange their partners: bonds A1-A2 and B1-B2 become A1-B2 and B1-A2, if these four
distances are below the cutoff and all four atoms belong to the group. The first such four are tried, accepted with probability

$$\min\left(1, e^{-\Delta E / k_B T}\right)$$

with the change of the energy of pairs, bonds and angles and the present temperature. Molecule numbers that count from the ends of the
chains keep their lengths. Random numbers, the order of the atoms and neighbours, and the energies of pairs beyond their cutoff (they go on)
are LAMMPS's on one processor, so the swaps are the same.

Source: S. W. Sides, G. S. Grest, M. J. Stevens, S. J. Plimpton, J. Polym. Sci. B 42, 199 (2004). Units: distance. Output: a vector, swaps
accepted and tried in this run.
"""
from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

from asemd import population
from asemd.compute._items import evaluate_all
from asemd.compute._pairs import Half, interactions, type_cutoffs
from asemd.compute.pressure import find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix.atom_order import ListOrder
from asemd.fix.measured import take_temperature
from asemd.marsaglia import Marsaglia
from asemd.words import exactly, number, whole


class BondSwap(Fix):
    """Exchange bonds.

    Parameters
    ----------
    group : str
        The atoms whose bonds may be exchanged.
    every : int
        Steps between two looks.
    fraction : float
        Of the atoms of the group that are looked at.
    cutoff : float
        Old and new bonds are shorter than this, distance units.
    seed : int
        Positive, at most 900,000,000.

    Raises
    ------
    InputError
        Numbers that make no sense.
    """

    style = "bond/swap"
    brings = ("temp",)
    size = 2
    extensive = False

    def __init__(self, group: str = "all", every: int = 1, fraction: float = 0.5, cutoff: float = 1.3, seed: int = 12345):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix bond/swap: Nevery must be at least 1, got {every}")
        if not 1 <= seed <= 900_000_000:
            raise InputError(f"fix bond/swap: the seed must be from 1 to 900000000, got {seed}")
        if not 0.0 <= fraction <= 1.0 or cutoff < 0.0:
            raise InputError(f"fix bond/swap: fraction must be from 0 to 1 and the cutoff not negative, got {fraction:g} and {cutoff:g}")
        self.interval, self.fraction, self.cutoff, self.seed = every, fraction, cutoff, seed
        self.random, self.temp, self.storage, self.newton_bond = Marsaglia(seed), Temp("all"), ListOrder(), True
        self.accepted = self.tried = 0

    @classmethod
    def from_lammps(cls, group, words, session):
        every, fraction, cutoff, seed = exactly(words, 4, "fix bond/swap (Nevery fraction cutoff seed)")
        fix = cls(group, whole(every, "fix bond/swap Nevery"), number(fraction, "fix bond/swap fraction"),
                  number(cutoff, "fix bond/swap cutoff"), whole(seed, "fix bond/swap seed"))
        scene = session.scene
        if not scene.need_system("fix bond/swap").molecular:
            raise InputError("fix bond/swap: Cannot use fix bond/swap with non-molecular systems: use an atom_style with bonds")
        pairs, fix.newton_bond = scene.newton
        fix.storage = ListOrder(*scene.sort, scene.list_style != "nsq", pairs, scene.order)
        return fix

    def to_lammps(self) -> list[str]:
        return [str(self.interval), repr(self.fraction), repr(self.cutoff), str(self.seed)]

    def modify_option(self, keyword, value, session):
        if keyword == "temp":
            take_temperature(self, find_temperature(value, session, "fix_modify temp"), session)
            return True
        return super().modify_option(keyword, value, session)

    def prepare(self, loop) -> None:
        inter = loop.interactions
        if not inter.uses["pair"] or not inter.uses["bond"]:
            raise InputError("fix bond/swap requires pair and bond styles")
        if inter.uses["dihedral"] or inter.uses["improper"]:
            raise InputError("fix bond/swap cannot use dihedral or improper styles: their energies do not count in a swap")
        if tuple(inter.special_lj) != (0.0, 1.0, 1.0):
            raise InputError("fix bond/swap requires special_bonds = 0,1,1: say special_bonds lj/coul 0 1 1")
        if not inter.uses["angle"] and len(loop.system.topology.angles):
            loop.warn("fix bond/swap will not preserve correct angle topology because no angle_style is defined")
        self.accepted = self.tried = 0

    def setup(self, loop) -> None:
        if loop.engine.mode == "none":
            raise InputError("fix bond/swap requires pair and bond styles: its partners are those of the neighbour list")
        self.storage.begin(loop)

    def resize(self, loop) -> None:
        if len(self.storage.place) != loop.system.n:
            self.storage.listed(loop)

    def post_neighbor(self, loop) -> None:
        self.storage.listed(loop)

    def next_step(self, step: int) -> int:
        return (step // self.interval + 1) * self.interval

    def post_integrate(self, loop) -> None:
        """On its steps: look for four atoms, and try them."""
        if loop.step % self.interval:
            return
        loop.sync_out()
        temperature = self.temp.scalar(loop.snapshot())
        four = self._find(loop)
        if four is None:
            return
        self.tried += 1
        delta, change = self._difference(loop, *four)
        if not delta < 0.0:
            chance = math.exp(-delta / (loop.units.boltz * temperature)) if temperature > 0.0 and delta == delta else 0.0
            if not self.random.uniform() < chance:
                return
        self.accepted += 1
        loop.system.topology = loop.system.topology.replaced(change, True)
        population.retie(loop)
        self.next_reneighbor = loop.step

    def _find(self, loop):
        """Rows of the bonds A1-A2 and B1-B2, and of their atoms: (bond, bond, A1, A2, B1, B2), the first that may be swapped."""
        system, mask, place = loop.system, loop.groups[self.group], self.storage.place
        order = np.argsort(place)
        shuffled = order[mask[order]].tolist()
        n = len(shuffled)
        self._shuffle(shuffled)
        cut = type_cutoffs(SimpleNamespace(system=system, engine=loop.engine))
        first, neighbours = self.storage.pairs(loop, np.where(cut > 0.0, cut + loop.settings.skin, 0.0))
        molecule, box, x = system.molecule, system.box, system.x
        top = system.topology
        bonds: dict[int, list[tuple[int, int]]] = {}
        for k in np.flatnonzero(top.bond_types > 0).tolist():
            a, b = map(int, top.bonds[k])
            bonds.setdefault(a, []).append((k, b))
            if not self.newton_bond:
                bonds.setdefault(b, []).append((k, a))

        def near(a: int, b: int) -> bool:
            d = box.minimum_image((x[a] - x[b])[None])[0][0]
            return float(d @ d) < self.cutoff**2
        for a in shuffled[:int(self.fraction * n)]:
            around = neighbours[first[a]:first[a + 1]].tolist()
            self._shuffle(around)
            for b in around:
                if b < 0 or not mask[b] or molecule[a] != molecule[b]:
                    continue
                for bond_a, next_a in bonds.get(a, ()):
                    for bond_b, next_b in bonds.get(b, ()):
                        if molecule[next_a] != molecule[next_b] or next_a in (next_b, b) or not (mask[next_a] and mask[next_b]):
                            continue
                        if near(a, next_a) and near(b, next_b) and near(a, next_b) and near(b, next_a):
                            return bond_a, bond_b, a, next_a, b, next_b
        return None

    def _shuffle(self, rows: list[int]) -> None:
        n = len(rows)
        for i in range(n - 1):
            j = i + int(self.random.uniform() * (n - i))
            rows[i], rows[j] = rows[j], rows[i]

    def _difference(self, loop, bond_a, bond_b, a, next_a, b, next_b):
        """The change of the energy by a swap, and the items of the topology after it."""
        system, inter, units = loop.system, loop.interactions, loop.units
        top, x = system.topology, system.x
        parts = {"bond": (top.bonds.copy(), top.bond_types)}
        for k, old, partner, new in ((bond_a, a, next_a, next_b), (bond_b, b, next_b, next_a)):
            parts["bond"][0][k] = np.where(top.bonds[k] == partner, new, old)
        changed = {"bond": [bond_a, bond_b]}
        if inter.uses["angle"]:
            angles = top.angles.copy()
            changed["angle"] = []
            for end, other, new in ((a, next_a, next_b), (next_a, a, b), (b, next_b, next_a), (next_b, b, a)):
                k = np.flatnonzero((top.angles[:, 1] == end) & ((top.angles[:, [0, 2]] == other).any(axis=1)))[:1]
                angles[k] = np.where(top.angles[k] == other, new, top.angles[k])
                changed["angle"] += k.tolist()
            parts["angle"] = angles, top.angle_types
        i, j = np.array([(a, next_a), (b, next_b), (a, next_b), (next_a, b)]).T
        d = system.box.minimum_image(x[i] - x[j])[0]
        state = SimpleNamespace(system=system, engine=loop.engine)
        pairs = Half(i, j, d, (d * d).sum(axis=1), np.zeros(4, np.int32))
        energy = interactions(state, pairs, beyond=True)[0]
        delta = float(energy[0] + energy[1] - energy[2] - energy[3])
        for kind, rows in changed.items():
            for sign, atoms in ((1.0, parts[kind][0]), (-1.0, getattr(top, kind + "s"))):
                delta += sign * float(evaluate_all(system, inter, kind, atoms[rows], parts[kind][1][rows], units)[0].sum())
        return delta, parts

    def vector(self, i: int) -> float:
        """1: swaps accepted in this run; 2: swaps tried."""
        if i not in (1, 2):
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 2 components, not {i}")
        return float((self.accepted, self.tried)[i - 1])
