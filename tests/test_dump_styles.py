"""Dumps of whole runs: the same snapshots as LAMMPS writes, in files that MDAnalysis, ASE and LAMMPS read."""
from __future__ import annotations

import gzip
import lzma
import re
import sys

import numpy as np
import pytest
from both import asemd, lines_of
from lj_cell import BASE
from wheel import ask, ran

from asemd.errors import InputError

SCENE = """
units real
region b prism 0 13 0 14 0 15 0.5 -0.3 0.2
create_box 2 b
create_atoms 1 random 6 123 NULL
mass * 1
velocity all create 300 1234 loop geom
set atom 3 type 2
pair_style zero 1
pair_coeff * *
labelmap atom 1 C 2 H
fix 1 all nve
compute st all stress/atom NULL
variable s equal logfreq(10,3,10)
variable sk equal step==4
"""
DUMPS = """
dump d0 all cfg 2 cfg.*.cfg mass type xs ys zs id vx
dump_modify d0 sort id element C H
dump d1 all cfg 10 cfgu.* mass type xsu ysu zsu vx c_st[*]
dump_modify d1 sort id
dump d2 all dcd 2 t.dcd
dump d3 all xtc 2 t.xtc
dump e2 all dcd 2 tu.dcd
dump e3 all xtc 2 tu.xtc
dump_modify e2 unwrap yes
dump_modify e3 unwrap yes precision 10000 sfactor 0.5 tfactor 2
dump d4 all extxyz 2 t.extxyz
dump_modify d4 mass yes element C H
dump e4 all extxyz 10 labels.extxyz
dump_modify e4 vel no forces no
dump d5 all yaml 2 t.yaml id type x c_st[2] element
dump_modify d5 thermo yes time yes units yes sort id
dump d6 all atom 2 t.bin
dump_modify d6 sort id units yes time yes
dump d7 all custom 2 tc.*.bin id type x vx ix element
dump_modify d7 sort id
dump d8 all atom 2 t.%.p
dump_modify d8 sort id pbc yes scale no image yes nfile 1
dump d9 all xyz 2 t.xyz
dump_modify d9 types labels
dump f0 all custom 2 every.txt id
dump_modify f0 every v_s first yes sort id
dump f1 all custom 2 time.txt id
dump_modify f1 every/time 2.5 sort id
dump g1 all custom 2 delayed.txt id
dump_modify g1 every/time 1.7 sort id delay 7
variable later equal time+2.7
dump g2 all custom 2 timed.txt id
dump_modify g2 every/time v_later sort id
dump f2 all custom 2 mf.*.txt id
dump_modify f2 maxfiles 2 pad 5 sort id
dump f3 all custom 2 last.txt id type x
dump_modify f3 sort id thresh x > LAST
dump f4 all custom 2 skip.txt id type
dump_modify f4 skip v_sk sort id thresh type |^ 0
dump f5 all custom 4 delay.txt id typelabel
dump_modify f5 delay 7 balance yes sort id
compute pairs all property/local patom1 patom2
dump z0 all atom/gz 2 z0.gz
dump_modify z0 sort id compression_level 1 format line "%d %d %g"
dump z1 all custom/gz 10 z1.*.gz id type x
dump_modify z1 sort id format line "%d %d %.12g %g %s"
dump z2 all xyz/gz 2 z2.gz
dump_modify z2 sort id format line "%s %g" compression_level -1
dump z3 all cfg/gz 10 z3.*.gz mass type xs ys zs
dump_modify z3 sort id element C H format line "%d %d %.8f %g %g"
dump z4 all local/gz 10 z4.gz index c_pairs[1] c_pairs[2]
dump_modify z4 sort 2
thermo 4
run 11
run 9
"""
THEIRS = """
import os
os.chdir(given["folder"])
lmp = ran(given["lines"])
"""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Folders with the dumps of LAMMPS and of asemd."""
    theirs, ours = tmp_path_factory.mktemp("theirs"), tmp_path_factory.mktemp("ours")
    flush = "import ctypes\nctypes.CDLL(None).fflush(None)\n"      # LAMMPS does not close xtc files
    ask(THEIRS + flush + "answer = 0", folder=str(theirs), lines=lines_of(SCENE + DUMPS))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ours)
        session = asemd(SCENE + DUMPS)
        session.close()
    return theirs, ours


def same_text(a: str, b: str) -> bool:
    """Equal but for the last digits of numbers."""
    x, y = ([float(n) for n in NUMBER.findall(text)] for text in (a, b))
    return NUMBER.sub("0", a) == NUMBER.sub("0", b) and np.allclose(x, y, rtol=1e-9, atol=1e-12)


def test_same_files(both):
    theirs, ours = ({p.name for p in folder.iterdir()} for folder in both)
    assert theirs == ours and "mf.00020.txt" in ours and "mf.00016.txt" not in ours


def test_same_text(both):
    theirs, ours = both
    names = [p.name for p in theirs.iterdir() if not p.name.endswith((".bin", ".dcd", ".xtc"))]
    assert len(names) > 25
    for name in names:
        a, b = ((gzip.open if name.endswith(".gz") else open)(folder / name, "rt") for folder in (ours, theirs))
        with a, b:
            assert same_text(a.read(), b.read()), name


def test_same_binary_files(both):
    theirs, ours = both
    for path in [theirs / "t.bin", *theirs.glob("tc.*.bin")]:
        a, b = path.read_bytes(), (ours / path.name).read_bytes()
        assert len(a) == len(b)
        differ = [i for i in range(len(a)) if a[i] != b[i]]
        assert all(i % 8 in {j % 8 for j in differ} for i in differ) and len(differ) < 0.05 * len(a)
        assert a[:0x90] == b[:0x90]         # everything but the numbers of atoms


@pytest.mark.parametrize("name", ["t.dcd", "tu.dcd", "t.xtc", "tu.xtc"])
def test_same_trajectories(both, name):
    mda = pytest.importorskip("MDAnalysis")
    frames = []
    for folder in both:
        universe = mda.Universe.empty(6, trajectory=True)
        universe.load_new(str(folder / name))
        frames.append([(ts.positions.copy(), ts.dimensions.copy(), ts.data.get("step", 0), ts.time) for ts in universe.trajectory])
    assert len(frames[0]) == len(frames[1]) == 11
    for theirs, ours in zip(*frames):
        assert np.allclose(ours[0], theirs[0], atol=2e-5) and np.allclose(ours[1], theirs[1], atol=1e-4)
        assert ours[2] == theirs[2] and np.isclose(ours[3], theirs[3])


def test_xtc_and_dcd_hold_what_was_there(both, tmp_path):
    """Against the text dump of the same run."""
    mda = pytest.importorskip("MDAnalysis")
    text = mda.Universe(str(both[1] / "t.xyz"), format="XYZ").trajectory
    for name, scale in (("t.dcd", 1.0), ("t.xtc", 1.0)):
        universe = mda.Universe.empty(6, trajectory=True)
        universe.load_new(str(both[1] / name))
        assert len(universe.trajectory) == len(text) == 11
        for ts, expected in zip(universe.trajectory, text):
            assert np.allclose(scale * ts.positions, expected.positions, atol=0.011 if "xtc" in name else 1e-4)


def test_ase_reads_extxyz_and_cfg(both):
    from ase.io import read
    frames = read(both[1] / "t.extxyz", index=":")
    first = read(both[1] / "cfg.0.cfg")
    assert len(frames) == 11 and frames[0].get_chemical_symbols() == ["C", "C", "H", "C", "C", "C"] and frames[0].pbc.all()
    assert np.allclose(frames[0].cell, [[13, 0, 0], [0.5, 14, 0], [-0.3, 0.2, 15]])
    assert "forces" in frames[0].arrays | frames[0].calc.results
    assert np.allclose(frames[0].cell, first.cell, atol=1e-4)
    assert np.allclose(frames[0].get_scaled_positions(), first.get_scaled_positions(), atol=1e-4)


def test_yaml_is_yaml(both):
    yaml = pytest.importorskip("yaml")
    documents = list(yaml.safe_load_all((both[1] / "t.yaml").read_text()))
    assert [d["timestep"] for d in documents] == list(range(0, 21, 2)) and len(documents[0]["data"]) == 6
    assert [d["timestep"] for d in documents if "thermo" in d] == [0, 4, 8, 12, 16, 20]


def block(name: str, step: int, folder) -> list[str]:
    """Lines of atoms of one step of a text dump."""
    text = (folder / name).read_text().split(f"ITEM: TIMESTEP\n{step}\n")[1].split("ITEM: TIMESTEP")[0]
    return text.split("ITEM: ATOMS")[1].splitlines()[1:]


def test_lammps_reads_our_dumps(both):
    """LAMMPS takes positions from the files of asemd."""
    files = {"t.0.p": "x y z replace yes"}
    answer = ask(THEIRS + """
