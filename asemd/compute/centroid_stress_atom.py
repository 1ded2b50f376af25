r"""Stress tensor of each atom of a group, times a volume, with forces at the centroids of what acts: nine components.

.. math:: S_{i,ab} = - m_i v_{ia} v_{ib} - \sum_n (r_{ia} - r^{(n)}_a) F^{(n)}_{ib}

with the centroid :math:`r^{(n)}` of the bond, angle, dihedral ... :math:`n` and its force on the atom. For pairs and bonds it is the same
as compute stress/atom; for angles and larger groups it is what the heat flux needs. Keywords pick terms: ke pair bond angle dihedral
improper fix, or virial for all of them but ke.

Source: LAMMPS manual, compute centroid/stress/atom; Surblys et al., Phys. Rev. E 99, 051301 (2019). Units: pressure times volume.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._items import evaluate_all
from asemd.compute.stress_atom import StressAtom
from asemd.errors import InputError

NINE = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1))      # xx yy zz xy xz yz yx zx zy


class CentroidStressAtom(StressAtom):
    """Stress per atom, by centroids.

    Parameters
    ----------
    group, temperature, terms
        As in `asemd.compute.stress_atom.StressAtom`.

    Raises
    ------
    InputError
        An unknown term; (when it is evaluated) a bonded style that is not a sum over bonds, angles ... of its own.
    """

    style = "centroid/stress/atom"

    def per_atom_columns(self) -> int:
        return 9

    def per_atom(self, state) -> np.ndarray:
        """(n, 9) xx yy zz xy xz yz yx zx zy; zero outside the group."""
        total = super()._of(state, [t for t in self.terms if t in ("ke", "pair", "bond", "fix")], 9)
        for category in ("angle", "dihedral", "improper"):
            if category in self.terms:
                total -= state.units.nktv2p * self._of_items(state, category)
        mask = state.mask(self.group)
        return total if mask.all() else np.where(mask[:, None], total, 0.0)

    def _of_items(self, state, category: str) -> np.ndarray:
        """(n, 9) virials of all items of a category."""
        system, n = state.system, state.system.n
        interactions = state.engine.interactions
        for use in interactions.uses[category]:
            if use.style.remembers or any(c in ("gamma", "rate") for c in use.style.coordinates):
                raise InputError(f"compute {self.style}: {category} style {use.style.name} is not a function of positions alone")
        atoms, types = system.topology.items(category)
        atoms, types = np.asarray(atoms)[types != 0], np.asarray(types)[types != 0]
        if not len(atoms):
            return np.zeros((n, 9))
        _, forces = evaluate_all(system, interactions, category, atoms, types, state.units)
        relative = np.zeros((len(atoms), atoms.shape[1], 3))
        for k in range(1, atoms.shape[1]):      # atom by atom along the chain, each at its image closest to the one before
            relative[:, k] = relative[:, k - 1] + system.box.minimum_image(system.x[atoms[:, k]] - system.x[atoms[:, k - 1]])[0]
        relative -= relative.mean(axis=1)[:, None]
        out = np.zeros((n, 9))
        for c, (a, b) in enumerate(NINE):
            out[:, c] = np.bincount(atoms.ravel(), (relative[:, :, a] * forces[:, :, b]).ravel(), minlength=n)
        return out
