"""The ASE calculator: derivatives, relaxation, copies and changes of atoms, scripts, units, forces of fixes, errors."""
from __future__ import annotations

import copy
import io
import json
import pickle

import both
import numpy as np
import pytest
from ase import Atoms as PlainAtoms
from ase import units
from ase.build import bulk, molecule
from ase.calculators.fd import calculate_numerical_forces, calculate_numerical_stress
from ase.constraints import FixAtoms, FixCartesian
from ase.filters import FrechetCellFilter
from ase.md.verlet import VelocityVerlet
from ase.optimize import BFGS, FIRE
from wheel import ran

import asemd
from asemd.calculator import ForceField
from asemd.errors import InputError, InputWarning, SimulationError
from asemd.forcefield import Interactions
from asemd.topology import Topology

ARGON = {"lj/cut 8.5": {("Ar", "Ar"): (0.0104, 3.4)}}
SWITCHED = {"lj/charmm/coul/charmm 3.0 4.5": {("O", "O"): (0.01, 3.1), ("H", "H"): (0.002, 1.8)}}
WATER = dict(bond={"harmonic": {1: (20.0, 0.96)}}, angle={"harmonic": {1: (2.0, 104.5)}},
             special_bonds={"lj": (0, 0, 0), "coul": (0, 0, 0)})
ROTATION = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
SHAPES = {"orthogonal": np.eye(3), "tilted": np.array([[1, 0, 0], [0.45, 1, 0], [-0.4, 0.3, 1]]),
          "rotated": np.array([[1, 0, 0], [0.2, 1, 0], [0.1, -0.3, 1]]) @ ROTATION, "left-handed": np.diag([1.0, 1, -1])}


def waters(n: int = 2, shape=None, seed: int = 0, spacing: float = 3.3) -> asemd.Atoms:
    """n^3 water-like molecules with charges, in a cell of `shape`; some stand across faces."""
    rng = np.random.default_rng(seed)
    one = molecule("H2O")
    x = np.concatenate([one.positions @ np.linalg.qr(rng.normal(size=(3, 3)))[0] + spacing * np.array((i, j, k))
                        for i in range(n) for j in range(n) for k in range(n)]) + rng.normal(0, 0.03, (3 * n**3, 3))
    cell = np.eye(3) * spacing * n
    shape = np.eye(3) if shape is None else shape
    atoms = asemd.Atoms("OH2" * n**3, positions=x @ shape, cell=cell @ shape, pbc=True)
    first = 3 * np.arange(n**3)[:, None]
    atoms.topology = Topology(bonds=(first + [[0, 1, 0, 2]]).reshape(-1, 2), angles=first + [[1, 0, 2]])
    atoms.set_initial_charges([-0.8, 0.4, 0.4] * n**3)
    atoms.calc = ForceField(pair=SWITCHED, **WATER)
    return atoms


def argon(n: int = 3, rattle: float = 0.1) -> PlainAtoms:
    atoms = bulk("Ar", "fcc", 5.26, cubic=True) * (n, n, n)
    atoms.rattle(rattle, seed=3)
    atoms.calc = ForceField(pair=ARGON)
    return atoms


# ------------------------------------------------------------------------------------------------------------------- derivatives ---

@pytest.mark.parametrize("pbc", [True, (True, False, True), False])
@pytest.mark.parametrize("shape", SHAPES)
def test_forces_and_stress_are_derivatives(shape, pbc):
    atoms = waters(2, SHAPES[shape])       # the cell is below twice the cutoff: many images
    atoms.pbc = pbc
    forces = atoms.get_forces()
    index = [0, 1, 13]
    assert np.allclose(calculate_numerical_forces(atoms, eps=1e-5, iatoms=index), forces[index], atol=2e-6)
    assert np.allclose(forces.sum(0), 0, atol=1e-10)
    assert np.allclose(calculate_numerical_stress(atoms, eps=1e-5), atoms.get_stress(), atol=2e-7)


def test_all_properties():
    atoms = waters(2)
    energy = atoms.get_potential_energy()
    assert energy == atoms.get_potential_energy(force_consistent=True) == atoms.calc.results["free_energy"]
    assert atoms.get_potential_energies().sum() == pytest.approx(energy, rel=1e-12)
    assert np.allclose(atoms.get_stresses().sum(0), atoms.get_stress(), atol=1e-14)
    assert atoms.get_stress(voigt=False).shape == (3, 3)
    assert set(atoms.calc.results) == set(ForceField.implemented_properties)
    for method in ("get_magnetic_moments", "get_dipole_moment"):
        with pytest.raises(Exception, match="not implemented"):
            getattr(atoms, method)()


def test_results_are_copies():
    atoms = argon(2)
    forces = atoms.get_forces()
    expected = forces.copy()
    forces[:] = 7
    assert np.array_equal(atoms.get_forces(), expected)


def test_no_stress_without_a_cell():
    atoms = PlainAtoms("Ar2", positions=[[0, 0, 0], [0, 0, 3.7]], calculator=ForceField(pair=ARGON))
    s6 = (3.4 / 3.7) ** 6
    assert atoms.get_potential_energy() == pytest.approx(4 * 0.0104 * (s6 * s6 - s6), rel=1e-12)
    with pytest.raises(Exception, match="no volume"):
        atoms.get_stress()


def test_one_atom_and_none():
    assert PlainAtoms("Ar", calculator=ForceField(pair=ARGON)).get_potential_energy() == 0
    assert PlainAtoms(calculator=ForceField(pair=ARGON)).get_potential_energy() == 0
    crystal = bulk("Ar", "fcc", 5.26)          # one atom that sees nothing but its images
    crystal.calc = ForceField(pair=ARGON)
    cubic = bulk("Ar", "fcc", 5.26, cubic=True) * (4, 4, 4)
    cubic.calc = ForceField(pair=ARGON)
    assert len(cubic) * crystal.get_potential_energy() == pytest.approx(cubic.get_potential_energy(), rel=1e-11)
    assert np.allclose(crystal.get_stress(), cubic.get_stress(), atol=1e-13)


def test_tail_and_shift():
    plain, tailed, shifted = (bulk("Ar", "fcc", 5.26, cubic=True) * (2, 2, 2) for _ in range(3))
    for atoms, options in ((plain, {}), (tailed, {"tail": True}), (shifted, {"shift": True})):
        atoms.rattle(0.1, seed=1)
        atoms.calc = ForceField(pair=ARGON, **options)
    assert np.allclose(plain.get_forces(), tailed.get_forces()) and np.allclose(plain.get_forces(), shifted.get_forces())
    assert tailed.get_potential_energy() < plain.get_potential_energy() < shifted.get_potential_energy()
    assert tailed.get_potential_energies().sum() == pytest.approx(tailed.get_potential_energy(), rel=1e-12)
    assert np.trace(tailed.get_stress(voigt=False)) > np.trace(plain.get_stress(voigt=False))      # the tail pulls
    assert np.allclose(tailed.get_stresses().sum(0), tailed.get_stress(), atol=1e-14)


