"""The symmetry of a crystal as the force field sees it: atoms by their types, bonds among what has to be mapped. Found by spglib."""
from __future__ import annotations

import warnings

import numpy as np
from ase.geometry import minkowski_reduce

from asemd.atoms import Atoms
from asemd.box import Box
from asemd.errors import InputError, InputWarning, SimulationError
from asemd.interop.cells import Places, codes, folded, groups, recell
from asemd.interop.sources import frames_of, remembered
from asemd.interop.symmetric import Reduced
from asemd.text_table import Table
from asemd.topology import cells_apart

BY = ("type", "initial_charges", "masses", "radius", "groups")      # arrays in which equivalent atoms agree
DIRECTED = {"mu": "point dipoles", "shape": "ellipsoids"}
DIGITS = 9
MANY = 3000       # atoms; so many in no order take about 10 s


class Symmetry(Reduced):
    """Space group of a crystal by force-field types.

    Parameters
    ----------
    source : ase.Atoms, asemd.Scene, asemd.Lammps or asemd.Session
        Periodic in three directions. Atoms are alike that have the same type (without types: element), charge, mass and radius; an
        operation counts if it also takes every bond, angle, dihedral and improper to one of the same type.
    tolerance : float
        How far an atom may be from its place, Angstrom (``units lj``: sigma).

    Attributes
    ----------
    number, international, point_group
        Of the space group: 1 to 230, Hermann-Mauguin symbols.
    rotations, translations : (k, 3, 3) int, (k, 3)
        One operation for each rotation of the point group, in fractional coordinates, ``s @ rotation.T + translation``.
    centrings : (m, 3)
        Translations within the cell that leave the crystal as it is, the first is zero. All operations are ``k * m``; those that would turn
        the cell itself, where it is longer one way than the group has it, are not among them.
    permutations, centred : (k, n) and (m, n) int
        The atom that comes to the place of which other: atom i goes to that of ``permutations[o, i]``.
    orbits : (n,) int
        The first atom that is equivalent to each.
    wyckoffs, sites : list of str
        Wyckoff letter and site symmetry of each atom.

    Raises
    ------
    InputError
        Something else was given, a direction is not periodic, atoms have directions of their own, or spglib is not installed.
    SimulationError
        spglib finds no symmetry: atoms are in the same place.
    """

    def __init__(self, source, tolerance: float = 1e-5):
        frames, _ = frames_of(source, "Symmetry")
        atoms = remembered(frames[0])
        atoms.calc = None
        atoms.set_constraint()
        if not tolerance > 0.0:
            raise InputError(f"Symmetry: the tolerance must be positive, got {tolerance}")
        if not atoms.pbc.all() or atoms.cell.rank < 3:
            k = int(np.argmin(atoms.pbc & atoms.cell.array.any(axis=1)))
            raise InputError(f"Symmetry: space groups are of crystals, but these atoms are not periodic along {'abc'[k]}")
        for name, what in DIRECTED.items():
            if name in atoms.arrays and np.any(atoms.arrays[name]):
                raise InputError(f"Symmetry: {what} have directions of their own, of which spglib knows nothing")
        if len(atoms) > MANY:
            warnings.warn(f"Symmetry: spglib's time grows with the square of the number of atoms that are in no order, to minutes for "
                          f"{len(atoms)}", InputWarning, stacklevel=2)
        self.atoms, self.tolerance = atoms, tolerance
        self._s = (atoms.positions - np.ravel(atoms.get_celldisp())) @ np.linalg.inv(atoms.cell.array)
        self._places = Places(self._s, atoms.cell.array)
        kinds = _kinds(atoms)
        found = _spglib(atoms.cell.array, *self._with_bonds(kinds), tolerance)
        self._operations(found, kinds)
        self._names(found)
        self.orbits = self._orbits()
        self.wyckoffs, self.sites = list(found.wyckoffs[:len(atoms)]), list(found.site_symmetry_symbols[:len(atoms)])

    # ---- what spglib is asked -----------------------------------------------------------------------------------------------------------
    def _with_bonds(self, kinds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places and kinds: atoms, and points in the middle of bonded items, so that bonds count.

        An item whose middle is in the place of an atom becomes part of the atom's kind.
        """
        atoms = self.atoms
        box = Box(np.zeros(3), atoms.cell.array)
        places, names = [], []
        for kind, items, types in atoms.topology.every():
            if len(items):
                apart = cells_apart(kind, items, box, atoms.positions)
                middle = (self._s[items] + apart).mean(axis=1)
                places.append(middle)
                names += [(kind, int(t)) for t in types]
        s, here = self._s, [[(str(k),)] for k in kinds]
        if places:
            middles = np.concatenate(places)
            row = self._places.nearest(middles, self.tolerance)
            for k in np.flatnonzero(row >= 0):
                here[row[k]].append(names[k])
            rest = np.flatnonzero(row < 0)
            first, number = groups(middles[rest], atoms.cell.array, self.tolerance)      # those that share their place become one point
            s = np.concatenate([s, middles[rest[first]]])
            shared = [[] for _ in first]
            for k, g in zip(rest, number):
                shared[g].append(names[k])
            here += [sorted(of_one) for of_one in shared]
        words = [repr([names[0], *sorted(names[1:])]) for names in here]
        return s, np.unique(words, return_inverse=True)[1] + 1

    # ---- operations ---------------------------------------------------------------------------------------------------------------------
    def _operations(self, found, kinds: np.ndarray) -> None:
        """Rotations with one translation each, translations without rotation, and where they take the atoms."""
        rotations, translations = np.array(found.rotations), np.array(found.translations)
        pure = (rotations == np.eye(3, dtype=int)).all(axis=(1, 2))
        centrings = folded(translations[pure] + 1e-9) - 1e-9
        centrings = centrings[np.argsort(np.abs(centrings).sum(axis=1) > 1e-6, kind="stable")]
        centrings[0] = 0.0
        _, first = np.unique(rotations.reshape(-1, 9), axis=0, return_index=True)
        first = np.sort(first)
        self.centrings, self.centred = self._without_rotation(centrings, kinds)
        chosen = []
        for k in first:         # of the operations with this rotation one that leaves the bonds as they are
            for t in centrings:
                p = self._permutation(rotations[k], translations[k] + t, kinds)
                if p is not None:
                    chosen.append((rotations[k], translations[k] + t, p))
                    break
        self.rotations, self.translations, self.permutations = (np.array(part) for part in zip(*chosen))
        self._complete = len(self.centrings) == len(centrings) and len(chosen) == len(first)
        turned = np.linalg.inv(self.atoms.cell.array) @ self.rotations.transpose(0, 2, 1) @ self.atoms.cell.array
        u, _, v = np.linalg.svd(turned)
        self.matrices = (u @ v).transpose(0, 2, 1)      # Cartesian, orthogonal also where the crystal is a little off

    def _without_rotation(self, centrings: np.ndarray, kinds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The translations that leave the bonds as they are too, and where they take the atoms."""
        one = np.eye(3, dtype=int)
        generators = _lattice(centrings)
        steps = [(t, self._permutation(one, t, kinds)) for t in generators]
        if any(p is None for _, p in steps):
            keep = [(t, p) for t in centrings if (p := self._permutation(one, t, kinds)) is not None]
            return np.array([t for t, _ in keep]), np.array([p for _, p in keep])
        found = {int(codes(np.zeros(3))): (np.zeros(3), np.arange(len(kinds)))}     # the others are steps one after the other
        queue = list(found.values())
        for t, to in queue:
            for step, p in steps:
                code = int(codes(t + step))
                if code not in found:
                    found[code] = (folded(t + step + 1e-9) - 1e-9, p[to])
                    queue.append(found[code])
        return np.array([t for t, _ in queue]), np.array([p for _, p in queue])

    def _permutation(self, rotation, translation, kinds) -> np.ndarray | None:
        """Where the atoms come to, None if bonds do not come to bonds."""
        to = self._places.nearest(self._s @ rotation.T + translation, 4.0 * self.tolerance)
        if (to < 0).any() or not np.array_equal(kinds[to], kinds) or len(np.unique(to)) < len(to):
            return None
        for kind, items, types in self.atoms.topology.every():
            if len(items) and not np.array_equal(_listed(kind, items, types), _listed(kind, to[items], types)):
                return None
        return to

    def _names(self, found) -> None:
        self._to_standard = np.array(found.transformation_matrix)
        if self._complete:
            self.number, self.international, self.point_group = int(found.number), found.international, found.pointgroup
            return
        import spglib
        every = [(r, t + c) for r, t in zip(self.rotations, self.translations) for c in self.centrings]
        group = _silent(spglib.get_spacegroup_type_from_symmetry, np.array([r for r, _ in every]), np.array([t for _, t in every]),
                        lattice=self.atoms.cell.array)
        if group is None:
            raise SimulationError("spglib cannot name the group of the operations that leave the bonds as they are")
        self.number, self.international, self.point_group = int(group.number), group.international_short, group.pointgroup_international

    def _orbits(self) -> np.ndarray:
        label = np.arange(len(self.atoms))
        while True:
            before = label.copy()
            for to in (*self.permutations, *self.centred):
                np.minimum.at(label, to, label.copy())
            if np.array_equal(label, before):
                return label

    def __len__(self) -> int:
        """Number of operations within the cell."""
        return len(self.rotations) * len(self.centrings)

    # ---- cells --------------------------------------------------------------------------------------------------------------------------
    def primitive(self) -> Atoms:
        """The smallest cell of the crystal, with its bonds; neither turned nor shifted.

        Raises
        ------
        InputError
            It is too small for the bonds: one would reach past the nearest image.
        """
        cell, _ = minkowski_reduce(_lattice(self.centrings) @ self.atoms.cell.array)
        return recell(self.atoms, _handed(cell, self.atoms.cell.array), 4.0 * self.tolerance)

    def conventional(self) -> Atoms:
        """The cell of the International Tables, with its bonds; neither turned nor shifted.

        Raises
        ------
        InputError
            Bonds break the symmetry of the atoms, or the cell is too small for them.
        """
        if not self._complete:
            raise InputError("the bonds have less symmetry than their middles: there is a primitive cell only")
        cell = np.linalg.inv(self._to_standard).T @ self.atoms.cell.array
        return recell(self.atoms, cell, 4.0 * self.tolerance)

    # ---- text ---------------------------------------------------------------------------------------------------------------------------
    def to_dict(self) -> dict:
        """The answers as plain data."""
        primitive = len(self.atoms) // len(self.centrings)
        first = np.unique(self.orbits)
        kinds = self.atoms.arrays.get("type", self.atoms.get_chemical_symbols())
        return {"number": self.number, "international": self.international, "point_group": self.point_group, "tolerance": self.tolerance,
                "atoms": len(self.atoms), "primitive_atoms": primitive, "operations": len(self), "displacements": len(self.displacements()),
                "strains": len(self.strains()),
                "orbits": [{"atom": int(self.atoms.arrays["id"][k]) if "id" in self.atoms.arrays else int(k) + 1, "type": str(kinds[k]),
                            "atoms": int((self.orbits == k).sum()), "wyckoff": self.wyckoffs[k], "site": self.sites[k]} for k in first]}

    def parts(self) -> list[Table | str]:
        """The answers as tables and text."""
        d = self.to_dict()
        head = (f"space group {d['international']} ({d['number']}), point group {d['point_group']}, within {self.tolerance:g}\n"
                f"{d['atoms']} atoms, {d['primitive_atoms']} in the primitive cell; {d['operations']} operations")
        table = Table("Places of atoms", ["first atom", "type", "atoms", "Wyckoff letter", "site symmetry"],
                      [[str(o[k]) for k in ("atom", "type", "atoms", "wyckoff", "site")] for o in d["orbits"]])
        return [head, table, f"Displacements for all second derivatives: {d['displacements']} of {6 * d['atoms']}; "
                             f"strains for all elastic constants: {d['strains']} of 6"]

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.parts()))

    def __repr__(self) -> str:
        return f"Symmetry({self.international}, {len(self.atoms)} atoms, {len(self)} operations)"


