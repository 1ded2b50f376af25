r"""The largest frequency of a scene: the top of the spectrum of the mass-weighted second derivatives, by a few Lanczos steps.

.. math:: A = M^{-1/2} H M^{-1/2}, \qquad \omega_{max}^2 = \lambda_{max}(A)

Small scenes have their exact second derivatives (`asemd.hessian`); others take differences of forces along a vector.
Source: C. Lanczos, J. Res. Natl. Bur. Stand. 45, 255 (1950); ARPACK by `scipy.sparse.linalg.eigsh`.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asemd import coordinates
from asemd.errors import AsemdError, InputError, SimulationError

EXACT, PAIRS = 1500, 200_000        # atoms and pairs up to which second derivatives are exact
STEP = 1e-5             # of differences: the largest displacement, relative to the distance of neighbours
TOLERANCE = 1e-2        # of the square of the frequency
VECTORS = 12            # Lanczos vectors


@dataclass
class Top:
    """The fastest vibration.

    Attributes
    ----------
    omega : float
        1/time of the scene.
    weight : (n,) array
        Share of each atom in the motion; they add up to 1.
    how : str
        ``exact second derivatives`` or ``differences of forces``.
    """

    omega: float
    weight: np.ndarray
    how: str


def top(case) -> Top | None:
    """The fastest vibration about the present positions; None where forces do not exist or nothing binds."""
    from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh
    n = case.system.n
    if n < 2 or case.result is None:
        return None
    scale = np.repeat(np.sqrt(case.units.ftm2v / case.masses), 3)
    scale[~np.repeat(case.moving, 3)] = 0.0
    product, how = _product(case)
    free = _projection(case, scale)
    operator = LinearOperator((3 * n, 3 * n), matvec=lambda v: free(scale * product(scale * free(v.ravel()))), dtype=float)
    start = np.random.default_rng(1).normal(size=3 * n)
    try:
        if 3 * n <= 2 * VECTORS:
            values, vectors = np.linalg.eigh(np.column_stack([operator.matvec(e) for e in np.eye(3 * n)]))
        else:
            values, vectors = eigsh(operator, k=1, which="LA", v0=start, tol=TOLERANCE, ncv=VECTORS, maxiter=20)
    except ArpackNoConvergence as e:
        values, vectors = e.eigenvalues, e.eigenvectors
    except (AsemdError, ArpackError):
        return None
    if not len(values) or not values[-1] > 0.0:
        return None
    return Top(float(np.sqrt(values[-1])), (vectors[:, -1].reshape(n, 3) ** 2).sum(axis=1), how)


def _projection(case, scale: np.ndarray):
    """The function that takes motion along held bonds and angles out of a mass-weighted vector."""
    from scipy import sparse
    from scipy.sparse.linalg import factorized
    rows, columns, numbers, count = [], [], [], 0
    for items in case.items:
        held = np.flatnonzero(~case.vibrates(items.category, items.atoms) & case.moving[items.atoms].any(axis=1))
        if items.style.coordinates[0] not in ("r", "theta") or not len(held):
            continue
        atoms, pairs = items.atoms[held], coordinates.pairs_of(items.style)
        x = case.system.x[atoms]
        v = np.stack([case.system.box.minimum_image(x[:, a] - x[:, b])[0] for a, b in pairs], axis=1)
        g = coordinates.gradients(items.style, v)[:, 0]
        for (a, b), part in zip(pairs, g.transpose(1, 0, 2)):
            for atom, sign in ((a, 1.0), (b, -1.0)):
                rows.append(np.repeat(np.arange(count, count + len(held)), 3))
                columns.append((3 * atoms[:, atom, None].astype(np.int64) + np.arange(3)).ravel())
                numbers.append(sign * part.ravel())
        count += len(held)
    if not count:
        return lambda v: v
    b = sparse.coo_matrix((np.concatenate(numbers), (np.concatenate(rows), np.concatenate(columns))), shape=(count, len(scale))).tocsr()
    b = b @ sparse.diags(scale)
    solve = factorized((b @ b.T + 1e-12 * sparse.eye(count)).tocsc())
    return lambda v: v - b.T @ solve(b @ v)


def _product(case):
    """The function that multiplies the second derivatives with a vector, and what it is called."""
    if case.system.n <= EXACT and case.engine.pairs <= PAIRS:
        from asemd.hessian import hessian_of
        try:
            matrix = hessian_of(case.engine.system, case.interactions, case.settings, numerical=True)
            return matrix.dot, "exact second derivatives"
        except (InputError, SimulationError):
            pass
    return _Differences(case), "differences of forces"


class _Differences:
    """Second derivatives times a vector, from forces at two displaced positions."""

    def __init__(self, case):
        self.engine = case.engine
        self.x = self.engine.system.x.copy()
        self.step = STEP * case.spacing
        self.forces = np.empty_like(self.x)

    def __call__(self, v: np.ndarray) -> np.ndarray:
        v = v.reshape(-1, 3)
        length = np.abs(v).max()
        if length == 0.0:
            return np.zeros(v.size)
        h = self.step / length
        out = np.zeros_like(v)
        for sign in (-1.0, 1.0):
            self.engine.move(self.x + sign * h * v)
            self.engine.store()
            out -= sign * self.engine.system.f
        return (out / (2.0 * h)).ravel()
