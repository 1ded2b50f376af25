"""Force fields as LAMMPS commands, element to type mappings, calculators made again from what they say of themselves."""
from __future__ import annotations

import json

import both
import numpy as np
import pytest
from ase import Atoms as PlainAtoms
from ase import units
from ase.build import bulk
from ase.calculators.calculator import get_calculator_class
from ase.db import connect

import asemd
from asemd import Atoms, ForceField, Topology
from asemd.errors import InputError

ALLOY = ["pair_style lj/cut 6.0", "pair_coeff 1 1 0.2 2.3", "pair_coeff 2 2 0.1 2.6", "pair_modify shift yes"]
WATER = """
# flexible, real units
pair_style lj/cut/coul/cut 8.0
pair_coeff 1 1 0.155 3.16
pair_coeff 2 2 0.02 0.4
pair_modify mix arithmetic
bond_style harmonic
bond_coeff 1 450.0 0.96
angle_style harmonic
angle_coeff 1 55.0 104.5
special_bonds lj/coul 0 0 0.5
dielectric 1.5
"""


def alloy() -> PlainAtoms:
    atoms = bulk("Cu", "fcc", 3.7, cubic=True) * 2
    atoms.symbols[::3] = "Al"
    atoms.rattle(0.05, seed=2)
    return atoms


def water() -> Atoms:
    x = np.array([[0, 0, 0], [0.98, 0, 0], [-0.2, 0.93, 0]])
    atoms = Atoms("OHHOHH", positions=np.concatenate([x, x + [2.9, 0.3, 0.5]]), cell=[12, 12, 12], pbc=True,
                  topology=Topology(bonds=[[0, 1], [0, 2], [3, 4], [3, 5]], angles=[[1, 0, 2], [4, 3, 5]]))
    atoms.set_initial_charges([-0.8, 0.4, 0.4] * 2)
    return atoms


def test_commands_are_the_same_as_arguments():
    """Types go by the order that is given, not by the alphabet."""
    atoms, other = alloy(), alloy()
    atoms.calc = ForceField(commands=ALLOY, units="metal", types=["Cu", "Al"])
    other.calc = ForceField(pair={"lj/cut 6.0": {("Cu", "Cu"): (0.2, 2.3), ("Al", "Al"): (0.1, 2.6)}}, shift=True)
    assert atoms.get_potential_energy() == pytest.approx(other.get_potential_energy(), rel=1e-12)
    assert np.allclose(atoms.get_forces(), other.get_forces(), atol=1e-12)
    assert np.allclose(atoms.get_stress(), other.get_stress(), atol=1e-13)
    swapped = alloy()
    swapped.calc = ForceField(commands=ALLOY, units="metal", types={"Al": 1, "Cu": 2})
    assert abs(swapped.get_potential_energy() - atoms.get_potential_energy()) > 0.1


def test_variables_have_their_values():
    atoms = bulk("Ar", a=5.3, cubic=True)
    lines = ["variable f equal 0.5", "variable k equal 0.3", "pair_style hybrid/scaled v_f lj/cut 5.0 1.0 lepton 4.0",
             "pair_coeff 1 1 lj/cut 0.01 3.4", "pair_coeff 1 1 lepton v_k*(r-4)^2"]
    plain = ["pair_style hybrid/overlay lj/cut 5.0 lepton 4.0", "pair_coeff 1 1 lj/cut 0.005 3.4", "pair_coeff 1 1 lepton 0.3*(r-4)^2"]
    calc = ForceField(commands=lines, units="metal", types=["Ar"])
    energy = ForceField(commands=plain, units="metal", types=["Ar"]).get_potential_energy(atoms)
    for one in (calc, ForceField(**json.loads(json.dumps(calc.todict())))):
        assert one.get_potential_energy(atoms) == pytest.approx(energy, rel=1e-12)
    with pytest.raises(InputError, match="undefined variable f"):
        ForceField(commands=lines[1:], units="metal", types=["Ar"])


