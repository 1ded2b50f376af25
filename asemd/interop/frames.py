"""Atoms as MDAnalysis wants a frame: unwrapped, in Angstrom, ps and kJ/mol, the cell's a along x and b in the xy plane."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from ase import units
from ase.calculators.calculator import PropertyNotImplementedError

from asemd.box import Box

SPEED = 1000.0 * units.fs           # ASE's velocities -> Angstrom/ps
FORCE = units.mol / units.kJ        # eV/Angstrom -> kJ/mol/Angstrom
MARGIN = 10.0                       # Angstrom beyond twice the atoms, where MDAnalysis must not see periodic images


@dataclass
class Frame:
    """One frame in double precision.

    Parameters
    ----------
    positions : (n, 3) array
        Unwrapped by the image flags, Angstrom.
    cell : (3, 3) array or None
        Lower triangular; None without periodic directions.
    rotation : (3, 3) array
        ``positions = x @ rotation``; its transpose leads back.
    velocities, forces : (n, 3) arrays or None
        Angstrom/ps and kJ/mol/Angstrom; numbers of reduced units as they are.
    """

    positions: np.ndarray
    cell: np.ndarray | None
    rotation: np.ndarray
    velocities: np.ndarray | None
    forces: np.ndarray | None

    @property
    def dimensions(self) -> np.ndarray:
        """(6,) single precision: lengths and angles in degrees, zeros without a cell."""
        return np.zeros(6, np.float32) if self.cell is None else lengths_and_angles(self.cell).astype(np.float32)


def frame_of(atoms, reduced: bool) -> Frame:
    """The frame of atoms as they are now; forces only where the calculator has them already.

    Raises
    ------
    InputError
        A periodic direction without a cell vector.
    """
    x = unwrapped(atoms)
    cell, rotation = turned_cell(atoms.cell.array, atoms.pbc, x)
    velocities = atoms.get_velocities() @ rotation * (1.0 if reduced else SPEED) if "momenta" in atoms.arrays else None
    forces = known_forces(atoms)
    return Frame(x @ rotation, cell, rotation, velocities, None if forces is None else forces @ rotation * (1.0 if reduced else FORCE))


def unwrapped(atoms) -> np.ndarray:
    """(n, 3) positions with the image flags applied, if the atoms have any."""
    image = atoms.arrays.get("image")
    return atoms.get_positions() if image is None else atoms.positions + image.astype(float) @ atoms.cell.array


def turned_cell(cell: np.ndarray, pbc: np.ndarray, x: np.ndarray) -> tuple[np.ndarray | None, np.ndarray]:
    """The cell in MDAnalysis's orientation, and the rotation (3, 3) that takes row vectors there.

    To MDAnalysis a cell is periodic in all directions or in none. A vector that is not periodic is made so long that the nearest image of
    an atom is always the atom itself; of a left-handed cell c is turned round, which leaves the lattice, and no molecule is mirrored.
    """
    if not np.any(pbc):
        return None, np.eye(3)
    box = Box.from_ase(cell, pbc, positions=x)
    full = box.cell.copy()
    for k in np.flatnonzero(~box.periodic):
        normal = np.linalg.inv(box.cell)[:, k]
        normal = normal / np.linalg.norm(normal)
        height = abs(float(full[k] @ normal))
        needed = 2.0 * np.ptp(x @ normal) + MARGIN if len(x) else height
        full[k] *= max(1.0, needed / height)
    if np.linalg.det(full) < 0.0:
        full[2] *= -1.0
    turned, rotation = Box(np.zeros(3), full).to_lammps()
    return turned.cell, rotation


def lengths_and_angles(cell: np.ndarray) -> np.ndarray:
    """(6,): lengths of a, b, c, angles between b c, a c, a b in degrees."""
    lengths = np.linalg.norm(cell, axis=1)
    a, b, c = cell / lengths[:, None]
    return np.array([*lengths, *(np.degrees(np.arctan2(np.linalg.norm(np.cross(p, q)), p @ q)) for p, q in ((b, c), (a, c), (a, b)))])


def known_forces(atoms) -> np.ndarray | None:
    """(n, 3) eV/Angstrom if the calculator has them for the atoms as they are; nothing is computed."""
    if atoms.calc is None:
        return None
    try:
        return atoms.calc.get_property("forces", atoms, allow_calculation=False)
    except PropertyNotImplementedError:
        return None


def is_reduced(atoms) -> bool:
    """Whether the numbers of the atoms are in units lj."""
    return getattr(atoms.calc, "units", "") == "lj"