answer = {}
for name, words in given["files"].items():
    lmp.command(f"read_dump {given['ours']}/{name} 10 {words}")
    answer[name] = by_id(lmp, "x")
""", folder=str(both[0]), ours=str(both[1]), lines=lines_of(SCENE), files=files)
    expected = np.loadtxt(list(block("t.0.p", 10, both[1])), usecols=(2, 3, 4))
    cell = np.array([[13, 0, 0], [0.5, 14, 0], [-0.3, 0.2, 15]])
    for x in answer.values():
        apart = (x - expected) @ np.linalg.inv(cell)
        assert np.allclose(apart - np.rint(apart), 0.0, atol=1e-5)


@pytest.mark.parametrize("ending, opener", [(".xz", lzma.open), (".bz2", None)])
def test_compressed(tmp_path, monkeypatch, ending, opener):
    import bz2
    monkeypatch.chdir(tmp_path)
    session = asemd(SCENE + f"dump a all atom 1 a{ending}\ndump b all atom 1 b\nrun 2")
    session.close()
    with (opener or bz2.open)(tmp_path / f"a{ending}", "rt") as f:
        assert f.read() == (tmp_path / "b").read_text()


BONDED = """
units real
atom_style bond
region b block 0 12 0 12 0 12
create_box 2 b bond/types 1 extra/bond/per/atom 2
create_atoms 1 single 3 6 6
create_atoms 2 single 5 6 6
create_atoms 2 single 9 6 6
create_bonds single/bond 1 1 2
mass * 12
pair_style zero 3
pair_coeff * *
bond_style zero
bond_coeff *
special_bonds lj 0 1 1
"""


def picture(tmp_path, words: str, modify: str = "", name: str = "i.*.png"):
    from PIL import Image
    session = asemd(BONDED + f"dump i all image 1 {tmp_path}/{name} {words} size 80 60" + (f"\ndump_modify i {modify}" if modify else "")
                    + "\nrun 0")
    session.close()
    return np.asarray(Image.open(next(tmp_path.glob(name.replace("*", "0")))).convert("RGB")).astype(int)


def test_picture_of_atoms_and_a_bond(tmp_path):
    a = picture(tmp_path, "type type adiam 1.5 box no 0 view 0 0 up 0 1 0 bond atom 0.6", "acolor 1 red acolor 2 blue backcolor white")
    assert a.shape == (60, 80, 3) and (a[0, 0] == 255).all()
    row = a[30]                                  # all atoms lie on the middle line: atom 1 and 2 with a bond, then 3 alone
    red, blue = row[:, 0] > row[:, 2] + 50, row[:, 2] > row[:, 0] + 50
    assert red.any() and blue.any() and red.argmax() < blue.argmax()
    joined = row[red.argmax():blue.argmax() + 3]
    assert (joined.min(axis=1) < 200).all()      # no gap between the bonded atoms
    assert (np.diff(np.flatnonzero(blue)) > 5).any()     # but between the others
    bare = picture(tmp_path, "type type adiam 1.5 box no 0 view 0 0 up 0 1 0 bond none none", "acolor 1 red acolor 2 blue backcolor white")
    assert (bare[30].min(axis=1) > 250).sum() > (row.min(axis=1) > 250).sum()


def test_picture_words(tmp_path):
    for words, modify in (("element element axes yes 0.3 0.02 ssao yes 123 0.5 shiny 0.2", "element C O boxcolor gray"),
                          ("x type zoom 1.5 center d 0.4 0.5 0.6 fsaa yes", "amap min max cf 0.0 3 min blue 0.5 white max red adiam * 2"),
                          ("id x atom yes subbox yes 0.01", "amap 0 10 da 1 2 0 1.5 green min max gold color gold 0.9 0.7 0.1"),
                          ("mass type bond type 0.3 view 90 0", "amap 0 100 sa 10 2 red blue bcolor 1 orange bdiam 1 0.2 thresh x < 8")):
        a = picture(tmp_path, words, modify)
        assert len(np.unique(a.reshape(-1, 3), axis=0)) > 25, words


def test_bonds_across_the_boundary_end_flat(tmp_path):
    """Half a bond that leads out of the box is closed by a disc, in the colour of its atom."""
    lines = BONDED.replace("single 3 6 6", "single 0.4 6 6").replace("single 5 6 6", "single 11.5 6 6")
    session = asemd(lines + f"dump i all image 1 {tmp_path}/i.*.ppm type type adiam 0.7 box no 0 view 90 0 bond type 0.6 size 120 120\n"
                    "dump_modify i acolor 1 red acolor 2 blue bcolor 1 white\nrun 0")
    session.close()
    from PIL import Image
    a = np.asarray(Image.open(tmp_path / "i.0.ppm")).astype(int)
    middle = a[58:62, 58:62].reshape(-1, 3)      # seen along the bond: its end hides the atom behind
    assert (middle.min(axis=1) > 100).all() and np.ptp(middle, axis=0).max() < 10


def test_endings_of_pictures(tmp_path):
    for ending, magic in (("png", b"\x89PNG"), ("jpg", b"\xff\xd8"), ("ppm", b"P6")):
        picture(tmp_path, "type type", name=f"p.*.{ending}")
        assert (tmp_path / f"p.0.{ending}").read_bytes().startswith(magic)


def test_one_picture_by_write_dump(tmp_path):
    from PIL import Image
    asemd(BONDED + f"write_dump all image {tmp_path}/p.png type type size 30 20\nwrite_dump all cfg {tmp_path}/c mass type xs ys zs")
    assert Image.open(tmp_path / "p.png").size == (30, 20) and (tmp_path / "c").read_text().startswith("Number of particles = 3\n")


def test_movie(tmp_path):
    from PIL import Image
    session = asemd(BONDED + f"velocity all create 5000 12\nfix 1 all nve\ndump m all movie 2 {tmp_path}/m.gif type type size 40 40\n"
                             "dump_modify m framerate 10\nrun 6")
    session.close()
    film = Image.open(tmp_path / "m.gif")
    assert film.n_frames == 4 and film.info["duration"] == 100 and film.size == (40, 40)


def test_colour_maps():
    from asemd.dump._colours import ColourMap, rgb
    words = "0 10 ca 0 3 min black 2 red max white".split()
    colours = ColourMap.from_words(words, {}, "amap")[0](np.array([-5.0, 1.0, 2.0, 6.0, 99.0]))
    assert np.allclose(colours, [[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1, 0.5, 0.5], [1, 1, 1]])
    bins = ColourMap.from_words("min max sf 0.25 2 red blue".split(), {}, "amap")[0](np.array([0.0, 0.3, 0.6, 1.0]))
    assert bins.tolist() == [list(rgb(n, {}, "")) for n in ("red", "blue", "red", "red")]


@pytest.mark.parametrize("line, message", [
    ("dump d all image 1 F.png type type", "needs a \\*"), ("dump d all image 1 F.* type", "needs 2 values"),
    ("dump d all image 1 F.* type type foo", "unknown keyword"), ("dump d all image 1 F.* type type line yes 1", "not supported"),
    ("dump d all image 1 F.* type type size 0 5", "pixels"), ("dump d all image 1 F.* type type view 190 0", "180"),
    ("dump d all image 1 F.* type type persp 1", "perspective"), ("dump d all image 1 F.* tipe type", "did you mean type"),
    ("dump d all image 1 F.* type type zoom 0", "positive"), ("dump d all movie 1 F.*.gif type type", "one file"),
    ("dump d all cfg 1 F.* id type xs ys zs", "mass type xs ys zs"), ("dump d all cfg 1 F mass type xs ys zs", "needs a \\*"),
    ("dump d all dcd 1 F.*", "one file holds all"), ("dump d all xtc 1 F.gz", "compressed"), ("dump d all dcd 1 F x", "no more words"),
    ("dump d all yaml 1 F.bin id", "binary"), ("dump d all local 1 F.bin index", "binary"),
    ("dump_modify i acolor 1 redd", "did you mean red"), ("dump_modify i amap 0 1 xx 0 2 min red max blue", "style"),
    ("dump_modify i amap 0 1 ca 0 2 min red 1 blue", "min to max"), ("dump_modify i adiam 9 1", "outside"),
    ("dump_modify i color c 2 0 0", "from 0 to 1"), ("dump_modify i sort id", "not supported"),
    ("dump_modify t sort off", "sorted by id"), ("dump_modify t append yes", "not possible"),
    ("dump_modify t every v_s", "equal intervals"),
    ("dump_modify x precision 5", "expected one of"), ("dump_modify x sfactor 0", "positive"), ("dump_modify t thresh x > 1", "not supp"),
    ("dump_modify c maxfiles 2", "with \\*"), ("dump_modify c skip 3", "v_name"), ("dump_modify c every/time -1", "positive"),
    ("dump d all image 1 F.* type type up 0 0 0", "direction"), ("dump d all image 1 F.* type type ssao yes 0 0.5", "seed"),
    ("dump_modify i amap 1 0 cf 0 2 min red max blue", "above the upper"), ("dump_modify c pad -1", "negative"),
    ("dump d all atom/gz 1 F", "must end in .gz"), ("dump_modify z compression_level 10", "0 to 9"),
    ("dump_modify c compression_level 3", "not supported"), ("dump_modify z format float %g", "only line and none"),
    ("dump_modify c triclinic/general yes", "general triclinic"),
    ("dump_modify c thermo yes", "not supported"), ("dump d all custom 1 F id i_no", "no property"),
])
def test_mistakes(line, message, tmp_path):
    session = asemd(SCENE + f"dump i all image 1 {tmp_path}/i.* type type\ndump t all dcd 1 {tmp_path}/t\n"
                            f"dump x all xtc 1 {tmp_path}/x\ndump c all custom 1 {tmp_path}/c id\n"
                            f"dump z all atom/gz 1 {tmp_path}/z.gz")
    with pytest.raises(InputError, match=message):
        session.execute(line.replace("F", str(tmp_path / "f")))
        session.execute("run 0")


def test_names_are_needed_for_extxyz(tmp_path):
    with pytest.raises(InputError, match="atoms need names"):
        asemd(BONDED + f"dump d all extxyz 1 {tmp_path}/f\nrun 0")


def test_dcd_on_a_full_disk(tmp_path, monkeypatch):
    """The library that writes the format says nothing of it; asemd counts what arrived."""
    pytest.importorskip("MDAnalysis")
    resource = pytest.importorskip("resource")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    lmp = ran(BASE + "run 5\ndump d all dcd 5 x.dcd\n")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (3000, hard))
    try:
        with pytest.raises(InputError, match=r"dump d: cannot write x.dcd: \d of \d+ snapshots arrived"):
            lmp.commands_string("run 50\nundump d\n")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    lmp.close()