def test_commands_with_bonds_agree_with_lammps(tmp_path):
    """Real units, bonds, charges, dielectric: the energy of the exported scene in a session."""
    atoms = water()
    atoms.calc = ForceField(commands=WATER, units="real", types=["O", "H"])
    energy = atoms.get_potential_energy()
    lines = "\n".join(f"{k + 1} {k // 3 + 1} {1 + (k % 3 > 0)} {q} {' '.join(map(repr, x.tolist()))}"
                      for k, (q, x) in enumerate(zip(atoms.get_initial_charges(), atoms.positions)))
    (tmp_path / "w.data").write_text(
        "water\n\n6 atoms\n2 atom types\n4 bonds\n1 bond types\n2 angles\n1 angle types\n0 12 xlo xhi\n0 12 ylo yhi\n0 12 zlo zhi\n\n"
        f"Masses\n\n1 16\n2 1\n\nAtoms # full\n\n{lines}\n\n"
        "Bonds\n\n1 1 1 2\n2 1 1 3\n3 1 4 5\n4 1 4 6\n\nAngles\n\n1 1 2 1 3\n2 1 5 4 6\n")
    session = both.asemd(f"units real\natom_style full\nread_data {tmp_path}/w.data\n{WATER}\nthermo_style custom step pe\nrun 0\n")
    assert session.last_thermo["PotEng"] * units.kcal / units.mol == pytest.approx(energy, rel=1e-12)
    bare = PlainAtoms(atoms)
    bare.info = {}
    bare.calc = ForceField(commands=WATER, units="real", types=["O", "H"])
    with pytest.raises(InputError, match="bond and angle styles, but these atoms do not know their bonds"):
        bare.get_potential_energy()


@pytest.mark.parametrize("make", [
    lambda: ForceField(commands=WATER, units="real", types=["O", "H"]),
    lambda: ForceField(pair={"lj/cut 8.0": {("O", "O"): (0.01, 3.1), ("H", "H"): (0.001, 1.0)}}, bond={"harmonic": {1: (20.0, 0.96)}},
                       angle={"harmonic": {1: (2.0, 104.5)}}, types={"O": 2, "H": 1}, skin=1.5)])
def test_made_again_from_json(make):
    atoms, again = water(), water()
    atoms.calc = make()
    energy = atoms.get_potential_energy()
    told = json.loads(json.dumps(atoms.calc.todict()))
    again.calc = get_calculator_class(atoms.calc.name)(**told)
    assert again.get_potential_energy() == pytest.approx(energy, rel=1e-13) and energy != 0.0
    assert json.loads(json.dumps(again.calc.todict())) == told
    assert again.calc.settings.skin == atoms.calc.settings.skin


@pytest.mark.parametrize("name", ["x.db", "x.json"])
def test_calculators_come_back_from_databases(name, tmp_path):
    atoms = water()
    atoms.set_array("mol-id", np.array([1, 1, 1, 2, 2, 2]))
    atoms.calc = ForceField(commands=WATER, units="real", types=["O", "H"])
    energy = atoms.get_potential_energy()
    with connect(tmp_path / name) as db:
        db.write(atoms, data=atoms.info)
        row = db.get(1)
    assert row.energy == energy and row.calculator == "asemd"
    back = Atoms(row.toatoms(add_additional_information=True))
    assert back.topology == atoms.topology and back.arrays["mol-id"].tolist() == [1, 1, 1, 2, 2, 2]
    back.calc = get_calculator_class(row.calculator)(**row.calculator_parameters)
    assert back.get_potential_energy() == pytest.approx(energy, rel=1e-13)


def test_a_script_by_elements(tmp_path):
    """The force field of a script for atoms that ASE made: element to type is said, not guessed."""
    (tmp_path / "in.x").write_text("units metal\nlattice fcc 3.7\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\ncreate_atoms 1 box\n"
                                   "mass 1 63.5\nmass 2 27\n" + "\n".join(ALLOY) + "\nneigh_modify exclude type 2 2\nrun 0\n")
    script, atoms = asemd.read(tmp_path / "in.x"), alloy()
    with pytest.raises(InputError, match="array 'type'.*with_types"):
        atoms.calc = script.calc
        atoms.get_potential_energy()
    atoms.calc = script.calc.with_types(["Cu", "Al"])
    energy = atoms.get_potential_energy()
    other = alloy()
    other.calc = ForceField(commands=[*ALLOY, "neigh_modify exclude type 2 2"], units="metal", types=["Cu", "Al"])
    assert other.get_potential_energy() == pytest.approx(energy, rel=1e-13)
    atoms.calc = ForceField(**json.loads(json.dumps(atoms.calc.todict())))
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-13)
    atoms.symbols[0] = "Ag"
    with pytest.raises(InputError, match="nothing of element Ag, but of Cu Al"):
        atoms.get_potential_energy()


