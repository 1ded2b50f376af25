"""Space groups by force-field types and bonds; cells, second derivatives and elastic constants that follow from them."""
from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from ase import Atoms as PlainAtoms
from ase.build import bulk
from ase.calculators.calculator import Calculator, all_changes
from ase.io import read
from ase.optimize import BFGS
from ase.spacegroup import crystal
from wheel import ran

from asemd import Atoms, ForceField, InputError, SimulationError, Symmetry, Topology
from asemd.cli import main
from asemd.interop.cells import recell
from asemd.interop.symmetric import KeepSymmetry

pytest.importorskip("spglib")
ARGON = {"lj/cut 8.5": {("Ar", "Ar"): (0.0104, 3.4)}}


def carbon_dioxide() -> Atoms:
    """Pa-3, four bonded molecules in a cell; a bond of C is never along another one."""
    plain = crystal(["C", "O"], [(0, 0, 0), (0.119, 0.119, 0.119)], spacegroup=205, cellpar=[5.6] * 3 + [90] * 3)
    middle, ends = np.flatnonzero(plain.numbers == 6), np.flatnonzero(plain.numbers == 8)
    angles = []
    for c in middle:
        d = plain.get_distances(c, ends, mic=True)
        angles.append([ends[np.argsort(d)[0]], c, ends[np.argsort(d)[1]]])
    bonds = [[c, o] for a, c, b in angles for o in (a, b)]
    atoms = Atoms(plain, topology=Topology(bonds=bonds, angles=angles))
    atoms.set_array("mol-id", np.array([1 + next(k for k, a in enumerate(angles) if i in a) for i in range(len(atoms))]))
    atoms.set_array("id", np.arange(1, len(atoms) + 1))
    return atoms


def dioxide_field() -> ForceField:
    pair = {(a, b): (0.005, 3.0) for a, b in (("C", "C"), ("C", "O"), ("O", "O"))}
    return ForceField(bond={"harmonic": {1: (40.0, 1.15)}}, angle={"harmonic": {1: (2.0, 180.0)}}, pair={"lj/cut 7.0": pair})


def turned(atoms, seed=3):
    """The same crystal in another orientation."""
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    other = atoms.copy()
    other.set_cell(atoms.cell.array @ q, scale_atoms=True)
    return other


GROUPS = {
    "copper": (bulk("Cu", cubic=True) * (2, 2, 1), 225, 1), "magnesium": (bulk("Mg") * (2, 1, 2), 194, 2),
    "silicon": (bulk("Si", cubic=True) * (2, 1, 1), 227, 2), "salt": (bulk("NaCl", "rocksalt", a=5.6) * (2, 2, 2), 225, 2),
    "iron": (bulk("Fe", cubic=True) * (3, 1, 1), 229, 1), "carbon dioxide": (carbon_dioxide() * (1, 2, 1), 205, 12),
    "quartz": (
        crystal(["Si", "O"], [(0.47, 0, 2 / 3), (0.4135, 0.2669, 0.7858)], spacegroup=154, cellpar=[4.91, 4.91, 5.4, 90, 90, 120]), 154, 9)}


@pytest.mark.parametrize("name", GROUPS)
def test_space_groups(name):
    """Of supercells, in any orientation and handedness; orbits and operations are those of the crystal."""
    atoms, number, primitive = GROUPS[name]
    for case in (atoms, turned(atoms), turned(atoms, 4)):
        s = Symmetry(case)
        assert s.number == number and s.to_dict()["primitive_atoms"] == primitive
        assert len(s.primitive()) == primitive and Symmetry(s.primitive()).number == number
        conventional = s.conventional()
        assert Symmetry(conventional).number == number and np.linalg.det(conventional.cell) * np.linalg.det(case.cell) != 0
        assert len(np.unique(s.orbits)) == len(np.unique(atoms.numbers))
        x = case.positions @ s.matrices[-1].T      # the operation as a whole takes the crystal to itself
        there = case.positions[s.permutations[-1]]
        shift = (there - x) @ np.linalg.inv(case.cell.array)
        assert np.abs((shift - shift[0]) - np.rint(shift - shift[0])).max() < 1e-5


