"""Second derivatives of the energy by all positions: exact, from the second derivatives of each style by its own coordinates.

With E = E(q(x)): H = sum over coordinates d2E/dq dq' grad q grad q' + dE/dq grad grad q.
Source: Wilson, Decius and Cross, Molecular Vibrations (1955), chapter 4.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import sparse

from asemd import coordinates
from asemd import units as unit_styles
from asemd.engine import Engine
from asemd.errors import InputError, SimulationError
from asemd.kernels import bonded, curvature, image
from asemd.kernels.generate import Builder, plain_source
from asemd.loads import Maps
from asemd.term import BondedTerm, PairListTerm

CHUNK = 20_000
STRAIGHT = 1e-6       # radians from a straight line within which the limit is taken
STEP = 2e-4           # of central differences of fourth order, relative to a length, or in radians
SHIFT = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))


class ListEngine(Engine):
    """An engine that lists every pair, whatever the size of the system."""

    def _choose_list(self):
        super()._choose_list()
        self.expanded, self.sparse = self.mode == "cluster", False


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
    n, blocks = system.n, []
    for term in engine.terms:
        if type(term) is BondedTerm:
            blocks += list(_bonded(engine, term, numerical))
        elif type(term) is PairListTerm:
            blocks += list(_pairs(engine, term, numerical))
        else:
            raise InputError(f"no second derivatives: {term.category} style {term.style.name} is not a function of positions alone")
    if not blocks:
        return sparse.csr_matrix((3 * n, 3 * n))
    rows, columns, numbers = (np.concatenate(part) for part in zip(*blocks))
    return sparse.coo_matrix((numbers, (rows, columns)), shape=(3 * n, 3 * n)).tocsr()


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
                inner[a] -= weight / STEP * load.items(x, system.box, system.topology, slice(m, m + 1))[1][0, 7:]
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


def _numerical(loop, q: np.ndarray, slope: np.ndarray, arguments, angles) -> np.ndarray:
    """Second derivatives (m, nc, nc) by central differences of the first ones."""
    out = np.zeros((*slope.shape, slope.shape[1]))
    unused = np.zeros((len(q), 0, 0))
    for a in range(q.shape[1]):
        h = np.full(len(q), STEP) if angles[a] else STEP * np.maximum(np.abs(q[:, a]), 1e-3)
        for count, weight in SHIFT:
            near, moved = np.empty_like(slope), q.copy()
            moved[:, a] += count * h
            loop(moved, *arguments, near, unused)
            out[:, a] += weight * near / h[:, None]
    return 0.5 * (out + out.transpose(0, 2, 1))


def _missing(category: str, name: str) -> InputError:
    return InputError(f"no second derivatives of {category} style {name}: it has no d2 function; numerical=True takes differences instead")


def _bonded(engine, term: BondedTerm, numerical: bool):
    """Blocks of all items of a bonded style."""
    style = term.style
    if "gamma" in style.coordinates:
        raise InputError(f"no second derivatives: {style.category} style {style.name} is not a function of positions alone")
    d2 = style.d2 if style.function is not style.lammps else None
    if d2 is None and not numerical:
        raise _missing(style.category, style.name)
    loop, pairs = curvature.of_style(style, d2), coordinates.pairs_of(style)
    nc, empty, x = len(style.coordinates), np.zeros(0), engine.system.x
    angles = [name in ("theta", "phi", "chi", "theta1", "theta2") for name in style.coordinates]
    for start in range(0, len(term.items), CHUNK):
        atoms, types = term.items[start:start + CHUNK], term.types[start:start + CHUNK]
        v = np.stack([x[atoms[:, i]] - x[atoms[:, j]] for i, j in pairs], axis=1)
        _closest(engine.ortho)(v.reshape(-1, 3), engine.cell)
        q = coordinates.values(style, v)
        slope, second = np.zeros((len(q), nc)), np.zeros((len(q), nc, nc))
        arguments = (types, types, empty, term.packed.coeff, empty, term.packed.arrays)
        loop(q, *arguments, slope, second)
        if d2 is None:
            second = _numerical(loop, q, slope, arguments, angles)
        _check(engine, style, atoms, types, q[:, 0], ~(np.isfinite(slope).all(axis=1) & np.isfinite(second).all(axis=(1, 2))))
        limit = _straight(style, q, slope, second)
        bend = second[limit, 0, 0]
        if len(bend):
            slope[limit, 0] = second[limit, 0, 0] = 0.0
        with np.errstate(all="ignore"):
            inner = coordinates.hessian(style, v, slope, second)
        if len(bend):
            inner[limit] += coordinates.straight_hessian(v[limit], bend)
        _check(engine, style, atoms, types, q[:, 0], ~np.isfinite(inner).all(axis=(1, 2)), "there it has no second derivatives")
        yield _block(atoms, pairs, inner)


def _straight(style, q, slope, second) -> np.ndarray:
    """Which angles are so close to 0 or 180 degrees that the limit must be taken; it exists where the energy has no cusp."""
    if style.coordinates[0] != "theta":
        return np.zeros(len(q), bool)
    theta = q[:, 0]
    inward = np.where(theta < 1.0, theta, theta - np.pi)
    smooth = np.abs(slope[:, 0] - second[:, 0, 0] * inward) <= 1e-8 * np.abs(second[:, 0, 0])
    return (np.abs(inward) < STRAIGHT) & smooth & ~second[:, 0, 1:].any(axis=1)


def _check(engine, style, atoms, types, first, wrong, why="") -> None:
    """Report the first item that `wrong` marks."""
    if wrong.any():
        m = int(np.argmax(wrong))
        ids = [int(engine.system.id[i]) for i in atoms[m]]
        if not why:
            raise SimulationError(bonded.describe(style, float(first[m]), ids, int(types[m])))
        raise SimulationError(f"{style.category} of type {types[m]} between atoms {' '.join(map(str, ids))}, {style.category} style "
                              f"{style.name}: atoms on one line or in one place: {why}")


def _closest(orthogonal: bool):
    """A compiled loop that replaces vectors (m, 3) by their closest images."""
    b = Builder("Closest images of vectors.")
    b.text(plain_source(image.closest_orthogonal if orthogonal else image.closest_general, "closest"), cache=False)
    b.text("def loop(d, cell):\n    for v in d:\n        v[0], v[1], v[2] = closest(v[0], v[1], v[2], cell)")
    return b.build().loop


def _pairs(engine, term: PairListTerm, numerical: bool):
    """Blocks of all pairs of a pair style, or of the special pairs that a bonded style asks for."""
    state = engine.state
    kind, shift = term.code & 3, term.shifts[term.code >> 2]
    d = state.x[:, term.i].T - state.x[:, term.j].T - shift
    r2 = (d * d).sum(axis=1)
    ti, tj = state.type[term.i], state.type[term.j]
    atoms = np.stack([state.row[term.i], state.row[term.j]], axis=1)
    qq = engine.qqr2e * state.q[term.i] * state.q[term.j] if state.q is not None else np.zeros(len(r2))
    row = constant = array = 0
    for part in term.parts:
        d2 = getattr(part.function, "d2", None)
        weight = (term.coul if part.charged else term.lj)[kind]
        near = np.flatnonzero((r2 < term.tables.rows[row, ti, tj]) & (weight != 0.0))
        if d2 is None and not numerical and len(near):
            raise _missing("pair", term.style.name)
        loop = curvature.of_part(part, d2, row, constant, array)
        for start in range(0, len(near), CHUNK):
            m = near[start:start + CHUNK]
            q = (r2[m] if part.coordinate == "r2" else np.sqrt(r2[m]))[:, None]
            slope, second = np.zeros((len(m), 1)), np.zeros((len(m), 1, 1))
            arguments = (ti[m], tj[m], qq[m], term.tables.rows, term.tables.constants, term.tables.arrays)
            loop(q, *arguments, slope, second)
            if d2 is None:
                second = _numerical(loop, q, slope, arguments, [False])
            one, two = weight[m] * slope[:, 0], weight[m] * second[:, 0, 0]
            if not (np.isfinite(one).all() and np.isfinite(two).all()):
                raise SimulationError(f"pair style {term.style.name}: a second derivative is not finite")
            outer = d[m][:, :, None] * d[m][:, None, :]
            if part.coordinate == "r2":
                inner = 2.0 * one[:, None, None] * np.eye(3) + 4.0 * two[:, None, None] * outer
            else:
                outer /= r2[m][:, None, None]
                inner = (one / q[:, 0])[:, None, None] * (np.eye(3) - outer) + two[:, None, None] * outer
            yield _block(atoms[m], [(0, 1)], inner)
        row, constant, array = row + 2 + len(part.rows), constant + len(part.constants), array + len(part.arrays)
