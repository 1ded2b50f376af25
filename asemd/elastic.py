r"""Elastic constants at rest and relaxed, from second derivatives.

$$C = \frac1V \left( \frac{\partial^2 E}{\partial \eta\, \partial \eta} - \Lambda^T H^{-1} \Lambda \right), \qquad
\Lambda = \frac{\partial^2 E}{\partial x\, \partial \eta}$$

by the Lagrangian strain in Voigt's notation; the second term is what the atoms gain by moving to where no force acts on them.
Source: Lutsko, J. Appl. Phys. 65, 2991 (1989).
"""
from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from asemd import units as unit_styles
from asemd.compute.born_matrix import UNIT, VOIGT, add_items, add_pairs
from asemd.curvatures import bonded_items, of_list
from asemd.embedded_curvature import of_embedded
from asemd.errors import InputError, InputWarning, SimulationError
from asemd.hessian import ListEngine, of_calculator
from asemd.manybody_term import ManyBodyTerm
from asemd.term import BondedTerm, PairListTerm

STRAIN = 1e-4
AWAY = 0.01       # distance of atoms from where no force acts, at which their elastic constants are not those of the crystal
SHIFT = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))


def elastic_constants(calculator, atoms, relaxed: bool = True, numerical: bool = False) -> np.ndarray:
    """Elastic constants of a crystal at rest.

    Parameters
    ----------
    calculator : asemd.ForceField
    atoms : ase.Atoms
        Forces should vanish, or there is an `InputWarning`; under stress the constants are those by the Lagrangian strain.
    relaxed : bool
        Let the atoms follow the strain; otherwise they keep their places in the cell.
    numerical : bool
        Take differences of stresses and forces where a style has no second derivatives.

    Returns
    -------
    (6, 6) array
        xx yy zz yz xz xy, eV/Angstrom^3 (``units lj`` numbers pass unchanged).

    Raises
    ------
    InputError
        The atoms are not periodic in three directions, or a style has no second derivatives.
    SimulationError
        Some atoms are held by no force.
    """
    if atoms is None:
        raise InputError("get_elastic_constants needs atoms: nothing has been calculated yet")
    if atoms.cell.rank < 3 or not atoms.pbc.all():
        raise InputError("elastic constants need a crystal: a cell with three vectors that is periodic in all of them, "
                         f"here pbc is {' '.join(str(int(p)) for p in atoms.pbc)}")
    try:
        born, mixed = _analytic(calculator, atoms)
    except InputError:
        if not numerical:
            raise
        born, mixed = _differences(calculator, atoms)
    if relaxed and len(atoms) > 1:
        matrix = sparse.csc_matrix(of_calculator(calculator, atoms, numerical))[3:, 3:]      # one atom stays: the crystal must not drift
        try:
            factors = linalg.splu(matrix)
        except RuntimeError:
            raise SimulationError("elastic constants: some atoms are held by no force, nothing says where they go under strain") from None
        born = born - mixed[3:].T @ factors.solve(mixed[3:])
        away = np.abs(factors.solve(calculator.get_forces(atoms).ravel()[3:])).max()
        if not away < AWAY:
            warnings.warn("elastic constants are those of a crystal at rest, and here forces act, which would move atoms by about "
                          f"{away:.2g}: relax the atoms first", InputWarning, stacklevel=3)
    return 0.5 * (born + born.T) / atoms.get_volume()


def _analytic(calculator, atoms) -> tuple[np.ndarray, np.ndarray]:
    """Second derivatives by strain (6, 6), and by positions and strain (3 n, 6), forces left out, which vanish at rest."""
    system = calculator._system(atoms)
    calculator.interactions.check_complete(system)
    if calculator.loads:
        raise InputError(f"no second derivatives by strain of {calculator.loads[0]}")
    engine = ListEngine(system, calculator.interactions, replace(calculator.neighbor_settings(atoms), threads=1, precision="double"))
    n, born, mixed = system.n, _of_tail(engine.compute().virial_of), np.zeros((system.n, 3, 6))

    def pairs(at, d, b):
        add_pairs(born, d, b)
        one = b[:, None, None] * d[:, :, None] * np.stack([d[:, i] * d[:, j] for i, j in VOIGT], axis=1)[:, None, :]
        np.add.at(mixed, at[:, 0], one)
        np.subtract.at(mixed, at[:, 1], one)
    for term in engine.terms:
        if type(term) is BondedTerm:
            for at, between, v, gradient, inner in bonded_items(engine, term):
                add_items(born, v, gradient, inner)
                moved = np.einsum("sab,mkb->mska", UNIT, v).reshape(len(v), 6, -1)
                by = np.einsum("mij,msj->mis", inner, moved).reshape(len(v), len(between), 3, 6)
                for k, (i, j) in enumerate(between):
                    np.add.at(mixed, at[:, i], by[:, k])
                    np.subtract.at(mixed, at[:, j], by[:, k])
        elif type(term) is PairListTerm:
            for at, d, _, b in of_list(engine, term):
                pairs(at, d, b)
        elif type(term) is ManyBodyTerm and getattr(term.style, "packable", False):
            found = of_embedded(engine, term)
            pairs(found.atoms, found.d, found.b)
            born += (found.strained * found.second) @ found.strained.T
            mixed += (found.density @ (found.second * found.strained).T).reshape(n, 3, 6)
        else:
            name = f"kspace_style {term.solver.style}" if term.category == "kspace" else f"{term.category} style {term.style.name}"
            raise InputError(f"no second derivatives by strain of {name}: numerical=True takes differences")
    unit = calculator.units
    return (born * unit_styles.factor("energy", unit),
            mixed.reshape(3 * n, 6) * unit_styles.factor("energy/distance", unit))


def _of_tail(virial_of) -> np.ndarray:
    """Second derivatives by strain (6, 6) of the tail correction, whose virial goes with one over the volume."""
    volume = np.zeros((6, 6))
    volume[:3, :3] = 1.0
    return (volume + np.diag([2.0] * 3 + [1.0] * 3)) * virial_of.get("tail", np.zeros(6))[0]


def _differences(calculator, atoms) -> tuple[np.ndarray, np.ndarray]:
    """The same from stresses and forces of strained crystals."""
    born, mixed = np.zeros((6, 6)), np.zeros((3 * len(atoms), 6))
    volume, moved, own = atoms.get_volume(), atoms.copy(), calculator.copy()
    moved.calc = own
    for s in range(6):
        for count, weight in SHIFT:
            values, vectors = np.linalg.eigh(np.eye(3) + 2.0 * count * STRAIN * UNIT[s])
            stretch = vectors * np.sqrt(values) @ vectors.T
            moved.set_cell(atoms.cell.array @ stretch)
            moved.positions = atoms.positions @ stretch
            back = np.linalg.inv(stretch)
            piola = volume * np.linalg.det(stretch) * back @ moved.get_stress(voigt=False) @ back
            born[s] += weight / STRAIN * np.array([piola[i, j] for i, j in VOIGT])
            mixed[:, s] -= weight / STRAIN * (moved.get_forces() @ stretch).ravel()
    return born, mixed
