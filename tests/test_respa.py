"""run_style respa against LAMMPS, and the words of the command."""
from __future__ import annotations

import numpy as np
import pytest
import scripted
from both import asemd

from asemd.errors import InputError

NVE = "fix 1 all nve"
CASES = {
    "two levels": {"commands": ["run_style respa 2 4", NVE], "runs": ["run 20", "run 7"], "values": ["pe", "ke", "press", "ebond"]},
    "three levels": {"commands": ["run_style respa 3 2 3 bond 1 pair 2", NVE], "runs": ["run 30"], "values": ["pe", "etotal", "pxx"]},
    "bond and pair together": {"commands": ["run_style respa 2 2 bond 2", NVE], "runs": ["run 10"], "values": ["pe", "etotal", "pxx"]},
    "one level": {"commands": ["run_style respa 1", NVE], "runs": ["run 10"], "values": ["pe", "etotal", "pxx"]},
    "group": {"commands": ["run_style respa 2 2", "fix 1 some nve"], "runs": ["run 20"], "values": ["pe", "temp"]},
    "forces from outside": {"commands": ["run_style respa 2 2", NVE, "fix 2 some addforce 0.3 0 -0.2"], "runs": ["run 20"],
                            "values": ["pe", "f_2", "f_2[1]"]},
    "back to verlet": {"commands": ["run_style respa 2 2", "run_style verlet", NVE], "runs": ["run 10"], "values": ["pe", "press"]},
    "lists": {"commands": ["run_style respa 2 2 ", NVE, "velocity all create 900 77"], "runs": ["run 200"], "values": ["pe", "etotal"]},
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    folder = tmp_path_factory.mktemp("respa")
    scripted.write_data(folder / "data")
    for case in CASES.values():
        case["data"] = str(folder / "data")
    if not scripted.have_lammps():
        pytest.skip("LAMMPS is not installed")
    return scripted.by_lammps(CASES, folder)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_path_as_lammps(answers, name):
    from asemd.lammps import Lammps
    tolerance = 1e-7 if name == "lists" else 1e-10
    for ours, theirs in zip(scripted.measure(Lammps, CASES[name]), answers[name]):
        np.testing.assert_allclose(ours["x"], theirs["x"], rtol=0, atol=tolerance)
        np.testing.assert_allclose(ours["v"], theirs["v"], rtol=0, atol=tolerance)
        np.testing.assert_allclose(ours["values"], theirs["values"], rtol=1e-9 if tolerance < 1e-8 else 1e-6, atol=1e-10)


BOX = "atom_style bond\nregion b block 0 5 0 5 0 5\ncreate_box 1 b bond/types 1\nmass 1 1"


def test_text():
    told = "".join(asemd(BOX + "\nrun_style respa 3 2 4 bond 1 angle 2 pair 3").told)
    assert told.endswith("Respa levels:\n  1 = bond\n  2 = angle dihedral improper\n  3 = pair kspace\n")


@pytest.mark.parametrize("line, message", [
    ("run_style", "1 value"), ("run_style verlett", "did you mean verlet"), ("run_style verlet 2", "0 values"),
    ("run_style respa", "1 value"),
    ("run_style respa 2", "loop factors needs 1 value"), ("run_style respa 2 0", "positive"), ("run_style respa 0", "positive"),
    ("run_style respa 2 2 bond 3", "valid range 1 to 2"), ("run_style respa 2 2 foo 1", "unknown keyword"),
    ("run_style respa 2 2 bond", "1 value"), ("run_style respa 2 2 bond 2 angle 1", "must not be on a level below bond"),
    ("run_style respa 2 2 inner 1 4 5 outer 2", "not supported"),
])
def test_mistakes(line, message):
    session = asemd(BOX)
    with pytest.raises(InputError, match=message):
        session.execute(line)
    assert session.scene.respa is None


def test_fixes_without_levels():
    session = asemd(BOX + "\ncreate_atoms 1 single 1 1 1\nrun_style respa 2 2\nfix 1 all nvt temp 1 1 1")
    with pytest.raises(InputError, match="fix 1"):
        session.execute("run 1")
