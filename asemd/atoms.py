"""``ase.Atoms`` that know their bonds: copying, slicing, deleting, repeating and joining keep the topology right."""
from __future__ import annotations

import numbers as abstract
from collections.abc import Mapping

import ase
import numpy as np
from ase.data import atomic_masses_iupac2016, chemical_symbols
from ase.data import atomic_numbers as number_of

from asemd import atoms_info
from asemd.atoms_info import holds
from asemd.box import Box
from asemd.togetherness import cells_of_molecules
from asemd.topology import Topology

CLOSE = 0.1        # how far a mass may be from that of its element, in amu
COMMON_UP_TO = 92  # elements beyond uranium are not guessed from masses
OF_ASE = ("numbers", "positions", "momenta", "masses", "tags", "initial_magmoms", "initial_charges")

__all__ = ["Atoms", "elements", "holds"]


class Atoms(ase.Atoms):
    """`ase.Atoms` with a `topology`.

    `info` holds the topology, atom types and molecules too (entries that begin with ``asemd_``), so that ASE's extxyz files and
    trajectories keep them: ``asemd.Atoms(ase.io.read("x.traj"))`` has its bonds again, and a `ForceField` finds them in plain
    `ase.Atoms` as well.

    Parameters
    ----------
    *args, **kwargs
        As for `ase.Atoms`.
    topology : Topology, optional
        Bonded items by atom index; by default those of the atoms that are copied or that their `info` holds, or none. Other arrays of
        atoms that are copied (``mol-id``, ``radius`` ...) are copied, too.

    Raises
    ------
    InputError
        The bonds in `info` belong to other atoms: plain `ase.Atoms` were sliced after they were read.
    """

    def __init__(self, *args, topology: Topology | None = None, **kwargs):
        source = args[0] if args else kwargs.get("symbols")
        if topology is None:
            topology = getattr(source, "topology", None)
        self.topology = Topology()
        super().__init__(*args, **kwargs)
        if topology is None and len(self):
            topology, arrays = atoms_info.found(self._info, self.numbers)
            for name, array in arrays.items():
                if name not in self.arrays:
                    self.set_array(name, array)
        if isinstance(source, ase.Atoms):       # ASE takes over the arrays that it knows
            for name, array in source.arrays.items():
                if name not in (*self.arrays, *OF_ASE):
                    self.set_array(name, array)
        self.topology = Topology() if topology is None else topology.copy()

    @property
    def info(self) -> dict:
        """ASE's dictionary for anything, the topology among it."""
        atoms_info.drop(self._info)
        if hasattr(self, "arrays"):
            self._info.update(atoms_info.entries(self.topology, self.arrays))
        return self._info

    @info.setter
    def info(self, value: dict) -> None:
        self._info = value

    def copy(self) -> Atoms:
        """A copy without calculator."""
        atoms = super().copy()
        atoms.topology = self.topology.copy()
        return atoms

    def __getitem__(self, i):
        picked = super().__getitem__(i)
        if not isinstance(i, abstract.Integral):
            picked.topology = self.topology.select(_index(i), len(self))
        return picked

    def __delitem__(self, i):
        n = len(self)
        keep = np.ones(n, bool)
        keep[_index(i)] = False
        super().__delitem__(i)
        self.topology = self.topology.select(keep, n)

    def extend(self, other):
        """Append atoms; ids and molecule ids of `other` are raised by the largest ones here."""
        n = len(self)
        if isinstance(other, ase.Atom):
            other = self.__class__([other])
        raised = {name: int(self.arrays[name].max(initial=0)) for name in ("id", "mol-id") if name in self.arrays}
        result = super().extend(other)
        for name, most in raised.items():
            tail = self.arrays[name][n:]
            if name not in other.arrays:
                tail[:] = np.arange(1, len(tail) + 1) if name == "id" else 0
            tail[:] = np.where((tail > 0) | (name == "id"), tail + most, 0)
        top = getattr(other, "topology", None)
        if top is not None:
            self.topology = self.topology.concatenate(top.shift(n))
        return result

    def __imul__(self, m):
        times = (m, m, m) if isinstance(m, abstract.Integral) else tuple(m)
        n, copies, number = len(self), int(np.prod(times)), None
        if not self.topology.is_empty:
            box = Box.from_ase(np.asarray(self.cell), self.pbc, np.ravel(self.get_celldisp()), self.positions)
            top = self.topology.repeat_periodic(n, times, box, self.positions)
            cells = cells_of_molecules(self.topology, n, box, self.positions)
            if cells.any():     # ids and molecule ids of one molecule stay together
                if "id" not in self.arrays:
                    self.set_array("id", np.arange(1, n + 1))
                copy = (np.stack(np.unravel_index(np.arange(copies), times), axis=-1)[:, None] - cells) % times
                number = np.ravel((copy[..., 0] * times[1] + copy[..., 1]) * times[2] + copy[..., 2])
        else:
            top = self.topology
        largest = {name: int(self.arrays[name].max(initial=0)) for name in ("id", "mol-id") if name in self.arrays}
        super().__imul__(times)
        number = np.repeat(np.arange(copies), n) if number is None else number
        for name, most in largest.items():
            self.arrays[name] = self.arrays[name] + number * most
        if "image" in self.arrays:       # flags of the old cell mean nothing in the new one
            self.arrays["image"] = np.zeros_like(self.arrays["image"])
        self.topology = top
        return self


def _index(i):
    """Lists as arrays, so that lists of bools are masks."""
    return np.array(i, int if len(i) == 0 else None) if isinstance(i, (list, tuple)) else i


def elements(types: np.ndarray, masses: np.ndarray, labels: Mapping[int, str], guess: bool = True) -> np.ndarray:
    """Atomic numbers: from type labels that are symbols, else the element with the nearest mass, else 0 (X).

    Parameters
    ----------
    types : (n,) int
    masses : (n,) float
        In amu; nan where unknown.
    labels : mapping
        Type -> label. A label that is a symbol counts unless the mass says another element (``CA`` is not calcium at 12.01).
    guess : bool
        Whether masses may be used at all (not in reduced units).

    Returns
    -------
    (n,) int
    """
    known = np.array(atomic_masses_iupac2016[:COMMON_UP_TO + 1])
    known[0] = -1e9
    out = np.zeros(len(types), int)
    pairs, inverse = np.unique(np.column_stack([types, np.nan_to_num(masses, nan=-1.0)]), axis=0, return_inverse=True)
    for row, (t, m) in enumerate(pairs):
        nearest = int(np.argmin(np.abs(known - m))) if guess else 0
        if abs(known[nearest] - m) > CLOSE:
            nearest = 0
        label = labels.get(int(t), "")
        named = number_of[label] if label in chemical_symbols else 0
        out[np.ravel(inverse) == row] = named if named and nearest in (0, named) else nearest
    return out
