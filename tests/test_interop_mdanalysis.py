"""Universes of MDAnalysis hold what atoms and scenes know, in MDAnalysis's units and orientation, and everything comes back."""
from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from ase import Atoms as PlainAtoms
from ase import units
from ase.build import bulk
from wheel import ran

import asemd
from asemd import Atoms, ForceField, InputError, MolecularDynamics, Topology

mda = pytest.importorskip("MDAnalysis")
from MDAnalysis.analysis.msd import EinsteinMSD  # noqa: E402
from MDAnalysis.analysis.pca import PCA  # noqa: E402
from MDAnalysis.analysis.rdf import InterRDF  # noqa: E402
from MDAnalysis.lib.distances import distance_array  # noqa: E402

TILTED = np.array([[5.0, 1.0, 0.3], [-1.0, 6.0, 0.2], [0.5, 0.4, 7.0]])
CELLS = {"tilted": TILTED, "left-handed": TILTED[[1, 0, 2]], "straight": np.diag([5.0, 6.0, 7.0])}


def scrambled(cell=TILTED, pbc=True) -> Atoms:
    """Eight atoms with some of everything, items listed both ways round and one twice."""
    rng = np.random.default_rng(1)
    top = Topology(bonds=[[1, 0], [0, 2], [3, 4], [3, 5]], bond_types=[1, 1, 2, 2], angles=[[2, 0, 1], [4, 3, 5]], angle_types=[1, 2],
                   dihedrals=[[3, 0, 1, 2], [2, 1, 0, 3], [3, 0, 1, 2], [0, 3, 4, 6]], dihedral_types=[1, 1, 2, 3],
                   impropers=[[3, 0, 1, 2], [0, 4, 5, 7]], improper_types=[1, 2], crossterms=[[4, 3, 0, 1, 2]], crossterm_types=[1])
    atoms = Atoms("OHHOHHCN", positions=rng.random((8, 3)) @ cell, cell=cell, pbc=pbc, topology=top, celldisp=[0.1, 0.2, 0.3])
    atoms.set_array("mol-id", np.array([7, 7, 7, 2, 2, 2, 0, 0]))
    atoms.set_array("type", np.array([2, 1, 1, 2, 1, 1, 4, 3], np.int32))
    atoms.set_array("id", np.array([8, 1, 2, 3, 4, 5, 6, 70]))
    atoms.set_array("image", rng.integers(-2, 3, (8, 3)).astype(np.int32))
    atoms.set_initial_charges(rng.random(8))
    atoms.set_masses([16.0, 1.0, 2.0, 16.0, 1.0, 1.0, 12.0, 14.5])
    atoms.set_velocities(rng.random((8, 3)))
    return atoms


def assert_same(a, b):
    assert set(a.arrays) == set(b.arrays) and all(np.array_equal(a.arrays[k], b.arrays[k]) for k in a.arrays)
    assert np.array_equal(a.cell, b.cell) and np.array_equal(a.pbc, b.pbc) and np.array_equal(a.get_celldisp(), b.get_celldisp())
    assert a.topology == b.topology


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("pbc", [True, (True, True, False), False])
def test_back_to_the_last_bit(cell, pbc):
    atoms = scrambled(CELLS[cell], pbc)
    u = asemd.to_mdanalysis(atoms)
    assert_same(atoms, asemd.from_mdanalysis(u))
    assert_same(atoms, u.atoms.convert_to("ASE"))
    assert_same(atoms, u.copy().atoms.convert_to.ase())
    rows = [5, 3, 4, 0]
    assert_same(atoms[rows], asemd.from_mdanalysis(u.atoms[rows]))


