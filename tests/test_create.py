"""create_box, create_atoms, mass, labelmap, displace_atoms, delete_atoms against LAMMPS."""
from __future__ import annotations

import time

import numpy as np
import pytest
from both import asemd, assert_same, lammps

from asemd.errors import InputError

FCC = """
units lj
lattice fcc 0.8442
region b block 0 4 0 4 0 4
create_box 2 b
create_atoms 1 box
mass 1 1
mass 2 2.5
"""
TRICLINIC = FCC.replace("block 0 4 0 4 0 4", "prism 0 4 0 3 0 5 0.5 -0.3 1.1")
FLAT = """
units lj
dimension 2
lattice hex 0.7
region b block 0 10 0 6 -4 5
create_box 1 b
create_atoms 1 box
mass 1 1
"""
GENERAL = """
units metal
lattice custom 3.0 a1 1 0.2 0.1 a2 -0.3 1.1 0 a3 0.2 0.1 0.9 basis 0 0 0 basis 0.5 0.5 0.5 triclinic/general
create_box 2 NULL 0 2 -1 1 0 3
"""
PAIR = "pair_style lj/cut 2.5\npair_coeff * * 1 1\n"


FLAKE = [[(1, 1, 1), (3, 1, 1), (1, 3.1, 1.5)], [(3, 1, 1), (3, 3, 2), (1, 3.1, 1.5)], [(0.5, 0.5, 3.2), (3.8, 1.1, 2), (2.2, 3.9, 3.1)],
         [(1, 1, 1), (2, 2, 1), (2, 1, 2)], [(1, 1, 1), (1, 1, 1), (2, 2, 2)], [(3, 3, 3), (5, 3, 3), (3, 5, 5)]]


def stl(folder, kind: str) -> str:
    """An STL file of some triangles: with equal sides, without area, beyond the box."""
    path = folder / f"{kind}.stl"
    if kind == "text":
        path.write_text("solid flake\n" + "".join(
            "facet normal 0 0 1\n outer loop\n" + "".join(f"  vertex {a} {b} {c}\n" for a, b, c in t) + " endloop\nendfacet\n"
            for t in FLAKE) + "endsolid flake\n")
    else:
        path.write_bytes(b"flake".ljust(80) + len(FLAKE).to_bytes(4, "little")
                         + b"".join(bytes(12) + np.array(t, "<f4").tobytes() + bytes(2) for t in FLAKE))
    return str(path)


MESH = """
units lj
atom_style {style}
region b block 0 4 0 4 0 4
create_box 1 b
"""


@pytest.mark.parametrize("style", ["sphere", "molecular"])
def test_mesh_is_that_of_lammps(tmp_path, style):
    start = MESH.format(style=style) + "create_atoms 1 single 1 1 1 units box\n"
    ways = ["", "meshmode bisect 0.4", "meshmode qrand 4", *(["radscale 1.5", "radscale 0.7 meshmode qrand 2"] * (style == "sphere"))]
    cases = {f"{kind} {words}": f"{start}create_atoms 1 mesh {stl(tmp_path, kind)} units box {words}"
             for kind in ("text", "binary") for words in ways}
    theirs = lammps(cases)
    for name, script in cases.items():
        session = asemd(script)
        assert_same(session, theirs[name], x=1e-14)
        assert f"Reading STL object flake from {name.split()[0]} file" in "".join(session.told) and session.scene.system.n > 7
    if style == "sphere":
        radii = session.scene.system.extra["radius"][1:]
        areas = [0.5 * np.linalg.norm(np.cross(np.subtract(t[1], t[0]), np.subtract(t[2], t[0]))) for t in FLAKE]
        assert radii[0] == pytest.approx(0.7 * np.sqrt(areas[0] / np.pi / np.ceil(2 * areas[0])), rel=1e-7)     # of a binary file


@pytest.mark.parametrize("text, words", [("nothing", "no STL file"), ("solid a\nfacet normal 0 0\n", "line 2"),
                                         ("solid a\n\nfacet\n", "line 3"),
                                         ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 x\n", "'vertex' and 3 numbers in line 4"),
                                         ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 1_0\n", "'vertex' and 3 numbers in line 4"),
                                         ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 nan\n", "'vertex' and 3 numbers in line 4"),
                                         ("solid a\nfacet normal 0 0 1\n", "the end of the file")])
def test_faulty_meshes(tmp_path, text, words):
    path = tmp_path / "a.stl"
    path.write_text(text)
    with pytest.raises(InputError, match=words):
        asemd(MESH.format(style="atomic") + f"create_atoms 1 mesh {path} units box")