# ------------------------------------------------------------------------------------------------------------ relaxation, dynamics ---

@pytest.mark.parametrize("optimizer", [BFGS, FIRE])
def test_relaxation(optimizer):
    atoms = argon(2, 0.2)
    before = atoms.get_potential_energy()
    assert optimizer(atoms, logfile=None).run(fmax=1e-4, steps=400)
    assert atoms.get_potential_energy() < before
    assert atoms.calc.engine.builds < 20


def test_cell_relaxation():
    atoms = bulk("Ar", "fcc", 5.0, cubic=True)
    atoms.set_cell(atoms.cell.array @ np.array([[1, 0, 0], [0.1, 1, 0], [0, -0.05, 1]]) @ ROTATION, scale_atoms=True)
    atoms.calc = ForceField(pair={"lj/charmm/coul/charmm 6.0 8.0": {(1, 1): (0.0104, 3.4)}})
    atoms.set_initial_charges(np.zeros(len(atoms)))
    assert BFGS(FrechetCellFilter(atoms), logfile=None).run(fmax=1e-3, steps=200)
    assert np.abs(atoms.get_stress()).max() < 1e-4


def test_ase_dynamics_conserves_energy():
    atoms = waters(2)
    atoms.set_velocities(np.random.default_rng(1).normal(0, 0.01, (len(atoms), 3)))
    energies = []
    dynamics = VelocityVerlet(atoms, 0.25 * units.fs)
    dynamics.attach(lambda: energies.append(atoms.get_total_energy()), interval=20)
    dynamics.run(400)
    assert np.ptp(energies) < 2e-3 * abs(atoms.get_kinetic_energy())
    assert atoms.calc.engine.builds < 40


# ------------------------------------------------------------------------------------------------------------------------- copies ---

def test_copies_and_pickles():
    atoms = waters(2)
    energy = atoms.get_potential_energy()
    for other in (copy.deepcopy(atoms), pickle.loads(pickle.dumps(atoms))):
        assert other.calc is not atoms.calc and other.topology == atoms.topology
        assert other.get_potential_energy() == pytest.approx(energy, rel=1e-13)
        other.positions[0] += 0.3
        assert other.get_potential_energy() != pytest.approx(energy, rel=1e-6)
    assert atoms.get_potential_energy() == energy
    calc = atoms.calc.copy()
    other = atoms.copy()
    other.calc = calc
    assert other.get_potential_energy() == pytest.approx(energy, rel=1e-13)
    shared = atoms.copy()
    shared.calc = atoms.calc                   # one calculator for two Atoms, in turns
    shared.positions[:, 0] *= 1.01
    first = shared.get_potential_energy()
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-13)
    assert shared.get_potential_energy() == pytest.approx(first, rel=1e-13)


def test_arguments_survive_json():
    atoms = waters(2)
    energy = atoms.get_potential_energy()
    for calc in (atoms.calc, ForceField(pair=SWITCHED, **WATER, topology=atoms.topology)):
        again = ForceField(**json.loads(json.dumps(calc.todict())))
        other = atoms.copy()
        other.calc = again
        assert other.get_potential_energy() == pytest.approx(energy, rel=1e-13)


def test_topology_beside_commands_survives_json():
    lines = ["bond_style harmonic", "bond_coeff 1 20.0 0.96"]
    calc = ForceField(commands=lines, units="metal", types=["O", "H"], topology=Topology(bonds=[[0, 1]]))
    atoms = PlainAtoms("OH", [[0, 0, 0], [1, 0, 0]])
    again = ForceField(**json.loads(json.dumps(calc.todict())))
    assert again.get_potential_energy(atoms) == pytest.approx(20.0 * 0.04**2, rel=1e-12)


def test_forces_of_lammps_where_they_are_no_gradient():
    atoms = asemd.Atoms("CCC", positions=[[1, 0, 0], [0, 0, 0], [-0.3, 1.1, 0.2]], topology=Topology(angles=[[0, 1, 2]], angle_types=[1]))
    atoms.calc = ForceField(angle={"mm3": {1: (2.0, 70.0)}}, compat="lammps")
    energy, forces = atoms.get_potential_energy(), atoms.get_forces()
    assert json.loads(json.dumps(atoms.calc.todict()))["compat"] == "lammps"
    atoms.calc = ForceField(angle={"mm3": {1: (2.0, 70.0)}})
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-14)
    assert 1e-6 < np.abs(atoms.get_forces() - forces).max() < 1e-2 * np.abs(forces).max()
    with pytest.raises(InputError, match="compat must be lammps or nothing, got 'gromacs'"):
        ForceField(compat="gromacs")


def test_repeated_atoms_have_repeated_energy():
    atoms = waters(2, SHAPES["tilted"])
    energy, forces = atoms.get_potential_energy(), atoms.get_forces()
    large = atoms * (2, 2, 1)
    large.calc = ForceField(pair=SWITCHED, **WATER)
    assert large.get_potential_energy() == pytest.approx(4 * energy, rel=1e-11)
    assert np.allclose(large.get_forces(), np.tile(forces, (4, 1)), atol=1e-9)


