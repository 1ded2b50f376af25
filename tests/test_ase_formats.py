"""The formats that ase.io finds by entry points: scripts, data files, dumps and databases keep bonds, types, elements and frames."""
from __future__ import annotations

import re
from importlib.metadata import EntryPoint
from pathlib import Path

import ase
import both
import numpy as np
import pytest
from ase.io import formats, read, write
from ase.units import fs

import asemd
from asemd import Atoms, ForceField, Topology
from asemd.errors import InputError

ROOT = Path(__file__).resolve().parents[1]
SECTION = (ROOT / "pyproject.toml").read_text().partition('[project.entry-points."ase.ioformats"]')[2].partition("\n[")[0]
GROUP = dict(re.findall(r'^([\w-]+) = "(.*)"', SECTION, re.M))


@pytest.fixture(autouse=True, scope="module")
def registered():
    """The entry points of this source tree, whatever is installed."""
    new = [name for name in GROUP if name not in formats.ioformats]
    for name in new:
        formats.define_external_io_format(EntryPoint(name=name, value=GROUP[name], group="ase.ioformats"))
    yield
    for name in new:
        del formats.ioformats[name]


def chain(turned: bool = False) -> Atoms:
    """Two molecules in a tilted cell, in LAMMPS's frame or in another; labels are not in alphabetical order."""
    x = np.array([[1.0, 1, 1], [2.1, 1, 1], [2.4, 2.1, 1], [5, 5, 5], [6.1, 5, 5], [6.4, 6.1, 5.2]])
    cell = np.array([[9.0, 0, 0], [1.5, 10, 0], [-1, 0.5, 11]])
    q = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0] if turned else np.eye(3)
    q *= np.linalg.det(q)
    atoms = Atoms("OCHOCH", positions=x @ q, cell=cell @ q, pbc=True,
                  topology=Topology(bonds=[[0, 1], [1, 2], [3, 4], [4, 5]], bond_types=[1, 2, 1, 2], angles=[[0, 1, 2], [3, 4, 5]]))
    atoms.set_velocities(np.random.default_rng(1).normal(0, 0.02, (6, 3)) @ q)
    atoms.set_initial_charges([-0.4, 0.3, 0.1] * 2)
    return atoms


BONDS = dict(bond={"harmonic": {1: (10.0, 1.0), 2: (8.0, 1.2)}}, angle={"harmonic": {1: (2.0, 100.0)}})


@pytest.mark.parametrize("units", ["metal", "real"])
@pytest.mark.parametrize("turned", [False, True])
def test_data_files(units, turned, tmp_path):
    """Also of a turned cell: bonds, elements, charges and the energy stay, velocities turn once with the positions."""
    atoms = chain(turned)
    path = tmp_path / "x.data"
    write(path, atoms, format="asemd-data", units=units, types=["O", "H", "C"])
    back = read(path, format="asemd-data", units=units)
    assert isinstance(back, Atoms) and back.topology == atoms.topology and back.get_chemical_symbols() == atoms.get_chemical_symbols()
    assert back.arrays["type"].tolist() == [1, 3, 2, 1, 3, 2]
    assert np.allclose(back.get_initial_charges(), atoms.get_initial_charges(), atol=1e-15)
    turn = np.linalg.solve(atoms.cell.array, back.cell.array)
    assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.allclose(back.get_all_distances(mic=True), atoms.get_all_distances(mic=True), atol=1e-10)
    assert np.allclose(back.get_velocities(), atoms.get_velocities() @ turn, atol=1e-12)
    assert np.allclose(back.get_kinetic_energy(), atoms.get_kinetic_energy(), rtol=1e-12)
    atoms.calc, back.calc = ForceField(**BONDS), ForceField(**BONDS)
    assert back.get_potential_energy() == pytest.approx(atoms.get_potential_energy(), rel=1e-10)
    if not turned:
        assert np.allclose(turn, np.eye(3), atol=1e-15)


