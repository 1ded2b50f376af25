"""The topology survives ASE's files, and what it does not survive is said."""
from __future__ import annotations

import ase
import ase.io
import numpy as np
import pytest
from ase.db import connect
from ase.io.jsonio import decode, encode
from ase.io.trajectory import Trajectory

import asemd
from asemd import Atoms, ForceField, Topology
from asemd.errors import InputError, InputWarning
from asemd.topology import Partners


def field() -> ForceField:
    return ForceField(bond={"harmonic": {1: (10.0, 1.1), 2: (8.0, 1.2)}}, angle={"harmonic": {1: (2.0, 100.0)}})


@pytest.fixture
def water():
    x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    top = Topology(bonds=[[0, 1], [0, 2], [3, 4], [3, 5]], bond_types=[1, 2, 1, 2], angles=[[1, 0, 2], [4, 3, 5]])
    atoms = Atoms("OH2OH2", positions=np.concatenate([x, x + 5.0]), cell=[12, 12, 12], pbc=True, topology=top)
    atoms.info["note"] = "two of them"
    return atoms


@pytest.mark.parametrize("name", ["x.extxyz", "x.traj"])
@pytest.mark.parametrize("molecules", [1, 2, 3])
def test_round_trip(name, molecules, water, tmp_path):
    """Also for matrices of nine numbers, which extxyz treats in its own way."""
    atoms = (water + water)[:3 * molecules]
    atoms.set_array("type", np.resize([1, 2, 2], len(atoms)))
    atoms.set_array("mol-id", np.arange(len(atoms)) // 3 + 1)
    ase.io.write(tmp_path / name, atoms)
    plain = ase.io.read(tmp_path / name)
    back = Atoms(plain)
    assert type(plain) is ase.Atoms and back.topology == atoms.topology and back.info["note"] == "two of them"
    assert np.array_equal(back.arrays["type"], atoms.arrays["type"]) and np.array_equal(back.arrays["mol-id"], atoms.arrays["mol-id"])
    atoms.calc, back.calc, plain.calc = field(), field(), field()
    assert back.get_potential_energy() == atoms.get_potential_energy() == plain.get_potential_energy()
    ase.io.write(tmp_path / name, back)
    assert Atoms(ase.io.read(tmp_path / name)).topology == atoms.topology


def test_trajectory_of_a_script(tmp_path, monkeypatch):
    """Atoms of a LAMMPS script keep types, bonds and what counts as bonded; the force field of the script fits them again."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(
        "units metal\natom_style full\nregion b block 0 9 0 9 0 9\n"
        "create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4\nmass * 12\n"
        "create_atoms 1 single 1 1 1\ncreate_atoms 2 single 2 1 1\ncreate_atoms 2 single 2 2 1\ncreate_atoms 2 single 3 3 1\n"
        "bond_style harmonic\nbond_coeff 1 3 1.1\npair_style lj/cut 4\npair_coeff 1 1 0.1 1\npair_coeff 2 2 0.2 1\n"
        "create_bonds single/bond 1 1 2\ncreate_bonds single/bond 1 2 3\ndelete_bonds all bond 1\n")
    atoms = asemd.read("in.x")
    energy = atoms.get_potential_energy()
    with Trajectory("x.traj", "w", atoms) as trajectory:
        trajectory.write()
    back = Atoms(ase.io.read("x.traj"))
    assert back.topology == atoms.topology and back.topology.frozen is not None
    back.calc = asemd.read("in.x").calc
    assert back.get_potential_energy() == pytest.approx(energy, rel=1e-12) and energy != 0.0


def test_database(water, tmp_path):
    """ASE's databases keep what is given to them as data."""
    with connect(tmp_path / "x.db") as db:
        db.write(water, data={"topology": water.topology.as_dict()})
        row = db.get(1)
    assert Atoms(row.toatoms(add_additional_information=True)).topology == water.topology
    lost = row.toatoms()
    lost.calc = field()
    with pytest.raises(InputError, match="do not know their bonds"):
        lost.get_potential_energy()


def test_json_of_ase(water):
    """ASE's JSON, with which phonons and vibrations keep atoms, knows nothing of topologies; lists older than the bonds stay too."""
    top = water.topology
    for frozen in (None, Topology(bonds=[[0, 1], [0, 2], [3, 4], [3, 5], [2, 5]]), Partners([[0, 1], [2, 5]], [1, 3])):
        water.topology = Topology(bonds=top.bonds, bond_types=top.bond_types, angles=top.angles, frozen=frozen)
        back = decode(encode(water))
        assert type(back) is ase.Atoms and Atoms(back).topology == Atoms.fromdict(water.todict()).topology == water.topology


def test_atoms_that_lost_their_bonds(water, tmp_path):
    ase.io.write(tmp_path / "x.extxyz", water)
    part = ase.io.read(tmp_path / "x.extxyz")[:3]
    with pytest.raises(InputError, match="belong to 6 other atoms than these 3"):
        Atoms(part)
    part.calc = field()
    with pytest.raises(InputError, match="belong to 6 other atoms"):
        part.get_potential_energy()
    shuffled = ase.io.read(tmp_path / "x.extxyz")[[1, 0, 2, 3, 4, 5]]
    with pytest.raises(InputError, match="sliced, sorted"):
        Atoms(shuffled)
    damaged = ase.io.read(tmp_path / "x.extxyz")
    damaged.info["asemd_bonds"] = "none"
    with pytest.raises(InputError, match="cannot be read"):
        Atoms(damaged)
    bare = Atoms("OH2")
    bare.calc = field()
    with pytest.warns(InputWarning, match="these atoms have no bonds"):
        bare.get_potential_energy()


def test_info_follows(water):
    """Entries are those of the atoms as they are now, in every kind of copy."""
    assert [name for name in water.info if name.startswith("asemd_")] == ["asemd_bonds", "asemd_angles", "asemd_atoms"]
    for atoms in (water[3:], water * (2, 1, 1), water + water[:3], Atoms(water), Atoms.fromdict(water.todict()), water[[0, 1]]):
        assert np.array_equal(atoms.info["asemd_bonds"][:, 1:], atoms.topology.bonds) and atoms.info["asemd_atoms"][0, 0] == len(atoms)
        assert Atoms(ase.Atoms(atoms, info=dict(atoms.info))).topology == atoms.topology
    water.topology = Topology()
    assert list(water.info) == ["note"]


@pytest.mark.parametrize(("words", "message"), [
    ({"bonds": [[0, 0]]}, "bond 0 names an atom twice: 0 0"), ({"angles": [[0, 1, 2], [0, 1, 0]]}, "angle 1 names an atom twice"),
    ({"bonds": [[0, 1], [1, 2]], "bond_types": [1]}, "one for each of the 2 bonds, got 1"),
    ({"bonds": [[0, 1]], "bond_types": [1, 2, 3]}, "one for each of the 1 bonds, got 3"), ({"bond_types": [1]}, "the 0 bonds, got 1"),
    ({"bonds": [[0, 1.5]]}, "2 atom numbers, got 1.5"), ({"bonds": [["O", "H"]]}, "2 atom numbers, got 'O'"),
    ({"bonds": [[0, 1], [1]]}, "different lengths"), ({"bonds": [0, 1]}, "shape"), ({"bonds": [[0, 2**40]]}, "1099511627776"),
    ({"dihedrals": [[0, 1, 2, 3]], "dihedral_types": [np.nan]}, "whole numbers, got nan")])
def test_wrong_topologies(words, message):
    with pytest.raises(ValueError, match=message):
        Topology(**words)
