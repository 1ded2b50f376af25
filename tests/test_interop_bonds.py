"""Bonds found when asked for, what follows from them, and force fields that other tools write."""
from __future__ import annotations

import io

import numpy as np
import pytest
from ase import Atoms as PlainAtoms
from ase.build import bulk, molecule
from ase.io.opls import OPLSff, OPLSStructure

import asemd
from asemd import Atoms, find_bonds, topology_from_bonds
from asemd.errors import InputError
from asemd.interop.bonds import angles_of, dihedrals_of

ETHANOL = dict(bond_types={("C", "C"): 1, ("C", "H"): 2, ("C", "O"): 3, ("O", "H"): 4},
               angle_types={("H", "C", "H"): 1, ("C", "C", "H"): 2, ("H", "C", "O"): 3, ("C", "C", "O"): 4, ("H", "O", "C"): 5},
               dihedral_types={("H", "C", "C", "H"): 1, ("H", "C", "C", "O"): 2, ("H", "C", "O", "H"): None, ("C", "C", "O", "H"): 3})


def test_ethanol():
    atoms = molecule("CH3CH2OH")
    bonds = find_bonds(atoms, 1.2)
    assert len(bonds) == len(atoms) - 1 and np.array_equal(bonds, find_bonds(
        atoms, {("C", "C"): 1.7, ("C", "H"): 1.3, ("C", "O"): 1.6, ("O", "H"): 1.2}))
    top = topology_from_bonds(atoms, bonds, **ETHANOL)
    assert top.counts() == {"bond": 8, "angle": 13, "dihedral": 10, "improper": 0}
    assert np.bincount(top.angle_types).tolist() == [0, 4, 5, 2, 1, 1] and np.bincount(top.dihedral_types).tolist() == [0, 6, 3, 1]
    middle = top.angles[:, 1]
    assert all(np.isin(np.sort(top.angles[:, [k, 1]]), bonds).all() for k in (0, 2)) and set(middle) == {0, 1, 2}
    shuffled = np.random.default_rng(1).permutation(len(atoms))
    again = topology_from_bonds(atoms[shuffled], find_bonds(atoms[shuffled], 1.2), **ETHANOL)
    assert {k: np.bincount(t).tolist() for k, _, t in again} == {k: np.bincount(t).tolist() for k, _, t in top}


def test_across_faces_and_repeated():
    """Bonds of a periodic chain reach into the neighbouring cells; the topology of a cell that is large enough can be repeated."""
    atoms = PlainAtoms("C4", positions=[[0.1 + 1.5 * k, 0, 0] for k in range(4)], cell=[6, 8, 8], pbc=[True, False, False])
    bonds = find_bonds(atoms, {("C", "C"): 1.6})
    assert bonds.tolist() == [[0, 1], [0, 3], [1, 2], [2, 3]]
    top = topology_from_bonds(atoms, bonds, {("C", "C"): 1}, {("C",) * 3: 1}, {("C",) * 4: 1})
    assert len(top.angles) == len(top.dihedrals) == 4
    long = Atoms(atoms, topology=top) * (3, 1, 1)
    expected = topology_from_bonds(long, find_bonds(long, {("C", "C"): 1.6}), {("C", "C"): 1}, {("C",) * 3: 1}, {("C",) * 4: 1})
    assert {tuple(sorted(b)) for b in long.topology.bonds.tolist()} == {tuple(b) for b in expected.bonds.tolist()}
    assert long.topology.counts() == expected.counts()


def test_rings():
    assert angles_of(np.array([[0, 1], [0, 2], [1, 2]])).tolist() == [[1, 0, 2], [0, 1, 2], [0, 2, 1]]
    assert dihedrals_of(np.array([[0, 1], [0, 2], [1, 2]])).shape == (0, 4)
    assert len(dihedrals_of(np.array([[0, 1], [1, 2], [2, 3], [0, 3]]))) == 4
    none = topology_from_bonds(PlainAtoms(), [], {}, {}, {})
    assert none.is_empty and find_bonds(PlainAtoms(), 1.1).shape == (0, 2)


def test_types_of_atoms_instead_of_elements():
    atoms = molecule("H2O")
    atoms.set_array("type", np.array([7, 3, 3]))
    top = topology_from_bonds(atoms, find_bonds(atoms, 1.2), {(7, 3): 2}, {(3, 7, 3): 5})
    assert top.bond_types.tolist() == [2, 2] and top.angle_types.tolist() == [5]


