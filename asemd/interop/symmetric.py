"""What symmetry saves: displacements and strains that give all others, and forces and stresses made symmetric."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy import linalg

from asemd.compute.born_matrix import UNIT, VOIGT
from asemd.elastic import SHIFT, STRAIN
from asemd.errors import InputError, SimulationError

DISTANCE = 0.01     # Angstrom
RANK = 1e-3         # a direction counts as new if it is this far out of the plane of the others


@dataclass(frozen=True)
class Displacement:
    """One atom moved.

    Parameters
    ----------
    atom : int
        Row.
    vector : (3,) array
        Angstrom.
    """

    atom: int
    vector: np.ndarray


class Reduced:
    """Methods of `asemd.Symmetry` that need its operations only."""

    # ---- symmetric forces and stresses --------------------------------------------------------------------------------------------------
    def symmetric_forces(self, forces: np.ndarray) -> np.ndarray:
        """The mean of forces, or other vectors of atoms (n, 3), over all operations."""
        total = np.zeros((len(self.atoms), 3))
        for to, matrix in zip(self.permutations, self.matrices):
            total[to] += forces @ matrix.T
        out = np.zeros_like(total)
        for to in self.centred:
            out[to] += total
        return out / (len(self.matrices) * len(self.centred))

    def symmetric_stress(self, stress: np.ndarray) -> np.ndarray:
        """The mean of a stress, (3, 3) or in Voigt's order xx yy zz yz xz xy, over all operations; comes back as it was given."""
        stress = np.asarray(stress, float)
        full = stress if stress.shape == (3, 3) else sum(stress[k] * (UNIT[k] if k < 3 else 2.0 * UNIT[k]) for k in range(6))
        mean = np.mean(self.matrices @ full @ self.matrices.transpose(0, 2, 1), axis=0)
        return mean if stress.shape == (3, 3) else np.array([mean[a, b] for a, b in VOIGT])

    def _around(self, atom: int):
        """The operations that leave an atom in its place: permutations and matrices."""
        for to, matrix in zip(self.permutations, self.matrices):
            for k in np.flatnonzero(self.centred[:, to[atom]] == atom):
                yield self.centred[k][to], matrix

    def constraint(self) -> KeepSymmetry:
        """A constraint of ASE under which optimisers keep the symmetry, of atoms that are listed as these are."""
        return KeepSymmetry(self)

    # ---- second derivatives -------------------------------------------------------------------------------------------------------------
    def displacements(self, distance: float = DISTANCE) -> list[Displacement]:
        """The displacements whose forces give all second derivatives.

        Parameters
        ----------
        distance : float
            Angstrom.

        Returns
        -------
        list of Displacement
            One atom of each kind, along as few directions as its surroundings allow, both ways where symmetry does not give the other one.
        """
        out = []
        for atom in np.unique(self.orbits):
            matrices = np.array([m for _, m in self._around(int(atom))])
            for u in _fewest(self._directions(), lambda u, m=matrices: m @ u, 3):
                out.append(Displacement(int(atom), distance * u))
                if not (np.abs(matrices @ u + u).max(axis=1) < 1e-6).any():
                    out.append(Displacement(int(atom), -distance * u))
        return out

    def _directions(self) -> list[np.ndarray]:
        """Sums of cell vectors, shortest first, as unit vectors."""
        cell = self.atoms.cell.array
        unit = cell / np.linalg.norm(cell, axis=1)[:, None]
        words = [w for w in product((1, 0, -1), repeat=3) if w > (0, 0, 0)]
        vectors = [np.array(w) @ unit for w in sorted(words, key=lambda w: np.abs(w).sum())]
        return [v / np.linalg.norm(v) for v in vectors]

    def displaced(self, distance: float = DISTANCE) -> list:
        """Copies of the atoms, one for each of `displacements`, for codes that compute their forces elsewhere."""
        out = []
        for d in self.displacements(distance):
            moved = self.atoms.copy()
            moved.positions[d.atom] += d.vector
            out.append(moved)
        return out

    def hessian(self, source, distance: float = DISTANCE) -> np.ndarray:
        """All second derivatives of the energy from the forces of a few displacements.

        Parameters
        ----------
        source : calculator of ASE, or sequence of (n, 3) arrays
            A calculator, or the forces of `displaced` in this order, eV/Angstrom.
        distance : float
            That of the displacements, Angstrom.

        Returns
        -------
        (3 n, 3 n) array
            eV/Angstrom^2; row 3 i + a belongs to atom i and axis a.

        Raises
        ------
        InputError
            Forces of other displacements.
        """
        moves, n = self.displacements(distance), len(self.atoms)
        forces = _forces(source, self.displaced(distance))
        if len(forces) != len(moves) or any(np.shape(f) != (n, 3) for f in forces):
            raise InputError(f"hessian: needs the forces of {len(moves)} displacements, ({n}, 3) each")
        blocks = np.zeros((n, n, 3, 3))
        for atom in np.unique(self.orbits):
            by, of = [], []
            for d, f in zip(moves, forces):
                if d.atom == atom:
                    for to, matrix in self._around(int(atom)):
                        turned = np.zeros((n, 3))
                        turned[to] = f @ matrix.T
                        by.append(matrix @ d.vector)
                        of.append(turned)
            u = np.array(by)
            # forces of the crystal at rest drop out: every displacement has its opposite
            blocks[atom] = np.einsum("am,mjb->jab", -np.linalg.pinv(u), np.array(of))
        return self._spread(blocks)

    def _spread(self, blocks: np.ndarray) -> np.ndarray:
        """Rows of the first atoms of the orbits to all rows; symmetric in the two atoms."""
        n, done = len(self.atoms), np.zeros(len(self.atoms), bool)
        for atom in np.unique(self.orbits):
            own = blocks[atom].copy()
            for to, matrix in zip(self.permutations, self.matrices):
                for centred in self.centred:
                    there = centred[to]
                    if not done[there[atom]]:
                        done[there[atom]] = True
                        blocks[there[atom], there] = matrix @ own @ matrix.T
        matrix = blocks.transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
        return 0.5 * (matrix + matrix.T)

    # ---- elastic constants --------------------------------------------------------------------------------------------------------------
    def strains(self) -> list[np.ndarray]:
        """The strains (3, 3) whose stresses give all elastic constants."""
        words = [w for w in product((1, 0), repeat=6) if 0 < sum(w) < 4]
        candidates = [np.einsum("s,sab->ab", w, UNIT) for w in sorted(words, key=sum)]
        candidates = [eta / np.linalg.norm(eta) for eta in candidates]
        return _fewest(candidates, lambda eta: np.array([_voigt(m @ eta @ m.T) for m in self.matrices]), 6)

    def elastic_constants(self, calculator, relaxed: bool = True, distance: float = DISTANCE) -> np.ndarray:
        """Elastic constants of a crystal at rest, from the stresses and forces of a few strains.

        Parameters
        ----------
        calculator : calculator of ASE
            With forces and stress.
        relaxed : bool
            Let the atoms follow the strain, by `hessian`; otherwise they keep their places in the cell.
        distance : float
            Of the displacements, Angstrom.

        Returns
        -------
        (6, 6) array
            xx yy zz yz xz xy, eV/Angstrom^3.

        Raises
        ------
        SimulationError
            Some atoms are held by no force.
        """
        n, by, stresses, pulls = len(self.atoms), [], [], []
        for eta in self.strains():
            piola, pull = _strained(self.atoms, calculator, eta)
            for to, matrix in zip(self.permutations, self.matrices):
                by.append(_voigt(matrix @ eta @ matrix.T))
                turned = matrix @ piola @ matrix.T
                stresses.append([turned[a, b] for a, b in VOIGT])
                moved = np.zeros((n, 3))
                moved[to] = pull @ matrix.T
                pulls.append(moved.ravel())
        solve = np.linalg.pinv(np.array(by))
        born, mixed = (solve @ np.array(stresses)).T, (solve @ np.array(pulls)).T
        if relaxed and n > 1:
            matrix = self.hessian(calculator, distance)[3:, 3:]      # one atom stays: the crystal must not drift
            try:
                born = born - mixed[3:].T @ linalg.solve(matrix, mixed[3:], assume_a="sym")
            except linalg.LinAlgError:
                raise SimulationError("elastic constants: some atoms are held by no force, nothing says where they go") from None
        return 0.5 * (born + born.T) / self.atoms.get_volume()