@pytest.mark.parametrize("ids", [True, False])
def test_molecules_across_faces_stay_molecules_in_repeated_cells(ids):
    """Their ids, by which TIP4P water finds its hydrogen atoms, and their molecule ids follow the bonds; periodic chains keep theirs."""
    atoms = waters(2, SHAPES["tilted"])
    atoms.set_array("mol-id", np.arange(24) // 3 + 1)
    if ids:
        atoms.set_array("id", np.arange(1, 25))
    atoms.positions += [0.3, 0.2, 0.1]
    calc = ForceField(commands=["bond_style harmonic", "bond_coeff 1 20 0.96", "angle_style harmonic", "angle_coeff 1 2 104.5",
                                "pair_style lj/cut/tip4p/cut 1 2 1 1 0.15 5 5", "pair_coeff 1 1 0.006 3.1", "pair_coeff 2 2 0 1"],
                      units="metal", types=["O", "H"])
    energy = calc.get_potential_energy(atoms)
    atoms.wrap()
    bonds = atoms.topology.bonds
    assert np.linalg.norm(atoms.positions[bonds[:, 0]] - atoms.positions[bonds[:, 1]], axis=1).max() > 3.0
    large = atoms * (1, 2, 3)
    assert calc.get_potential_energy(large) == pytest.approx(6 * energy, rel=1e-10)
    for name in ("mol-id", "id"):
        assert name == "mol-id" or len(set(large.arrays[name])) == len(large)
        apart = large.arrays[name][large.topology.bonds]
        assert np.abs(np.diff(apart)).max() <= (0 if name == "mol-id" else 2)
    chain = asemd.Atoms("C4", positions=[[1.5 * k, 0, 0] for k in range(4)], cell=[6, 9, 9], pbc=True,
                        topology=Topology(bonds=[[0, 1], [1, 2], [2, 3], [3, 0]]))
    chain.set_array("mol-id", np.array([5] * 4))
    assert (chain * (2, 1, 1)).arrays["mol-id"].tolist() == [5] * 4 + [10] * 4


def test_hydrogen_atoms_of_tip4p_are_those_with_bonds():
    atoms = asemd.Atoms("OHHOHH", positions=[[0, 0, 0], [0.9, 0, 0], [-0.2, 0.9, 0], [4, 0, 0], [4.9, 0, 0], [3.8, 0.9, 0]], cell=[12] * 3,
                        pbc=True, topology=Topology(bonds=[[0, 1], [0, 2], [3, 4], [3, 5]]))
    atoms.set_initial_charges([-1, 0.5, 0.5] * 2)
    calc = ForceField(commands=["bond_style harmonic", "bond_coeff 1 20 0.96", "angle_style harmonic", "angle_coeff 1 2 104.5",
                                "pair_style tip4p/cut 1 2 1 1 0.15 5", "pair_coeff * *"], units="metal", types=["O", "H"])
    calc.get_potential_energy(atoms)
    with pytest.raises(InputError, match="atoms 2 and 3 behind oxygen atom 1 are not those bonded to it"):
        calc.get_potential_energy(atoms[[3, 1, 2, 0, 4, 5]])


def test_slices_and_deleted_atoms():
    """Molecules apart: the energy of a part is the sum over its molecules."""
    atoms = waters(2, spacing=12.0)
    calc = atoms.calc
    energies = []
    for k in range(8):
        one = atoms[3 * k:3 * k + 3]
        one.calc = calc
        energies.append(one.get_potential_energy())
    assert atoms.get_potential_energy() == pytest.approx(sum(energies), rel=1e-12)
    del atoms[[3, 4, 5]]
    assert atoms.get_potential_energy() == pytest.approx(sum(energies) - energies[1], rel=1e-12)
    del atoms[0]                                     # the bonds of this molecule are gone
    assert len(atoms.topology.bonds) == 12
    broken = atoms.get_potential_energy()
    atoms.topology = Topology()
    atoms.calc = calc
    assert atoms.get_potential_energy() != pytest.approx(broken, rel=1e-3)


def test_types_stay_when_an_element_vanishes():
    pair = {"lj/cut 6.0": {("Ar", "Ar"): (0.0104, 3.4), ("Kr", "Kr"): (0.014, 3.6), ("Ar", "Kr"): (0.012, 3.5)}}
    atoms = PlainAtoms("ArKrKr", positions=[[0, 0, 0], [4, 0, 0], [0, 4.2, 0]], calculator=ForceField(pair=pair))
    atoms.get_potential_energy()
    del atoms[0]
    r = np.sqrt(16 + 4.2**2)
    assert atoms.get_potential_energy() == pytest.approx(4 * 0.014 * ((3.6 / r) ** 12 - (3.6 / r) ** 6), rel=1e-12)
    with pytest.raises(InputError, match="coeff|missing|not set"):
        atoms.append("Xe")
        atoms.get_potential_energy()


ORIENTED = {
    "gayberne": ({"gayberne 1.0 3.0 1.0 4.5": {("Ar", "Ar"): (0.1, 3.4, 1.0, 1.0, 0.2, 1.0, 1.0, 0.2)}}, "", 1e-8),
    "lj/cut/dipole/cut": ({"lj/cut/dipole/cut 4.5 8": {("Ar", "Ar"): (0.01, 3.0)}}, "", 1e-8),
    "lj/long/dipole/long": ({"lj/long/dipole/long cut long 4.5": {("Ar", "Ar"): (0.01, 3.0)}}, "ewald/disp 1e-8", 2e-6),
}


@pytest.mark.parametrize("name", ORIENTED)
def test_stress_of_atoms_that_turn(name):
    """All six components are derivatives by a strain under which atoms keep their orientation."""
    pair, kspace, precision = ORIENTED[name]
    rng = np.random.default_rng(1)
    atoms = PlainAtoms("Ar4", rng.random((4, 3)) * 2 + [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]], cell=[9, 9, 9], pbc=True)
    turns = rng.normal(size=(4, 4))
    if name == "gayberne":
        atoms.set_array("shape", np.full((4, 3), 1.0) * [2, 3, 4])
        atoms.set_array("quaternions", turns / np.linalg.norm(turns, axis=1)[:, None])
    else:
        atoms.set_array("mu", 0.3 * turns[:, :3])
        atoms.set_initial_charges([0.5, -0.5, 0.5, -0.5])
    atoms.calc = ForceField(pair=pair, kspace=kspace)
    stress = atoms.get_stress()
    assert np.abs(stress - calculate_numerical_stress(atoms, 1e-5)).max() < precision * np.abs(stress).max()
    assert np.abs(atoms.get_stresses().sum(axis=0) - stress).max() < 1e-12 * np.abs(stress).max()
    atoms.set_velocities(0.01 * rng.normal(size=(4, 3)))
    asemd.MolecularDynamics(atoms, 0.01).run(3)
    after = atoms.get_stress(include_ideal_gas=False)
    assert np.abs(after - calculate_numerical_stress(atoms, 1e-5)).max() < precision * np.abs(after).max()


def test_scripts_in_two_dimensions_come_back_from_their_arguments(tmp_path):
    atoms = read(tmp_path, "units lj\ndimension 2\nlattice hex 0.8\nregion b block 0 6 0 6 -0.5 0.5\ncreate_box 1 b\ncreate_atoms 1 box\n"
                           "mass 1 1\npair_style lj/cut 2.5\npair_coeff 1 1 1 1\n")
    other = atoms.copy()
    other.calc = ForceField(**json.loads(json.dumps(atoms.calc.todict())))
    assert other.get_potential_energy() == pytest.approx(atoms.get_potential_energy(), rel=1e-14)
    assert other.calc.commands() == atoms.calc.commands() and other.calc.commands()[0] == "dimension 2"


