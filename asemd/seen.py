"""What a calculator sees of atoms: their types and bonds, and whether anything has changed that its results depend on."""
from __future__ import annotations

import warnings

import numpy as np

from asemd.errors import InputError, InputWarning, SimulationError
from asemd.topology import Topology

GROUPS = "groups"               # array of atoms: group bits, for interactions that differ by group
FURTHER = ("mu", "shape", "quaternions", "epsilon", "radius", "mol-id", GROUPS)


def view(atoms, charges: bool) -> dict[str, np.ndarray | None]:
    """The arrays that count, besides the topology; charges only where something acts on them.

    Momenta are not among them: styles whose forces depend on velocities have no calculator.
    """
    a = atoms.arrays
    return {"positions": a["positions"], "numbers": a["numbers"], "cell": atoms.cell.array, "pbc": atoms.pbc,
            "initial_charges": a.get("initial_charges") if charges else None, "type": a.get("type"), "origin": atoms.get_celldisp(),
            "image": a.get("image"), **{name: a.get(name) for name in FURTHER}}


def check_finite(atoms) -> None:
    """Refuse positions that are no numbers.

    Raises
    ------
    SimulationError
        Names the first such atom.
    """
    strange = np.flatnonzero(~np.isfinite(atoms.positions).all(axis=1))
    if strange.size:
        k = int(strange[0])
        raise SimulationError(f"position of atom {atoms.arrays['id'][k] if 'id' in atoms.arrays else k + 1} is not finite")


def turns_as_virials(torques: np.ndarray) -> np.ndarray:
    """(n, 6) what virials, of which LAMMPS has one half (xy and not yx), gain where atoms have torques (n, 3) and keep their orientation
    under a strain; their sum is then the derivative of the energy by the strain."""
    out = np.zeros((len(torques), 6))
    out[:, 3], out[:, 4], out[:, 5] = 0.5 * torques[:, 2], -0.5 * torques[:, 1], 0.5 * torques[:, 0]
    return out


def same(a, b) -> bool:
    """Whether two arrays, or their absence, are equal."""
    return a is b or (a is not None and b is not None and a.shape == b.shape and bool((a == b).all()))


def uses_charges(interactions, loads) -> bool:
    """Whether the energy can depend on charges, as far as is known before the first evaluation."""
    return bool(interactions is None or loads or interactions.kspace != "none" or any(
        use.style.charged or use.style.oriented or use.style.dielectric for use in interactions.uses["pair"]))


def typed(atoms, type_of: dict[str, int]):
    """The atoms with the array ``type`` by their elements, where there is a mapping and they have no such array.

    Raises
    ------
    InputError
        An element that the mapping does not have.
    """
    if not type_of or "type" in atoms.arrays:
        return atoms
    symbols = atoms.get_chemical_symbols()
    if unknown := sorted(set(symbols) - set(type_of)):
        raise InputError(f"types say nothing of element {unknown[0]}, but of {' '.join(type_of)}")
    atoms = atoms.copy()
    atoms.set_array("type", np.array([type_of[s] for s in symbols], int))
    return atoms


def topology_of(calc, atoms, bonded: list[str]) -> Topology:
    """The bonds of these atoms: their own, else the ones given to the calculator, which has `bonded` styles but no topology.

    Raises
    ------
    InputError
        Nobody knows the bonds, or they are those of other atoms.
    """
    own, given, n = getattr(atoms, "topology", None), calc.topology, len(atoms)
    if own is not None and own.is_empty and bonded and n > 1:
        warnings.warn(f"the force field has {' and '.join(bonded)} styles, but these atoms have no bonds: they need "
                      "asemd.Atoms(atoms, topology=...)", InputWarning, stacklevel=2)
    if own is not None and (given is None or calc.like is not None or not own.is_empty):
        for kind, items, _ in own.every():
            if len(items) and not 0 <= int(items.min()) <= int(items.max()) < n:
                wrong = items[(items < 0) | (items >= n)][0]
                raise InputError(f"the {kind}s name atom {wrong}, but the atoms are 0 to {n - 1}")
        return own
    if given is None:
        if bonded:
            raise InputError(f"the force field has {' and '.join(bonded)} styles, but these atoms do not know their bonds: use "
                             "asemd.Atoms(atoms, topology=...), or give the topology to the ForceField")
        return Topology()
    largest = max((int(items.max()) for _, items, _ in given.every() if len(items)), default=-1)
    if largest >= n:
        raise InputError(f"the topology names atom {largest}, but there are {n} atoms: use asemd.Atoms, whose topology "
                         "follows slices and copies, or hand a new topology to the calculator")
    if not given.is_empty and calc.natoms not in (0, n):
        raise InputError(f"the topology of the calculator is for {calc.natoms} atoms, not for {n}: use asemd.Atoms, whose topology "
                         "follows slices and copies, or hand a new topology to the calculator")
    calc.natoms = n
    return given
