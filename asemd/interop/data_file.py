"""``format="asemd-data"`` of ``ase.io``: LAMMPS data files with bonds, both ways."""
from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

import numpy as np

from asemd import atom_style as atom_styles
from asemd.atoms import Atoms
from asemd.atoms_info import holds
from asemd.errors import InputError, nearest
from asemd.lammps import read
from asemd.lammps.data_write import write_data
from asemd.recipe import numbers_of
from asemd.seen import typed
from asemd.system import System


def read_asemd_data(path: str | os.PathLike, units: str | None = None, atom_style: str | None = None,
                    types: Mapping[str, int] | Sequence[str] | None = None) -> Atoms:
    """Atoms of a LAMMPS data file in order of id, with bonds, types, charges and velocities.

    Parameters
    ----------
    path : path
    units, atom_style : str, optional
        By default what the file says, see `asemd.read`.
    types : sequence of str or mapping, optional
        Elements in the order of their types, or element -> type; by default type labels and masses say which element a type is.

    Raises
    ------
    InputError
        Errors of the file, with their line; it is a script; a type without element.
    """
    if not read.is_data(read.head(os.fspath(path))):
        raise InputError(f"{os.fspath(path)} is no data file: a script is read with format='lammps-script'")
    atoms = read.read(path, units, atom_style)
    return with_elements(atoms, types)


def with_elements(atoms: Atoms, types: Mapping[str, int] | Sequence[str] | None) -> Atoms:
    """The same atoms with the elements that their types stand for; masses stay."""
    type_of, _ = numbers_of(types)
    if type_of:
        symbol = {number: s for s, number in type_of.items()}
        if unknown := sorted({int(t) for t in atoms.arrays["type"]} - set(symbol)):
            raise InputError(f"types say nothing of atom type {unknown[0]}, but of {' '.join(map(str, sorted(symbol)))}")
        masses = atoms.get_masses() if atoms.has("masses") else None
        atoms.set_chemical_symbols([symbol[int(t)] for t in atoms.arrays["type"]])
        if masses is not None:
            atoms.set_masses(masses)
    return atoms


def write_asemd_data(path: str | os.PathLike, atoms, units: str = "metal", atom_style: str | None = None,
                     types: Mapping[str, int] | Sequence[str] | None = None) -> None:
    """Write a LAMMPS data file with bonds and velocities; atoms in a cell of another frame than LAMMPS's are turned into that.

    Parameters
    ----------
    path : path
        Ending in ``.gz``: compressed.
    atoms : ase.Atoms
        With the topology of `asemd.Atoms`, or of their ``info``.
    units : str
        Unit style of the numbers in the file.
    atom_style : str, optional
        By default ``atomic``, ``charge``, ``molecular`` or ``full``, what the atoms need.
    types : sequence of str or mapping, optional
        As for reading; by default the array ``type``, or else the elements in alphabetical order.

    Raises
    ------
    InputError
        An element that `types` does not have, masses that differ within a type, bonds that the atom style has no place for.
    """
    atoms = Atoms(atoms) if getattr(atoms, "topology", None) is None and holds(atoms.info) else atoms
    type_of, ntypes = numbers_of(types)
    if type_of and "type" in atoms.arrays:
        atoms = atoms.copy()
        del atoms.arrays["type"]
    system = System.from_ase(typed(atoms, type_of), units=units)
    if type_of:
        system.labels["atom"] = {number: symbol for symbol, number in type_of.items()} if len(type_of) == ntypes else {}
    grow(system, ntypes)
    if atom_style:
        if not atom_styles.known(atom_style):
            raise InputError(f"asemd-data: unknown atom_style {atom_style!r}{nearest(atom_style, atom_styles.NAMES)}")
        homeless = [kind for kind, _, items in system.topology if len(items) and kind not in atom_styles.bonded(atom_style)]
        if homeless:
            raise InputError(f"asemd-data: atom_style {atom_style} has no place for {homeless[0]}s, which these atoms have")
        system.atom_style = atom_style
    write_data(path, system)


def grow(system: System, ntypes: int) -> None:
    """Room for types that no atom has; they have the mass 1."""
    if ntypes > system.counts["ntypes"]:
        system.counts["ntypes"] = ntypes
        system.mass = np.append(system.mass, np.full(ntypes + 1 - len(system.mass), np.nan))
    if ntypes:
        system.mass[1:][np.isnan(system.mass[1:])] = 1.0
