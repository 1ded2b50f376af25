"""Molecule templates: the atoms and bonds of one molecule, of which commands and fixes make copies."""
from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError
from asemd.system import LABELLED, System
from asemd.topology import Topology


@dataclass
class Molecule:
    """One molecule.

    Parameters
    ----------
    title : str
        First line of its file.
    x : (n, 3) float, optional
        Positions in the frame of the molecule.
    type : (n,) int, optional
        Atom types.
    molecule : (n,) int, optional
        Molecule numbers within the template, from 1.
    q, radius, rmass : (n,) float, optional
    mu : (n, 3) float, optional
        Dipoles.
    topology : Topology
    special : (pairs, kind), optional
        1-2, 1-3 and 1-4 pairs that the file lists.
    fragments : dict of str to (n,) bool
    shake : dict
        ``flag (n,)``, ``atoms`` and ``types`` (lists of n lists) of the SHAKE clusters, as far as the file has them.
    mass, com, inertia
        Values of the header that replace the computed ones.
    natoms : int
        Number of atoms; needed where there are no positions.
    """

    title: str = ""
    natoms: int = 0
    x: np.ndarray | None = None
    type: np.ndarray | None = None
    molecule: np.ndarray | None = None
    q: np.ndarray | None = None
    radius: np.ndarray | None = None
    rmass: np.ndarray | None = None
    mu: np.ndarray | None = None
    topology: Topology = field(default_factory=Topology)
    special: tuple[np.ndarray, np.ndarray] | None = None
    fragments: dict[str, np.ndarray] = field(default_factory=dict)
    shake: dict[str, list] = field(default_factory=dict)
    mass: float | None = None
    com: np.ndarray | None = None
    inertia: np.ndarray | None = None

    @property
    def centred(self) -> np.ndarray:
        """(n, 3) positions from the geometric centre."""
        centre = np.zeros(3)
        for row in self.x:      # one after the other: the last bit counts
            centre += row
        return self.x - centre / self.natoms

    @property
    def has_body(self) -> bool:
        """Whether the file says itself what mass or inertia the molecule has as a rigid body."""
        return any(value is not None for value in (self.rmass, self.mass, self.com, self.inertia))

    def body(self, masses: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Mass, centre of mass (3,) and moments of inertia (3, 3) about it, in the frame of the molecule.

        `masses` (n,) are those of the atoms where the file has none. What the header gives counts; the centre of mass is the sum of mass
        times position over the mass of the molecule, also if that is another one than the sum of masses, as in LAMMPS, which takes the last
        three moments of inertia in the order yz xz xy.
        """
        m = masses if self.rmass is None else self.rmass
        mass = float(m.sum()) if self.mass is None else self.mass
        com = m @ self.x / mass if self.com is None else self.com
        if self.inertia is not None:
            xx, yy, zz, yz, xz, xy = self.inertia
            return mass, com, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        d = self.x - com
        return mass, com, (m * (d * d).sum(axis=1)).sum() * np.eye(3) - np.einsum("i,ia,ib->ab", m, d, d)

    @property
    def nmolecules(self) -> int:
        """How many molecules the template has."""
        return 1 if self.molecule is None else int(self.molecule.max(initial=1))

    def largest(self, kind: str) -> int:
        """The largest type of ``atom``, ``bond``, ... in the template; 0 without any."""
        types = self.type if kind == "atom" else self.topology.items(kind)[1]
        return 0 if types is None else int(max(types, default=0))

    def check(self, system: System, what: str, offset: int = 0) -> None:
        """Make sure that copies fit into a system; `offset` is added to atom types.

        Raises
        ------
        InputError
            No positions or types, or types that the system does not have.
        """
        if self.x is None or self.type is None:
            raise InputError(f"{what}: the molecule has no {'Coords' if self.x is None else 'Types'} section")
        for kind in LABELLED:
            have, need = system.counts["ntypes" if kind == "atom" else f"n{kind}types"], self.largest(kind)
            if kind == "atom":
                need += offset
                if min(self.type) + offset < 1:
                    raise InputError(f"{what}: the molecule has atom type {min(self.type) + offset}, types count from 1")
            if need > have:
                raise InputError(f"{what}: the molecule needs {kind} type {need}, the system has {have}")

    def copies(self, x: np.ndarray, system: System, offset: int, matrices: list[np.ndarray]) -> System:
        """Atoms of copies at positions `x` (m, n, 3), like those of `system`; types are raised by `offset`, dipoles turned by `matrices`.

        Ids count from 1; molecule numbers too where `system` has molecules.
        """
        from asemd.atom_style import fresh, volume
        m, n = len(x), self.natoms
        own = fresh(system.atom_style, m * n)
        if own["q"] is not None and self.q is not None:
            own["q"] = np.tile(self.q, m)
        if "radius" in own["extra"]:
            if self.radius is not None:
                own["extra"]["radius"] = np.tile(self.radius, m)
            own["rmass"] = volume(own["extra"]["radius"]) if self.rmass is None else np.tile(self.rmass, m)
        elif own.get("rmass") is not None and self.rmass is not None:
            own["rmass"] = np.tile(self.rmass, m)
        if "mu" in own["extra"] and self.mu is not None:
            own["extra"]["mu"] = np.concatenate([turned(matrix, self.mu) for matrix in matrices] or [np.zeros((0, 3))])
        number = np.ones(n, int) if self.molecule is None else self.molecule
        molecule = (np.arange(m)[:, None] * self.nmolecules + number).ravel() if system.molecular else None
        x = x.reshape(-1, 3).copy()
        image = np.zeros((m * n, 3), np.int32)
        system.box.wrap(x, image)
        topology = self.topology.repeat(n, m) if system.molecular else Topology()
        return System(box=system.box, x=x, image=image, type=np.tile(self.type, m) + offset, molecule=molecule, units=system.units,
                      dimension=system.dimension, counts=dict(system.counts), topology=topology, **own)


def rotation(axis, angle: float) -> np.ndarray:
    """The matrix of a rotation by `angle` (radians) about a unit vector."""
    w, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    i, j, k = (c * s for c in axis)
    w2, i2, j2, k2 = w * w, i * i, j * j, k * k
    ij, ik, jk, iw, jw, kw = (2.0 * p for p in (i * j, i * k, j * k, i * w, j * w, k * w))
    return np.array([[w2 + i2 - j2 - k2, ij - kw, jw + ik], [ij + kw, w2 - i2 + j2 - k2, jk - iw], [ik - jw, jk + iw, w2 - i2 - j2 + k2]])


def turned(matrix: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) turned by a matrix; sums in a fixed order, coordinates are compared by their last bit."""
    return np.column_stack([row[0] * x[:, 0] + row[1] * x[:, 1] + row[2] * x[:, 2] for row in matrix])


def random_rotation(generator, dimension: int) -> np.ndarray:
    """A random rotation as `create_atoms mol` draws it; in two dimensions about z."""
    axis = [0.0, 0.0, 1.0]
    if dimension == 3:
        axis = [generator.uniform() - 0.5 for _ in range(3)]
        scale = 1.0 / math.sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2])
        axis = [a * scale for a in axis]
    return rotation(axis, generator.uniform() * (2.0 * math.pi))


__all__ = ["Molecule", "random_rotation", "rotation", "turned"]
