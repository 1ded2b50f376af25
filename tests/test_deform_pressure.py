"""fix deform/pressure changes the box as LAMMPS does."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

CRYSTAL = """
units lj
lattice fcc 0.8442
region b {region}
create_box 1 b
create_atoms 1 box
mass * 1
velocity all create 1.0 87287
pair_style lj/cut 2.0
pair_coeff * * 1 1
variable p equal 5*step
fix 1 all nve
fix 2 all deform/pressure {words}
timestep 0.003
thermo 1
thermo_modify norm no
run {steps}
"""
BLOCK, PRISM = "block 0 4 0 4 0 4", "prism 0 4 0 4 0 4 0 0 0"
CASES = {
    "pressure": "1 x pressure 5.0 0.1", "mean": "1 x pressure 5.0 0.1 y pressure/mean 2.0 0.1", "couple": "1 x pressure 5 0.1 couple xy",
    "volume": "1 x erate 0.1 y volume z pressure 1 0.1", "box": "1 box pressure 1 0.1", "box volume": "1 x erate 0.1 box volume",
    "pressure and box": "1 x pressure 5 0.1 box pressure 1 0.1", "rate and box": "1 x volume y erate 0.1 box pressure 1 0.1",
    "limit": "1 x pressure 5 0.1 max/rate 0.01", "normalized": "1 x pressure 5 0.1 normalize/pressure yes",
    "xy": "1 xy pressure 1 0.1 y pressure 1 0.1", "rescaled": "1 xy erate/rescale 0.1 y pressure 3 0.2", "variable": "1 x pressure v_p 0.1",
    "balance": "1 x trate 0.5 y volume z volume vol/balance/p yes",
    "balance, every": "3 x volume y erate -0.4 z volume vol/balance/p yes",
    "balance, limit": "1 x volume y volume z erate 0.5 vol/balance/p yes max/rate 0.3",
    "balance, box": "1 x volume y volume z erate -0.3 box pressure 3 0.01 vol/balance/p yes",
    "remap v": "1 x pressure 5 0.1 remap v", "box, remap v": "1 box pressure 8 0.1 remap v", "every": "5 x pressure 5 0.1",
}
STEPS = {"remap v": "40", "box, remap v": "40"}
SCRIPT = """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    box = lmp.extract_box()
    answer[name] = [*box[0], *box[1], *box[2:5], lmp.get_thermo("press"), lmp.get_thermo("temp")]
    lmp.close()
"""


def text(name: str) -> str:
    words = CASES.get(name, name)
    region = PRISM if "xy " in words and "couple" not in words else BLOCK
    return CRYSTAL.format(words=words, region=region, steps=STEPS.get(name, "6\nrun 5"))


@pytest.fixture(scope="module")
def theirs():
    return ask(SCRIPT, cases={name: lines_of(text(name)) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    session = asemd(text(name))
    box, tilt = session.scene.system.box, session.scene.system.box.tilt
    got = [*box.lo, *box.hi, tilt[0], tilt[2], tilt[1], session.last_thermo["Press"], session.last_thermo["Temp"]]
    limit = 1e-8 if "balance" in name else 1e-10        # it divides by changes of the pressure from step to step
    assert got == pytest.approx(theirs[name], rel=limit, abs=0.1 * limit)
    assert not np.allclose([*box.lengths, *tilt], [4 * (4 / 0.8442) ** (1 / 3)] * 3 + [0.0] * 3)


@pytest.mark.parametrize("name", ["box", "balance"])
def test_goes_on_from_a_restart_file(name, tmp_path):
    """A second run, and one of a restart file between the two."""
    head, fixes = text(name).split("pair_style")
    first = asemd(f"{head}pair_style{fixes}\nwrite_restart {tmp_path}/r\nrun 5")
    again = asemd(f"read_restart {tmp_path}/r\npair_style{fixes.rpartition('run 6')[0]}\nrun 5")
    for key in ("Press", "Temp", "Volume"):
        assert again.last_thermo[key] == pytest.approx(first.last_thermo[key], rel=1e-10)
    assert first.scene.system.box.lengths == pytest.approx(again.scene.system.box.lengths, rel=1e-13)


@pytest.mark.parametrize(("words", "message"), [
    ("1 x pressure 5", "2 values"), ("1 x pressure 5 0.1 max/rate 0", "positive"), ("1 x pressure 5 0.1 couple foo", "one of none"),
    ("1 x pressure 5 0.1 y pressure 4 0.1 couple xy", "identical gain"), ("1 z pressure 5 0.1 couple xy", "at least one coupled"),
    ("1 x erate 0.1 couple xy", "non-pressure-controlled"), ("1 x final 0 5 box pressure 1 0.1", "box cannot be used with x final"),
    ("1 x erate/rescale 0.1", "one of"), ("1 x pressure 5 0.1 foo", "unknown keyword 'foo'"), ("1 box foo", "one of volume pressure"),
    ("1 x erate 1 y volume z volume vol/balance/p maybe", "yes or no"), ("1 x erate 1 y volume z volume vol/balance/p", "1 value"),
    ("1 x pressure 0 0.1 normalize/pressure yes", "zero pressure"),
])
def test_messages(words, message):
    with pytest.raises(InputError, match=message):
        asemd(text(words))