def lattice(words: str, units: str = "metal", boundary: str = "p p p", region: str = "block 0 3 0 2 0 3", more: str = "") -> str:
    return f"units {units}\nboundary {boundary}\nlattice {words}\nregion b {region}\ncreate_box 2 b\ncreate_atoms 1 box {more}"


CASES = {
    "fcc": FCC,
    "fcc fixed": FCC.replace("units lj", "units lj\nboundary f f f"),
    "fcc shrink": FCC.replace("units lj", "units lj\nboundary s p f"),
    "fcc minimum": FCC.replace("units lj", "units lj\nboundary m fs p"),
    "fcc at faces": lattice("fcc 1.0", boundary="f p f"),
    "bcc": lattice("bcc 3.1 origin 0.1 0.25 0.5", boundary="f p f"),
    "hcp": lattice("hcp 3.1"),
    "diamond": lattice("diamond 5.4"),
    "oriented": lattice("fcc 3.52 orient x 1 1 1 orient y 1 -1 0 orient z 1 1 -2 origin 0.1 0 0"),
    "custom": lattice("custom 3.52 a1 1 0 0 a2 0.5 1 0 a3 0 0 0.5 basis 0 0 0 basis .5 .5 .5"),
    "basis": lattice("fcc 3.52", more="basis 2 2 basis 4 2"),
    "general triclinic": GENERAL + "create_atoms 1 box basis 2 2\ncreate_atoms 1 single 0.5 0.5 0.5",
    "general triclinic region": GENERAL + "region s sphere 1 1 1 1\ncreate_atoms 1 region s",
    "hex": FLAT,
    "triclinic": TRICLINIC,
    "single": FCC + """
        create_atoms 2 single 1.1 1.2 1.3
        create_atoms 2 single 5 1.2 -1.3 remap yes
        create_atoms 2 single 5 1.2 -1.3
        create_atoms 1 single 1 1 1 units box""",
    "random": FCC + "create_atoms 2 random 50 991 NULL",
    "random region": FCC + """
        region s sphere 2 2 2 1.5
        create_atoms 2 random 50 991 s
        region o sphere 2 2 2 1.5 side out
        create_atoms 1 random 10 5 o""",
    "random on faces": """
        units lj
        region b block 0 6 -1 5 2 8
        create_box 2 b
        region high block 6 6 0 4 3 5
        region low block 0 2 -1 -1 3 5
        region point block 3 3 3 3 8 8
        create_atoms 1 random 4 991 high
        create_atoms 2 random 5 991 low
        create_atoms 2 random 6 12 point overlap 0.1 maxtry 3""",
    "random triclinic": TRICLINIC + "create_atoms 2 random 60 991 NULL",
    "random flat": FLAT + "create_atoms 1 random 7 33 NULL",
    "displace random": FCC + "displace_atoms all random 0.1 0.2 0.3 4711",
    "displace move": FCC + "displace_atoms all move 10 0.3 -7\ndisplace_atoms all move 0.1 0.2 0.3 units box",
    "displace variable": FCC + "variable a atom x*0.1\nvariable b equal 0.3\ndisplace_atoms all move v_a v_b 0.1",
    "displace ramp": FCC + "displace_atoms all ramp x 0 1 y 0.5 2",
    "displace shrink": FCC.replace("units lj", "units lj\nboundary s s s") + "displace_atoms all move 1 1 1",
    "displace rotate": FCC + "displace_atoms all move 2 0 0\ndisplace_atoms all rotate 1 1 1 0.3 0.4 0.5 33",
    "delete region": FCC + "region s sphere 2 2 2 1.5\ndelete_atoms region s",
    "delete group": FCC + "group g id 1:100:3\ndelete_atoms group g",
    "delete keep ids": FCC + "group g id 1:100:3\ndelete_atoms group g compress no",
    "delete variable": FCC + "variable far atom x>3\ndelete_atoms variable far",
    **{f"delete random {words}": FCC + "region h block INF INF INF 2 INF INF\ngroup g id 1:200:2\ndelete_atoms random " + words
       for words in (
        "fraction 0.3 yes g h 71", "fraction 0.3 no g h 71", "count 10 no g h 71", "count 1000 no g h 71", "count 10 yes all NULL 5",
        "fraction 0.5 no all NULL 77", "fraction 0.3 yes all NULL 7 compress no")},
    "overlap": FCC + "create_atoms 2 random 100 991 NULL\n" + PAIR + "delete_atoms overlap 0.5 all all",
    "overlap groups": FCC + "create_atoms 2 random 100 991 NULL\n" + PAIR
    + "group a type 1\ngroup b type 2\ndelete_atoms overlap 0.7 b all",
}