def test_energies_do_not_depend_on_what_was_asked_before():
    calc = ForceField(pair={"lj/cut 6.0": {("Ar", "Ar"): (0.01, 3.4)}})
    argon, krypton = bulk("Ar", a=5.3), bulk("Kr", a=5.3)
    energy = calc.get_potential_energy(argon)
    with pytest.raises(InputError, match="no coefficients for Ar-Kr, Kr-Kr: given are those for Ar-Ar"):
        calc.get_potential_energy(krypton)
    assert calc.get_potential_energy(argon) == energy
    numbered = {"lj/cut 6.0": {(1, 1): (0.01, 3.4), (2, 2): (0.02, 3.6)}}
    one, both_ = PlainAtoms("Kr2", [[0, 0, 0], [3.7, 0, 0]]), PlainAtoms("KrAr2", [[0, 0, 0], [3.7, 0, 0], [0, 3.7, 0]])
    calc = ForceField(pair=numbered)
    calc.get_potential_energy(one)
    with pytest.raises(InputError, match=r"other elements than those before \(Kr\): say .* types=\['Ar', 'Kr'\]"):
        calc.get_potential_energy(both_)
    orders = [[one, both_], [both_, one]]
    calcs = [ForceField(pair=numbered, types=["Ar", "Kr"]) for _ in orders]
    energies = [{id(a): c.get_potential_energy(a) for a in order} for c, order in zip(calcs, orders)]
    assert energies[0] == energies[1]


# ------------------------------------------------------------------------------------------------------------------------ changes ---

CHANGES = {
    "positions": lambda a: a.positions.__setitem__((0, 0), a.positions[0, 0] + 0.1),
    "charges": lambda a: a.set_initial_charges(a.get_initial_charges() * 1.2),
    "elements": lambda a: a.numbers.__setitem__([0, 1], a.numbers[[1, 0]]),
    "cell": lambda a: a.set_cell(a.cell.array * 1.02, scale_atoms=True),
    "cell alone": lambda a: a.set_cell(a.cell.array * 1.05),
    "pbc": lambda a: a.set_pbc((True, False, True)),
    "bonds": lambda a: setattr(a, "topology", Topology(angles=a.topology.angles)),
    "bonds in place": lambda a: a.topology.bonds.__setitem__((0, 1), 2),
    "bond types": lambda a: a.topology.bond_types.__setitem__(0, 2),
}


@pytest.mark.parametrize("change", CHANGES)
def test_changes_are_noticed(change):
    def fresh():
        a = waters(2)
        a.calc = ForceField(pair=SWITCHED, **(WATER | {"bond": {"harmonic": {1: (20.0, 0.96), 2: (25.0, 1.1)}}}))
        return a
    atoms, other = fresh(), fresh()
    before = atoms.get_potential_energy()
    assert not atoms.calc.calculation_required(atoms, ["energy", "forces"])
    CHANGES[change](atoms)
    CHANGES[change](other)
    assert atoms.calc.calculation_required(atoms, ["energy"])
    assert atoms.get_potential_energy() == pytest.approx(other.get_potential_energy(), rel=1e-11)
    assert np.allclose(atoms.get_forces(), other.get_forces(), atol=1e-9)
    assert atoms.get_potential_energy() != pytest.approx(before, rel=1e-9)


@pytest.mark.parametrize(("lines", "array", "before", "after"), [
    (["pair_style lj/cut/sphere 8.0", "pair_coeff * * 0.01"], "radius", [1.7, 1.7, 1.7], [1.5, 1.6, 1.7]),
    (["pair_style hybrid/molecular lj/cut 6.0 morse 6.0", "pair_coeff * * lj/cut 0.01 3.4", "pair_coeff * * morse 0.1 1.5 3.0"],
     "mol-id", [1, 1, 2], [1, 2, 3]),
    (["pair_style lepton/coul 8.0", "pair_coeff * * qi*qj/r"], "initial_charges", [0.5, -0.5, 0.1], [0.5, 0.5, 0.1])])
def test_changes_of_arrays_of_lammps_are_noticed(lines, array, before, after):
    def fresh(values):
        a = PlainAtoms("Ar3", [[0, 0, 0], [3.5, 0, 0], [0, 3.6, 0]], cell=[20] * 3, pbc=True)
        a.set_array(array, np.array(values))
        a.calc = ForceField(commands=lines, units="metal", types=["Ar"])
        return a
    atoms, other = fresh(before), fresh(after)
    atoms.get_potential_energy()
    atoms.arrays[array][:] = after
    for shift in (0.0, 0.1):
        for a in (atoms, other):
            a.positions[0, 1] += shift
        assert atoms.get_potential_energy() == pytest.approx(other.get_potential_energy(), rel=1e-12)


def test_changes_that_do_not_matter_cost_nothing():
    atoms = waters(2)
    atoms.get_potential_energy()
    atoms.set_momenta(np.ones((len(atoms), 3)))
    atoms.set_masses(np.full(len(atoms), 5.0))
    atoms.info["x"] = 1
    atoms.set_constraint(FixAtoms([0]))
    assert not atoms.calc.calculation_required(atoms, ["energy", "forces"])


def test_the_list_is_kept_while_atoms_move_a_little():
    atoms = argon(3)
    atoms.get_potential_energy()
    for _ in range(5):
        atoms.positions += np.random.default_rng(1).normal(0, 0.02, (len(atoms), 3))
        atoms.get_forces()
    assert atoms.calc.engine.builds == 1


def test_atoms_far_outside_the_cell():
    atoms, other = waters(2), waters(2)
    other.positions += np.random.default_rng(1).integers(-3, 4, (len(atoms), 3)) @ other.cell.array
    assert other.get_potential_energy() == pytest.approx(atoms.get_potential_energy(), rel=1e-11)
    assert np.allclose(other.get_forces(), atoms.get_forces(), atol=1e-10)
    atoms.positions[3] += atoms.cell.array[0] * 2          # an atom that jumps by whole cells between two calls
    assert atoms.get_potential_energy() == pytest.approx(other.get_potential_energy(), rel=1e-11)