def test_type_labels_with_unsorted_ids(tmp_path):
    """Labels are those of their types, whatever the order of the lines."""
    (tmp_path / "x.data").write_text(
        "units = metal\n\n4 atoms\n3 atom types\n1 bonds\n1 bond types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n"
        "Atom Type Labels\n\n2 C\n3 Si\n1 O\n\nMasses\n\nSi 28.085\nO 15.999\nC 12.011\n\n"
        "Atoms # molecular\n\n40 1 C 4 4 4\n7 1 Si 1 1 1\n3 2 O 3 3 3\n12 2 C 2 2 2\n\n"
        "Velocities\n\n12 2 0 0\n3 3 0 0\n40 4 0 0\n7 1 0 0\n\n"
        "Bonds\n\n1 1 40 3\n")
    atoms = read(tmp_path / "x.data", format="asemd-data", units="metal")
    assert atoms.arrays["id"].tolist() == [3, 7, 12, 40] and atoms.get_chemical_symbols() == ["O", "Si", "C", "C"]
    assert atoms.positions[:, 0].tolist() == [3, 1, 2, 4] and np.allclose(atoms.get_velocities()[:, 0] * 1000 * fs, [3, 1, 2, 4])
    assert atoms.topology.bonds.tolist() == [[3, 0]]
    other = read(tmp_path / "x.data", format="asemd-data", units="metal", types=["N", "B", "P"])
    assert other.get_chemical_symbols() == ["N", "P", "B", "B"] and np.allclose(other.get_masses(), atoms.get_masses())


def dump(tmp_path, style: str, units: str = "metal", every: str = "dump_modify d units yes sort off") -> Path:
    """A run with a dump of some columns, its data file beside it."""
    write(tmp_path / "x.data", chain(), format="asemd-data", units=units, types=["O", "H", "C"])
    both.asemd(f"units {units}\natom_style full\nread_data {tmp_path}/x.data\nbond_style harmonic\nbond_coeff * 5 1.1\n"
               "angle_style harmonic\nangle_coeff 1 2 100\npair_style zero 4.0\npair_coeff * *\nfix 1 all nve\ncompute e all pe/atom\n"
               f"dump d all custom 5 {tmp_path}/x.dump {style}\n{every}\nrun 20\n")
    return tmp_path / "x.dump"


@pytest.mark.parametrize("columns", ["id type x y z ix iy iz vx vy vz fx fy fz", "id xs ys zs q vx vy vz", "id type xu yu zu",
                                     "id xsu ysu zsu element"])
@pytest.mark.parametrize("units", ["metal", "real"])
def test_dumps_with_the_bonds_of_their_data_file(columns, units, tmp_path):
    more = "dump_modify d units yes" + (" element O H C" if "element" in columns else "")
    path = dump(tmp_path, columns, units, more)
    images = read(path, ":", format="asemd-dump", data=tmp_path / "x.data")
    start = chain()
    assert [image.info["timestep"] for image in images] == [0, 5, 10, 15, 20]
    for image in images:
        assert image.topology == start.topology and image.get_chemical_symbols() == start.get_chemical_symbols()
        assert np.allclose(image.cell.array, start.cell.array, atol=1e-5) and image.pbc.all()
    assert np.allclose(images[0].get_all_distances(mic=True), start.get_all_distances(mic=True), atol=1e-4)
    if "vx" in columns:
        assert np.allclose(images[0].get_velocities(), start.get_velocities(), atol=1e-6)
    if "fx" in columns:
        like = images[2].copy()
        like.calc = asemd.ForceField(commands="bond_style harmonic\nbond_coeff * 5 1.1\nangle_style harmonic\nangle_coeff 1 2 100\n"
                                     "pair_style zero 4.0\npair_coeff * *\nbond_coeff 2 5 1.1", units=units, types=3)
        assert np.allclose(images[2].get_forces(), like.get_forces(), atol=3e-4) and np.abs(like.get_forces()).max() > 0.02
    last, = read(path, "-1:", format="asemd-dump", data=tmp_path / "x.data")
    assert last == images[-1] and read(path, 1, format="asemd-dump", data=tmp_path / "x.data").info["timestep"] == 5
    part = images[1][[3, 4, 5]]
    assert part.topology.bonds.tolist() == [[0, 1], [1, 2]]