@pytest.fixture(scope="module")
def theirs():
    return lammps(CASES)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_atoms_as_lammps(theirs, name):
    tolerance = {"general": 1e-13}.get(name.split()[0], 0.0)
    assert_same(asemd(CASES[name]), theirs[name], x=tolerance)


def test_text():
    told = "".join(asemd(FCC).told)
    assert "Created orthogonal box = (0 0 0) to (6.7183848 6.7183848 6.7183848)\n" in told
    assert "Created 256 atoms\n  using lattice units in orthogonal box = (0 0 0) to (6.7183848 6.7183848 6.7183848)\n" in told
    told = "".join(asemd(TRICLINIC).told)
    assert "Created triclinic box = (0 0 0) to (6.7183848 5.0387886 8.397981) with tilt (0.8397981 -0.50387886 1.8475558)\n" in told


def test_speed():
    script = FCC.replace("0 4 0 4 0 4", "0 20 0 20 0 20")
    asemd(FCC)
    start = time.perf_counter()
    assert asemd(script + "velocity all create 1.44 87287").scene.system.n == 32000
    assert time.perf_counter() - start < 1.0


def test_counts_of_create_box():
    counts = asemd("""
        atom_style full
        region b block 0 1 0 1 0 1
        create_box 3 b bond/types 2 angle/types 1 extra/bond/per/atom 4 extra/special/per/atom 5""").scene.system.counts
    assert (counts["ntypes"], counts["nbondtypes"], counts["nangletypes"]) == (3, 2, 1)
    assert (counts["extra_bond_per_atom"], counts["extra_special_per_atom"]) == (4, 5)


def test_mass_and_labels():
    session = asemd(FCC + "labelmap atom 1 A 2 B\nmass * 3\nmass B 7")
    assert session.scene.system.mass[1:].tolist() == [3, 7]
    assert session.scene.system.labels["atom"] == {1: "A", 2: "B"}
    session.execute("create_atoms B single 1 1 1")
    assert session.scene.system.type[-1] == 2


def test_write_labels(tmp_path):
    session = asemd(FCC + "labelmap atom 1 A 2 B")
    session.execute(f"labelmap write {tmp_path / 'labels'}")
    session.execute("labelmap clear")
    assert session.scene.system.labels["atom"] == {}
    session.execute(f"include {tmp_path / 'labels'}")
    assert session.scene.system.labels["atom"] == {1: "A", 2: "B"}


def test_groups_follow_the_atoms():
    session = asemd(FCC + "group a id 1:10\ngroup b type 1\ncreate_atoms 2 single 1 1 1 units box\ngroup d id 3:5\ndelete_atoms group d")
    groups, system = session.scene.groups, session.scene.system
    assert groups["all"].all() and groups["a"].sum() == 7 and groups["b"].sum() == 253 and len(groups["a"]) == system.n == 254


