r"""Stress across planes, by what goes through them: the method of planes.

.. math:: P_{b d} = \frac{1}{A} \Big[ \sum_{items} \sum_{i \text{ above}} F_{i b}^{item}
          + \frac{1}{\Delta t} \sum_{crossing} \pm m_i v_{i b}(t - \Delta t / 2) \Big]

for a plane normal to d: of each pair, bond, angle or dihedral with atoms on both sides the forces on those above count; atoms that passed
the plane during the last step count with their momentum.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute import Compute
from asemd.compute._items import evaluate_all
from asemd.compute._pairs import force_cutoff, half, interactions
from asemd.errors import InputError, nearest
from asemd.words import choice, number

PARTS = {"kin": ("kin",), "pair": ("pair",), "bond": ("bond",), "angle": ("angle",), "dihedral": ("dihedral",),
         "conf": ("pair", "bond", "angle", "dihedral"), "total": ("kin", "pair", "bond", "angle", "dihedral")}
ORIGINS = ("lower", "center", "upper")


class Planes(Compute):
    """Base class.

    Parameters
    ----------
    group : str
        Its atoms count, pairs with one or two of them, and bonds, angles and dihedrals all of whose atoms are in it.
    axis : str
        Normal of the planes: ``x``, ``y`` or ``z``.
    origin : float or str
        Place of a plane, distance units, or ``lower``, ``center``, ``upper`` of the box.
    terms : sequence of str
        Some of total conf kin pair bond angle dihedral; three numbers each.

    Raises
    ------
    InputError
        Words that are not among these, none of them; when it is evaluated: a box that is tilted, flat, or changes during a run.
    """

    def __init__(self, group: str = "all", axis: str = "z", origin: float | str = "center", terms=("total",)):
        super().__init__(group)
        self.axis = "xyz".index(choice(axis, ("x", "y", "z"), f"compute {self.style} direction"))
        if not terms:
            raise InputError(f"compute {self.style} needs at least one of {' '.join(PARTS)}")
        for word in terms:
            if word not in PARTS:
                raise InputError(f"compute {self.style}: unknown keyword {word!r}{nearest(word, PARTS)}")
        self.origin, self.terms, self.places = origin, tuple(terms), None

    @classmethod
    def read_origin(cls, word: str) -> float | str:
        return word if word in ORIGINS else number(word, f"compute {cls.style} position")

    def at(self, box) -> float:
        """The place of the plane that `origin` names."""
        low, high = float(box.lo[self.axis]), float(box.hi[self.axis])
        return {"lower": low, "center": 0.5 * (low + high), "upper": high}[self.origin] if isinstance(self.origin, str) else self.origin

    def planes(self, box) -> np.ndarray:
        """Places of the planes in this box."""
        raise NotImplementedError

    def setup(self, state) -> None:
        what, box = f"compute {self.style}", state.system.box
        if state.system.dimension != 3:
            raise InputError(f"{what} needs three dimensions")
        if box.triclinic or not box.is_lammps_frame:
            raise InputError(f"{what} is incompatible with triclinic simulation box: it needs a box along the axes")
        if state.engine is not None and state.engine.box_moves:
            raise InputError(f"{what} requires a fixed simulation box geometry, without fixes that change it")
        if self.places is None:
            self.places = self.planes(box)

    def stresses(self, state) -> np.ndarray:
        """(planes, 3 x terms) in pressure units."""
        self.setup(state)
        needed = {part for term in self.terms for part in PARTS[term]}
        box, u = state.system.box, state.units
        length = box.lengths
        area = float(np.prod(np.delete(length, self.axis)))
        of = {part: self._through(state, *self._kinetic(state) if part == "kin" else self._items(state, part)) for part in needed}
        per = {part: u.nktv2p / area / (state.dt * u.ftm2v if part == "kin" else 1.0) for part in needed}
        return np.concatenate([sum(of[part] * per[part] for part in PARTS[term]) for term in self.terms], axis=1)

    def _through(self, state, place: np.ndarray, force: np.ndarray) -> np.ndarray:
        """(planes, 3) sum of `force` (m, 3) over the places (m,) above each plane or its images; the forces of each item add up to zero."""
        box, planes = state.system.box, self.places
        n, shifts = len(planes), np.zeros(1)
        out = np.zeros((n, 3))
        if not len(place):
            return out
        if box.periodic[self.axis]:
            length = float(box.lengths[self.axis])
            first, last = math.floor((place.min() - planes.max()) / length), math.ceil((place.max() - planes.min()) / length)
            shifts = np.arange(first, last + 1) * length
        every = (planes + shifts[:, None]).ravel()
        order = np.argsort(every, kind="stable")
        below = np.searchsorted(every[order], place)        # how many planes lie below each place
        for d in range(3):
            added = np.bincount(below, force[:, d], len(every) + 1)
            above = np.cumsum(added[::-1])[::-1][1:]
            out[:, d] = np.bincount(order % n, above, n)
        return out

    def _kinetic(self, state) -> tuple[np.ndarray, np.ndarray]:
        """Momenta of atoms where they are, minus the same where they were a step ago."""
        system, dt = state.system, state.dt
        mask = state.mask(self.group)
        mass = system.atom_masses()[mask][:, None]
        half_kick = 0.5 / mass * dt * state.units.ftm2v * system.f[mask]
        x, v = system.x[mask][:, self.axis], system.v[mask] - half_kick
        before = x - v[:, self.axis] * dt
        moved = before != x
        p = mass * v
        return np.concatenate([x[moved], before[moved]]), np.concatenate([p[moved], -p[moved]])

    def _items(self, state, part: str) -> tuple[np.ndarray, np.ndarray]:
        """Places along the axis, and forces, of the atoms of all items of a kind."""
        system, engine, mask = state.system, state.engine, state.mask(self.group)
        if engine is None:
            raise InputError(f"compute {self.style}: forces are not known before the first run")
        if part == "pair":
            if not engine.interactions.uses["pair"]:
                return np.zeros(0), np.zeros((0, 3))
            pairs = half(state, force_cutoff(state, f"compute {self.style}"))
            pairs = pairs.take(mask[pairs.i] | mask[pairs.j])
            force = interactions(state, pairs)[1]
            z = system.x[pairs.i, self.axis]
            return np.concatenate([z, z - pairs.d[:, self.axis]]), np.concatenate([force, -force])
        atoms, types = system.topology.items(part)
        keep = mask[atoms].all(axis=1) & (types > 0)
        atoms, types = atoms[keep], types[keep]
        force = evaluate_all(system, engine.interactions, part, atoms, types, state.units)[1]
        z = [system.x[atoms[:, 0], self.axis]]
        for a, b in zip(atoms.T[:-1], atoms.T[1:]):
            z.append(z[-1] + system.box.minimum_image(system.x[b] - system.x[a])[0][:, self.axis])
        return np.concatenate(z), np.concatenate(list(np.moveaxis(force, 1, 0)))


__all__ = ["Planes"]
