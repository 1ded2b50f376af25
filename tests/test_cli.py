"""The command line."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from lj_cell import BASE

import asemd
from asemd import cli
from asemd.errors import InputError
from asemd.lammps import command_line


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
    (["rnu", "in.x"], "did you mean run"), (["in.typo"], "neither a command nor a file"), (["in.typo", "-var", "n", "2"], "in.typo"),
    (["run", "-var", "n", "1", "in.typo"], "before -var"), (["-var", "n", "1"], "needs a script"),
    (["-vra", "n", "1", "in.x"], "did you mean var"),
    (["in.x", "-var", "n"], "needs a name"), (["run", "in.x", "bad"], "bad"),
    (["run", "bad"], "bad:2: run x"),
])
def test_failures_end_with_one_message(script, capsys, arguments, message):
    (script / "bad").write_text(BASE.splitlines()[0] + "\nrun x\n")
    assert cli.main(arguments) == 1
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert last.startswith("ERROR: ") and message in last


@pytest.mark.parametrize("line", [
    "-var n 6 run in.x", "run -var n 6 in.x", "run in.x -var n 6", "-in in.x -var n 6", "-var n 6 -in in.x",
    "in.x -v n 6", "-v n 6 in.x", "--in in.x --var n 6", "run -var n 6 -echo screen in.x", "run -nocite in.x -var n 6",
    "-sf opt -v n 6 -i in.x", "-sf hybrid gpu omp in.x -v n 6", "run -pk omp 2 -v n 6 in.x",
    "run -var n 6 --threads 1 in.x", "run in.x --html page.html -var n 6", "run --html page.html -var n 6 in.x",
    "run --import styles.py -var n 6 in.x", "-v n 6 run --log none in.x", "-threads 1 in.x -v n 6",
    "run -var n 6 --html=page.html in.x", "run in.x -var n 6 -precision mixed"])
def test_switches_in_any_order(script, capsys, line):
    """As people type them: LAMMPS's own order without a command, the script before, between and behind the switches."""
    for name in ("styles.py", "page.html"):
        (script / name).write_text("")
    assert cli.main(line.split()) == 0
    assert "for 6 steps" in capsys.readouterr().out


def test_values_stay_with_their_switch(script):
    """A file or a command's name may be a value where the script stands elsewhere."""
    (script / "data").write_text("")
    words, switches = command_line.split("-in in.x -var list in.x run data".split(), cli.COMMANDS)
    assert words == ["run"] and switches.input == "in.x" and switches.variables == [("list", ["in.x", "run", "data"])]
    words, switches = command_line.split("run in.x -var list in.x data -var x -0.5 -v e -1".split(), cli.COMMANDS)
    assert words == ["run", "in.x"]
    assert switches.variables == [("list", ["in.x", "data"]), ("x", ["-0.5"]), ("e", ["-1"])]
    assert command_line.split("-var x in.x".split(), cli.COMMANDS)[1].variables == [("x", ["in.x"])]
    assert command_line.split(["-h"], cli.COMMANDS)[0] == ["--help"]


@pytest.mark.parametrize("line, said", [
    ("run in.x -var n 6 -threads 2", "1 MPI tasks x 2 OpenMP threads"), ("-in in.x -threads 2", "x 2 OpenMP threads"),
    ("in.x -skiprun", "for 0 steps"), ("run in.x -cap 3", "for 3 steps"), ("in.x -cap 3 --steps-cap 4", "for 4 steps")])
def test_switches_of_its_own_count_with_one_dash(script, capsys, line, said):
    assert cli.main(line.split()) == 0
    assert said in capsys.readouterr().out


def test_wrong_values_of_its_own_switches(script, capsys):
    for line, word in (("in.x -threads none", "--threads"), ("in.x -precision half", "half"), ("in.x -cap many", "-cap needs")):
        assert cli.main(line.split()) == 1
        assert word in capsys.readouterr().err.strip().splitlines()[-1]


def test_every_unknown_name_is_reported(script, capsys):
    (script / "in.y").write_text("foo\nunits lj\nbar\n")
    assert cli.main(["run", "in.y"]) == 1
    errors = capsys.readouterr().err.strip().splitlines()
    assert len(errors) == 2 and "in.y:1" in errors[0] and "in.y:3" in errors[1]


def test_the_installed_command_is_that_of_the_module():
    """Which prints warnings without lines of code."""
    assert '\n[project.scripts]\nasemd = "asemd.cli:entry"\n' in (Path(__file__).parents[1] / "pyproject.toml").read_text()


def test_letters_that_the_terminal_does_not_have(script):
    (script / "in.u").write_text('print "gr\u00f6\u00dfer"\nprint last\n')
    done = subprocess.run([sys.executable, "-m", "asemd", "run", "in.u", "-log", "none"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONPATH": str(Path(asemd.__file__).parents[1])})
    assert done.returncode == 0 and "gr??er" in done.stdout and "last" in done.stdout, done.stderr


@pytest.mark.parametrize("command", [["run"], ["run", "--dry"], ["check"], ["convert"]])
def test_a_data_file_is_no_script(script, capsys, command):
    (script / "x.data").write_text("x\n\n1 atoms\n1 atom types\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\nAtoms\n\n1 1 0 0 0\n")
    assert cli.main([*command, "x.data"]) == 1
    said = "".join(capsys.readouterr())
    assert "x.data is a data file, not a script: a script reads it by read_data" in said and "unknown" not in said


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


def test_read_takes_variables(script):
    (script / "in.v").write_text(BASE.replace("mass 1 ", "variable m index 2.0\nvariable which index a b\nmass 1 ${m} # "))
    path = script / "in.v"
    assert asemd.read(path).get_masses()[0] == 2.0
    assert asemd.read(path, variables={"m": 3.5, "which": ["c", "d"]}).get_masses()[0] == 3.5
    (script / "x.data").write_text("x\n\n0 atoms\n1 atom types\n0 1 xlo xhi\n")
    with pytest.raises(InputError, match="variables are for scripts"):
        asemd.read(script / "x.data", variables={"m": 1})


def test_import_is_light():
    code = "import sys, asemd; print([m for m in ('numba', 'ase', 'scipy', 'rich', 'typer', 'numpy') if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                         env={**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(asemd.__file__))})
    assert out.stdout.strip() == "[]"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_full_disk(script, capsys):
    """The log file and dumps, large ones and those that are flushed at the end only: one line that names the file."""
    assert cli.main(["run", "in.x", "-log", "/dev/full"]) == 1
    assert capsys.readouterr().err.splitlines()[-1].startswith("ERROR: cannot write log file /dev/full: No space left")
    for line in ("dump 1 all xyz 1 /dev/full", "dump 1 all custom 1 /dev/full id x"):
        (script / "in.full").write_text(BASE + line + "\nrun 20\n")
        assert cli.main(["run", "in.full"]) == 1, line
        assert "cannot write /dev/full: No space left" in capsys.readouterr().err