class KeepSymmetry:
    """A constraint of ASE: steps, momenta, forces, stress and changes of the cell become their means over all operations of a symmetry.

    Files of ASE leave it out: it has no dictionary from which it could be made again.
    """

    def __init__(self, symmetry):
        self.symmetry = symmetry

    def adjust_positions(self, atoms, new):
        new[:] = atoms.positions + self.symmetry.symmetric_forces(new - atoms.positions)

    def adjust_momenta(self, atoms, momenta):
        momenta[:] = self.symmetry.symmetric_forces(momenta)

    def adjust_forces(self, atoms, forces):
        forces[:] = self.symmetry.symmetric_forces(forces)

    def adjust_stress(self, atoms, stress):
        stress[:] = self.symmetry.symmetric_stress(stress)

    def adjust_cell(self, atoms, cell):
        change = np.linalg.solve(atoms.cell.array, np.asarray(cell, float))       # x_new = x @ change
        matrices = self.symmetry.matrices
        cell[:] = atoms.cell.array @ np.mean(matrices @ change @ matrices.transpose(0, 2, 1), axis=0)

    def get_removed_dof(self, atoms):
        n = 3 * len(atoms)
        kept = sum(np.trace(m) * (c[to] == np.arange(len(atoms))).sum()
                   for to, m in zip(self.symmetry.permutations, self.symmetry.matrices) for c in self.symmetry.centred)
        return n - round(kept / len(self.symmetry))

    def index_shuffle(self, atoms, ind):
        raise InputError("the symmetry of a crystal is not that of some of its atoms: find it anew with asemd.Symmetry")

    def copy(self):
        return KeepSymmetry(self.symmetry)