def test_constraints_hold():
    atoms = argon(2)
    atoms.set_constraint([FixAtoms([0, 1]), FixCartesian([5], (True, False, True))])
    x = atoms.positions.copy()
    BFGS(atoms, logfile=None).run(fmax=1e-3, steps=20)
    assert np.array_equal(atoms.positions[:2], x[:2]) and np.array_equal(atoms.positions[5, [0, 2]], x[5, [0, 2]])
    assert np.abs(atoms.get_forces(apply_constraint=False)[0]).max() > 0 == np.abs(atoms.get_forces()[0]).max()


@pytest.mark.parametrize("options", [{"threads": 2}, {"precision": "mixed"}])
def test_threads_and_precision(options):
    atoms = argon(4)
    exact = atoms.get_forces()
    atoms.calc = ForceField(pair=ARGON, **options)
    assert np.sqrt(((atoms.get_forces() - exact) ** 2).mean() / (exact**2).mean()) < 1e-6


# ------------------------------------------------------------------------------------------------------- scenes without a script ---

def test_bead_chain_with_topology_in_the_calculator():
    n, k, r0 = 20, 2.0, 1.5
    rng = np.random.default_rng(2)
    x = np.cumsum(rng.normal(0, 0.9, (n, 3)), axis=0)
    bonds = [(i, i + 1) for i in range(n - 1)]
    atoms = PlainAtoms(f"C{n}", positions=x)
    atoms.calc = ForceField(bond={"harmonic": {1: (k, r0)}}, topology=Topology(bonds=bonds))
    r = np.linalg.norm(np.diff(x, axis=0), axis=1)
    assert atoms.get_potential_energy() == pytest.approx((k * (r - r0) ** 2).sum(), rel=1e-12)
    assert "harmonic" in repr(atoms.calc)
    own = asemd.Atoms(atoms)
    own.calc = ForceField(bond={"harmonic": {1: (k, r0)}}, topology={"bonds": bonds})
    assert own.get_potential_energy() == pytest.approx(atoms.get_potential_energy(), rel=1e-12)
    for other in (atoms[:10], atoms * (2, 1, 1) if atoms.cell.rank == 3 else atoms + atoms):
        other.calc = atoms.calc
        with pytest.raises(InputError, match="topology"):
            other.get_potential_energy()


def test_types_by_number_array():
    atoms = PlainAtoms("X3", positions=[[0, 0, 0], [3.5, 0, 0], [0, 3.9, 0]])
    atoms.set_array("type", np.array([1, 2, 2]))
    atoms.calc = ForceField(pair={"lj/cut 8.0": {(1, 1): (0.01, 3.0), (1, 2): (0.02, 3.2), (2, 2): (0.03, 3.4)}})

    def lj(e, s, r):
        return 4 * e * ((s / r) ** 12 - (s / r) ** 6)
    expected = lj(0.02, 3.2, 3.5) + lj(0.02, 3.2, 3.9) + lj(0.03, 3.4, np.hypot(3.5, 3.9))
    assert atoms.get_potential_energy() == pytest.approx(expected, rel=1e-12)
    atoms.arrays["type"][1] = 1
    assert atoms.get_potential_energy() != pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("make, message", [
    (lambda: ForceField(pair={"lj/cut 8.0": {("Ar", "Xx"): (1, 1)}}), "Xx|coeff|missing"),
    (lambda: ForceField(pair={"lj/cut 8.0": {}}), "pair_coeff|coefficients|coeffs"),
    (lambda: ForceField(pair={"lj/cutt 8.0": {(1, 1): (1, 1)}}), "did you mean"),
    (lambda: ForceField(pair={"lj/cut 8.0": {(1, 1): (1,)}}), "epsilon sigma"),
    (lambda: ForceField(pair={"lj/cut/coul/cut 8.0": {(1, 1): (1, 3.4)}}), "set_initial_charges"),
    (lambda: ForceField(pair=ARGON, bond={"harmonic": {}}, topology=Topology(bonds=[(0, 1)])), "bond"),
    (lambda: ForceField(pair=ARGON, bond={"harmonic": {1: (1, 1)}}, topology=Topology(bonds=[(0, 1)], bond_types=[2])), "bond_coeff.* 2"),
    (lambda: ForceField(pair=ARGON, topology=Topology(bonds=[(0, 99)])), "names atom 99"),
    (lambda: ForceField(pair=ARGON, precision="half"), "double or mixed"),
    (lambda: ForceField(pair=ARGON, skin=-1), "skin"),
    *((lambda v=v: ForceField(pair=ARGON, dielectric=v), f"dielectric must be a positive number, got {v!r}") for v in (0, -1.0, "2")),
    *((lambda v=v: ForceField(pair=ARGON, threads=v), f"threads must be a whole number from 1, got {v!r}") for v in (0, 2.5, "2")),
    (lambda: ForceField(pair={"lj/cut 8.0": (0.01, 3.4)}), "coefficients are a mapping from type to values"),
    (lambda: ForceField(pair=ARGON, types=[18]), "types are elements in the order of their types, .*got 18"),
    (lambda: ForceField(pair={"lj/cut 8.0": {("Aq", "Ar"): (1, 3)}}), "'Aq' is no chemical symbol"),
    (lambda: ForceField(pair={"lj/cut 8.0": {("Kr", "Kr"): (1, 3)}}), "no coefficients for Ar-Ar, Ar-Kr: given are those for Kr-Kr"),
    (lambda: ForceField(pair={"lj/cut 8.0": {("Ar", "Kr"): (1, 3), ("Kr", "Ar"): (2, 3)}}), "is there twice, with other values"),
])
def test_mistakes_are_input_errors(make, message):
    atoms = bulk("Ar", "fcc", 5.26, cubic=True)
    with pytest.raises(InputError, match=message):
        atoms.calc = make()
        atoms.get_potential_energy()


def test_bad_positions_name_the_atom_and_leave_the_calculator_usable():
    atoms = argon(2)
    energy = atoms.get_potential_energy()
    x = atoms.positions.copy()
    atoms.positions[4] = np.nan
    for _ in range(2):
        with pytest.raises(SimulationError, match="atom"):
            atoms.get_potential_energy()
    atoms.positions[:] = x
    atoms.positions[4] = x[5]
    with pytest.raises(SimulationError, match="atoms 5 and 6"):
        atoms.get_potential_energy()
    atoms.positions[:] = x
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-12)


# ------------------------------------------------------------------------------------------------------------------------ scripts ---