def _kinds(atoms: Atoms) -> np.ndarray:
    """A number for each atom, equal for atoms that the force field does not tell apart."""
    columns = [np.round(np.asarray(atoms.arrays[name], float), DIGITS) for name in BY if name in atoms.arrays]
    if "type" not in atoms.arrays:
        columns.append(atoms.numbers)
    return np.unique(np.column_stack(columns), axis=0, return_inverse=True)[1].ravel() + 1


def _listed(kind: str, items: np.ndarray, types: np.ndarray) -> np.ndarray:
    """The items of a kind in an order that does not depend on how they are listed; of impropers only which atoms they have."""
    if kind == "improper":
        items = np.sort(items, axis=1)
    else:
        items = np.where((items[:, :1] > items[:, -1:]), items[:, ::-1], items)
    rows = np.column_stack([items, types])
    return rows[np.lexsort(rows.T)]


def _lattice(centrings: np.ndarray) -> np.ndarray:
    """The primitive vectors (3, 3), in those of the cell, of a lattice with these translations within the cell."""
    m = len(centrings)
    return _basis(np.concatenate([np.rint(centrings * m).astype(int), m * np.eye(3, dtype=int)])) / m


def _basis(rows: np.ndarray) -> np.ndarray:
    """Three vectors of whole numbers that span the same lattice as the given ones (m, 3)."""
    rows, out = rows.copy(), []
    for k in range(3):
        while True:
            rows = rows[rows.any(axis=1)]
            live = np.flatnonzero(rows[:, k])
            pivot = live[np.argmin(np.abs(rows[live, k]))]
            others = live[live != pivot]
            if not len(others):
                break
            rows[others] -= (rows[others, k] // rows[pivot, k])[:, None] * rows[pivot]
        out.append(rows[pivot])
        rows = np.delete(rows, pivot, axis=0)
    return np.array(out)


def _handed(cell: np.ndarray, like: np.ndarray) -> np.ndarray:
    """The cell with its vectors turned round if another hand's is wanted."""
    return cell if np.linalg.det(cell) * np.linalg.det(like) > 0 else -cell


def _silent(function, *args, **kwargs):
    """The answer of a function of spglib, None if it fails; how it wants to fail changes between versions."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return function(*args, **kwargs)
        except Exception as e:
            if type(e).__module__.partition(".")[0] != "spglib":
                raise
            return None


def _spglib(cell: np.ndarray, s: np.ndarray, kinds: np.ndarray, tolerance: float):
    """spglib's data set.

    Raises
    ------
    InputError
        It is not installed.
    SimulationError
        It finds nothing.
    """
    try:
        import spglib
    except ImportError:
        raise InputError("spglib is not installed: pip install spglib") from None
    found = _silent(spglib.get_symmetry_dataset, (cell, s, kinds), symprec=tolerance)
    if found is None:
        raise SimulationError(f"spglib finds no symmetry within {tolerance:g}: are two atoms in the same place?")
    return found
