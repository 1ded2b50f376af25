"""Lennard-Jones and Coulomb forces summed over all pairs and all images with numpy: slow, short, and nothing in common with the kernels;
and the systems that engines are compared on."""
from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from asemd import engine as engines
from asemd.box import Box
from asemd.engine import Engine, Settings
from asemd.forcefield import Interactions
from asemd.system import System

EPSILON = np.array([[0, 0, 0, 0], [0, 1.0, 0.7, 0.4], [0, 0.7, 0.9, 0.5], [0, 0.4, 0.5, 1.2]])
SIGMA = np.array([[0, 0, 0, 0], [0, 1.0, 0.95, 0.9], [0, 0.95, 0.9, 0.85], [0, 0.9, 0.85, 1.1]])
CUT = np.array([[0, 0, 0, 0], [0, 1.5, 1.23, 1.41], [0, 1.23, 1.37, 1.64], [0, 1.41, 1.64, 1.17]])
COULOMB = 1.73
PAIRS = {"lj/cut/coul/cut 1.5 1.73": {(i, j): (EPSILON[i, j], SIGMA[i, j], CUT[i, j], COULOMB) for i in (1, 2, 3) for j in range(i, 4)}}
ROTATION = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]

CELLS = {
    "orthogonal": np.diag([5.0, 6.0, 7.0]),
    "triclinic": np.array([[6.0, 0, 0], [2, 6, 0], [1, -2, 6]]),
    "strongly tilted": np.array([[5.0, 0, 0], [4.9, 6, 0], [9, 11, 8]]),
    "most negative tilt": np.array([[6.0, 0, 0], [-2.9, 6, 0], [-3, -2.9, 6]]),
    "left-handed": np.array([[6.0, 0, 0], [1, 6, 0], [1, 2, -6]]),
    "rotated": np.array([[6.0, 0, 0], [2, 6, 0], [1, -2, 6]]) @ ROTATION,
    "negative diagonal": np.diag([-5.0, 6.0, -7.0]),
    "permuted axes": np.array([[0, 5.0, 0], [0, 0, 6], [7, 0, 0]]),
    "flat": np.array([[8.0, 0, 0], [0, 8, 0], [0, 0, 1.2]]),
    "tiny": np.diag([1.2, 1.31, 1.1]),
    "tiny and tilted": np.array([[1.2, 0, 0], [0.5, 1.1, 0], [-0.4, 0.7, 1.3]]),
}
PERIODIC = list(itertools.product((False, True), repeat=3))


@dataclass
class Sum:
    """Energies, forces, virial (xx yy zz xy xz yz), and each atom's half share of them."""

    lj: float
    coul: float
    forces: np.ndarray
    energies: np.ndarray
    virials: np.ndarray

    @property
    def virial(self) -> np.ndarray:
        return self.virials.sum(0)


def images(cell: np.ndarray, periodic, reach: float) -> np.ndarray:
    """All lattice vectors that can bring two atoms of one cell within `reach`."""
    widths = 1.0 / np.linalg.norm(np.linalg.inv(cell), axis=0)
    counts = [int(reach / w) + 2 if p else 0 for w, p in zip(widths, periodic)]
    return np.array(list(itertools.product(*(range(-c, c + 1) for c in counts))), float) @ cell


