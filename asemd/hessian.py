"""Second derivatives of the energy by all positions: exact, from the second derivatives of each style by its own coordinates.

With E = E(q(x)): H = sum over coordinates d2E/dq dq' grad q grad q' + dE/dq grad grad q.
Source: Wilson, Decius and Cross, Molecular Vibrations (1955), chapter 4.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import sparse

from asemd import units as unit_styles
from asemd.curvatures import SHIFT, STEP, bonded_items, of_list
from asemd.embedded_curvature import of_embedded
from asemd.engine import Engine
from asemd.errors import InputError
from asemd.kernels import pair_matrix
from asemd.kernels.hooks import bound
from asemd.loads import Maps, Potential
from asemd.manybody_term import ManyBodyTerm
from asemd.own_term import OwnTerm
from asemd.term import BondedTerm, PairListTerm


class ListEngine(Engine):
    """An engine that lists every pair, whatever the size of the system."""

    def list_for(self, n):
        mode, *_, why = super().list_for(n)
        return mode, mode == "cluster", False, False, why


def hessian_of(system, interactions, settings, numerical: bool = False):
    """The matrix of second derivatives of the energy.

    Parameters
    ----------
    system : System
    interactions : Interactions
    settings : asemd.result.Settings
    numerical : bool
        Second derivatives by the coordinates of styles that do not have any from differences of their first derivatives.

    Returns
    -------
    scipy.sparse.csr_matrix
        (3 n, 3 n), in energy / distance^2 of the system's units; row 3 i + a belongs to atom i and axis a.

    Raises
    ------
    InputError
        A style has no second derivatives; the message names it.
    SimulationError
        An item where they do not exist, such as a straight angle with a force.
    """
    engine = ListEngine(system, interactions, replace(settings, threads=1, precision="double"))
    engine.compute()
    n, blocks, pairs, rest = system.n, [], [], []
    for term in engine.terms:
        if type(term) is BondedTerm:
            blocks += [_block(atoms, ends, inner) for atoms, ends, _, _, inner in bonded_items(engine, term, numerical)]
        elif type(term) is PairListTerm:
            if numerical and term.sized:
                rest.append(_of_forces(engine, term))
            else:
                pairs += of_list(engine, term, numerical)
        elif type(term) is ManyBodyTerm:
            rest.append(_many(engine, term, numerical, pairs))
        elif term.category == "kspace":
            if not numerical:
                raise InputError(f"no second derivatives of kspace_style {term.solver.style}; numerical=True takes differences instead")
            rest.append(_of_forces(engine, term))
        elif type(term) is not OwnTerm:
            raise InputError(f"no second derivatives: {term.category} style {term.style.name} is not a function of positions alone")
    if pairs:
        rest.insert(0, of_pairs(n, *(np.concatenate(part) for part in zip(*pairs))))
    if blocks:
        rows, columns, numbers = (np.concatenate(part) for part in zip(*blocks))
        rest.append(sparse.coo_matrix((numbers, (rows, columns)), shape=(3 * n, 3 * n)).tocsr())
    return sum(rest[1:], rest[0]) if rest else sparse.csr_matrix((3 * n, 3 * n))


def of_pairs(n: int, atoms: np.ndarray, d: np.ndarray, a: np.ndarray, b: np.ndarray) -> sparse.csr_matrix:
    """The matrix (3 n, 3 n) of pairs (m, 2) whose own one by the vector d (m, 3) is ``a I + b d d^T``."""
    k, m = pair_matrix.module(), len(atoms)
    i, j = (np.ascontiguousarray(atoms[:, side], np.int64) for side in (0, 1))
    start, place = np.empty((2, n + 1), np.int64)
    order, column, pair = np.empty((3, 2 * m), np.int64)
    size = 9 * (k.arrange(i, j, start, place, order, column, pair) + n)
    first, columns = (np.empty(length, np.int32 if size < 2**31 else np.int64) for length in (3 * n + 1, size))
    numbers = np.empty(size)
    k.fill(start, column, pair, d, a, b, first, columns, numbers)
    return sparse.csr_matrix((numbers, columns, first), shape=(3 * n, 3 * n))


def _many(engine, term, numerical: bool, pairs: list):
    """Second derivatives of a many-body style: those of its pairs into `pairs`, what is left as a matrix."""
    if getattr(term.style, "packable", False):
        found = of_embedded(engine, term)
        pairs.append((found.atoms, found.d, found.a, found.b))
        return found.matrix()
    if not numerical:
        raise InputError(f"no second derivatives of pair style {term.style.name}; numerical=True takes differences instead")
    return _of_forces(engine, term)


def _of_forces(engine, term):
    """Second derivatives of a term by central differences of its forces."""
    s, n, f, kernel = engine.state, engine.system.n, engine.buffers[0], term.kernel(False, False)
    slots, out = np.flatnonzero(s.row[:engine.ns] >= 0), []
    rows = s.row[slots]
    for slot in slots:
        for axis in range(3):
            here, column = s.x[axis, slot], np.zeros((n, 3))
            for count, weight in SHIFT:
                s.x[axis, slot] = here + count * STEP
                f[:] = 0.0
                bound(kernel, term.arguments(engine, 0))()
                column[rows] -= weight / STEP * f[:3, slots].T
            s.x[axis, slot] = here
            out.append(sparse.csr_matrix(column.reshape(1, -1)))
    order = np.argsort((3 * rows[:, None] + np.arange(3)).ravel())
    matrix = sparse.vstack(out).tocsr()[order]
    return 0.5 * (matrix + matrix.T)


def of_calculator(calculator, atoms, numerical: bool = False):
    """The matrix of second derivatives of the energy of ``ase.Atoms``, exact to round-off.

    Parameters
    ----------
    calculator : asemd.ForceField
    atoms : ase.Atoms
    numerical : bool
        Take differences for styles that do not have second derivatives of their own.

    Returns
    -------
    scipy.sparse.csr_matrix
        (3 n, 3 n), eV/Angstrom^2 (``units lj`` numbers pass unchanged). Constant added forces have none; constraints are not applied.

    Raises
    ------
    InputError, SimulationError
        As `hessian_of`.
    """
    if atoms is None:
        raise InputError("get_hessian needs atoms: nothing has been calculated yet")
    system = calculator._system(atoms)
    calculator.interactions.check_complete(system)
    matrix = hessian_of(system, calculator.interactions, calculator.neighbor_settings(atoms), numerical)
    for load in calculator.loads:
        if isinstance(load, Potential):
            raise InputError(f"no second derivatives of fix {load}")
        if isinstance(load, Maps) and len(system.topology.crossterms):
            if not numerical:
                raise InputError("no second derivatives of fix cmap: numerical=True takes differences instead")
            matrix = matrix + _of_maps(load, system)
    return matrix * unit_styles.factor("energy/distance^2", calculator.units)


def _of_maps(load: Maps, system):
    """The part of correction maps, by central differences of their forces: of one cross term after the other, which may share atoms."""
    x, n, blocks = system.x.copy(), system.n, []
    for m, atoms in enumerate(system.topology.crossterms):
        inner = np.zeros((15, 15))
        for a in range(15):
            at = atoms[a // 3], a % 3
            here = x[at]
            for count, weight in SHIFT:
                x[at] = here + count * STEP
                inner[a] -= weight / STEP * load.items(x, system, slice(m, m + 1))[1][0, 7:]
            x[at] = here
        index = (3 * atoms[:, None].astype(np.int64) + np.arange(3)).ravel()
        blocks.append((np.repeat(index, 15), np.tile(index, 15), 0.5 * (inner + inner.T).ravel()))
    rows, columns, numbers = (np.concatenate(part) for part in zip(*blocks))
    return sparse.coo_matrix((numbers, (rows, columns)), shape=(3 * n, 3 * n)).tocsr()


def _block(atoms: np.ndarray, pairs, inner: np.ndarray):
    """Rows, columns and numbers of items (m, k) whose second derivatives by their vectors are `inner (m, 3 nv, 3 nv)`."""
    m, k = atoms.shape
    turn = np.zeros((len(pairs), k))
    for row, (i, j) in enumerate(pairs):
        turn[row, i], turn[row, j] = 1.0, -1.0
    inner = inner.reshape(m, len(pairs), 3, len(pairs), 3)
    whole = np.einsum("ui,muavb,vj->miajb", turn, inner, turn, optimize=True)
    index = 3 * atoms[:, :, None].astype(np.int64) + np.arange(3)
    rows = np.broadcast_to(index[:, :, :, None, None], whole.shape)
    columns = np.broadcast_to(index[:, None, None, :, :], whole.shape)
    return rows.ravel(), columns.ravel(), whole.ravel()
