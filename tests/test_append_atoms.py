"""fix append/atoms lets a crystal grow as LAMMPS does."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, assert_same, lammps

from asemd.errors import InputError

CRYSTAL = """
units {units}
boundary p p {face}
lattice fcc {lattice}
region b block 0 3 0 3 0 4
create_box 2 b
create_atoms 1 box
mass * {mass}
velocity all create {temperature} 87287
pair_style lj/cut {cutoff}
pair_coeff * * {well}
group low id 1:30
fix 1 all nve
fix 2 {group} append/atoms zhi {words}
timestep {dt}
run {steps}
"""
COMMON = {"units": "lj", "face": "sm", "lattice": "0.8442", "mass": 1, "temperature": 1.0, "cutoff": 2.0, "well": "1 1", "group": "all",
          "dt": 0.002, "steps": "9\nrun 16"}
CASES = {
    "size": {"words": "size 1 freq 10"},
    "basis": {"words": "size 2.5 freq 10 basis 2 2 basis 4 2", "lattice": "0.8442 origin 0.1 0.2 0.3"},
    "box units": {"words": "size 3.0 freq 6 units box", "group": "low"},
    "random": {"words": "size 1 freq 10 random 0.05 0.04 0.03 7345"},
    "random in box units": {"words": "size 2 freq 10 units box random 0.05 0.04 0.0 73"},
    "friction": {"lattice": "0.8442 origin 0.1 0.2 0.3", "words": "size 1 freq 5 temp 1e-20 0.5 77 4",
                 "temperature": 2.0},
    "metal": {"units": "metal", "lattice": "5.26 origin 0.1 0.2 0.3",
              "mass": 40, "temperature": 100, "cutoff": 7.0, "well": "0.01 3.4", "dt": 0.002,
              "words": "size 1.5 freq 8 temp 1e-20 0.1 77 12"},
    "nothing": {"words": "size 0 freq 5"},
    "rest": {"words": "size 1 freq 20 basis 1 2", "steps": "0\nrun 5"},
}


def text(name: str) -> str:
    return CRYSTAL.format(**COMMON | CASES[name])


@pytest.fixture(scope="module")
def theirs():
    return lammps({name: text(name) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    session = asemd(text(name))
    assert_same(session, theirs[name], x=1e-9, v=1e-9)
    assert len(session.scene.groups.mask("low")) == session.scene.system.n
    if name not in ("nothing", "rest"):
        assert session.scene.system.n > 144


def test_thermostat():
    """Between the frozen layer and the rest atoms take up the target temperature."""
    words = {"temperature": 0.01, "well": "0 1", "steps": 600, "words": "size 1 freq 1000 temp 2.0 0.1 77 5"}
    session = asemd(CRYSTAL.format(**COMMON | words))
    system = session.scene.system
    z, speed = system.x[:, 2], (system.v**2).sum(axis=1)
    top = system.box.hi[2]
    assert (speed[z >= top - session.scene.fixes["2"].size] == 0.0).all()
    warm = (z < top - session.scene.fixes["2"].size) & (z >= top - 5.0)
    assert speed[warm].mean() / 3 == pytest.approx(2.0, rel=0.35)
    assert np.median(speed[z < top - 5.5]) / 3 < 0.5


@pytest.mark.parametrize(("words", "face", "message"), [
    ("size 1 freq 0", "sm", "freq: needs a number of steps"), ("size -1 freq 1", "sm", "size: must not be negative"),
    ("size 1 freq 1 basis 5 1", "sm", "4 basis atoms"), ("size 1 freq 1 basis 1 3", "sm", "type 3 is outside"),
    ("size 1 freq 1 random 1 1 1", "sm", "random needs 4 values"), ("size 1 freq 1 temp 0 1 7 1", "sm", "must be above 0"),
    ("size 1 freq 1 temp 1 1 0 1", "sm", "temp: the seed"), ("size 1 freg 1", "sm", "did you mean freq"),
    ("size 1 freq 1 units cell", "sm", "one of lattice box"), ("size 1 freq 1", "s", "Append boundary must be shrink/minimum"),
    ("size 1 freq 1", "p", "Append boundary must be shrink/minimum"),
])
def test_messages(words, face, message):
    with pytest.raises(InputError, match=message):
        asemd(CRYSTAL.format(**COMMON | {"face": face, "words": words}))


def test_other_faces_and_no_lattice():
    with pytest.raises(InputError, match="Only zhi"):
        asemd(text("size").replace("zhi", "zlo"))
    with pytest.raises(InputError, match="needs a lattice"):
        asemd(text("size").replace("fix 2", "lattice none 1.0\nfix 2"))


def test_round_trip():
    fix = asemd(text("size").rpartition("run 9")[0]).scene.fixes["2"]
    assert fix.to_lammps() == "zhi size 1 freq 10".split()