def test_what_the_universe_holds():
    atoms = scrambled()
    u = asemd.to_mdanalysis(atoms)
    assert list(u.atoms.types) == list("21121143") and list(u.atoms.elements) == atoms.get_chemical_symbols()
    assert np.array_equal(u.atoms.resids, atoms.arrays["mol-id"]) and len(u.residues) == 3
    assert np.array_equal(u.atoms.ids, atoms.arrays["id"]) and np.array_equal(u.atoms.masses, atoms.get_masses())
    assert np.array_equal(u.atoms.charges, atoms.get_initial_charges())
    assert {tuple(b.indices): b.type for b in u.bonds} == {(0, 1): "1", (0, 2): "1", (3, 4): "2", (3, 5): "2"}
    assert len(u.angles) == 2 and len(u.impropers) == 2 and "3" in u.dihedrals.types()
    assert u.atoms.fragments[0].n_atoms == 3


@pytest.mark.parametrize("cell", CELLS)
def test_geometry(cell):
    """Unwrapped distances, nearest images, signed torsions and lattice are those of the atoms."""
    atoms = scrambled(CELLS[cell])
    u = asemd.to_mdanalysis(atoms)
    flat = atoms.copy()
    flat.positions += atoms.arrays["image"] @ atoms.cell.array
    assert np.allclose(distance_array(u.atoms, u.atoms), flat.get_all_distances(), atol=1e-5)
    assert np.allclose(distance_array(u.atoms, u.atoms, box=u.dimensions), atoms.get_all_distances(mic=True), atol=2e-5)
    off = u.atoms[[3, 0, 1, 2]].dihedral.value(pbc=False) - flat.get_dihedral(3, 0, 1, 2)
    assert abs((off + 180) % 360 - 180) < 1e-3
    assert u.trajectory.ts.volume == pytest.approx(atoms.get_volume(), rel=1e-5)
    if cell != "left-handed":
        assert np.allclose(u.dimensions, atoms.cell.cellpar(), rtol=1e-6)


def test_a_slab_has_no_images_along_its_normal():
    """MDAnalysis knows all directions periodic or none: the vector that is not has to be out of reach."""
    atoms = scrambled(pbc=(True, True, False))
    atoms.cell[2] = [0, 0, 1.5]
    del atoms.arrays["image"]
    u = asemd.to_mdanalysis(atoms)
    assert np.allclose(distance_array(u.atoms, u.atoms, box=u.dimensions), atoms.get_all_distances(mic=True), atol=2e-5)
    atoms.pbc = False
    assert asemd.to_mdanalysis(atoms).dimensions is None


def test_units():
    """Velocities in Angstrom/ps, forces in kJ/mol/Angstrom: energies computed from them agree."""
    atoms = scrambled()
    atoms.calc = ForceField(pair={"lj/cut 3.0": {(i, j): (0.01, 1.0) for i in range(1, 5) for j in range(i, 5)}})
    assert not asemd.to_mdanalysis(atoms).trajectory.ts.has_forces      # nothing is computed
    forces = atoms.get_forces()
    u = asemd.to_mdanalysis(atoms)
    joule = 0.5 * (u.atoms.masses * (u.atoms.velocities.astype(float) ** 2).sum(axis=1)).sum() * 0.01      # u (A/ps)^2 -> kJ/mol
    assert joule == pytest.approx(atoms.get_kinetic_energy() / (units.kJ / units.mol), rel=1e-5)
    assert np.linalg.norm(u.atoms.forces, axis=1) == pytest.approx(np.linalg.norm(forces, axis=1) * 96.48533, rel=1e-5)
    assert np.allclose(asemd.from_mdanalysis(u).get_forces(), forces, rtol=1e-13)


