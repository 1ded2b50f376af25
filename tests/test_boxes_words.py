"""Fixes that drive the box, momentum or heat: their words, and what is wrong with them."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from wheel import ask, ran

import asemd.compute
import asemd.fix
from asemd.box import Box
from asemd.errors import InputError
from asemd.scene import Scene
from asemd.variable import Variables


def session_of(triclinic: bool, boundary=("pp", "pp", "pp"), dimension: int = 3):
    variables = Variables()
    for name in "de":
        variables.define(name, "equal", ["1.0"])
    box = Box.from_lammps((0, 0, 0), (10, 10, 10), (0, 0, 0), boundary, triclinic)
    region = SimpleNamespace(inside=lambda x: np.ones(len(x), bool))
    return SimpleNamespace(variables=variables, scene=Scene(regions={"half": region}, system=SimpleNamespace(box=box, dimension=dimension)))


@pytest.mark.parametrize("line", [
    "deform 1 x erate 0.1 remap x flip yes units box", "deform 5 x final 0.0 2.0 y delta -1.0 1.0 z scale 2.0 remap v flip no units box",
    "deform 1 x vel 0.5 y volume z volume remap none flip yes units box",
    "deform 1 x trate 0.1 xy wiggle 1.0 5.0 remap x flip yes units box",
    "deform 1 yz variable v_d v_e remap x flip yes units box", "deform 1 remap v flip yes units box",
    "nvt/sllod temp 1.0 2.0 0.5 tchain 1 tloop 1 psllod no", "nvt/sllod temp 1.0 2.0 0.5 tchain 3 tloop 4 drag 0.1 psllod yes",
    "heat 1 0.5", "heat 2 v_d region half", "ehex 1 0.5 region half constrain com hex", "ehex 10 -0.5", "accelerate/cos 0.1",
    "box/relax x 1.0 y 1.0 couple xy dilate partial vmax 0.001 nreset 5 scaleyz no scalexz yes scalexy no fixedpoint 0.0 1.0 0.0",
    "viscosity 10 x z 20 swap 2 vtarget 1.5", "viscosity 10 y x 4 swap 1 vtarget INF", "thermal/conductivity 10 z 20 swap 3",
])
def test_round_trip(line):
    name, *words = line.split()
    cls = asemd.fix.find(name)
    assert cls.from_lammps("all", words, session_of(True)).to_lammps() == words
    assert getattr(asemd.fix, cls.__name__) is cls


@pytest.mark.parametrize(("line", "message"), [
    ("deform", "needs N"), ("deform 0 x erate 1", "at least 1"), ("deform 1 x", "needs 1 value"), ("deform 1 x erate", "needs 1 value"),
    ("deform 1 x erat 1", "did you mean erate"), ("deform 1 xy volume", "expected one of"), ("deform 1 xy scale 2", "expected one of"),
    ("deform 1 x volume y volume", "another length"), ("deform 1 x erate 1 remap w", "remap"),
    ("deform 1 x erate 1 flip maybe", "yes or no"),
    ("deform 1 x erate 1 unit box", "did you mean units"), ("deform 1 x erate 1 remap v y erate 1", "y must stand before remap"),
    ("deform 1 x wiggle 1 0", "period"), ("deform 1 x variable d e", "v_name"),
    ("deform 1 x erate fast", "number"), ("deform 1 x erate 1 units", "1 value"),
    ("nvt/sllod", "needs temp"), ("nvt/sllod temp 1 1 1 psllod", "1 value"), ("nvt/sllod temp 1 1 1 psllod maybe", "yes or no"),
    ("nvt/sllod temp 1 1 1 tloop 0", "at least 1"), ("nvt/sllod temp 1 1 1 peculiar yes", "unknown keyword"),
    ("heat 1", "2 values"), ("heat 0 1.0", "at least 1"), ("heat 1 1.0 region hal", "did you mean half"),
    ("heat 1 1.0 regoin half", "region ID"),
    ("heat 1 1.0 region half 3", "region ID"), ("ehex 1", "2 values"), ("ehex 0 1", "at least 1"),
    ("ehex 1 v_d", "number"), ("ehex 1 1 constrain region", "1 value"), ("ehex 1 1 com", "needs constrain"),
    ("ehex 1 1 hexe", "did you mean hex"),
    ("ehex 1 1 region", "1 value"), ("accelerate/cos", "1 value"), ("accelerate/cos 1 2", "1 value"), ("accelerate/cos x", "number"),
    ("box/relax", "target pressure"), ("box/relax couple xyz", "target pressure for each|needs a target"), ("box/relax iso", "1 value"),
    ("box/relax iso 1 vmax 0", "vmax"), ("box/relax iso 1 nreset -1", "nreset"), ("box/relax x 1 y 2 couple xy", "same target"),
    ("box/relax x 1 couple xy", "each of these"), ("box/relax iso 1 dilate some", "dilate"), ("box/relax iso 1 foo 2", "unknown keyword"),
    ("box/relax xy 1 scalexy yes", "relaxed and scaled"), ("box/relax iso 1 fixedpoint 0 0", "3 values"),
    ("viscosity 10 x z", "4 values"), ("viscosity 0 x z 4", "at least 1"), ("viscosity 10 w z 4", "vdim"), ("viscosity 10 x w 4", "pdim"),
    ("viscosity 10 x z 5", "even"), ("viscosity 10 x z 2", "at least 4"), ("viscosity 10 x z 4 swap 0", "swap"),
    ("viscosity 10 x z 4 vtarget 0", "positive"), ("viscosity 10 x z 4 vtarget", "1 value"),
    ("viscosity 10 x z 4 swpa 1", "did you mean swap"),
    ("thermal/conductivity 10 z", "3 values"), ("thermal/conductivity 0 z 4", "at least 1"), ("thermal/conductivity 10 q 4", "edim"),
    ("thermal/conductivity 10 z 3", "even"), ("thermal/conductivity 10 z 4 swap 0", "swap"),
    ("thermal/conductivity 10 z 4 vtarget 1", "swap Nswap"),
])
def test_errors(line, message):
    name, *words = line.split()
    with pytest.raises(InputError, match=message) as e:
        asemd.fix.find(name).from_lammps("all", words, session_of(True))
    assert "\n" not in str(e.value)


@pytest.mark.parametrize(("line", "session", "message"), [
    ("1 xy erate 1", session_of(False), "triclinic"), ("1 y erate 1", session_of(False, ("pp", "ss", "pp")), "shrink-wrapped"),
    ("1 xy erate 1", session_of(True, ("pp", "ss", "pp")), "direction y")])
def test_boxes_that_cannot_be_deformed(line, session, message):
    with pytest.raises(InputError, match=message):
        asemd.fix.Deform.from_lammps("all", line.split(), session)


@pytest.mark.parametrize(("words", "session", "message"), [
    ("xy 1", session_of(False), "triclinic"), ("x 1", session_of(False, ("ff", "pp", "pp")), "direction x is not periodic"),
    ("z 1", session_of(False, dimension=2), "two dimensions"), ("xz 1", session_of(True, ("pp", "pp", "ff")), "direction z")])
def test_boxes_that_cannot_be_relaxed(words, session, message):
    with pytest.raises(InputError, match=message):
        asemd.fix.BoxRelax.from_lammps("all", words.split(), session)


def test_acceleration_in_two_dimensions():
    with pytest.raises(InputError, match="three dimensions"):
        asemd.fix.AccelerateCos.from_lammps("all", ["0.1"], session_of(False, dimension=2))


def test_extra_words_of_computes():
    for name in ("temp/deform", "viscosity/cos"):
        with pytest.raises(InputError, match="takes no arguments"):
            asemd.compute.find(name).from_lammps("all", ["1"], session_of(False))


def test_factor_of_heat_before_the_first_step():
    script = "region b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 random 5 77 NULL\nmass 1 1\npair_style zero 1.0\n" \
             "pair_coeff * *\nfix 1 all nve\nfix 2 all heat 1 0.1\nrun 0"
    theirs = ask("answer = ran(given['text']).extract_fix('2', 0, 0)", text=script)
    assert ran(script).extract_fix("2", 0, 0) == theirs == 1.0
