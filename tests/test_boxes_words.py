"""Fixes that drive the box, momentum or heat: their words, and what is wrong with them."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

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
    "nvt/sllod temp 1.0 2.0 0.5 tchain 1 tloop 1 psllod no", "nvt/sllod temp 1.0 2.0 0.5 tchain 3 tloop 1 drag 0.1 psllod yes",
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
    ("deform 1 x erate 1 unit box", "did you mean units"), ("deform 1 x erate 1 remap v y erate 1", "unknown keyword 'y'"),
    ("deform 1 x wiggle 1 0", "period"), ("deform 1 x variable d e", "v_name"), ("deform 1 x variable v_q v_e", "undefined variable q"),
    ("deform 1 x erate fast", "number"), ("deform 1 x erate 1 units", "1 value"),
    ("nvt/sllod", "needs temp"), ("nvt/sllod temp 1 1 1 psllod", "1 value"), ("nvt/sllod temp 1 1 1 psllod maybe", "yes or no"),
    ("nvt/sllod temp 1 1 1 tloop 2", "tloop must be 1"), ("nvt/sllod temp 1 1 1 peculiar yes", "unknown keyword"),
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