def test_types_and_charges_count():
    """Elements alone are not what the force field sees."""
    atoms = bulk("Cu", cubic=True)
    assert Symmetry(atoms).number == 225
    atoms.set_array("type", np.array([1, 1, 2, 2]))
    assert Symmetry(atoms).number == 123
    atoms.set_array("type", np.array([1, 1, 1, 1]))
    atoms.set_initial_charges([0.5, -0.5, -0.5, 0.5])
    assert Symmetry(atoms).number == 123 and Symmetry(atoms).orbits.max() > 0
    atoms.set_initial_charges([0.0] * 4)
    atoms.set_masses([63.5, 63.5, 63.5, 65.0])
    assert Symmetry(atoms).number == 221


def test_bonds_count():
    """A cubic lattice whose atoms are bonded in pairs, or in angles of different types, is not cubic."""
    atoms = Atoms("Ar", cell=np.eye(3) * 3.0, pbc=True) * (4, 4, 4)
    assert Symmetry(atoms).number == 221
    x = np.rint(atoms.positions / 3.0).astype(int)
    even = np.flatnonzero(x[:, 0] % 2 == 0)
    right = [int(np.flatnonzero((x == (x[i] + [1, 0, 0]) % 4).all(axis=1))[0]) for i in even]
    atoms.topology = Topology(bonds=np.column_stack([even, right]))
    s = Symmetry(atoms)
    assert s.number == 123 and len(s.centrings) == 32 and len(s.primitive()) == 2 and len(s.primitive().topology.bonds) == 1
    atoms.topology.bond_types[:1] = 2
    assert len(Symmetry(atoms).centrings) == 1


def test_cells_keep_energy_and_molecules():
    """Energy per molecule, bonds and molecule ids in supercell, primitive and conventional cell."""
    cell = carbon_dioxide()
    large = turned(cell * (2, 1, 2))
    large.positions += [0.3, 5.0, -7.0]
    s = Symmetry(large)
    energies = []
    for atoms in (cell, large, s.primitive(), s.conventional()):
        atoms.calc = dioxide_field()
        energies.append(atoms.get_potential_energy() / len(atoms))
        assert len(atoms.topology.bonds) * 3 == 2 * len(atoms) and len(atoms.topology.angles) * 3 == len(atoms)
        mol = atoms.arrays["mol-id"]
        if atoms is large:      # copies of a cell have their own molecules, also across its faces
            continue
        assert (mol[atoms.topology.bonds[:, 0]] == mol[atoms.topology.bonds[:, 1]]).all() and set(np.bincount(mol)[1:]) == {3}
        assert sorted(atoms.arrays["id"]) == list(range(1, len(atoms) + 1))
    assert np.ptp(energies) < 1e-11 * abs(energies[0])
    again = recell(s.primitive(), large.cell.array, 1e-4)           # and back into the supercell, whose vectors are no sums of its own
    again.calc = dioxide_field()
    assert len(again) == len(large) and again.get_potential_energy() / len(again) == pytest.approx(energies[0], rel=1e-11)


def test_chain_is_not_cut_too_short():
    """A polymer along a: the primitive cell would bond an atom with itself."""
    n = 6
    atoms = Atoms(f"C{n}", positions=[[1.5 * k, 0, 0] for k in range(n)], cell=[1.5 * n, 8, 8], pbc=True,
                  topology=Topology(bonds=[[k, (k + 1) % n] for k in range(n)]))
    s = Symmetry(atoms)
    assert len(s.centrings) == n
    with pytest.raises(InputError, match="too small for its bonds"):
        s.primitive()
    three = recell(atoms, atoms.cell.array / [[2], [1], [1]], 1e-4)
    assert len(three) == 3 and len(three.topology.bonds) == 3
    with pytest.raises(InputError, match="no cell of the crystal"):
        recell(atoms, atoms.cell.array * 0.7, 1e-4)