def pairs(x, cell, periodic, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All pairs closer than `reach`, each once, over all images: i <= j, and the vector from j to i, in no order.

    Atoms may stand anywhere. Of an atom and its own image, the vector whose image comes first is kept.
    """
    x, cell, periodic = np.asarray(x, float).reshape(-1, 3), np.asarray(cell, float), np.asarray(periodic, bool)
    inverse = np.linalg.inv(cell)
    base = np.where(periodic, np.floor(x @ inverse), 0.0) @ cell      # so that images are few
    shifts, y, found = images(cell, periodic, reach), x - base, ([], [], [])
    square = (y * y).sum(axis=1)
    for number, shift in enumerate(shifts):
        z = y + shift
        rough = square[:, None] + (z * z).sum(axis=1)[None] - 2.0 * y @ z.T
        slack = 1e-9 * (square.max(initial=0.0) + (z * z).sum(axis=1).max(initial=0.0))
        i, j = np.nonzero(rough < reach * reach + slack)
        keep = (i < j) | ((i == j) & (number < len(shifts) // 2))
        d = y[i[keep]] - z[j[keep]]
        near = (d * d).sum(axis=1) < reach * reach
        for out, values in zip(found, (i[keep][near], j[keep][near], d[near])):
            out.append(values)
    return np.concatenate(found[0]), np.concatenate(found[1]), np.concatenate(found[2])


def lj_coul(x, cell, periodic, type_, q, epsilon, sigma, cut, cut_coul=0.0, qqr2e=1.0, special=None, excluded=None) -> Sum:
    """The sum.

    Parameters
    ----------
    epsilon, sigma, cut : (ntypes + 1, ntypes + 1)
    special : mapping, optional
        (i, j), i < j -> (weight of lj, weight of coul), for the closest image of the pair.
    excluded : (n, n) bool, optional
        Pairs that do not interact, in any image.
    """
    n = len(x)
    cell, x, periodic = np.asarray(cell, float), np.array(x, float), np.asarray(periodic, bool)
    inverse = np.linalg.inv(cell)
    shifts = images(cell, periodic, max(float(np.max(cut)), cut_coul))
    total = Sum(0.0, 0.0, np.zeros((n, 3)), np.zeros(n), np.zeros((n, 6)))
    for i in range(n):
        j = np.arange(i, n)
        if excluded is not None:
            j = j[~excluded[i, i:]]
        d = x[i] - x[j]
        d -= np.where(periodic, np.floor(d @ inverse), 0.0) @ cell
        d = d[:, None] - shifts
        r2 = (d * d).sum(2)
        share = np.where(j == i, 0.5, 1.0)[:, None] * np.ones(len(shifts))        # every self image is met twice
        wl, wc = share.copy(), share.copy()
        for k, partner in enumerate(j.tolist()):
            if special and (i, partner) in special:
                near = int(np.argmin(r2[k]))
                wl[k, near], wc[k, near] = special[i, partner]
        ti, tj = type_[i], type_[j]
        apart = (j != i)[:, None] | (r2 > 0.0)
        inside, near = apart & (r2 < cut[ti, tj][:, None] ** 2), apart & (r2 < cut_coul**2)
        k, image = np.nonzero(inside | near)
        j, tj = j[k], tj[k]
        d, r2, wl, wc, inside, near = (a[k, image] for a in (d, r2, wl, wc, inside, near))
        e, s6 = epsilon[ti, tj], (sigma[ti, tj] ** 2 / r2) ** 3
        el = np.where(inside, wl * 4 * e * (s6 * s6 - s6), 0.0)
        fl = np.where(inside, wl * 24 * e * (2 * s6 * s6 - s6) / r2, 0.0)
        ec = np.where(near, wc * qqr2e * q[i] * q[j] / np.sqrt(r2), 0.0) if cut_coul else np.zeros(len(r2))
        f = (fl + ec / r2)[:, None] * d
        total.lj += el.sum()
        total.coul += ec.sum()
        total.forces[i] += f.sum(0)
        np.subtract.at(total.forces, j, f)
        v = np.stack([d[:, a] * f[:, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], 1)
        total.energies[i] += 0.5 * (el + ec).sum()
        total.virials[i] += 0.5 * v.sum(0)
        np.add.at(total.energies, j, 0.5 * (el + ec))
        np.add.at(total.virials, j, 0.5 * v)
    return total


def scattered(n: int, cell, origin, rng) -> np.ndarray:
    """`n` atoms on a jittered grid in the cell."""
    m = max(1, int(np.ceil(n ** (1 / 3))))
    grid = np.array(list(itertools.product(range(m), repeat=3)), float)[rng.permutation(m**3)[:n]]
    return (grid + 0.5 + rng.uniform(-0.2, 0.2, grid.shape)) / m @ cell + origin


def make(x, cell, periodic, rng, origin=(0, 0, 0), dimension: int = 3) -> System:
    """Charged atoms of three types in a box."""
    n = len(x)
    return System(box=Box(origin, cell, tuple("pp" if p else "ss" for p in periodic)), x=np.array(x, float).reshape(-1, 3),
                  type=rng.integers(1, 4, n), q=rng.normal(0, 1, n), units="lj", mass=np.array([np.nan, 1.0, 1.0, 1.0]),
                  counts={"ntypes": 3}, dimension=dimension)


def engine_of(system: System, mode: str, interactions: Interactions | None = None, **options) -> Engine:
    """An engine with the list asked for where the cell allows it."""
    small = engines.SMALL
    engines.SMALL = {"cluster": 0, "plain": 10**9}[mode]
    try:
        return Engine(system, interactions or Interactions.build(pair=PAIRS), Settings(**options))
    finally:
        engines.SMALL = small


def errors(system: System, mode: str, periodic=None, interactions=None, special=None, excluded=None, **options) -> tuple[Engine, float]:
    """The engine, and its largest relative error in energies, forces, virial and per-atom shares."""
    x, cell = system.x.copy(), system.box.cell.copy()
    expected = lj_coul(x, cell, system.box.periodic if periodic is None else periodic, system.type, system.q, EPSILON, SIGMA, CUT, COULOMB,
                       special=special, excluded=excluded)
    engine = engine_of(system, mode, interactions, **options)
    result = engine.per_atom(engine.compute())
    energy = max(1.0, np.abs(expected.energies).sum())
    return engine, max(
        abs(result.energy["evdwl"] - expected.lj) / energy, abs(result.energy["ecoul"] - expected.coul) / energy,
        np.abs(result.forces - expected.forces).max(initial=0.0) / max(1.0, np.abs(expected.forces).max(initial=0.0)),
        np.abs(result.virial - expected.virial).max() / max(1.0, np.abs(expected.virials).sum()),
        np.abs(result.energies - expected.energies).max(initial=0.0) / energy,
        np.abs(result.virials - expected.virials).max(initial=0.0) / max(1.0, np.abs(expected.virials).max(initial=0.0)))