BASE = """
units {units}
atom_style full
boundary p p {z}
region b block 0 {l} 0 {l} 0 {l}
lattice custom {d} a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.1 0.1 0.1
create_box 2 b
create_atoms 1 box
set group all type/fraction 2 0.4 123
mass 1 12
mass 2 16
set type 1 charge 0.2
set type 2 charge -0.3
pair_style lj/cut/coul/cut {c}
pair_coeff 1 1 {e} {s}
pair_coeff 2 2 {e} {s}
displace_atoms all random {r} {r} {r} 55
group low id <= 20
group mid id 21:30
group two type 2
{more}
run 0
"""
NUMBERS = {"real": dict(l=20, d=4, c=8.0, e=0.1, s=3.3, r=0.3), "metal": dict(l=20, d=4, c=8.0, e=0.005, s=3.3, r=0.3),
           "lj": dict(l=6, d=1.2, c=2.4, e=1.0, s=1.0, r=0.1)}
FACTORS = {"real": (units.kcal / units.mol, 1.0), "metal": (1.0, 1.0), "lj": (1.0, 1.0)}


def script(unit: str = "real", more: str = "", z: str = "p") -> str:
    numbers = dict(NUMBERS[unit], more=more, z=z, units=unit)
    numbers["d"] = f"{numbers['d']}" if unit != "lj" else f"{1 / numbers['d']**3}"
    return BASE.format(**numbers)


def read(tmp_path, text: str):
    path = tmp_path / "in.script"
    path.write_text(text)
    return asemd.read(path)


@pytest.mark.parametrize("unit", FACTORS)
@pytest.mark.parametrize("more", ["", "pair_modify tail yes", "neigh_modify exclude group low two\nneigh_modify exclude type 1 1",
                                  "special_bonds lj 0 0 0.5 coul 0 0 0.8", "dielectric 2.0"])
def test_scripts_give_the_energies_of_lammps(tmp_path, unit, more):
    text = script(unit, more)
    atoms = read(tmp_path, text)
    with ran(text + "\nthermo_modify norm no\nrun 0") as session:
        energy, forces = session.get_thermo("pe"), np.array(session.gather_atoms("f", 1, 3)).reshape(-1, 3)
    e, d = FACTORS[unit]
    assert atoms.get_potential_energy() == pytest.approx(energy * e, rel=1e-9)
    assert np.allclose(atoms.get_forces(), forces * e / d, rtol=0, atol=1e-8 * np.abs(forces).max())
    assert np.allclose(calculate_numerical_forces(atoms, 1e-4, iatoms=[3])[0], atoms.get_forces()[3], atol=1e-4)
    assert json.dumps(atoms.calc.todict())


def test_script_atoms_can_be_copied_repeated_and_sliced(tmp_path):
    atoms = read(tmp_path, script("real", "neigh_modify exclude group low two\nfix 1 two addforce 0.5 0 -1"))
    energy = atoms.get_potential_energy()
    for other in (copy.deepcopy(atoms), pickle.loads(pickle.dumps(atoms))):
        assert other.get_potential_energy() == pytest.approx(energy, rel=1e-12)
    atoms = read(tmp_path, script("real", "neigh_modify exclude group low two"))
    large = atoms * (2, 1, 1)
    large.calc = atoms.calc
    assert large.get_potential_energy() == pytest.approx(2 * atoms.get_potential_energy(), rel=1e-10)
    part = atoms[atoms.arrays["type"] == 2]
    part.calc = atoms.calc
    assert np.isfinite(part.get_potential_energy())
    bare = PlainAtoms(atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell, pbc=True)
    bare.calc = atoms.calc
    with pytest.raises(InputError, match="array 'type'"):
        bare.get_potential_energy()


def test_added_forces_are_part_of_the_calculator(tmp_path):
    more = "fix 1 two addforce 0.5 0 -1\nfix 2 all addforce 0.1 0.2 0.3\nfix_modify 1 energy yes\nfix_modify 2 energy yes"
    atoms, free = read(tmp_path, script("real", more)), read(tmp_path, script("real"))
    two, kcal = atoms.arrays["type"] == 2, units.kcal / units.mol
    forces = kcal * (np.where(two[:, None], [0.5, 0, -1.0], 0) + [0.1, 0.2, 0.3])
    assert np.allclose(atoms.get_forces() - free.get_forces(), forces, atol=1e-12)
    unwrapped = atoms.positions + atoms.arrays["image"] @ atoms.cell.array
    assert atoms.get_potential_energy() - free.get_potential_energy() == pytest.approx(-(forces * unwrapped).sum(), rel=1e-9)
    assert np.allclose(calculate_numerical_forces(atoms, 1e-4, iatoms=[3, 40]), atoms.get_forces()[[3, 40]], atol=1e-6)
    assert np.allclose(calculate_numerical_stress(atoms, 1e-5), atoms.get_stress(), atol=1e-7)
    assert atoms.get_potential_energies().sum() == pytest.approx(atoms.get_potential_energy(), rel=1e-10)
    assert np.allclose(atoms.get_stresses().sum(0), atoms.get_stress(), atol=1e-12)
    assert "addforce 0.5 0 -1 on group two" in repr(atoms.calc)
    energy = atoms.get_potential_energy()
    session = both.asemd(script("real", more) + "thermo_style custom step pe\nthermo_modify norm no\nrun 0\n")
    assert session.last_thermo["PotEng"] * kcal == pytest.approx(energy, rel=1e-9)
    atoms.arrays["image"][two] += 1            # unwrapped positions count
    jump = -(forces[two] @ atoms.cell.array.sum(0)).sum()
    assert atoms.get_potential_energy() - energy == pytest.approx(jump, rel=1e-9)


LOADS = {
    "efield": "efield 0.1 0.2 -0.3", "spring": "spring tether 5 3 NULL 4 1.5", "spring couple": "spring couple low 5.0 1 2 3 0.5",
    "spring/self": "spring/self 4.0 xy", "indent": "indent 10 sphere 5 5 5 6 units box",
    "walls": "wall/harmonic zlo EDGE 1 1 4 zhi EDGE 1 1 3",
    "restrain": "restrain bond 1 2 5 5 2.5 angle 1 2 3 5 5 100 dihedral 1 2 3 4 5 5 30 mult 2",
}


