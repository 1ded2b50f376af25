"""fix adapt/fep: properties by atom type and changes after multiples of N, as LAMMPS has them; its words."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran, start

from asemd.errors import InputError

BASE = """
units real
atom_style full
atom_modify map array
region b block 0 15 0 15 0 15
create_box 3 b
create_atoms 1 random 40 123 NULL overlap 2.8 maxtry 3000
create_atoms 3 single 7.5 7.5 7.5
create_atoms 2 single 2.5 7.5 7.5
mass * 20
set type 3 charge 0.3
set type 2 charge -0.3
pair_style lj/cut/coul/cut 6 7
pair_coeff * * 0.1 2.8
minimize 1e-3 1e-3 10 50
reset_timestep 0
velocity all create 120 77
group few id 1:41
fix 1 all nve
variable lam equal ramp(0.1,1.0)
variable q equal 0.3*v_lam
variable p equal -0.2*v_lam
variable e equal 0.1*v_lam
thermo_style custom step evdwl ecoul press
"""
CASES = {
    "plain": "fix a all adapt/fep 3 pair lj/cut/coul/cut epsilon 1 2*3 v_e atom charge 3 v_q atom charge 1*2 v_p",
    "after": "fix a few adapt/fep 3 atom charge * v_q pair lj/cut/coul/cut epsilon 1 3 v_e after yes",
    "after each": "fix a all adapt/fep 1 atom charge 2 v_p after yes reset yes",
    "factors": "fix a all adapt/fep 4 pair lj/cut/coul/cut epsilon 1 1 v_q pair lj/cut/coul/cut epsilon 3 3 v_lam scale yes reset yes",
    "start only": "fix a all adapt/fep 0 atom charge 3 v_q",
}
THEIRS = """
answer = {}
for name, text in given["scripts"].items():
    lmp, rows = ran(text), []
    for run in given["runs"]:
        lmp.command(run)
        rows.append([*[lmp.last_thermo()[k] for k in ("E_vdwl", "E_coul", "Press")], *lmp.gather_atoms("q", 1, 1),
                     *lmp.gather_atoms("x", 1, 3)])
    answer[name] = rows
    lmp.close()
"""
RUNS = ["run 0", "run 4", "run 3", "run 9"]


@pytest.fixture(scope="module")
def theirs():
    return ask(THEIRS, scripts={name: BASE + line for name, line in CASES.items()}, runs=RUNS)


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    lmp = ran(BASE + CASES[name])
    for run, expected in zip(RUNS, theirs[name], strict=True):
        lmp.command(run)
        row = [*(lmp.last_thermo()[k] for k in ("E_vdwl", "E_coul", "Press")), *lmp.gather_atoms("q", 1, 1), *lmp.gather_atoms("x", 1, 3)]
        np.testing.assert_allclose(row, expected, rtol=1e-8, atol=1e-8)
    words = lmp.scene.fixes["a"].to_lammps()
    again = type(lmp.scene.fixes["a"]).from_lammps("all", words, lmp.session)
    assert again.to_lammps() == words == CASES[name].split()[4:]
    lmp.close()


@pytest.mark.parametrize(("words", "message"), [
    ("3", "at least one of"), ("3 atom mass 1 v_q", "expected one of charge diameter"), ("3 atom charge 4 v_q", "outside the valid range"),
    ("3 atom diameter 1 v_q", "has no diameter"), ("3 bond harmonic k 1 v_q", "expected one of pair"), ("3 atom charge 1 q", "v_name"),
    ("3 pair lj/cut/coul/cut foo 1 1 v_e", "no coefficient 'foo'"), ("-1 atom charge 1 v_q", "not be negative"), ("3 after", "1 value"),
])
def test_refused(words, message):
    lmp = start()
    lmp.commands_string(BASE.replace("minimize 1e-3 1e-3 10 50", ""))
    with pytest.raises(InputError, match=message):
        lmp.command(f"fix a all adapt/fep {words}")
