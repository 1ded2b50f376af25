r"""Break bonds that are too long.

Every Nevery steps the bonds of one type longer than Rmax may break. Each atom names the longest of its own; a bond breaks if both of its
atoms name it. Angles, dihedrals and impropers that hold a broken bond go with it, and the weights of pairs follow the bonds that are left.

Source: LAMMPS manual, fix bond/break. Units: distance. Output: a vector, bonds broken at the last look and so far.
"""
from __future__ import annotations

import itertools

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix.atom_order import AtomOrder
from asemd.fix.bond_change import BondChange, mutual
from asemd.topology import KINDS
from asemd.words import bounds, number, take, whole


class BondBreak(BondChange):
    """Break bonds longer than `distance`; parameters as `BondChange`."""

    style = "bond/break"

    @classmethod
    def from_lammps(cls, group, words, session):
        every, kind, distance = take(words, 3, "fix bond/break Nevery bondtype Rmax")
        options, rest = {}, words[3:]
        while rest:
            if rest[0] != "prob":
                raise InputError(f"fix bond/break: unknown keyword {rest[0]!r}{nearest(rest[0], ('prob',))}")
            options, rest = cls.read_probability(rest[1:3]), rest[3:]
        system = session.scene.system
        kind = bounds(kind, 1, system.counts["nbondtypes"], "fix bond/break bond type", system.labels["bond"])[0]
        fix = cls(group, whole(every, "fix bond/break Nevery"), kind, number(distance, "fix bond/break Rmax"), **options)
        fix.storage = AtomOrder(*session.scene.sort, session.scene.order)
        return fix

    def to_lammps(self) -> list[str]:
        words = [str(self.interval), str(self.bond_type), repr(self.distance)]
        return words + (["prob", repr(self.probability), str(self.seed)] if self.probability < 1.0 else [])

    def candidates(self, loop) -> tuple[np.ndarray, np.ndarray]:
        system, mask = loop.system, loop.groups[self.group]
        bonds, types = system.topology.bonds, system.topology.bond_types
        bonds = bonds[(types == self.bond_type) & mask[bonds].all(axis=1)] if len(bonds) else bonds
        s = (system.x[bonds[:, 0]] - system.x[bonds[:, 1]]) @ system.box.inverse
        d = (s - np.where(system.box.periodic, np.rint(s), 0.0)) @ system.box.cell
        square = (d * d).sum(axis=1)
        long = square > self.distance**2
        return mutual(system.n, bonds[long], -square[long])

    def change(self, loop, pairs) -> None:
        system = loop.system
        broken = {tuple(sorted(map(int, pair))) for pair in pairs}
        parts = {}
        for kind in KINDS:
            atoms, types = system.topology.items(kind)
            if not len(atoms):
                continue
            keep = np.ones(len(atoms), bool)
            for a, b in itertools.combinations(range(atoms.shape[1]), 2):
                if kind != "improper" and b != a + 1:       # a bond of an angle or dihedral joins atoms that follow each other
                    continue
                ends = np.sort(atoms[:, [a, b]], axis=1)
                keep &= np.array([tuple(pair) not in broken for pair in ends.tolist()])
            if kind == "bond":
                keep |= types != self.bond_type
            parts[kind] = atoms[keep], types[keep]
        system.topology = system.topology.replaced(parts, True)