@pytest.mark.parametrize("line, message", [
    ("create_box 1 b", "defined already"), ("create_atoms 3 box", "valid range 1 to 2"), ("create_atoms 1 bix", "did you mean box"),
    ("create_atoms 1 region q", "unknown region"), ("create_atoms 1 single 1 1", "3 values"),
    ("create_atoms 1 box basis 5 1", "4 basis atoms"), ("create_atoms 0 box", "valid range"),
    ("create_atoms 1 box mol m 1", "no molecule m"),
    ("create_atoms 1 random 5 0 NULL", "seed"), ("create_atoms 1 mesh a.stl", "units box"),
    ("create_atoms 1 mesh a.stl units box", "cannot open"),
    ("create_atoms 1 box radscale 2", "only for style mesh"), ("create_atoms 1 box meshmode qrand 3", "only for style mesh"),
    ("create_atoms 1 box overlap 1", "only for style random"), ("create_atoms 1 mesh a.stl meshmode qrand 0", "positive"),
    ("create_atoms 1 mesh a.stl meshmode rand 1", "bisect qrand"),
    ("create_atoms 1 random 5 9 far", "does not overlap"), ("mass 3 1.0", "valid range"), ("mass 1 0", "positive"),
    ("mass 1 x", "number"), ("mass 1", "1 words"), ("mass 1 nan", "finite"), ("labelmap atom 3 C", "valid range"),
    ("labelmap atom 1 2B", "digit"), ("labelmap atom 1 'A b'", "one word"), ("labelmap clear x", "0 values"),
    ("labelmap write a b", "1 value"),
    ("group g type A", "whole number"), ("labelmap atom 1 A 2 A", "two types"), ("labelmap atoms 1 A", "did you mean atom"),
    ("displace_atoms all mov 1 1 1", "did you mean move"), ("displace_atoms all move 1 1", "3 values"),
    ("displace_atoms non move 1 1 1", "unknown group"), ("displace_atoms all rotate 0 0 0 0 0 0 10", "axis"),
    ("displace_atoms all ramp x 0 1 y 2 2", "differ"), ("displace_atoms all move 1 1 1 unit box", "unknown keyword"),
    ("delete_atoms group g", "unknown group"), ("delete_atoms group all mol yes", "no molecules"),
    ("delete_atoms overlap -1 all all", "negative"), ("delete_atoms porosity b 1.1 1", "0 to 1"),
    ("delete_atoms random count 1000 yes all NULL 3", "exceeds number"),
    ("delete_atoms random frac 0.1 yes all NULL 3", "did you mean fraction"),
    ("delete_atoms random count 3 yes all NULL 0", "seed"), ("delete_atoms random count 3 yes all", "6 values"),
    ("delete_atoms group all compress maybe", "yes or no"),
])
def test_mistakes(line, message):
    session = asemd(FCC + "region far block 100 101 0 1 0 1")
    before = session.scene.system.x.copy()
    with pytest.raises(InputError, match=message):
        session.execute(line)
    assert np.array_equal(session.scene.system.x, before)


@pytest.mark.parametrize("script, message", [
    ("mass 1 1", "before simulation box"), ("region b sphere 0 0 0 1 side out\ncreate_box 1 b", "no bounds"),
    ("region b block 0 1 0 1 0 1\ncreate_box 0 b", "positive"), ("create_box 1 b", "unknown region"),
    ("region b block 0 1 0 1 0 1\ncreate_box 1 b bond/types 1", "no bonds"),
    ("dimension 2\nregion b block 0 1 0 1 1 2\ncreate_box 1 b", "z = 0"),
    ("region b block 0 1 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 box", "no lattice"),
    ("create_box 1 NULL 0 1 0 1 0 1", "triclinic/general"), (GENERAL.replace("-1 1", "1 1"), "blo 1 must be less"),
    (GENERAL.replace(" 0 3", ""), "6 values"), (GENERAL.replace("a1 1", "a1 -1"), "right-handed"),
    ("lattice fcc 1 triclinic/general", "style custom"),
    (GENERAL + "lattice sc 2\ncreate_atoms 1 box", "needs a lattice with triclinic/general"),
])
def test_mistakes_before_the_box(script, message):
    with pytest.raises(InputError, match=message):
        asemd(script)


BONDED = """
units lj
atom_style bond
region b block 0 10 0 10 0 10
create_box 1 b bond/types 1
"""


def chain():
    from asemd.topology import Topology
    session = asemd(BONDED)
    system = session.scene.system
    new = type(system)(box=system.box, x=np.arange(18.0).reshape(6, 3) / 2, type=1, molecule=[1, 1, 1, 2, 2, 2], atom_style="bond",
                       counts=system.counts, topology=Topology(bonds=[(0, 1), (1, 2), (3, 4), (4, 5)]))
    session.scene.system = new
    session.scene.sync_groups()
    return session


def test_delete_molecules_and_bonds():
    session = chain()
    session.execute("group g id 2")
    session.execute("delete_atoms group g bond yes compress no")
    system = session.scene.system
    assert sorted(system.id) == [1, 3, 4, 5, 6] and len(system.topology.bonds) == 2
    session.execute("group h id 5")
    session.execute("delete_atoms group h mol yes compress no")
    assert sorted(session.scene.system.id) == [1, 3] and not len(session.scene.system.topology.bonds)
    assert session.scene.system.topology.special(2)[1].tolist() == [2]      # still two bonds apart


def test_porosity_is_the_older_name_of_random():
    scripts = ("porosity b 0.3 17", "porosity all b 0.3 17", "random fraction 0.3 no all b 17")
    first, *others = (asemd(FCC + "delete_atoms " + words).scene.system.x for words in scripts)
    assert 150 < len(first) < 200 and all(np.array_equal(first, x) for x in others)