def test_dumps_alone(tmp_path):
    path = dump(tmp_path, "id type x y z c_e", every="dump_modify d sort off")
    with pytest.raises(InputError, match="does not say its units: give units="):
        read(path, format="asemd-dump")
    atoms = read(path, 0, format="asemd-dump", units="metal", types={"O": 1, "H": 2, "C": 3})
    assert atoms.get_chemical_symbols() == list("OCHOCH") and atoms.topology.is_empty and atoms.arrays["c_e"].shape == (6,)
    assert read(path, 0, format="asemd-dump", units="metal").get_chemical_symbols() == ["X"] * 6
    with pytest.raises(InputError, match="nothing of atom type 3"):
        read(path, 0, format="asemd-dump", units="metal", types=["O", "H"])
    short = chain()[:4]
    with pytest.raises(InputError, match=r"has atom 5, data does not.*x.dump:1"):
        read(path, 0, format="asemd-dump", units="metal", data=short)
    text = path.read_text()
    path.write_text(text[:len(text) // 2])
    with pytest.raises(InputError, match="ends before|has .* words|not a number"):
        read(path, ":", format="asemd-dump", units="metal")


@pytest.mark.parametrize("name", ["x.db", "x.json"])
def test_databases(name, tmp_path):
    atoms = chain()
    atoms.set_array("type", np.array([2, 3, 1] * 2))
    atoms.info["note"], atoms.calc = "a chain", ForceField(**BONDS)
    energy = atoms.get_potential_energy()
    write(tmp_path / name, [atoms, atoms[:3]], format="asemd-db")
    write(tmp_path / name, atoms[3:], format="asemd-db", append=True)
    back, first, second = read(tmp_path / name, ":", format="asemd-db")
    assert back.topology == atoms.topology and back.arrays["type"].tolist() == [2, 3, 1] * 2 and back.info["note"] == "a chain"
    assert back.get_potential_energy() == energy and first.topology == second.topology == atoms[:3].topology
    assert read(tmp_path / name, format="asemd-db").info["note"] == "a chain"


@pytest.mark.parametrize("name", ["x.db", "x.extxyz"])
def test_arrays_of_lammps(name, tmp_path):
    """What styles of spheres, ellipsoids and dipoles need comes back, and goes over to copies of plain atoms."""
    rng = np.random.default_rng(3)
    wanted = {"radius": rng.random(3), "shape": rng.random((3, 3)), "quaternions": rng.random((3, 4)), "mu": rng.random((3, 3)),
              "mol-id": np.array([1, 1, 2]), "type": np.array([2, 1, 1])}
    plain = ase.Atoms("ArNeAr", positions=rng.random((3, 3)) * 9, cell=[9] * 3, pbc=True)
    for key, array in wanted.items():
        plain.set_array(key, array)
    kind = {"format": "asemd-db"} if name == "x.db" else {}
    write(tmp_path / name, Atoms(plain), **kind)
    again = Atoms(read(tmp_path / name, **kind))
    for key, array in wanted.items():
        assert np.allclose(again.arrays[key], array, rtol=0, atol=1e-7), key
    again.arrays["radius"][0] = 9.0
    assert Atoms(plain, masses=[1, 2, 3]).get_masses().tolist() == [1, 2, 3] and plain.arrays["radius"][0] < 1


def test_scripts(tmp_path):
    (tmp_path / "in.argon").write_text("units metal\nlattice fcc 5.26\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 box\n"
                                       "mass 1 39.948\npair_style lj/cut 5.0\npair_coeff 1 1 0.0104 3.40\nrun 0\n")
    for atoms in (read(tmp_path / "in.argon"), read(tmp_path / "in.argon", format="lammps-script")):
        assert set(atoms.get_chemical_symbols()) == {"Ar"} and isinstance(atoms.calc, ForceField)
        assert atoms.get_potential_energy() < 0
    with pytest.raises(InputError, match="is no data file"):
        read(tmp_path / "in.argon", format="asemd-data")


@pytest.mark.parametrize("arguments, message", [
    (dict(atom_style="molecular"), "atoms with their own masses"), (dict(atom_style="charge"), "no place for bonds"),
    (dict(atom_style="fulll"), "did you mean full"), (dict(types=["O", "H"]), "nothing of element C"), (dict(units="metall"), "metal")])
def test_what_data_files_cannot_hold(arguments, message, tmp_path):
    atoms = chain()
    if "masses" in message:
        atoms.set_masses([16.0, 12, 1, 18, 12, 1])
    with pytest.raises(InputError, match=message):
        write(tmp_path / "x.data", atoms, format="asemd-data", **arguments)


def test_formats_cost_nothing_until_they_are_used():
    """The module with the entry points imports nothing of the package."""
    text = (ROOT / "asemd" / "interop" / "formats.py").read_text()
    assert re.findall(r"^(?:from|import) (\S+)", text, re.M) == ["ase.utils.plugins"]


def test_blocks_of_the_documentation(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    section = re.search(r"^## Files\n(.*?)^## ", (ROOT / "docs" / "ase.md").read_text(), re.S | re.M)[1]
    found = re.findall(r"^```python\n(.*?)^```", section, re.S | re.M)
    assert len(found) >= 2
    exec("\n".join(found), {"__name__": "page", "ase": ase})
