"""What fixes mean without dynamics: constant added forces and correction maps have an energy, forces set to zero are constraints."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from asemd.box import Box
from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix.addforce import AddForce
from asemd.fix.cmap import CMAP
from asemd.fix.setforce import SetForce
from asemd.kernels import correction_map
from asemd.kernels.state import cell_arrays
from asemd.result import COMPONENTS
from asemd.topology import CROSSTERM, Topology


@dataclass(frozen=True)
class Load:
    """A constant force on each atom of a group: E = -f . r with unwrapped positions.

    Parameters
    ----------
    group : str
    force : (float, float, float)
        In force units of the scene.
    """

    group: str
    force: tuple[float, float, float]
    in_virial = False       # whether the fix counts in the virial of a run

    def fix(self, group: str) -> Fix:
        """The fix that does the same in a run."""
        return AddForce(group, self.force)

    def act(self, x: np.ndarray, mask: np.ndarray, box: Box, topology: Topology) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies (n,), forces (n, 3) and virials (n, 6; xx yy zz xy xz yz) of atoms at unwrapped positions `x (n, 3)`."""
        f = np.where(mask[:, None], np.array(self.force, float), 0.0)
        w = np.stack([0.5 * (f[:, a] * x[:, b] + f[:, b] * x[:, a]) for a, b in COMPONENTS], axis=1)
        return -(f * x).sum(axis=1), f, w

    def __str__(self) -> str:
        return f"addforce {self.force[0]:g} {self.force[1]:g} {self.force[2]:g} on group {self.group}"


@dataclass(frozen=True, eq=False)
class Maps:
    """Correction maps (m, 24, 24) for the cross terms of the atoms, see `asemd.fix.CMAP`.

    Parameters
    ----------
    maps : (m, 24, 24) array
        In energy units of the scene.
    """

    maps: np.ndarray
    group = "all"
    in_virial = True

    def fix(self, group: str) -> Fix:
        """The fix that does the same in a run."""
        return CMAP(self.maps, group)

    def items(self, x: np.ndarray, box: Box, topology: Topology, only: slice = slice(None)) -> tuple[np.ndarray, np.ndarray]:
        """Atoms (m, 5) of some cross terms and their energies, virials and forces (m, 22)."""
        items, types = (np.ascontiguousarray(a[only], np.int32) for a in topology.items(CROSSTERM))
        wrong = types[(types < 1) | (types > len(self.maps))]
        if len(wrong):
            raise InputError(f"a cross term has correction map {wrong[0]}, there are {len(self.maps)}")
        out = np.zeros((len(items), correction_map.OUT))
        correction_map.evaluator()(np.ascontiguousarray(x.T), np.arange(len(x), dtype=np.int32), cell_arrays(box.cell, box.periodic), items,
                                   types, correction_map.with_slopes(self.maps), out, np.zeros((2, 4, 3)), 0, len(items))
        return items, out

    def act(self, x: np.ndarray, mask: np.ndarray, box: Box, topology: Topology) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `Load.act`; the five atoms of a cross term have equal shares of energy and virial."""
        items, out = self.items(x, box, topology)
        shares, forces = np.zeros((len(x), 7)), np.zeros((len(x), 3))
        for k, atoms in enumerate(items.T):
            np.add.at(shares, atoms, 0.2 * out[:, :7])
            np.add.at(forces, atoms, out[:, 7 + 3 * k:10 + 3 * k])
        return shares[:, 0], forces, shares[:, 1:]

    def __str__(self) -> str:
        return f"cmap with {len(self.maps)} maps"


def _named(fix: Fix) -> str:
    return f"fix {fix.id} ({fix.style})" if fix.id else f"fix {fix.style}"


def loads_of(fixes: Iterable[Fix]) -> tuple[list[Load | Maps], list[str]]:
    """Constant forces and correction maps that fixes add, and the names of those whose forces are not the gradient of an energy."""
    loads, left_out = [], []
    for fix in fixes:
        if isinstance(fix, AddForce):
            if fix.region is not None or fix.add_every > 1 or any(callable(f) for f in fix.force):
                left_out.append(f"{_named(fix)} with a force that is not constant")
            else:
                loads.append(Load(fix.group, tuple(float(f) for f in fix.force)))
        elif isinstance(fix, CMAP):
            loads.append(Maps(fix.maps))
    return loads, left_out


def together(loads: Iterable[Load | Maps], atoms, unit: float, mask: Callable, topology: Topology) -> tuple[np.ndarray, ...]:
    """What loads do to ``ase.Atoms``, in the units of the force field.

    Parameters
    ----------
    unit : float
        The unit of length, in Angstrom.
    mask : callable
        ``mask(atoms, group)``: (n,) bool.

    Returns
    -------
    energies (n,), forces (n, 3), virials (n, 6) by atom; virial (6,) of those whose fixes count in the virial of a run
    """
    x = (atoms.positions + (atoms.arrays["image"] @ atoms.cell.array if "image" in atoms.arrays else 0.0)) / unit
    box = Box.from_ase(atoms.cell.array / unit, atoms.pbc, np.ravel(atoms.get_celldisp()) / unit, x)
    energies, forces, virials, counted = np.zeros(len(x)), np.zeros((len(x), 3)), np.zeros((len(x), 6)), np.zeros(6)
    for load in loads:
        e, f, w = load.act(x, mask(atoms, load.group), box, topology)
        energies, forces, virials = energies + e, forces + f, virials + w
        counted += load.in_virial * w.sum(axis=0)
    return energies, forces, virials, counted


def constraints_of(fixes: Iterable[Fix], groups: Mapping[str, np.ndarray]) -> tuple[list, list[str]]:
    """ASE constraints for fixes that set forces to zero, and the names of those that set them to something else."""
    out, left_out = [], []
    for fix in fixes:
        if isinstance(fix, SetForce):
            from ase.constraints import FixAtoms, FixCartesian  # a quarter of a second that most scenes need not wait
            if fix.region is not None or any(f is not None and (callable(f) or f != 0.0) for f in fix.force):
                left_out.append(f"{_named(fix)} with a force that is not zero everywhere in its group")
                continue
            index, held = np.flatnonzero(groups[fix.group]), tuple(f is not None for f in fix.force)
            if len(index) and any(held):
                out.append(FixAtoms(index) if all(held) else FixCartesian(index, held))
    return out, left_out