def crystals():
    argon = bulk("Ar", a=5.26, cubic=True) * (2, 2, 2)
    argon.calc = ForceField(pair=ARGON)
    hexagonal = turned(bulk("Ar", "hcp", a=3.75, c=6.2) * (3, 3, 2))
    hexagonal.calc = ForceField(pair=ARGON)
    molecules = carbon_dioxide() * (1, 1, 1)
    molecules.calc = dioxide_field()
    return {"fcc": (argon, 1), "hcp": (hexagonal, 2), "molecules": (molecules, 99)}


@pytest.mark.parametrize("name", ["fcc", "hcp", "molecules"])
def test_second_derivatives(name):
    """From few displacements as exactly as differences allow; compared with the analytic ones, and with all displacements."""
    atoms, most = crystals()[name]
    s = Symmetry(atoms)
    exact = atoms.calc.get_hessian(atoms).toarray()
    size = abs(exact).max()
    errors = [abs(s.hessian(atoms.calc.copy(), d) - exact).max() / size for d in (0.02, 0.01)]
    assert errors[1] < 2e-3 and errors[0] / errors[1] > 3.0        # central differences
    assert len(s.displacements()) <= most and len(s.displacements()) < 2 * len(atoms)
    forces = []
    for moved in s.displaced(0.01):
        moved.calc = atoms.calc.copy()
        forces.append(moved.get_forces())
    assert np.allclose(s.hessian(forces, 0.01), s.hessian(atoms.calc.copy(), 0.01), atol=1e-12 * size)
    with pytest.raises(InputError, match="hessian: needs the forces of"):
        s.hessian(forces[1:])


@pytest.mark.parametrize("name", ["fcc", "hcp"])
def test_elastic_constants(name):
    atoms, _ = crystals()[name]
    s = Symmetry(atoms)
    for relaxed in (False, True):
        exact = atoms.calc.get_elastic_constants(atoms, relaxed)
        assert np.allclose(s.elastic_constants(atoms.calc.copy(), relaxed, 0.003), exact, atol=2e-4 * abs(exact).max())
    assert len(s.strains()) <= 2
    if name == "hcp":       # the atoms do move
        assert abs(exact - atoms.calc.get_elastic_constants(atoms, False)).max() > 1e-3 * abs(exact).max()


def test_symmetric_forces_and_stress():
    """Means over all operations: what is symmetric stays, what is not goes, and doing it twice changes nothing."""
    atoms = GROUPS["quartz"][0] * (2, 2, 1)
    s, rng = Symmetry(atoms), np.random.default_rng(0)
    once = s.symmetric_forces(noise := rng.normal(size=(len(atoms), 3)))
    assert np.allclose(s.symmetric_forces(once), once, atol=1e-14) and abs(once).max() < abs(noise).max()
    for to, matrix in zip(s.permutations, s.matrices):
        assert np.allclose(once[to], once @ matrix.T, atol=1e-14)
    stress = s.symmetric_stress(rng.normal(size=6))
    assert stress[0] == pytest.approx(stress[1]) and abs(stress[3:]).max() < 1e-15
    full = s.symmetric_stress(np.diag([1.0, 2.0, 4.0]))
    assert np.allclose(full, np.diag([1.5, 1.5, 4.0])) and not abs(Symmetry(bulk("Cu")).symmetric_forces(np.ones((1, 3)))).max() > 1e-15