def test_what_words_cannot_make(tmp_path):
    (tmp_path / "in.x").write_text("units metal\nlattice fcc 3.7\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\ncreate_atoms 1 box\n"
                                   "mass * 63.5\n" + "\n".join(ALLOY) + "\nfix 1 all addforce 0.1 0 0\nrun 0\n")
    told = asemd.read(tmp_path / "in.x").calc.todict()
    with pytest.raises(InputError, match="addforce 0.1 0 0 on group all comes from a script.*asemd.read"):
        ForceField(**told)


@pytest.mark.parametrize("arguments, message", [
    (dict(commands=ALLOY), "commands need units="),
    (dict(commands=ALLOY, units="metall"), "metal"),
    (dict(commands="pair_style lj/cut 6.0\npair_coeff * * 1 1", units="metal"), "how many atom types.*types="),
    (dict(commands=[*ALLOY, "fix 1 all nve"], units="metal"), r"fix is not a command of a force field.*fix 1 all nve"),
    (dict(commands=[*ALLOY, "pair_cof 1 1 1 1"], units="metal"), "did you mean pair_coeff"),
    (dict(commands=["pair_style lj/cut 6.0", "pair_coeff 1 1 0.2"], units="metal"), "line 2|:2"),
    (dict(commands=["pair_style lj/cut 6.0", "pair_coeff 1 1 nan 1"], units="metal"), "nan"),
    (dict(commands=ALLOY, units="metal", types=["Cu"]), "atom type 2, but types has 1"),
    (dict(commands=ALLOY, units="metal", types=["Cu", "Cu"]), "Cu twice"),
    (dict(commands=ALLOY, units="metal", types="CuAl"), "types are elements"),
    (dict(commands=ALLOY, units="metal", types={"Cu": 0}), "whole numbers from 1, got 0 for Cu"),
    (dict(commands=ALLOY, units="metal", pair={"lj/cut 6.0": {}}), "pair cannot be given beside commands"),
    (dict(units="metal"), "units are for commands")])
def test_mistakes(arguments, message):
    with pytest.raises(InputError, match=message):
        ForceField(**arguments)


def test_charges_count_only_where_something_acts_on_them():
    """An evaluation is not repeated for charges that no style looks at; types and charges that count are noticed."""
    atoms = alloy()
    atoms.calc = ForceField(commands=ALLOY, units="metal", types=["Cu", "Al"])
    atoms.get_potential_energy()
    atoms.set_initial_charges(np.linspace(-1, 1, len(atoms)))
    atoms.set_momenta(np.ones((len(atoms), 3)))
    assert not atoms.calc.calculation_required(atoms, ["energy", "forces"])
    charged = water()
    charged.calc = ForceField(commands=WATER, units="real", types=["O", "H"])
    energy = charged.get_potential_energy()
    charged.set_initial_charges(0.5 * charged.get_initial_charges())
    assert charged.calc.check_state(charged) == ["initial_charges"] and charged.get_potential_energy() != energy
    charged.symbols[0] = "H"
    assert "numbers" in charged.calc.check_state(charged)


def test_kinetic_part_of_stresses():
    """The shares of the atoms add up to the stress with the ideal gas part too."""
    atoms = alloy()
    atoms.calc = ForceField(commands=ALLOY, units="metal", types=["Cu", "Al"])
    atoms.set_velocities(np.random.default_rng(1).normal(0, 0.02, (len(atoms), 3)))
    kinetic = atoms.get_stress(include_ideal_gas=True) - atoms.get_stress()
    v, m = atoms.get_velocities(), atoms.get_masses()
    expected = -np.einsum("n,na,nb->ab", m, v, v) / atoms.get_volume()
    assert np.allclose(kinetic, expected[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]], atol=1e-15)
    assert np.allclose(atoms.get_stresses(include_ideal_gas=True).sum(0), atoms.get_stress(include_ideal_gas=True), atol=1e-14)
