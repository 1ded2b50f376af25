"""``asemd run --dry`` and ``--safe``, standard input, LAMMPS's rarer switches."""
from __future__ import annotations

import io
import subprocess
import sys
import time

import pytest

from asemd import cli
from asemd.lammps.switches import parse

WRONG = """units lj
lattice fcc 0.8442
region b block 0 2 0 2 0 2
create_box 1 b
create_atoms 1 box
mas 1 1.0
velocity all creat 1.0 87287
pair_style lj/cut 2.5
pair_coeff 1 2 1.0 1.0
fix 1 gg nve
fix_modify 1 energy yes
variable a loop 1000000
label top
compute c$a all ke
next a
jump SELF top
variable x equal v_y
thermo_style custom step v_x
run 100
variable p equal $(pe)
print "$p"
dump d all custom 10 x.dump id c_z
undump d
"""
RIGHT = """units lj
lattice fcc 0.8442
region b block 0 2 0 2 0 2
create_box 1 b
create_atoms 1 box
mass 1 1.0
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
fix 1 all nve
dump d all custom 10 x.dump id x
run 100000000
print "$(pe)" file out.txt
if "$(pe) > 3" then "quit 3"
write_data out.data
shell touch made
label forever
jump SELF forever
"""


SALT = """units lj
atom_style charge
lattice sc 0.6
region b block 0 6 0 6 0 6
create_box 2 b
create_atoms 1 box
mass * 1.0
set type 1 type/fraction 2 0.5 12
set type 1 charge 1.0
set type 2 charge -1.0
pair_style lj/cut/coul/long 2.5
pair_coeff * * 1.0 1.0
kspace_style pppm 1e-4
fix 1 all nve
run 10
run 20
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_dry_reports_every_problem_once_with_its_line(folder, capsys):
    (folder / "in.x").write_text(WRONG)
    assert cli.main(["run", "--dry", "in.x"]) == 1
    told = capsys.readouterr().err.splitlines()
    lines = [int(line.split("(in.x:")[1].split(":")[0]) for line in told]
    assert lines == [6, 7, 9, 10, 19, 22]
    assert "did you mean mass?" in told[0] and "did you mean create?" in told[1] and "unknown group" in told[3]
    assert "v_x" in told[4]      # that the mass is missing follows from line 6


def test_dry_expects_other_numbers_after_a_run(folder, capsys):
    averages = RIGHT.split("dump")[0] + "fix 2 all ave/time 1 5 5 c_thermo_temp\nvariable x equal 1/f_2\nthermo_style custom step v_x\n"
    (folder / "in.x").write_text(averages + "run 10\nprint $(v_x)\nprint $(ln(f_2))\nvariable y equal ${x}\n")
    assert cli.main(["run", "--dry", "in.x"]) == 0
    (folder / "in.x").write_text(averages + "print $(v_x)\nrun 10\n")
    assert cli.main(["run", "--dry", "in.x"]) == 1
    assert "division by 0" in capsys.readouterr().err


def test_dry_runs_and_writes_nothing(folder, capsys):
    (folder / "in.x").write_text(RIGHT)
    assert cli.main(["run", "--dry", "in.x"]) == 0
    assert "no problems" in capsys.readouterr().out
    assert [p.name for p in folder.iterdir()] == ["in.x"]


def test_dry_is_fast(folder):
    middle = "".join(f"variable v{i} equal {i}+1\npair_coeff 1 1 1.0 1.{i}\n" for i in range(500))
    (folder / "in.x").write_text(RIGHT.replace("fix 1", middle + "fix 1"))
    started = time.perf_counter()
    assert cli.main(["run", "--dry", "in.x"]) == 0
    assert time.perf_counter() - started < 2.0       # a quiet machine needs a fifth of it


def test_standard_input(folder, monkeypatch, capsys):
    monkeypatch.setattr(sys, "stdin", io.StringIO("variable a loop 2\nlabel l\nprint 'turn $a'\nnext a\njump SELF l\n"))
    assert cli.main(["run", "-", "-log", "none"]) == 0
    assert [w for w in capsys.readouterr().out.splitlines() if w.startswith("turn")] == ["turn 1", "turn 2"]


@pytest.mark.parametrize("line, message", [
    ("shell ls", "shell is refused"), ("python source here 'x=1'", "python is refused"), ("print a file ../out", "refuses to write"),
    ("log ../log", "refuses to write"), ("print a append /dev/shm/asemd-unsafe", "refuses to write"), ("labelmap write ../l", ""),
    ("print a file inside", None), ("log other", None), ("print a file link/out", "refuses to write"),
])
def test_safe(folder, line, message):
    inner = folder / "inner"
    inner.mkdir()
    (inner / "link").symlink_to(folder)
    (inner / "in.x").write_text(line + "\n")
    done = subprocess.run([sys.executable, "-c", "from asemd.cli import entry; entry()", "run", "--safe", "in.x"], cwd=inner,
                          capture_output=True, text=True, timeout=60)
    assert done.returncode == (0 if message is None else 1), done.stderr
    assert (message or "") in done.stderr
    assert [p.name for p in folder.iterdir()] == ["inner"]


@pytest.mark.parametrize("words, message", [
    (["-partition", "2x1"], "one partition"), (["-kokkos", "on"], "no Kokkos"), (["-restart2data", "a"], "at least one value"),
    (["-restart2data", "a", "remap"], "words of write_data"), (["-nonbuf", "x"], "takes no value"),
])
def test_wrong_switches(words, message, folder, capsys):
    assert cli.main(["run", "in.x", *words]) == 1
    assert message in capsys.readouterr().err


def test_switches():
    s = parse("-p 1x1 -k off -nb -sr -r2data a remap b nocoeff -cite none -sf opt".split())
    assert s.nonbuf and s.cap == 0 and s.convert == ["read_restart a remap", "write_data b nocoeff"] and s.suffix == "opt"
    assert parse("-restart2dump a all atom d".split()).convert == ["read_restart a", "write_dump all atom d"]


CONSEQUENCES = """units lj
lattice fcc 0.8442
region b block 0 2 0 2 0 2
create_box 1 b
create_atoms 1 box
mass 1 1.0
par_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
pair_modify shift yes
varible v equal 2
print "${v}"
fix 1 all nve
restart 10 state
write_data out.data
group2ndx out.ndx
ndx2group out.ndx
run 10
clear
read_data out.data
pair_style lj/cut 2.5
run 10
clear
read_restart state.20
run 10
clear
read_data other.data
run 10
"""


def test_dry_leaves_out_what_follows_from_other_problems(folder, capsys):
    (folder / "in.x").write_text(CONSEQUENCES)
    assert cli.main(["run", "--dry", "in.x"]) == 1
    told = capsys.readouterr().err.splitlines()
    assert [line.split("(in.x:")[1].split(":")[0] for line in told] == ["7", "10", "26"], told


def test_dry_looks_at_dumps(folder, capsys):
    """Columns that the atoms cannot fill are found before the run."""
    (folder / "in.dump").write_text("region b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\n"
                                    "pair_style zero 1\npair_coeff * *\ndump e all extxyz 5 d.extxyz\nrun 10\nundump e\n"
                                    "dump q all custom 5 d.dump id q\nrun 10\n")
    assert cli.main(["run", "--dry", "in.dump"]) == 1
    problems = capsys.readouterr().err.splitlines()
    assert len(problems) == 2 and "dump_modify e element" in problems[0]
    assert "no charges for the column q (in.dump:11: run 10)" in problems[1]


@pytest.mark.parametrize("old, new, problem", [
    ("kspace_style pppm 1e-4\n", "", "pair style lj/cut/coul/long needs a kspace_style, such as pppm 1.0e-4 (in.x:14: run 10)"),
    ("1e-4", "1e-14", "is too large; use a lower accuracy, a larger Coulomb cutoff, or kspace_modify (in.x:15: run 10)"),
    ("lj/cut/coul/long 2.5", "lj/cut 2.5", "kspace_style pppm needs a pair style that leaves it the long-range part, such as"),
    ("pppm 1e-4", "pppm 10", "the relative accuracy must be at most 1, got 10 (in.x:13: kspace_style pppm 10)"),
    ("pair_style lj/cut/coul/long", "pair_style lj/cut/coul/lang", "unknown pair style 'lj/cut/coul/lang'"),
    ("1e-4", "1e-5", "")])
def test_dry_looks_at_the_long_range_solver(folder, capsys, old, new, problem):
    """What a run would find when it sets up the solver; one problem, where it is met first."""
    (folder / "in.x").write_text(SALT.replace(old, new))
    assert cli.main(["run", "--dry", "in.x"]) == bool(problem)
    shown = " ".join(" ".join(capsys.readouterr()).split())
    assert problem in shown and ("no problems found" if not problem else ": 1 problem") in shown