class Noisy(Calculator):
    """A well for every atom, and forces that are a little wrong, as those of many a code are."""

    implemented_properties = ["energy", "forces", "stress"]

    def __init__(self, places):
        super().__init__()
        self.places, self.rng = places, np.random.default_rng(2)

    def calculate(self, atoms=None, properties=None, system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        d = atoms.positions - self.places
        self.results = {"energy": 0.5 * (d**2).sum(), "forces": -d + 0.1 * self.rng.normal(size=d.shape),
                        "stress": self.rng.normal(size=6)}


def test_constraint_keeps_the_symmetry(tmp_path):
    atoms = GROUPS["quartz"][0].copy()
    s = Symmetry(atoms)
    atoms.calc = Noisy(atoms.positions + s.symmetric_forces(np.random.default_rng(1).normal(size=(len(atoms), 3))) * 0.2)
    free = atoms.copy()
    free.calc = Noisy(atoms.calc.places)
    atoms.set_constraint(s.constraint())
    assert isinstance(atoms.constraints[0], KeepSymmetry) and atoms.constraints[0].get_removed_dof(atoms) == 27 - 4
    before = atoms.positions.copy()
    for a in (atoms, free):
        BFGS(a, logfile=None).run(fmax=0.0, steps=5)
    assert abs(atoms.positions - before).max() > 0.01
    assert Symmetry(atoms, 1e-4).number == 154 and Symmetry(free, 1e-4).number == 1
    assert atoms.get_stress()[0] == pytest.approx(atoms.get_stress()[1])
    cell = atoms.cell.array @ (np.eye(3) + 0.01 * np.random.default_rng(3).normal(size=(3, 3)))
    atoms.set_cell(cell, scale_atoms=True)
    assert Symmetry(atoms, 1e-4).number == 154
    atoms.write(tmp_path / "x.traj")
    assert not read(tmp_path / "x.traj").constraints
    with pytest.raises(InputError, match="find it anew"):
        atoms[:3]


@pytest.mark.parametrize(("give", "error", "message"), [
    (lambda: PlainAtoms("H2", [[0, 0, 0], [0, 0, 1]]), InputError, "not periodic along a"),
    (lambda: PlainAtoms("H", cell=[3, 3, 3], pbc=(True, True, False)), InputError, "not periodic along c"),
    (lambda: PlainAtoms("H2", [[0, 0, 0], [0, 0, 0]], cell=[3, 3, 3], pbc=True), SimulationError, "in the same place"),
    (lambda: "in.file", InputError, "Symmetry needs atoms"),
])
def test_errors(give, error, message):
    with pytest.raises(error, match=message) as caught:
        Symmetry(give())
    assert "\n" not in str(caught.value)


def test_more_errors():
    with pytest.raises(InputError, match="tolerance must be positive"):
        Symmetry(bulk("Cu"), 0.0)
    dipoles = bulk("Cu")
    dipoles.set_array("mu", np.ones((1, 3)))
    with pytest.raises(InputError, match="point dipoles have directions"):
        Symmetry(dipoles)
    code = "import sys; sys.modules['spglib'] = None\nimport asemd; from ase.build import bulk\ntry: asemd.Symmetry(bulk('Cu'))\n" \
           "except asemd.InputError as e: print(e)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "spglib is not installed: pip install spglib"


SCRIPT = """
units metal
lattice diamond 5.43
region box block 0 ${n} 0 ${n} 0 ${n}
create_box 2 box
create_atoms 1 box basis 5 2 basis 6 2 basis 7 2 basis 8 2
mass * 28
pair_style lj/cut 3.0
pair_coeff * * 0.1 2.0
fix 1 all nve
run 0
"""


def test_command_line(tmp_path, capsys, monkeypatch):
    """The script of a zincblende crystal, by its two types; its data file; mistakes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.zb").write_text(SCRIPT)
    assert main(["symmetry", "in.zb", "-var", "n", "2"]) == 0
    text = capsys.readouterr().out
    assert "F-43m (216)" in text and "64 atoms, 2 in the primitive cell; 768 operations" in text and "-43m" in text
    assert main(["symmetry", "in.zb", "--json", "-var", "n", "1"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["number"] == 216 and [o["atoms"] for o in found["orbits"]] == [4, 4] and found["displacements"] == 2
    assert main(["symmetry", "in.zb"]) == 1 and "in.zb:4" in capsys.readouterr().err
    assert main(["symmetry"]) == 1 and "needs a script" in capsys.readouterr().err
    assert main(["symmetry", "in.zb", "--tolerance", "-1", "-var", "n", "1"]) == 1 and "tolerance" in capsys.readouterr().err
    bulk("Cu", cubic=True).write("data.cu", format="lammps-data", masses=True)
    assert main(["symmetry", "data.cu"]) == 0 and "Fm-3m (225)" in capsys.readouterr().out


def test_scene():
    with ran(SCRIPT, "-var", "n", "1") as lmp:
        assert Symmetry(lmp).number == Symmetry(lmp.session.scene).number == 216
