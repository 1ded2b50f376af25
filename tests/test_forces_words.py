"""Fixes that change forces and positions read and write their words, and say what is wrong with them."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ran

import asemd.fix
from asemd.errors import InputError, SimulationError
from asemd.lammps import Lammps

SETUP = """
units real
atom_style charge
boundary p f f
region all block 0 10 0 10 0 10
create_box 1 all
create_atoms 1 single 3 4 5
create_atoms 1 single 4 6 5
mass 1 12
group one id 1
region ball sphere 5 5 5 3
variable e equal 1.0
variable a atom x
"""


@pytest.fixture(scope="module")
def lmp():
    lmp = ran(SETUP)
    yield lmp
    lmp.close()


@pytest.mark.parametrize("line", [
    "aveforce 0.0 NULL v_e region ball", "addtorque v_e 0.0 1.0", "lineforce 1.0 0.0 2.0", "planeforce 1.0 0.0 2.0", "nve/noforce",
    "viscous 0.5 scale 1 2.0", "drag 1.0 NULL 2.0 0.5 0.1", "gravity v_e chute 20.0", "gravity 1.0 vector 0.0 0.0 1.0 disable",
    "spring tether 1.0 NULL 0.0 0.0 2.0", "spring couple one 1.0 NULL 0.0 0.0 2.0", "spring/self v_a xy", "spring/rg 1.0 NULL",
    "smd cvel 1.0 0.1 couple one auto NULL 1.0 2.0", "smd cfor 1.0 tether 0.0 NULL 1.0 2.0", "efield v_a v_e 0.0 region ball energy v_a",
    "efield/tip4p v_a v_e 0.0 region ball energy v_a",
    "restrain bond 1 2 1.0 2.0 3.0 4.0 angle 1 2 1 1.0 1.0 90.0 dihedral 1 2 1 2 1.0 1.0 90.0 mult 2",
    "wall/lj93 ylo v_e 1.0 1.0 2.5 units box", "wall/morse zhi EDGE 1.0 1.0 1.0 2.5", "wall/lepton zhi EDGE k*r^2;k=2 2.5",
    "wall/reflect ylo EDGE yhi v_e", "oneway 3 ball -x", "recenter INIT NULL 5.0 units box", "move rotate 0 0 0 0 0 1 10.0",
    "indent 1.0 cylinder x 1.0 v_e 2.0 side in", "numdiff 5 0.001", "dt/reset 2 NULL 1.0 0.1 emax 3.0 units box",
])
def test_round_trip(line, lmp):
    style, *words = line.split()
    lmp.command(f"fix f one {line}" if "one" not in line else f"fix f all {line}")
    fix = lmp.session.scene.fixes["f"]
    lmp.command("unfix f")
    assert fix.to_lammps() == words
    assert getattr(asemd.fix, type(fix).__name__) is type(fix)


def test_springs_of_chunks():
    lmp = ran([SETUP, "compute c all chunk/atom type", "compute d all chunk/atom type", "compute m all com/chunk c"])
    for words, message in (("1 c", "3 values"), ("x c m", "number"), ("1 m m", "not chunk/atom"), ("1 c d", "not com/chunk"),
                           ("1 d m", "not same"), ("1 c k", "no compute k")):
        with pytest.raises(InputError, match=message):
            lmp.command(f"fix f one spring/chunk {words}")
    lmp.command("fix f one spring/chunk 3.0 c m")
    assert lmp.session.scene.fixes["f"].to_lammps() == ["3.0", "c", "m"]
    for line in ("run 0 post no", "displace_atoms all move 0.3 0.1 0", "run 0 post no"):
        lmp.command(line)
    fix, system = lmp.session.scene.fixes["f"], lmp.session.scene.system
    assert fix.scalar() == pytest.approx(0.15)
    assert system.f == pytest.approx(np.tile([-0.45, -0.15, 0.0], (2, 1)))      # minus the gradient, half of it for each of two atoms
    lmp.close()


@pytest.mark.parametrize(("text", "words", "message"), [
    ("1 0 0 0\n2 0 0 0\n", "-1 FILE 0", "negative"), ("1 0 0 0\n2 0 0 0\n", "1 FILE 5", "file2"), ("1 0 0 0\n", "1 FILE 0", "atom 2"),
    ("1 0 0 0\n2 0 0\n", "1 FILE 0", "line 2"), ("1 0 0 0 0 0 0\n", "1 FILE 0", "bounds"), ("1 0 0 0\n1 0 0 0\n", "1 FILE 0", "already"),
    ("0 1 xlo xhi\n1 0 0 0\n", "1 FILE 0", "no image flags"), ("", "1 nowhere 0", "nowhere"), ("1 0 0 0\n", "1 FILE", "3 values"),
])
def test_bad_targets(text, words, message, lmp, tmp_path):
    (tmp_path / "target").write_text(text)
    with pytest.raises(InputError, match=message):
        lmp.command("fix f all tmd " + words.replace("FILE", str(tmp_path / "target")))


@pytest.mark.parametrize(("line", "message"), [
    ("aveforce 1 1", "needs fx fy fz"), ("aveforce 1 1 1 regoin ball", "did you mean region"), ("addtorque 1 1", "3 values"),
    ("addtorque 1 x 1", "number"), ("lineforce 0 0 0", "length 0"), ("planeforce 1 1", "3 values"), ("viscous", "1 value"),
    ("viscous 1 scale 4 1", "no atom type 4"), ("viscous 1 scael 1 1", "unknown keyword"), ("drag 1 1 1 1", "5 values"),
    ("gravity 1", "expected one of"), ("gravity 1 chute", "1 value"), ("gravity 1 vector 0 0 1 no", "disable"),
    ("gravity 1 vectr 0 0 1", "did you mean vector"), ("spring tehter 1 0 0 0 0", "did you mean tether"),
    ("spring tether 1 0 0 0 -1", "negative"), ("spring couple two 1 0 0 0 0", "two"), ("spring couple all 1 0 0 0 0", "same"),
    ("spring/self 0", "positive"), ("spring/self 1 yx", "expected one of"), ("spring/rg 1", "2 values"),
    ("smd cvel 1 tether 0 0 0 0", "number"), ("smd cfor 1 tether auto 0 0 0", "number"), ("smd pull 1", "expected one of"),
    ("efield 1 1", "needs ex ey ez"), ("efield 1 1 1 energy v_a", "constant"), ("efield v_e 1 1 energy v_e", "style atom"),
    ("efield v_e 1 1 energy v_a potential v_a", "same time"), ("restrain", "needs one of"), ("restrain bnd 1 2 1 1 1", "did you mean bond"),
    ("restrain bond 1 2 1 1", "5 values"), ("wall/lj93", "no walls"), ("wall/lj93 xlo EDGE 1 1 2.5", "periodic"),
    ("wall/lj93 ylo EDGE 1 1 0", "above 0"), ("wall/lj93 ylo EDGE 1 1 2 ylo EDGE 1 1 2", "twice"), ("wall/lj93 ylo EDGE 1 1", "4 values"),
    ("wall/lj93 ylo EDGE 1 1 2 unit box", "did you mean units"), ("wall/lj93 ylo EDGE 1 1 2 fld yes", "not supported"),
    ("wall/lepton ylo EDGE r+*2 2.5", "wall/lepton ylo"), ("wall/table linear 10 ylo EDGE none.txt A 2", "none.txt"),
    ("wall/table cubic 10 ylo EDGE none.txt A 2", "expected one of"), ("wall/reflect ylo", "1 value"),
    ("wall/reflect xlo EDGE", "periodic"),
    ("oneway 0 ball x", "at least 1"), ("oneway 1 bal x", "did you mean ball"), ("oneway 1 ball w", "expected one of"),
    ("recenter 1 1", "3 values"), ("recenter 1 1 1 units mile", "expected one of"), ("recenter 1 1 1 shitf all", "did you mean shift"),
    ("move liner 1 1 1", "did you mean linear"), ("move wiggle 1 1 1 0", "period"), ("move rotate 0 0 0 0 0 0 1", "rotation vector"),
    ("move variable 1 1 1 1 1 1", "variable or NULL"), ("move linear 1 1 1 unit box", "unknown words"),
    ("numdiff 0 0.1", "at least 1"), ("numdiff 1", "2 values"), ("dt/reset 1 NULL NULL", "4 values"),
    ("dt/reset 0 NULL NULL 1", "at least 1"),
    ("dt/reset 1 2 1 1", "below Tmax"), ("dt/reset 1 NULL NULL 1 emx 2", "did you mean emax"),
    ("indent 1", "needs one of"), ("indent 1 sphere 1 1 1", "4 values"), ("indent 1 sphere 1 1 1 -1", "negative"),
    ("indent 1 plane x 1 up", "expected one of"), ("indent 1 shpere 1 1 1 1", "did you mean sphere"),
])
def test_errors(line, message, lmp):
    with pytest.raises(InputError, match=message) as e:
        lmp.command(f"fix f all {line}")
    assert "\n" not in str(e.value)


@pytest.mark.parametrize("style", ["aveforce 0 0 0", "spring/rg 1 NULL", "viscous 1", "drag 0 0 0 1 1"])
def test_no_energy_no_virial(style, lmp):
    lmp.command(f"fix f all {style}")
    for word in ("energy yes", "virial yes"):
        with pytest.raises(InputError, match="does not support"):
            lmp.command(f"fix_modify f {word}")
    lmp.command("unfix f")


def test_a_run_does_not_begin_behind_a_wall():
    """At r = 0 the wall gave no force, and the run came apart some steps later."""
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        for line in [*filter(None, SETUP.split("\n")), "fix w all wall/lj93 ylo 4.0 1.0 1.0 2.5 units box"]:
            lmp.command(line)
        with pytest.raises(SimulationError, match=r"wall/lj93\): atom 1 is on the wall or behind it \(ylo, 1 in all\)"):
            lmp.command("run 0")