def _voigt(eta: np.ndarray) -> np.ndarray:
    """(6,) of a strain, shear doubled."""
    return np.array([eta[a, b] * (1.0 if a == b else 2.0) for a, b in VOIGT])


def _fewest(candidates: Sequence[np.ndarray], images, rank: int) -> list[np.ndarray]:
    """As few candidates as possible whose images under the symmetry span the space; of equals the earlier one."""
    chosen, have = [], np.zeros((0, rank))
    while len(have) == 0 or np.linalg.matrix_rank(have, tol=RANK * np.linalg.norm(have, 2)) < rank:
        gains = []
        for c in candidates:
            both = np.concatenate([have, images(c)])
            gains.append(np.linalg.matrix_rank(both, tol=RANK * np.linalg.norm(both, 2)))
        best = int(np.argmax(gains))
        chosen.append(candidates[best])
        have = np.concatenate([have, images(candidates[best])])
    return chosen


def _forces(source, displaced: list) -> list[np.ndarray]:
    """Forces of a calculator for all of these atoms, or those that were given."""
    if not hasattr(source, "get_property"):
        return list(source)
    out = []
    for atoms in displaced:
        atoms.calc = source
        out.append(atoms.get_forces())
    return out


def _strained(atoms, calculator, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives by a Lagrangian strain of the stress times volume (3, 3), and of the energy by the positions (n, 3)."""
    moved, piola, pull = atoms.copy(), np.zeros((3, 3)), np.zeros((len(atoms), 3))
    moved.calc = calculator
    for count, weight in SHIFT:
        values, vectors = np.linalg.eigh(np.eye(3) + 2.0 * count * STRAIN * eta)
        stretch = vectors * np.sqrt(values) @ vectors.T
        moved.set_cell(atoms.cell.array @ stretch)
        moved.positions = atoms.positions @ stretch
        back = np.linalg.inv(stretch)
        piola += weight / STRAIN * moved.get_volume() * back @ moved.get_stress(voigt=False) @ back
        pull -= weight / STRAIN * moved.get_forces() @ stretch
    return piola, pull