def test_changes_come_back():
    atoms = scrambled()
    u = asemd.to_mdanalysis(atoms)
    u.atoms[2].position += [0.5, 0.0, 0.0]
    u.atoms[1].charge = -3.0
    u.atoms.masses = np.where(u.atoms.elements == "H", 4.0, u.atoms.masses)
    u.delete_bonds([(0, 2)])
    u.add_bonds([(6, 7)], types=["2"])
    u.add_TopologyAttr("resnames", ["WAT", "WAT", "CN"])
    back = asemd.from_mdanalysis(u)
    still = [k for k in range(8) if k != 2]
    assert np.array_equal(back.positions[still], atoms.positions[still])
    assert np.linalg.norm(back.positions[2] - atoms.positions[2]) == pytest.approx(0.5, abs=1e-5)
    assert back.get_initial_charges()[1] == -3.0 and back.get_masses()[4] == 4.0 and list(back.arrays["residuenames"][:2]) == ["WAT"] * 2
    assert sorted(map(sorted, back.topology.bonds.tolist())) == [[0, 1], [3, 4], [3, 5], [6, 7]]
    assert back.topology.impropers.tolist() == atoms.topology.impropers.tolist()         # still the way round they were
    u.dimensions = [10, 11, 12, 90, 90, 90]
    assert np.allclose(asemd.from_mdanalysis(u).cell.cellpar(), [10, 11, 12, 90, 90, 90], atol=1e-5)


def test_trajectory(tmp_path):
    """Frames with cells of their own; read from ASE's file too; each comes back."""
    frames = []
    for k in range(3):
        atoms = scrambled(TILTED * (1 + 0.1 * k))
        atoms.positions += k
        frames.append(atoms)
    u = asemd.to_mdanalysis(frames, dt=0.5)
    assert len(u.trajectory) == 3 and u.trajectory[2].time == 1.0
    for ts in u.trajectory:
        assert_same(frames[ts.frame], asemd.from_mdanalysis(u))
        assert ts.dimensions[:3] == pytest.approx(frames[ts.frame].cell.lengths(), rel=1e-6)
    from ase.io.trajectory import Trajectory
    with Trajectory(tmp_path / "x.traj", "w") as out:
        for atoms in frames:
            out.write(atoms)
    again = asemd.to_mdanalysis(Trajectory(tmp_path / "x.traj"))
    assert len(again.trajectory) == 3 and len(again.dihedrals) == len(u.dihedrals)


SCRIPT = """
units {units}
atom_style full
region box prism 0 8 0 7 0 6 1.0 0.5 0.3
create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 4
mass 1 16.0
mass 2 1.0
create_atoms 1 single 1 1 1
create_atoms 2 single 2 1 1
create_atoms 2 single 1 2 1
set group all mol 3
set type 1 charge -0.8
set type 2 charge 0.4
bond_style harmonic
bond_coeff 1 10 1
angle_style harmonic
angle_coeff 1 10 90
pair_style lj/cut 2.5
pair_coeff * * 0.1 0.5
create_bonds single/bond 1 1 2
create_bonds single/bond 1 1 3
create_bonds single/angle 1 2 1 3
velocity all create 1.0 4711
fix 1 all nve
"""


@pytest.mark.parametrize("unit", ["lj", "real"])
def test_scene_is_as_mdanalysis_reads_its_data_file(unit, tmp_path):
    """Another way from a scene to a universe: the data file, read by MDAnalysis."""
    with ran(SCRIPT.format(units=unit)) as lmp:
        lmp.command("run 3")
        lmp.command(f"write_data {tmp_path}/x.data")
        u = asemd.to_mdanalysis(lmp)
        scene = asemd.to_mdanalysis(lmp.session.scene)
        v = np.array(lmp.gather_atoms("v", 1, 3)).reshape(-1, 3)
    theirs = mda.Universe(str(tmp_path / "x.data"), format="DATA", atom_style="id resid type charge x y z")
    for name in ("types", "resids", "ids"):
        assert list(getattr(u.atoms, name)) == list(getattr(theirs.atoms, name)), name
    assert np.allclose(u.atoms.masses, theirs.atoms.masses, rtol=1e-12) and np.allclose(u.atoms.charges, theirs.atoms.charges, rtol=1e-6)
    assert np.allclose(u.atoms.positions, theirs.atoms.positions, atol=1e-5) and np.allclose(u.dimensions, theirs.dimensions, rtol=1e-6)
    assert np.array_equal(u.bonds.indices, theirs.bonds.indices) and np.array_equal(u.angles.indices, theirs.angles.indices)
    assert np.allclose(u.atoms.velocities, v * (1.0 if unit == "lj" else 1000.0), rtol=1e-5) and len(scene.bonds) == 2