@pytest.mark.parametrize("name", LOADS)
def test_forces_of_fixes_that_go_by_positions_are_part_of_the_calculator(tmp_path, name):
    away, kcal = "displace_atoms all move 0 0 1.2 units box\n", units.kcal / units.mol
    fix, then = f"fix 1 two {LOADS[name]}\nfix_modify 1 energy yes\n", "displace_atoms two move 0.2 0.1 0 units box\n"
    text = script("real", away + fix + then, "f")
    atoms, free = read(tmp_path, text), read(tmp_path, script("real", away + then, "f"))
    virial = "fix_modify 1 virial yes\n" if name in ("efield", "walls") else ""
    session = both.asemd(text + virial + "thermo_style custom step pe pxx pyy pzz\nthermo_modify norm no\nrun 0\n")
    forces, energy = session.scene.system.f[np.argsort(session.scene.system.id)], atoms.get_potential_energy()
    assert abs(forces - free.get_forces() / kcal).max() > 1e-3
    assert energy == pytest.approx(session.last_thermo["PotEng"] * kcal, rel=1e-12)
    assert np.allclose(atoms.get_forces() / kcal, forces, rtol=0, atol=1e-11 * abs(forces).max())
    pressure = [session.last_thermo[word] * 101325 * units.Pascal for word in ("Pxx", "Pyy", "Pzz")]
    assert np.allclose(atoms.get_stress()[:3], -np.array(pressure), rtol=1e-5)      # an atmosphere has five digits in units real
    index = [0, 3, 40]
    assert np.allclose(calculate_numerical_forces(atoms, 1e-4, iatoms=index), atoms.get_forces()[index], atol=1e-5)
    if name == "efield":
        assert np.allclose(calculate_numerical_stress(atoms, 1e-5), atoms.get_stress(), atol=1e-7)
    assert atoms.get_potential_energies().sum() == pytest.approx(energy, rel=1e-10)
    assert np.allclose(atoms.get_stresses().sum(0), atoms.get_stress(), atol=1e-12)
    assert f"{LOADS[name].split()[0]} " in repr(atoms.calc)
    for other in (copy.deepcopy(atoms), pickle.loads(pickle.dumps(atoms))):
        assert other.get_potential_energy() == pytest.approx(energy, rel=1e-12)
    asemd.MolecularDynamics(atoms, 0.2 * units.fs, fixes=[asemd.fix.NVE()]).run(5)
    here = atoms.get_potential_energy(), atoms.get_forces()
    atoms.calc.reset()
    assert np.allclose(atoms.get_forces(), here[1], atol=1e-9) and atoms.get_potential_energy() == pytest.approx(here[0], rel=1e-10)


def test_a_field_turns_with_charges_and_dipoles(tmp_path):
    atoms = read(tmp_path, script("real", "fix 1 two efield 0.1 0.2 -0.3"))
    energy, q = atoms.get_potential_energy(), atoms.get_initial_charges()
    two = atoms.arrays["type"] == 2
    unwrapped = atoms.positions + atoms.arrays["image"] @ atoms.cell.array
    free = read_free(tmp_path)
    added = -(q[:, None] * unwrapped)[two].sum(0) @ [0.1, 0.2, -0.3]
    assert energy - free.get_potential_energy() == pytest.approx(added, rel=1e-6)       # of a volt and an elementary charge in units real
    atoms.set_array("mu", np.tile([0.0, 0.0, 0.5], (len(atoms), 1)))
    assert atoms.get_potential_energy() - energy == pytest.approx(0.15 * two.sum(), rel=1e-6)
    del atoms.arrays["mu"], atoms.arrays["initial_charges"]
    with pytest.raises(InputError, match="needs charges"):
        atoms.get_potential_energy()


def test_loads_say_what_they_cannot_do(tmp_path):
    atoms = read(tmp_path, script("real", "fix 1 two spring/self 4.0"))
    with pytest.raises(InputError, match="no second derivatives of fix spring/self"):
        atoms.calc.get_hessian(atoms)
    part = atoms[:10]
    part.calc = atoms.calc
    with pytest.raises(InputError, match="spring/self of the calculator is for"):
        part.get_potential_energy()
    atoms = read(tmp_path, script("real", "displace_atoms all move 0 0 1.2 units box\nfix 1 all wall/lj93 zlo -3 1 1 2.5 units box", "f"))
    atoms.positions[3, 2] = -3.5
    with pytest.raises(SimulationError, match="wall/lj93: atom 4 is on the wall or behind it"):
        atoms.get_potential_energy()


def test_forces_set_to_zero_are_constraints(tmp_path):
    more = "fix 1 low setforce 0 0 0\nfix 2 mid setforce NULL 0.0 NULL\nfix 3 all nve"
    atoms = read(tmp_path, script("real", more))
    fixed, cartesian = atoms.constraints
    assert isinstance(fixed, FixAtoms) and fixed.index.tolist() == list(range(20))
    assert isinstance(cartesian, FixCartesian) and cartesian.index.tolist() == list(range(20, 30))
    forces = atoms.get_forces()
    assert np.all(forces[:20] == 0) and np.all(forces[20:30, 1] == 0) and np.all(forces[20:30, [0, 2]] != 0)


@pytest.mark.parametrize(("fix", "kept"), [
    ("lineforce 1 0 0", [[1, 0, 0], [0, 0, 0], [0, 0, 0]]), ("planeforce 0 0 2", [[1, 0, 0], [0, 1, 0], [0, 0, 0]]),
    ("lineforce 1 1 0", [[0.5, 0.5, 0], [0.5, 0.5, 0], [0, 0, 0]]), ("planeforce 1 1 0", [[0.5, -0.5, 0], [-0.5, 0.5, 0], [0, 0, 1]])])
def test_forces_along_lines_and_planes_are_constraints(tmp_path, fix, kept):
    atoms = read(tmp_path, script("real", f"fix 1 low {fix}"))
    free = atoms.get_forces(apply_constraint=False)
    assert np.allclose(atoms.get_forces()[:20], free[:20] @ np.array(kept), atol=1e-12)
    assert np.array_equal(atoms.get_forces()[20:], free[20:])


def test_atoms_in_two_dimensions_have_the_temperature_of_two(tmp_path):
    atoms = read(tmp_path, "units metal\ndimension 2\nlattice sq2 4\nregion b block 0 4 0 4 -0.1 0.1\ncreate_box 1 b\ncreate_atoms 1 box\n"
                           "mass 1 40\nvelocity all create 80 123\npair_style lj/cut 6\npair_coeff 1 1 0.01 3.4\nfix 2 all enforce2d\n")
    assert atoms.get_temperature() == pytest.approx(80.0 * 62 / 64, rel=1e-4)       # LAMMPS takes two degrees off for the drift


@pytest.mark.parametrize("fix", ["adapt 1 atom charge v_k", "qeq/point 1 6.0 1.0e-6 200 q.par", "ti/spring 10.0 5 5"])
def test_fixes_that_change_energies_are_named(tmp_path, monkeypatch, fix):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "q.par").write_text("1 5.0 7.0 1.0 1.0 0.0\n2 6.0 8.0 1.0 1.0 0.0\n")
    with pytest.warns(InputWarning, match=f"fix 1 .{fix.split()[0]}. is not part of the calculator"):
        read(tmp_path, script("real", f"variable k equal 0.3\nfix 1 all {fix}"))


