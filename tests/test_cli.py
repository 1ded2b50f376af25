"""The command line."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest
from lj_cell import BASE

import asemd
from asemd import cli


@pytest.fixture
def script(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text("variable n index 4\n" + BASE + "thermo 2\nrun $n\n")
    return tmp_path


def test_run(script, capsys):
    assert cli.main(["run", "in.x"]) == 0
    out = capsys.readouterr().out
    assert "   Step          Temp" in out and "Loop time of" in out
    log = (script / "log.lammps").read_text()
    assert "thermo 2\nrun $n\nrun 4\n" in log and "   Step          Temp" in log


def test_switches_and_options(script, capsys):
    assert cli.main(["run", "in.x", "-var", "n", "7", "-log", "a.log", "-nocite", "--threads", "1", "--quiet", "--steps-cap", "6"]) == 0
    assert capsys.readouterr().out == "" and "for 6 steps" in (script / "a.log").read_text()
    assert cli.main(["run", "-in", "in.x", "--log", "none", "-screen", "none"]) == 0
    assert not (script / "log.lammps").exists() and capsys.readouterr().out == ""


@pytest.mark.parametrize("arguments, message", [
    (["run", "nofile"], "cannot open input script nofile"), (["run"], "needs a script"),
    (["run", "in.x", "--precision", "half"], "--precision"),
    (["run", "in.x", "--thread", "2"], "--thread"), (["run", "in.x", "-foo"], "-f"), (["frobnicate"], "frobnicate"), ([], "command"),
    (["run", "bad"], "bad:2: run x"),
])
def test_failures_end_with_one_message(script, capsys, arguments, message):
    (script / "bad").write_text(BASE.splitlines()[0] + "\nrun x\n")
    assert cli.main(arguments) == 1
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert last.startswith("ERROR: ") and message in last


def test_every_unknown_name_is_reported(script, capsys):
    (script / "in.y").write_text("foo\nunits lj\nbar\n")
    assert cli.main(["run", "in.y"]) == 1
    errors = capsys.readouterr().err.strip().splitlines()
    assert len(errors) == 2 and "in.y:1" in errors[0] and "in.y:3" in errors[1]


def test_quit_status(script):
    (script / "in.q").write_text("quit 7\n")
    assert cli.main(["run", "in.q"]) == 7


def test_version(capsys):
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out == f"asemd {asemd.__version__}\n"


def test_interrupt_ends_in_order(script):
    (script / "in.long").write_text(BASE + "thermo 1000\ndump d all atom 100000 d.txt\nrun 100000000\n")
    env = {**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(asemd.__file__))}
    process = subprocess.Popen([sys.executable, "-m", "asemd.cli", "run", "in.long"], env=env, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    log = script / "log.lammps"
    end = time.time() + 120
    while time.time() < end and not (log.exists() and "      2000 " in log.read_text()):
        time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130 and err.strip().splitlines()[-1] == "ERROR: interrupted"
    text = log.read_text()
    assert "MPI task timing breakdown" in text and "interrupted at step" in text
    rows = [line for line in text.splitlines() if line[:10].strip().isdigit()]
    last = int(rows[-1].split()[0])
    assert f"for {last} steps" in text and f"TIMESTEP\n{last}\n" in (script / "d.txt").read_text()


def test_read_stops_before_the_first_run(script):
    (script / "in.r").write_text(BASE + "dump d all atom 1 d.txt\nshell touch touched\nprint x file p.txt\nrun 10\nno_such_command\n")
    atoms = asemd.read("in.r")
    assert len(atoms) == 32 and atoms.get_potential_energy() == pytest.approx(32 * -5.5046614, rel=1e-6)
    assert not {"d.txt", "touched", "p.txt", "log.lammps"} & set(os.listdir(script))


def test_import_is_light():
    code = "import sys, asemd; print([m for m in ('numba', 'ase', 'scipy', 'rich', 'typer', 'numpy') if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                         env={**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(asemd.__file__))})
    assert out.stdout.strip() == "[]"