def test_atoms_of_a_script_fit_its_dump(tmp_path):
    """Where atoms are deleted, their order is not that of their ids; MDAnalysis sorts dumps by id, and has the same atoms as we."""
    with ran(["lattice sc 1.0", "region box block 0 3 0 3 0 3", "create_box 3 box", "create_atoms 1 box", "mass * 1.0",
              "set group all type/fraction 2 0.5 4711", "set atom 20 type 3", "pair_style zero 1.2", "pair_coeff * *",
              "group some id 2 3 7", "delete_atoms group some compress no", f"dump 1 all custom 1 {tmp_path}/x.dump id type x y z vx vy vz",
              "velocity all create 1.0 4711 loop geom", "run 0"]) as lmp:
        order = lmp.session.scene.system.id.copy()
        u = asemd.to_mdanalysis(lmp)
    assert np.any(np.diff(order) < 0)
    theirs = mda.Universe(str(tmp_path / "x.dump"), format="LAMMPSDUMP")
    assert u.atoms.ids.tolist() == theirs.atoms.ids.tolist() and u.atoms.types.tolist() == theirs.atoms.types.tolist()
    assert np.allclose(u.atoms.positions, theirs.atoms.positions, atol=1e-5)
    assert np.allclose(u.atoms.velocities, theirs.atoms.velocities, atol=1e-4)


def test_atoms_that_mdanalysis_read(tmp_path):
    """A universe from elsewhere: types that are words are numbered, and the numbers are explained."""
    (tmp_path / "x.pdb").write_text(
        "CRYST1   10.000   11.000   12.000  90.00  90.00  90.00 P 1           1\n"
        "ATOM      1  CH3 ACE A   1       0.000   0.000   0.000  1.00  0.00           C\n"
        "ATOM      2  C   ACE A   1       1.500   0.000   0.000  1.00  0.00           C\n"
        "ATOM      3  O   ACE A   1       2.100   1.000   0.000  1.00  0.00           O\nEND\n")
    u = mda.Universe(str(tmp_path / "x.pdb"))
    atoms = asemd.from_mdanalysis(u)
    assert atoms.get_chemical_formula() == "C2O" and "type" not in atoms.arrays and atoms.pbc.all()
    assert list(atoms.arrays["atomtypes"]) == ["CH3", "C", "O"] and atoms.cell.cellpar() == pytest.approx([10, 11, 12, 90, 90, 90])
    u.atoms.types = ["CT", "C", "O"]
    u.add_TopologyAttr("bonds", [(0, 1), (2, 1)])
    atoms = asemd.from_mdanalysis(u)
    assert atoms.arrays["type"].tolist() == [2, 1, 3] and atoms.info["labels"]["atom"] == {1: "C", 2: "CT", 3: "O"}
    assert atoms.info["labels"]["bond"] == {1: "C-CT", 2: "C-O"} and atoms.topology.bond_types.tolist() == [1, 2]
    atoms.calc = ForceField(bond={"harmonic": {1: (10.0, 1.5), 2: (10.0, 1.2)}})
    assert atoms.get_potential_energy() == pytest.approx(10 * (np.hypot(0.6, 1) - 1.2) ** 2, rel=1e-5)


def test_bonds_of_plain_atoms():
    """Those in `info`, and those of the calculator."""
    top = Topology(bonds=[[0, 1]])
    molecule = PlainAtoms("HCl", [[0, 0, 0], [1.3, 0, 0]])
    assert not hasattr(asemd.to_mdanalysis(molecule), "bonds")
    molecule.calc = ForceField(bond={"harmonic": {1: (1.0, 1.0)}}, topology=top)
    assert len(asemd.to_mdanalysis(molecule).bonds) == 1
    told = PlainAtoms("HCl", [[0, 0, 0], [1.3, 0, 0]], info=Atoms("HCl", topology=top).info)
    assert len(asemd.to_mdanalysis(told).bonds) == 1


