"""Sums over pieces of a system: the atoms of a group, of each chunk, of each molecule; positions are unwrapped."""
from __future__ import annotations

from functools import cached_property

import numpy as np

from asemd.compute._original import unwrapped
from asemd.kernels import observe

NOTHING = np.zeros(0, np.int32)
SINGULAR = 1e-6     # determinants and relative moments of inertia below: about that axis nothing turns


class Pieces:
    """Masses, momenta and moments of numbered pieces.

    Parameters
    ----------
    system : asemd.system.System
    index : (n,) int array
        The piece of each atom from 1 on, 0 for none; or (n,) bool, the atoms of the only piece.
    count : int
        How many pieces there are.
    """

    def __init__(self, system, index: np.ndarray, count: int = 1):
        self.system, self.count = system, count
        self._index, self._whole = np.asarray(index), np.count_nonzero(index) == len(index)

    @cached_property
    def at(self) -> np.ndarray:
        """(m,) the piece of each of the atoms `rows`, from 0."""
        return self._mine(self._index).astype(np.int64, copy=False) - 1

    @cached_property
    def m(self) -> np.ndarray:
        """(m,) their masses."""
        return self._mine(self.system.atom_masses())

    @cached_property
    def rows(self) -> np.ndarray:
        """(m,) the atoms of all pieces."""
        return np.flatnonzero(self._index)

    def _mine(self, values: np.ndarray) -> np.ndarray:
        """Those of the atoms `rows`."""
        return values if self._whole else values[self.rows]

    def sum(self, values: np.ndarray) -> np.ndarray:
        """(m,) or (m, k) values of the atoms `rows`, added up for each piece."""
        out = np.zeros((self.count, *values.shape[1:]))
        (observe.total if values.ndim == 1 else observe.totals)(self.at, np.ascontiguousarray(values, float), out)
        return out

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Averages (count, 3) of vectors weighted by mass; 0 for pieces without atoms."""
        out = np.zeros((self.count, 3))
        observe.weighted(self.at, self.m, np.ascontiguousarray(values), out)
        return self._by_mass(out)

    def _by_mass(self, sums: np.ndarray) -> np.ndarray:
        """Sums of each piece divided by its mass."""
        mass = self.mass.reshape(-1, *(1,) * (sums.ndim - 1))
        return np.divide(sums, mass, out=np.zeros_like(sums), where=mass > 0.0)

    @cached_property
    def mass(self) -> np.ndarray:
        return self.sum(self.m)

    @cached_property
    def atoms(self) -> np.ndarray:
        """How many atoms each piece has."""
        return np.bincount(self.at, minlength=self.count)

    @cached_property
    def x(self) -> np.ndarray:
        return self._mine(unwrapped(self.system))

    @property
    def v(self) -> np.ndarray:
        return self._mine(self.system.v)

    @property
    def _atoms(self) -> tuple[np.ndarray, ...]:
        """Pieces, masses, and places of all atoms, for compiled sums."""
        s = self.system
        masses = (s.rmass, NOTHING) if s.rmass is not None else (s.mass, s.type)
        return self._index, *masses, s.x, s.image, s.box.cell

    @cached_property
    def com(self) -> np.ndarray:
        """(count, 3) centres of mass."""
        mass, out = np.zeros(self.count), np.zeros((self.count, 3))
        observe.centres(*self._atoms, mass, out)
        self.mass = mass
        return out

    @cached_property
    def vcm(self) -> np.ndarray:
        return self.mean(self.v)

    @cached_property
    def d(self) -> np.ndarray:
        """(m, 3) from the centre of mass of its piece to each atom."""
        return self.x - self.com[self.at]

    def gyration(self) -> np.ndarray:
        """(count, 3, 3) tensors of the squared radius of gyration."""
        out = np.zeros((self.count, 3, 3))
        observe.moments(*self._atoms, self.com, out)
        return self._by_mass(out)

    def inertia(self) -> np.ndarray:
        """(count, 3, 3) tensors of inertia."""
        d = self.d
        own = (d * d).sum(axis=1)[:, None, None] * np.eye(3) - d[:, :, None] * d[:, None, :]
        return self.sum(self.m[:, None] * own.reshape(-1, 9)).reshape(-1, 3, 3)

    def angular_momentum(self) -> np.ndarray:
        """(count, 3) about the centre of mass."""
        return self.sum(self.m[:, None] * np.cross(self.d, self.v))

    def torque(self) -> np.ndarray:
        return self.sum(np.cross(self.d, self._mine(self.system.f)))

    def omega(self) -> np.ndarray:
        """(count, 3) angular velocities; zero about axes without inertia."""
        inertia, momentum = self.inertia(), self.angular_momentum()
        out = np.zeros((self.count, 3))
        solid = (np.linalg.det(inertia) > SINGULAR) & (self.atoms > 1)
        out[solid] = np.linalg.solve(inertia[solid], momentum[solid][:, :, None])[:, :, 0]
        for k in np.flatnonzero(~solid & (self.atoms > 1)):
            moments, axes = np.linalg.eigh(inertia[k])
            turns = moments > SINGULAR * moments.max(initial=0.0)
            out[k] = axes[:, turns] @ (momentum[k] @ axes[:, turns] / moments[turns])
        return out


def shape(tensors: np.ndarray) -> np.ndarray:
    """(n, 6) of (n, 3, 3) gyration tensors: eigenvalues, largest first, asphericity, acylindricity, relative shape anisotropy."""
    a, b, c = np.linalg.eigvalsh(tensors)[:, ::-1].T
    trace = a + b + c
    with np.errstate(invalid="ignore"):     # nan for a piece that is a point
        anisotropy = 1.5 * (a * a + b * b + c * c) / (trace * trace) - 0.5
    return np.column_stack([a, b, c, a - 0.5 * (b + c), b - c, anisotropy])