def test_variables_of_the_force_field_have_their_values_of_the_run(tmp_path):
    """Factors of hybrid/scaled, and expressions that name variables which change after their pair_coeff."""
    more = """variable f equal 0.3
variable k equal 0.9
pair_style hybrid/scaled v_f lj/cut 8.0 0.4 lepton 6.0
pair_coeff * * lj/cut 0.1 3.3
pair_coeff * * lepton "4*eps*((3.3/r)^12-(3.3/r)^6);eps=v_k"
variable k equal 0.5
"""
    atoms = read(tmp_path, script("real", more))
    with ran(script("real", more)) as session:
        energy = session.get_thermo("pe") * FACTORS["real"][0]
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-9)
    assert ForceField(**json.loads(json.dumps(atoms.calc.todict()))).get_potential_energy(atoms) == pytest.approx(energy, rel=1e-9)
    with pytest.warns(InputWarning, match="variable f of the force field may change during a run"):
        read(tmp_path, script("real", more.replace("0.3", "0.3+step", 1)))
    with pytest.raises(InputError, match="atom-style variable f as a factor forces are not the gradient"):
        read(tmp_path, script("real", more.replace("f equal 0.3", "f atom 0.3*id")))


def test_forces_without_an_energy_are_left_out_and_named(tmp_path):
    more = ("variable f atom -x\nfix 1 low setforce 1.0 0 0\nfix 2 two addforce v_f 0 0\nfix 3 two efield v_f 0 0\n"
            "fix 4 all restrain bond 1 2 5 6 2.5\nfix 5 all gravity 1 vector 0 0 -1\nfix 6 all viscous 1.0")
    with pytest.warns(InputWarning, match="is not part of the calculator") as caught:
        atoms = read(tmp_path, script("real", more))
    assert {str(w.message)[:5] for w in caught} == {f"fix {k}" for k in range(1, 6)}
    assert not atoms.constraints and "fix 2 (addforce)" in repr(atoms.calc)
    assert atoms.get_potential_energy() == pytest.approx(read_free(tmp_path).get_potential_energy(), rel=1e-12)


def read_free(tmp_path):
    return read(tmp_path, script("real"))


def test_atoms_come_in_order_of_id(tmp_path):
    data = tmp_path / "x.data"
    data.write_text("made by a test\n\n3 atoms\n1 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\nMasses\n\n1 40.0\n\n"
                    "Atoms # atomic\n\n3 1 1.0 1.0 1.0\n1 1 4.0 1.0 1.0\n2 1 1.0 5.0 1.0\n")
    atoms = read(tmp_path, f"units metal\natom_style atomic\nread_data {data}\npair_style lj/cut 4.0\n"
                 "pair_coeff 1 1 0.01 3.0\nfix 1 all nve\nrun 5")
    assert atoms.arrays["id"].tolist() == [1, 2, 3]
    assert atoms.positions[0].tolist() == [4.0, 1.0, 1.0]
    assert np.isfinite(atoms.get_potential_energy())


def test_atoms_can_be_written_and_printed():
    atoms = waters(2)
    atoms.get_potential_energy()
    from ase.io import read as ase_read
    from ase.io import write as ase_write
    buffer = io.StringIO()
    ase_write(buffer, atoms, format="extxyz")
    buffer.seek(0)
    assert ase_read(buffer, format="extxyz").get_potential_energy() == pytest.approx(atoms.get_potential_energy(), rel=1e-6)
    assert "lj/charmm" in repr(atoms.calc)


def test_special_bonds_by_three_numbers():
    same = [Interactions.build(pair={"lj/cut 3.0": {(1, 1): (1.0, 1.0)}}, special_bonds=special)
            for special in ((0.0, 0.25, 0.5), {"lj/coul": (0.0, 0.25, 0.5)}, "lj/coul 0.0 0.25 0.5")]
    assert {(i.special_lj, i.special_coul) for i in same} == {((0.0, 0.25, 0.5), (0.0, 0.25, 0.5))}


def test_plain_atoms_with_a_bonded_force_field_are_refused():
    """Atoms that have lost their bonds on the way through a file or a tool must not get energies without them."""
    plain = PlainAtoms("H2", positions=[[0, 0, 0], [0.9, 0, 0]])
    plain.calc = ForceField(bond={"harmonic": {1: (10.0, 1.0)}})
    with pytest.raises(InputError, match="bond styles.*topology"):
        plain.get_potential_energy()
    plain.calc = ForceField(bond={"harmonic": {1: (10.0, 1.0)}}, topology=Topology(bonds=[[0, 1]], bond_types=[1]))
    assert plain.get_potential_energy() == pytest.approx(0.1)
    own = asemd.Atoms(plain)
    own.calc = ForceField(bond={"harmonic": {1: (10.0, 1.0)}})
    assert own.get_potential_energy() == 0.0


@pytest.mark.parametrize("row", [5, -1])
def test_bonds_to_atoms_that_do_not_exist(row):
    atoms = asemd.Atoms("H2", positions=[[0, 0, 0], [0.9, 0, 0]], topology=Topology(bonds=[[0, row]], bond_types=[1]))
    atoms.calc = ForceField(bond={"harmonic": {1: (10.0, 1.0)}})
    with pytest.raises(InputError, match=f"the bonds name atom {row}, but the atoms are 0 to 1"):
        atoms.get_potential_energy()


def test_position_that_is_not_finite():
    atoms = asemd.Atoms("Ar2", positions=[[0, 0, 0], [np.nan, 0, 0]])
    atoms.calc = ForceField(pair=ARGON)
    with pytest.raises(SimulationError, match="position of atom 2 is not finite"):
        atoms.get_potential_energy()


def test_style_without_coefficients():
    with pytest.raises(InputError, match="styles are given with their coefficients.*got 'harmonic'"):
        ForceField(bond="harmonic")


def test_appended_atom_without_type(tmp_path):
    (tmp_path / "in.lj").write_text("units metal\nlattice fcc 5.26\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 box\n"
                                    "mass 1 39.948\npair_style lj/cut 5.0\npair_coeff 1 1 0.0104 3.40\nrun 0\n")
    atoms = asemd.read(tmp_path / "in.lj")
    atoms.append("Ar")
    with pytest.raises(InputError, match=r"atoms\[32\] has the type 0: set atoms.arrays\['type'\]"):
        atoms.get_potential_energy()
