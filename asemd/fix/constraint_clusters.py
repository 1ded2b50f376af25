"""Clusters of atoms that fixes hold at fixed distances: a central atom with one, two or three others, or three atoms with their angle."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asemd.errors import InputError

ANGLE, PAIR, TWO, THREE, RIGID = 1, 2, 3, 4, 5      # kinds: three atoms with their angle; 1, 2, 3 bonds; as ANGLE, solved in one go
SIZE = np.array([0, 3, 2, 3, 4, 3])                 # atoms of each kind
HELD = np.array([0, 3, 1, 2, 3, 3])                 # distances of each kind
ENDS = {ANGLE: ((0, 1), (0, 2), (1, 2)), PAIR: ((0, 1),), TWO: ((0, 1), (0, 2)), THREE: ((0, 1), (0, 2), (0, 3)),
        RIGID: ((0, 1), (0, 2), (1, 2))}
SAME_MASS = 0.1     # masses that differ by less are the same


@dataclass
class Clusters:
    """What is held.

    Parameters
    ----------
    atoms : (m, 4) int
        Rows (or ids), the central atom first, -1 where there is none.
    kind : (m,) int
    types : (m, 3) int
        Bond types, of an angle its type in the last place; 0 where there is none.
    """

    atoms: np.ndarray
    kind: np.ndarray
    types: np.ndarray

    def count(self, kind: int) -> int:
        return int(np.count_nonzero(self.kind == kind))

    def pairs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """All distances: cluster (k,), which of its distances (k,), atoms (k, 2)."""
        of, which, ends = [], [], []
        for kind, pairs in ENDS.items():
            mine = np.flatnonzero(self.kind == kind)
            for n, (i, j) in enumerate(pairs):
                of.append(mine)
                which.append(np.full(len(mine), n))
                ends.append(self.atoms[mine][:, [i, j]])
        return np.concatenate(of), np.concatenate(which), np.concatenate(ends)


@dataclass
class Chosen:
    """Which bonds and angles are held: types of bonds, of angles, of atoms, and masses."""

    bonds: tuple[int, ...] = ()
    angles: tuple[int, ...] = ()
    atoms: tuple[int, ...] = ()
    masses: tuple[float, ...] = ()


def find(system, mask: np.ndarray, chosen: Chosen, what: str) -> Clusters:
    """The clusters of a system among the atoms of `mask` (n,) bool; bonds and angles that are turned off do not count.

    Raises
    ------
    InputError
        Bonds that form no such clusters: one atom with more than three of them, or a chain; the ids of atoms are named.
    """
    topology, n = system.topology, system.n
    bonds, bond_types = topology.items("bond")
    held = mask[bonds].all(axis=1) & (bond_types > 0) if len(bonds) else np.zeros(0, bool)
    wanted = np.isin(bond_types, chosen.bonds) | np.isin(system.type[bonds], chosen.atoms).any(axis=1)
    if chosen.masses and len(bonds):
        masses = system.atom_masses()[bonds]
        wanted |= (np.abs(masses[:, :, None] - np.array(chosen.masses)) <= SAME_MASS).any(axis=(1, 2))
    bonds, bond_types = bonds[held & wanted], bond_types[held & wanted]
    count = np.bincount(bonds.ravel(), minlength=n)
    if len(bonds) and count.max() > 3:
        raise InputError(f"{what}: atom {system.id[np.argmax(count)]} has {count.max()} bonds that are to be held; a cluster has at most "
                         "4 atoms, a central one and three others")
    linked = np.flatnonzero((count[bonds] > 1).all(axis=1))
    if len(linked):
        i, j = system.id[bonds[linked[0]]]
        raise InputError(f"{what}: clusters are connected: atoms {i} and {j}, which are bonded, both have other bonds that are to be held; "
                         "only a central atom may have several")
    first = (count[bonds[:, 0]] > 1) | ((count[bonds[:, 1]] == 1) & (system.id[bonds[:, 0]] < system.id[bonds[:, 1]]))
    centre, other = np.where(first, bonds.T, bonds.T[::-1])
    order = np.lexsort((system.id[other], centre))
    centre, other, bond_types = centre[order], other[order], bond_types[order]
    centres, start, size = np.unique(centre, return_index=True, return_counts=True)
    atoms, types = np.full((len(centres), 4), -1), np.zeros((len(centres), 3), int)
    atoms[:, 0] = centres
    for k in range(3):
        there = size > k
        atoms[there, k + 1], types[there, k] = other[start[there] + k], bond_types[start[there] + k]
    kind = size + 1
    angles, angle_types = topology.items("angle")
    known = np.isin(angle_types, chosen.angles) & (angle_types > 0)
    if known.any():
        cluster_of = np.full(n, -1)
        cluster_of[centres[size == 2]] = np.flatnonzero(size == 2)
        for a, t in zip(angles[known], angle_types[known]):
            c = cluster_of[a[1]]
            if c >= 0 and {int(a[0]), int(a[2])} == {int(atoms[c, 1]), int(atoms[c, 2])}:
                kind[c], types[c, 2] = ANGLE, t
    return Clusters(atoms, kind, types)


def by_id(clusters: Clusters, system) -> Clusters:
    """The same with ids for rows."""
    return Clusters(np.where(clusters.atoms >= 0, system.id[clusters.atoms], -1), clusters.kind, clusters.types)


def of_template(molecule, ids: np.ndarray) -> Clusters:
    """The clusters that the file of a molecule says, of copies whose atoms have the ids (copies, n)."""
    shake, atoms, kinds, types = molecule.shake, [], [], []
    for k, flag in enumerate(shake["flag"]):
        if flag and shake["atoms"][k][0] == k:      # the central atom
            atoms.append([*shake["atoms"][k], *[-1] * (4 - len(shake["atoms"][k]))])
            kinds.append(flag)
            types.append([*shake["types"][k], *[0] * (3 - len(shake["types"][k]))])
    at = np.array(atoms, int).reshape(-1, 4)
    found = np.where(at >= 0, ids[:, at], -1).reshape(-1, 4)
    return Clusters(found, np.tile(np.array(kinds, int), len(ids)), np.tile(np.array(types, int).reshape(-1, 3), (len(ids), 1)))


def switch(system, clusters: Clusters, on: bool) -> None:
    """Turn the bonds and angles of clusters (of rows) off, or on again, in a topology of the system's own."""
    topology, n = system.topology, max(system.n, 1)
    of, which, ends = clusters.pairs()
    angled = np.isin(clusters.kind, (ANGLE, RIGID))
    for name, held, atoms, types in (
            ("bond_types", ends[~(angled[of] & (which == 2))], topology.bonds, topology.bond_types),
            ("angle_types", clusters.atoms[angled][:, 1:3], topology.angles[:, [0, 2]], topology.angle_types)):
        found = np.isin(_keys(atoms, n), _keys(held, n))
        new = types.copy()
        new[found] = np.abs(types[found]) * (1 if on else -1)
        if not np.array_equal(new, types):
            if system.topology is topology:
                system.topology = topology.copy()
            setattr(system.topology, name, new)


