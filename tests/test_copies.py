"""Copies of sessions, scenes and atoms: by pickle and deepcopy, before and after runs, whatever refers to variables."""
from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from asemd.lammps.session import Session
from asemd.lammps.switches import Switches

START = """
units lj
lattice fcc 0.8
region b block 0 3 0 3 0 3
create_box 1 b
create_atoms 1 box
mass 1 1
pair_style lj/cut 1.5
pair_coeff 1 1 1 1
velocity all create 1 123
variable a equal 0.5+step*0.01
variable w atom 0.01*x
fix nve all nve
"""
CASES = {
    "region with a variable": "region m sphere 2 2 2 v_a\nfix 2 all setforce 0 0 0 region m",
    "region that moves": "region m sphere 2 2 2 1 move v_a NULL v_a\nfix 2 all addforce 0.1 0 0 region m",
    "region that turns": "region m block 1 4 1 2 1 2 rotate v_a 0 0 0 0 0 1\nfix 2 all addforce 0.1 0 0 region m",
    "union of such regions": "region m sphere 2 2 2 v_a\nregion n sphere 3 3 3 1 move v_a v_a v_a\nregion u union 2 m n\n"
                             "fix 2 all addforce 0.1 0 0 region u",
    "dynamic group": "region m sphere 2 2 2 2 move v_a NULL NULL\ngroup g dynamic all region m every 1\nfix 2 g addforce 0.1 0 0",
    "force from a variable": "fix 2 all addforce v_w 0 v_a",
    "dump": "variable no equal 0\ndump d all custom 1 dump.x id v_w\ndump_modify d thresh v_w > 0.01 skip v_no",
    "python": "variable p python f\npython f return v_p format f here \"def f():\\n    return 0.5\"\nfix 2 all addforce v_p 0 0",
}


@pytest.fixture
def session(tmp_path, monkeypatch):
    """A function that makes a session in a folder of its own; all are closed afterwards."""
    monkeypatch.chdir(tmp_path)
    made = []

    def make(more: str) -> Session:
        switches = Switches()
        switches.log, switches.screen = "log.first", "none"
        made.append(Session(switches=switches))
        made[-1].commands(START)
        for line in more.split("\n"):
            made[-1].execute(line.replace("\\n", "\n"))
        return made[-1]
    yield make
    for one in made:
        one.close()


@pytest.mark.parametrize("way", [copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))], ids=["deepcopy", "pickle"])
@pytest.mark.parametrize("name", CASES)
def test_a_copied_session_goes_on_alike(tmp_path, session, name, way):
    first = session(CASES[name])
    first.execute("run 3")
    second = way(first)
    first.close_dumps()
    before = second.scene.system.x.copy()
    first.execute("run 4")
    assert np.array_equal(second.scene.system.x, before), "the copy moves with the original"
    second.execute("run 4")
    assert np.array_equal(first.scene.system.x, second.scene.system.x) and second.scene.step == 7
    length = (tmp_path / "log.first").stat().st_size
    second.execute("variable a equal 9")
    assert (tmp_path / "log.first").stat().st_size == length and first.variables.value("a") != "9"
    second.close()


@pytest.mark.parametrize("name", CASES)
@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_atoms_of_such_scenes(session, name):
    atoms = session(CASES[name]).scene.to_atoms()
    for other in (copy.deepcopy(atoms), pickle.loads(pickle.dumps(atoms))):
        assert other.get_potential_energy() == atoms.get_potential_energy()
