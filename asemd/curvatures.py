"""Second derivatives of the energy of every item and pair by its own vectors: what `asemd.hessian` and compute born/matrix sum up.

With E = E(q(v)): d2E/dv dv' = sum over coordinates d2E/dq dq' grad q grad q' + dE/dq grad grad q.
Source: Wilson, Decius and Cross, Molecular Vibrations (1955), chapter 4.
"""
from __future__ import annotations

import numpy as np

from asemd import coordinates
from asemd.errors import InputError, SimulationError
from asemd.kernels import bonded, curvature, image
from asemd.kernels.generate import Builder, plain_source

CHUNK = 20_000
STRAIGHT = 1e-6       # radians from a straight line within which the limit is taken
STEP = 2e-4           # of central differences of fourth order, relative to a length, or in radians
SHIFT = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))


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


def bonded_items(engine, term, numerical: bool = False):
    """Derivatives of the energy of all items of a bonded style by their vectors, in stretches of items.

    Parameters
    ----------
    engine : asemd.engine.Engine
    term : asemd.term.BondedTerm
    numerical : bool
        Take differences for styles that do not have second derivatives of their own.

    Yields
    ------
    atoms : (m, k) rows of the atoms
    pairs : list of (i, j), the places in an item between which the vectors go, from j to i
    v, gradient : (m, nv, 3)
    inner : (m, 3 nv, 3 nv)

    Raises
    ------
    InputError
        The style has no second derivatives.
    SimulationError
        An item where they do not exist.
    """
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
            along = np.where(slope[:, :, None, None] == 0.0, 0.0, coordinates.gradients(style, v))
        gradient = np.einsum("mc,mcki->mki", slope, along)
        if len(bend):
            inner[limit] += coordinates.straight_hessian(v[limit], bend)
        _check(engine, style, atoms, types, q[:, 0], ~np.isfinite(inner).all(axis=(1, 2)), "there it has no second derivatives")
        yield atoms, pairs, v, gradient, inner


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


def of_pairs(style, parts, tables, ti, tj, qq, r2, weights, numerical: bool = False, whole: float = 1.0):
    """Second derivatives of pairs: the matrix of each by its vector d is ``a I + b d d^T``; in stretches of pairs.

    Parameters
    ----------
    style : PairStyle
    parts : sequence
        The parts of the style that `tables` (PairTables) has coefficients of.
    ti, tj, qq, r2 : (m,)
        Types, products of charges with the constant of units, squared distances.
    weights : ((m,), (m,))
        Of van der Waals and Coulomb parts.
    numerical : bool
        Take differences for parts that do not have second derivatives of their own.
    whole : float
        The Coulomb weight of pairs that are not special.

    Yields
    ------
    index : (k,) which of the pairs
    a, b : (k,)

    Raises
    ------
    InputError
        A part that has no second derivatives.
    SimulationError
        One is not finite.
    """
    row = constant = array = 0
    for part in parts:
        d2 = getattr(part.function, "d2", None)
        weight = weights[1] if part.charged else weights[0]
        near = np.flatnonzero((r2 < tables.rows[row, ti, tj]) & ((weight != 0.0) | part.long))
        if (part.sized or d2 is None and not numerical) and len(near):      # radii of atoms are not in the tables
            raise _missing("pair", style.name)
        loop = curvature.of_part(part, d2, row, constant, array)
        for start in range(0, len(near), CHUNK):
            m = near[start:start + CHUNK]
            q = (r2[m] if part.coordinate == "r2" else np.sqrt(r2[m]))[:, None]
            slope, second = np.zeros((len(m), 1)), np.zeros((len(m), 1, 1))
            arguments = (ti[m], tj[m], qq[m], tables.rows, tables.constants, tables.arrays)
            loop(q, *arguments, slope, second)
            if d2 is None:
                second = _numerical(loop, q, slope, arguments, [False])
            scale = whole if part.long else weight[m]
            one, two = scale * slope[:, 0], scale * second[:, 0, 0]
            if not (np.isfinite(one).all() and np.isfinite(two).all()):
                raise SimulationError(f"pair style {style.name}: a second derivative is not finite")
            if part.coordinate == "r2":
                a, b = 2.0 * one, 4.0 * two
            else:
                a, b = one / q[:, 0], (two - one / q[:, 0]) / r2[m]
            if part.long and part.charged:
                power, bare = 1.0, (whole - weight[m]) * qq[m] / (r2[m] * np.sqrt(r2[m]))
            elif part.long:
                power, bare = 6.0, -6.0 * (whole - weight[m]) * tables.rows[row + 2, ti[m], tj[m]] / r2[m] ** 4
            else:
                power, bare = 0.0, 0.0
            yield m, a + bare, b - (power + 2.0) * bare / r2[m]
        row, constant, array = row + 2 + len(part.rows), constant + len(part.constants), array + len(part.arrays)


def of_list(engine, term, numerical: bool = False):
    """The same of the pairs of an `asemd.term.PairListTerm`: atoms (k, 2), vectors (k, 3), a, b."""
    state = engine.state
    kind, shift = term.code & 3, term.shifts[term.code >> 2]
    d = state.x[:, term.i].T - state.x[:, term.j].T - shift
    r2 = (d * d).sum(axis=1)
    atoms = np.stack([state.row[term.i], state.row[term.j]], axis=1)
    qq = engine.qqr2e * state.q[term.i] * state.q[term.j] if state.q is not None else np.zeros(len(r2))
    for m, a, b in of_pairs(term.style, term.parts, term.tables, state.type[term.i], state.type[term.j], qq, r2,
                            (term.lj[kind], term.coul[kind]), numerical, term.coul[0]):
        yield atoms[m], d[m], a, b
