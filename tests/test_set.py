"""The set command."""
from __future__ import annotations

import pytest
from both import asemd, assert_same, lammps
from wheel import ask

from asemd.errors import InputError
from asemd.topology import Topology

ATOMS = """
units lj
atom_style full
lattice fcc 0.8442
region b block 0 3 0 3 0 3
create_box 3 b bond/types 3 angle/types 2
create_atoms 1 box
mass * 1
set atom 50*60 type 2
set atom 20*70 mol 4
region left block INF 1.5 INF INF INF INF
variable even atom id%2
variable where atom x*0.1+1.7
group g id 1:100:7
"""
FORMS = {
    "type": "set atom 3*7 type 3",
    "open ranges": "set atom 100* type 3\nset atom *4 type 2\nset type 2* charge 0.25",
    "all types": "set type * charge -0.5",
    "mol": "set mol 4 mol 9\nset mol *3 mol 2",
    "group": "set group g charge 1.5 type 2 mol 3",
    "region": "set region left type 2 vx 1 vy 2 vz 3",
    "place": "set atom 5 x 0.5 y 0.6 z 0.7",
    "variable": "set group g charge v_where vx v_even",
    "variable type": "set group g type v_where mol v_where",
    "image": "set group g image 1 -2 NULL\nset atom 4 image NULL NULL 3",
    "fraction": "set type 1 type/fraction 3 0.3 12345\nset group all type/fraction 2 0.5 99",
    "fraction all": "set group all type/fraction 2 1.0 7",
    "ratio": "set type 1 type/ratio 3 0.3 12345\nset group all type/ratio 2 0.5 99",
    "subset": "set type 1 type/subset 3 17 12345\nset region left type/subset 2 1 99",
    "none": "set atom 9999 x 1",
}


@pytest.fixture(scope="module")
def theirs():
    return lammps({name: ATOMS + text for name, text in FORMS.items()})


@pytest.mark.parametrize("form", FORMS)
def test_same_as_lammps(theirs, form):
    assert_same(asemd(ATOMS + FORMS[form]), theirs[form])


def test_text():
    told = "".join(asemd(ATOMS + "set atom 1*5 mol 3 charge -1").told)
    assert told.endswith("Setting atom values ...\n  5 settings made for mol\n  5 settings made for charge\n")


def test_bonded_types():
    session = asemd(ATOMS)
    system = session.scene.system
    system.topology = Topology(bonds=[(0, 1), (1, 2), (4, 5)], angles=[(0, 1, 2)])
    session.execute("set atom 1*2 bond 3 angle 2")
    assert system.topology.bond_types.tolist() == [3, 1, 1] and system.topology.angle_types.tolist() == [1]
    session.execute("set atom 1*3 angle 2")
    assert system.topology.angle_types.tolist() == [2]
    with pytest.raises(InputError, match="no improper types"):
        session.execute("set group all improper 1")


@pytest.mark.parametrize("line, message", [
    ("set atom 1 type 4", "valid range 1 to 3"), ("set type 4 x 1", "valid range"), ("set atom 1 typ 1", "did you mean type"),
    ("set atm 1 type 1", "did you mean atom"), ("set atom 1", "keyword"), ("set atom 1 x", "1 value"), ("set atom 1 x y", "number"),
    ("set atom 1 x nan", "finite"), ("set group nope x 1", "unknown group"), ("set region nope x 1", "unknown region"),
    ("set atom 1 diameter 2", "no diameter"), ("set atom 1 type/fraction 2 1.5 1", "from 0 to 1"),
    ("set atom 1 type/fraction 2 0.5 0", "seed"), ("set atom 1 mass 2", "mass command"), ("set atom 1 mol -1", "negative"),
    ("set atom 1 charge v_nope", "undefined"), ("set atom x type 1", "range"), ("set group all type v_even", "valid range"),
])
def test_mistakes(line, message):
    session = asemd(ATOMS)
    with pytest.raises(InputError, match=message):
        session.execute(line)


def test_properties_the_style_does_not_have():
    script = "lattice sc 1.0\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 box\nset group all "
    for words, message in (("charge 1", "charges"), ("mol 1", "molecules"), ("bond 1", "bond types")):
        with pytest.raises(InputError, match=message):
            asemd(script + words)
    with pytest.raises(InputError, match="not periodic"):
        asemd("boundary f p p\n" + script + "image 1 0 0")


SPHERES = """
units lj
atom_style sphere
lattice fcc 0.8442
region b block 0 2 0 2 0 2
create_box 1 b
create_atoms 1 box
variable w atom id*0.1
set atom 3*9 diameter 0.8
set group all density 2.5 omega 1.5 v_w -0.2
"""
DISCS = SPHERES.replace("units lj", "units lj\ndimension 2").replace("fcc 0.8442", "hex 0.7").replace("0 2 0 2 0 2", "0 4 0 4 -0.5 0.5")
DISCS += "set atom 4* density/disc 0.7\n"


@pytest.mark.parametrize("script", [SPHERES, DISCS])
def test_spheres(script):
    answer = ask("""
lmp = ran(given["lines"])
answer = {name: by_id(lmp, name) for name in ("rmass", "radius", "omega")}
lmp.close()""", lines=script.splitlines())
    system = asemd(script).scene.system
    for name, ours in (("rmass", system.rmass), ("radius", system.extra["radius"]), ("omega", system.extra["omega"])):
        assert abs(ours - answer[name]).max() < 1e-14, name


@pytest.mark.parametrize("line, message", [
    ("set group all type/ratio 2 1.5 7", "0 to 1"), ("set group all type/subset 2 109 7", "109 of 108"),
    ("set group all type/subset 2 -1 7", "negative"),
    ("set group all type/subset 2 5 0", "seed"), ("set group all omega 1 2 3", "no angular"), ("set group all omega 1 2", "3 values"),
])
def test_mistakes_of_new_keywords(line, message):
    with pytest.raises(InputError, match=message):
        asemd(ATOMS).execute(line)