def test_stream_gives_what_the_frames_give():
    """Results during a run equal those of `run()` on the collected frames; each run is a trajectory."""
    atoms = bulk("Ar", a=5.4, cubic=True) * (2, 2, 2)
    atoms.calc = ForceField(pair={"lj/cut 7.0": {("Ar", "Ar"): (0.0104, 3.4)}})
    atoms.set_velocities(np.random.default_rng(5).normal(0, 0.02, (len(atoms), 3)))
    md = MolecularDynamics(atoms, 4 * units.fs)
    stream, frames = asemd.Stream(md, 5), []
    md.attach(lambda: frames.append(atoms.copy()), interval=5)
    u = stream.universe
    rdf, msd = stream.feed(InterRDF(u.atoms, u.atoms, nbins=20, range=(0, 7))), stream.feed(EinsteinMSD(u, fft=False))
    for steps in (23, 27):
        frames.clear()
        md.run(steps)
        v = asemd.to_mdanalysis(frames, dt=0.02)
        assert len(frames) == stream.frames == stream.seen == (5 if steps == 23 else 6)
        assert np.array_equal(rdf.results.rdf, InterRDF(v.atoms, v.atoms, nbins=20, range=(0, 7)).run().results.rdf)
        assert np.array_equal(msd.results.timeseries, EinsteinMSD(v, fft=False).run().results.timeseries)
        assert msd.times[-1] == pytest.approx(md.get_time() // (20 * units.fs) * 0.02)
    assert np.array_equal(asemd.from_mdanalysis(u.copy()).positions, frames[-1].positions)
    stream.feed(PCA(u))
    with pytest.raises(InputError, match="frames twice or out of order"):
        md.run(10)


@pytest.mark.parametrize(("give", "message"), [
    (lambda: asemd.to_mdanalysis("x.traj"), "ase.io.read"),
    (lambda: asemd.to_mdanalysis([]), "without frames"),
    (lambda: asemd.to_mdanalysis(5), "got int"),
    (lambda: asemd.to_mdanalysis([scrambled(), scrambled()[:3]]), "frame 1 has other atoms"),
    (lambda: asemd.to_mdanalysis(asemd.Scene()), "to_mdanalysis command before simulation box is defined"),
    (lambda: asemd.to_mdanalysis(PlainAtoms("H", pbc=True)), "is zero but its direction is periodic"),
    (lambda: asemd.from_mdanalysis(scrambled()), "needs a Universe"),
    (lambda: asemd.from_mdanalysis(asemd.to_mdanalysis(scrambled()).atoms[:0]), "no atoms"),
    (lambda: asemd.Stream(scrambled()), "needs a dynamics"),
])
def test_errors(give, message):
    with pytest.raises(InputError, match=message) as caught:
        give()
    assert "\n" not in str(caught.value)


def test_stream_refuses_what_it_cannot_feed():
    atoms = scrambled()
    atoms.calc = ForceField(pair={"zero 2.0": {}})
    md = MolecularDynamics(atoms, 1.0)
    with pytest.raises(InputError, match="interval"):
        asemd.Stream(md, 0)
    stream, other = asemd.Stream(md), asemd.to_mdanalysis(atoms)
    with pytest.raises(InputError, match="another universe"):
        stream.feed(InterRDF(other.atoms, other.atoms))
    with pytest.raises(InputError, match="AnalysisBase"):
        stream.feed(print)


def test_imported_when_used():
    code = ("import sys, asemd.interop.mdanalysis, asemd.interop.stream; assert 'MDAnalysis' not in sys.modules; "
            "sys.modules['MDAnalysis'] = None\ntry: asemd.to_mdanalysis(asemd.Atoms('H'))\nexcept asemd.InputError as e: print(e)")
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "MDAnalysis is not installed: pip install MDAnalysis"