@pytest.mark.parametrize("make, message", [
    (lambda a: find_bonds(a, -1.0), "positive number, got -1.0"), (lambda a: find_bonds(a, np.nan), "positive number, got nan"),
    (lambda a: find_bonds(a, {("O", "H"): "1"}), "got '1'"), (lambda a: find_bonds(bulk("Cu"), 1.2), "own periodic image: repeat"),
    (lambda a: find_bonds(bulk("Cu", cubic=True), 1.2), "several periodic images: repeat"),
    (lambda a: topology_from_bonds(a, [[0, 1], [0, 2]], {("C", "C"): 1}), r"what type H-O is \(None leaves such bonds out\)"),
    (lambda a: topology_from_bonds(a, [[0, 1], [0, 2]], {("O", "H"): 1}, {}), "angle_types does not say what type H-O-H is"),
    (lambda a: topology_from_bonds(a, [[0, 9]], {("O", "H"): 1}), "names atom 9, but the atoms are 0 to 2"),
    (lambda a: topology_from_bonds(a, [[0, 1]], {("O", "H"): 0}), "whole numbers from 1, or None, got 0 for O-H"),
    (lambda a: topology_from_bonds(a, [[0, 1]], {("O", "H"): 1, ("H", "O"): 2}), "H-O has the types 1 and 2"),
    (lambda a: topology_from_bonds(a, [[0, 1]], {"OH": 1}), "must be 2 names of atoms"),
    (lambda a: topology_from_bonds(a, [[0, 1]], {(1, 2): 1}), "no array 'type'")])
def test_mistakes(make, message):
    with pytest.raises(InputError, match=message):
        make(molecule("H2O"))


def test_guesser_of_mdanalysis():
    pytest.importorskip("MDAnalysis")
    atoms = molecule("CH3CH2OH")
    atoms.center(vacuum=5.0)
    u = asemd.to_mdanalysis(atoms)
    u.atoms.guess_bonds()
    assert np.array_equal(topology_from_bonds(atoms, u.bonds.indices, ETHANOL["bond_types"]).bonds,
                          topology_from_bonds(atoms, find_bonds(atoms, 1.2), ETHANOL["bond_types"]).bonds)


FIELD = """# one: type, mass, epsilon, sigma, charge
CT 0.0028619844 3.50 -0.18
HC 0.0013009018 2.50 0.06

# bonds
CT-CT  11.621 1.529
CT-HC  14.743 1.090

# angles
CT-CT-HC   1.6262   110.700
HC-CT-HC   1.4310   107.800

# dihedrals
HC-CT-CT-HC 0.0 0.0 0.0137 0.0

# cutoffs
CT-CT 1.85
CT-HC 1.4
"""


def test_opls_of_ase(tmp_path, monkeypatch):
    """The files that ``ase.io.opls`` writes for LAMMPS are read as they come, and the energy is that of the field it was given."""
    monkeypatch.chdir(tmp_path)
    ethane = molecule("C2H6")
    ethane.rattle(0.03, seed=3)
    structure = OPLSStructure(None, ethane.get_chemical_symbols(), positions=ethane.positions + 6.0)
    structure.types = ["CT", "HC"]
    structure.set_cell([12, 12, 12])
    OPLSff(io.StringIO(FIELD)).write_lammps(structure, prefix="ethane")
    atoms = asemd.read("ethane_in")
    own = topology_from_bonds(atoms, find_bonds(atoms, 1.2), {("C", "C"): 1, ("C", "H"): 2}, {("C", "C", "H"): 1, ("H", "C", "H"): 2},
                              {("H", "C", "C", "H"): 1})
    for kind, items, types in own:
        theirs = {tuple(min(i, i[::-1])): t for i, t in zip(atoms.topology.items(kind)[0].tolist(), atoms.topology.items(kind)[1].tolist())}
        ours = {tuple(min(i, i[::-1])): t for i, t in zip(items.tolist(), types.tolist())}
        assert theirs.keys() == ours.keys() and len({(theirs[i], ours[i]) for i in ours}) == len(set(ours.values()))
    assert atoms.get_chemical_symbols() == ethane.get_chemical_symbols()
    assert np.allclose(atoms.get_initial_charges(), np.where(atoms.numbers == 6, -0.18, 0.06))
    lines = " ".join(atoms.calc.commands())
    assert all(number in lines for number in ("11.621 1.529", "14.743 1.09", "1.6262 110.7", "1.431 107.8", "0.0137", "0.0028619844 3.5"))
