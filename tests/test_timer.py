"""The command timer: what the table after a run shows, and the limit of wall time for runs and minimisations."""
from __future__ import annotations

import pytest
from both import asemd

from asemd.errors import InputError, InputWarning

SCENE = """
units lj
lattice fcc 0.8442
region b block 0 3 0 3 0 3
create_box 1 b
create_atoms 1 box
mass 1 1
displace_atoms all random 0.1 0.1 0.1 7
pair_style lj/cut 2.5
pair_coeff 1 1 1 1
fix 1 all nve
thermo 0
"""


def told(commands: str) -> str:
    return "".join(asemd(SCENE + commands).told)


@pytest.mark.parametrize("words, settings", [
    ("", "style=normal  mode=nosync  timeout=off"), ("full sync", "style=full  mode=sync  timeout=off"),
    ("timeout 2:30 loop", "style=loop  mode=nosync  timeout=00:02:30"), ("timeout 100:00:05 every 7", "timeout=100:00:05"),
    ("timeout 75", "timeout=00:01:15"), ("timeout 5 timeout unlimited", "timeout=off"),
])
def test_settings(words, settings):
    assert f"New timer settings: {settings}\n".removeprefix("New timer settings: timeout") in told(f"timer {words}")


@pytest.mark.parametrize("words, message", [
    ("timeout", "timer timeout"), ("timeout x", "hours:minutes:seconds"),
    ("timeout -5", "hours:minutes"), ("timeout 1:2:3:4", "hours:minutes"),
    ("every 0", "positive"), ("every x", "timer every"), ("fast", "unknown keyword 'fast'"),
])
def test_mistakes(words, message):
    with pytest.raises(InputError, match=message):
        asemd(f"timer {words}")


def test_settings_stay():
    assert told("timer full\ntimer sync\ntimer every 3").endswith("style=full  mode=sync  timeout=off\n")


def test_runs_after_the_limit_are_skipped():
    session = asemd(SCENE + "timer timeout 0\nrun 10\nminimize 0 0 10 10\nrun 10 every 5 'print hi'")
    assert session.scene.step == 0 and "Step" not in "".join(session.told) and "hi" not in session.told[-1]
    session.execute("timer timeout off")
    session.execute("run 2")
    assert session.scene.step == 2


def test_run_stops_at_a_look_at_the_clock():
    session = asemd(SCENE + "run 0\ntimer timeout 1 every 7\nvariable left equal timeremain")
    with pytest.warns(InputWarning, match="Wall time limit reached"):
        session.execute("run 1000000000")
    step, text = session.scene.step, "".join(session.told)
    assert step > 0 and step % 7 == 0 and f"procs for {step} steps" in text
    assert session.variables.number("left") == 0.0 and f"\n{step:10d} " not in text     # no row of output, as in LAMMPS
    session.execute("run 10")
    assert session.scene.step == step


@pytest.mark.parametrize("style", ["quickmin", "fire"])
def test_minimisation_stops(style):
    session = asemd(SCENE + f"run 0\nmin_style {style}\nmin_modify dmax 1e-9 vdfmax 0\ntimer timeout 1 every 5")
    with pytest.warns(InputWarning, match="Wall time limit reached"):
        session.execute("minimize 0 0 1000000000 1000000000")
    assert "Stopping criterion = walltime limit reached" in "".join(session.told) and session.scene.step % 5 == 0


def test_remaining_time_in_thermo():
    session = asemd(SCENE + "timer timeout 1:00:00\nthermo_style custom step timeremain\nrun 1")
    assert 3500 < session.last_thermo["TimeoutLeft"] <= 3600


@pytest.mark.parametrize("style, there, missing", [
    ("off", (), ("Loop time", "CPU use", "MPI task timing")), ("loop", ("Loop time", "CPU use"), ("MPI task timing",)),
    ("full", ("|%varavg|  %CPU | %total\n" + "-" * 71 + "\nPair ",), ("Sync",)),
    ("normal sync", ("|%varavg| %total\n" + "-" * 63 + "\nPair ", "\nSync    | 0          |"), ("%CPU",)),
])
@pytest.mark.parametrize("action", ["run 2", "minimize 0 0 2 10"])
def test_table(style, there, missing, action):
    text = told(f"timer {style}\n{action}")
    assert all(t in text for t in there) and not any(t in text for t in missing) and "\n\nNlocal:" in text