def _keys(pairs: np.ndarray, n: int) -> np.ndarray:
    """One number for each pair of rows, whatever their order."""
    p = np.sort(np.asarray(pairs, np.int64).reshape(-1, 2), axis=1)
    return p[:, 0] * n + p[:, 1]


def lengths(clusters: Clusters, interactions, what: str) -> np.ndarray:
    """(m, 3) the distances that are held: rest lengths of the bonds, and from them and the rest angle that of the ends of an angle.

    Raises
    ------
    InputError
        A style without a rest length or angle; angles of one type with bonds of different types.
    """
    out = np.zeros((len(clusters.kind), 3))
    rest = {t: _rest(interactions, "bond", int(t), what) for t in np.unique(_bond_types(clusters))}
    angled = np.isin(clusters.kind, (ANGLE, RIGID))
    for k in range(3):
        there = (HELD[clusters.kind] > k) & ~(angled & (k == 2))
        out[there, k] = [rest[t] for t in clusters.types[there, k]]
    for t in np.unique(clusters.types[angled, 2]):
        mine = np.flatnonzero(angled & (clusters.types[:, 2] == t))
        bonds = np.unique(np.sort(clusters.types[mine, :2], axis=1), axis=0)
        if len(bonds) > 1:
            raise InputError(f"{what}: angles of type {t} have bonds of different types: {bonds[0][0]} {bonds[0][1]} and {bonds[1][0]} "
                             f"{bonds[1][1]}; use an angle type of its own for each")
        a, b = (rest[x] for x in clusters.types[mine[0], :2])
        out[mine, 2] = math.sqrt(a * a + b * b - 2.0 * a * b * math.cos(math.radians(_rest(interactions, "angle", int(t), what))))
    return out


def _bond_types(c: Clusters) -> np.ndarray:
    angled = np.isin(c.kind, (ANGLE, RIGID))
    used = np.concatenate([c.types[angled, :2].ravel(), c.types[~angled].ravel()])
    return used[used > 0]


def _rest(interactions, kind: str, type_: int, what: str) -> float:
    for use in interactions.uses[kind]:
        if type_ in use.coeff:
            value = use.style.rest_value(use.coeff[type_])
            if not math.isfinite(value):
                raise InputError(f"{what}: {kind}_style {use.style.name} has no rest {'length' if kind == 'bond' else 'angle'}, which type "
                                 f"{type_} needs to be held")
            return value
    raise InputError(f"{what}: {kind} type {type_}, which is to be held, has no coefficients: a {kind}_style must be defined"
                     if not interactions.uses[kind] else f"{what}: {kind} type {type_}, which is to be held, has no coefficients")
