r"""How fast each bonded item vibrates by itself: from the second derivative of its energy and the masses of its atoms.

For a coordinate q with energy E(q) the frequency is :math:`\omega^2 = E''(q) \sum_i |\nabla_i q|^2 / m_i`; of several coordinates the
largest eigenvalue counts. Source: Wilson, Decius and Cross, Molecular Vibrations (1955), chapter 4.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asemd import coordinates
from asemd.kernels import curvature
from asemd.term import BondedTerm

STEP = 1e-4         # of central differences, relative to a length, or in radians
NUDGE = 1e-4        # how far straight angles are bent, where their gradient has no direction


@dataclass
class Items:
    """All items of one bonded style as they are now.

    Attributes
    ----------
    category, style : str, asemd.style.Style
    atoms : (m, k) int
        Rows.
    types : (m,) int
    q : (m, nc)
        Coordinates, angles in radians.
    slope : (m, nc)
        Derivatives of the energy; not finite outside the style's domain.
    omega : (m,)
        Frequency in 1/time of the scene; 0 where the energy does not bind.
    term : asemd.term.BondedTerm
    """

    category: str
    style: object
    atoms: np.ndarray
    types: np.ndarray
    q: np.ndarray
    slope: np.ndarray
    omega: np.ndarray
    term: BondedTerm

    def column(self, name: str) -> np.ndarray | None:
        """One coordinate (m,), None if the style does not have it."""
        names = self.style.coordinates
        return self.q[:, names.index(name)] if name in names else None

    def rest(self, kind: int) -> float:
        """Rest length or rest angle in degrees of a type; nan without one."""
        return rest_of(self.term, kind)

    def slopes(self, q: np.ndarray, types: np.ndarray) -> np.ndarray:
        """Derivatives (m, nc) at other coordinates of items of these types."""
        return slopes(self.term, q, types)


def rest_of(term: BondedTerm, kind: int) -> float:
    """Rest length or rest angle in degrees of a type; nan without one."""
    coeff = term.use.coeff.get(kind)
    return term.style.rest_value(coeff) if coeff else float("nan")


def slopes(term: BondedTerm, q: np.ndarray, types: np.ndarray) -> np.ndarray:
    """Derivatives (m, nc) of the energy at coordinates (m, nc)."""
    types, out = np.ascontiguousarray(types, np.int32), np.zeros((len(q), q.shape[1]))
    loop = curvature.of_style(term.style, None)
    empty = np.zeros(0)
    loop(np.ascontiguousarray(q, float), types, types, empty, term.packed.coeff, empty, term.packed.arrays, out, np.zeros((0, 0, 0)))
    return out


def items_of(case) -> list[Items]:
    """The items of every bonded style that is a function of the positions."""
    out = []
    for term in case.engine.terms:
        if isinstance(term, BondedTerm) and not {"gamma", "rate", "reference"} & set(term.style.coordinates):
            out.append(_items(case, term))
    return out


def _items(case, term: BondedTerm) -> Items:
    style, atoms, x = term.style, term.items, case.system.x
    v = np.stack([case.system.box.minimum_image(x[atoms[:, i]] - x[atoms[:, j]])[0] for i, j in coordinates.pairs_of(style)], axis=1)
    with np.errstate(all="ignore"):
        q = coordinates.values(style, v)
        slope, second = slopes(term, q, term.types), _second(term, q if case.settled else _at_rest(term, q))
        stiffness = _products(case, style, atoms, v) @ second
        if stiffness.shape[1] == 1:
            square = stiffness[:, 0, 0]
        else:
            usable = np.isfinite(stiffness).all(axis=(1, 2))
            square = np.full(len(q), np.nan)
            square[usable] = np.linalg.eigvals(stiffness[usable]).real.max(axis=1)
        omega = np.sqrt(np.maximum(np.nan_to_num(square, nan=0.0, posinf=0.0) * case.units.ftm2v, 0.0))
    return Items(term.category, style, atoms, term.types, q, slope, omega, term)


def _at_rest(term: BondedTerm, q: np.ndarray) -> np.ndarray:
    """Coordinates with bonds at their rest lengths: what a run gets to, where these positions are not its own."""
    if term.style.coordinates != ("r",):
        return q
    kinds, which = np.unique(term.types, return_inverse=True)
    rest = np.array([rest_of(term, int(t)) for t in kinds])[which.ravel()]
    return np.where(np.isfinite(rest) & (rest > 0.0), rest, q[:, 0])[:, None]


def _second(term: BondedTerm, q: np.ndarray) -> np.ndarray:
    """Second derivatives (m, nc, nc) by central differences: a few digits are enough here."""
    nc = q.shape[1]
    out = np.zeros((len(q), nc, nc))
    for a, name in enumerate(term.style.coordinates):
        angle = name in ("theta", "phi", "chi", "theta1", "theta2", "gamma")
        h = np.full(len(q), STEP) if angle else STEP * np.maximum(np.abs(q[:, a]), 1e-3)
        near = []
        for sign in (-1.0, 1.0):
            moved = q.copy()
            moved[:, a] += sign * h
            near.append(slopes(term, moved, term.types))
        out[:, a] = (near[1] - near[0]) / (2.0 * h[:, None])
    return 0.5 * (out + out.transpose(0, 2, 1))


def _products(case, style, atoms: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Sums over atoms (m, nc, nc) of the products of gradients of two coordinates, divided by the mass."""
    pairs, k = coordinates.pairs_of(style), atoms.shape[1]
    if style.coordinates[0] == "ax":
        g = np.broadcast_to(np.eye(3 * len(pairs)).reshape(1, -1, len(pairs), 3), (len(v), 3 * len(pairs), len(pairs), 3))
    else:
        g = coordinates.gradients(style, v)
        lost = ~np.isfinite(g).all(axis=(1, 2, 3))
        if lost.any():
            bent = v[lost] + NUDGE * np.abs(v[lost]).max(axis=(1, 2), keepdims=True) * np.array([0.3, -0.5, 0.8])[None, None] * (
                np.arange(len(pairs))[None, :, None] - 0.5)
            g[lost] = coordinates.gradients(style, bent)
    turn = np.zeros((len(pairs), k))
    for row, (i, j) in enumerate(pairs):
        turn[row, i], turn[row, j] = 1.0, -1.0
    by_atom = np.einsum("mapx,pi->maix", g.reshape(len(v), -1, len(pairs), 3), turn, optimize=True)
    return np.einsum("maix,mbix,mi->mab", by_atom, by_atom, 1.0 / case.masses[atoms], optimize=True)
