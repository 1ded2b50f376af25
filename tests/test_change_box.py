"""change_box against LAMMPS."""
from __future__ import annotations

import pytest
from both import asemd, assert_same, lammps
from wheel import ask, ran

from asemd.errors import InputError

FCC = """
units lj
boundary {}
lattice fcc 0.8442
region b block 0 2 0 2.5 0 3
create_box 1 b
create_atoms 1 box
mass 1 1
"""
BOX = FCC.format("p p p")
OFF = BOX + "displace_atoms all move 0.01 0.02 0.03\n"      # no atom on a face, where the last bit says on which side it is
FLAT = "units lj\ndimension 2\nlattice hex 0.7\nregion b block 0 6 0 4 -0.5 0.5\ncreate_box 1 b\ncreate_atoms 1 box\nmass 1 1\n"
CASES = {
    "final": BOX + "change_box all x final 0 4 y delta -0.2 0.1 z scale 1.1 remap",
    "box units": BOX + "change_box all x final 0.2 5 y delta -0.2 0.1 remap units box",
    "no remap": BOX + "change_box all x final 0.5 1.5",
    "volume": BOX + "change_box all x scale 1.1 y volume z volume remap",
    "volume of one": BOX + "change_box all x scale 1.1 z volume y scale 1.1 z volume remap",
    "tilt": OFF + "change_box all triclinic\nchange_box all xy final 0.3 xz delta 0.2 yz final -0.1 remap units box",
    "skew large": OFF + "change_box all triclinic xy final 1.5 remap\nchange_box all x scale 1.2 remap",
    "there and back": OFF + "change_box all triclinic xy final 0.3 remap\nchange_box all xy final 0 remap ortho",
    "on faces": BOX + "change_box all triclinic xy final 0.3 remap",
    "on faces, all tilts": BOX + "change_box all triclinic xy delta 0.3 xz delta 0.2 yz final -0.2 remap units box",
    "on faces, run": BOX + "change_box all triclinic xy final 0.3 remap\npair_style lj/cut 2.5\npair_coeff * * 1 1\nrun 0",
    "remap after remap": BOX + "change_box all x final 0 4 remap y delta 0 1 remap z scale 1.1 remap",
    "tilts one by one": BOX + "change_box all triclinic xy final 0.7 remap xz final 0.3 remap yz final 0.1 remap",
    "set": BOX + "change_box all x scale 1.2 set y scale 1.5 remap",
    "group": BOX + "group g id 1:20\nchange_box g x scale 1.2 remap",
    "boundary": BOX + "change_box all boundary p f s",
    "fixed to periodic": FCC.format("f f f") + "change_box all boundary p p p x scale 0.8",
    "minimum": BOX + "change_box all boundary p m s x scale 1.1 y scale 0.5 remap",
    "images": BOX + "displace_atoms all move 5 5 5\nset atom 3 image 2 1 NULL\nchange_box all boundary p s p x scale 1.3",
    "shrinks": FCC.format("s s p") + "change_box all z scale 2 x scale 1.5 remap",
    "after a run": BOX + "velocity all create 1 87287 loop geom\npair_style lj/cut 2.5\npair_coeff * * 1 1\nfix 1 all nve\nrun 5\n"
    "change_box all boundary s s p\nrun 5\nchange_box all x scale 1.05 z final 0 6 remap\nrun 5",
    "shape of a shrunk box": FCC.format("s p p") + "change_box all triclinic yz final 0.3 x scale 1.2 remap",
    "tilt beyond an open face": OFF + "change_box all triclinic boundary p f f xy final 0.7 remap xz final 0.3 remap yz final 0.1 remap\n"
    "pair_style lj/cut 2.5\npair_coeff * * 1 1\nfix 1 all nve\nrun 3",
    "flat": FLAT + "change_box all x scale 1.1 y volume remap\nchange_box all triclinic xy final 0.5 remap",
}


@pytest.fixture(scope="module")
def theirs():
    return lammps(CASES)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_atoms_as_lammps(theirs, name):
    tolerance = 1e-12 if "run 3" in CASES[name] or "run 5" in CASES[name] else 1e-14
    assert_same(asemd(CASES[name]), theirs[name], x=tolerance, v=tolerance)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_shrink_wrapped_across_a_tilt():
    """Volume and pressure are LAMMPS's, while atoms move too, though the vector across the face has another direction."""
    lines = [*OFF.splitlines(), "velocity all create 1 87287",
             "change_box all triclinic boundary p p s xz final 0.7 remap yz final 0.3 remap",
             "pair_style lj/cut 2.5", "pair_coeff * * 1 1", "fix 1 all nve", "run 40"]
    what = ("pe", "vol", "lz", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
    want = ask("lmp = ran(given['lines'])\nanswer = [lmp.get_thermo(k) for k in given['what']]", lines=lines, what=what)
    lmp = ran(lines)
    assert [lmp.get_thermo(k) for k in what] == pytest.approx(want, rel=1e-10)


def test_text():
    told = "".join(asemd(BOX + "change_box all x final 0 4 y scale 1.1 z volume remap units box\nchange_box all triclinic xy final 1").told)
    told = told[told.index("Changing"):]
    assert told.count("Changing box ...\n") == 2
    assert told.splitlines()[1] == "  orthogonal box = (0 0 0) to (4 4.1989905 5.0387886)"
    assert "  triclinic box = " in told and told.splitlines()[-1].endswith("with tilt (1.6795962 0 0)")


@pytest.mark.parametrize("line, message", [
    ("change_box all", "2 values"), ("change_box non x scale 2", "unknown group"), ("change_box all foo", "unknown keyword"),
    ("change_box all x final 0", "3 values"), ("change_box all x scale 0", "no volume"), ("change_box all x final 3 2", "no volume"),
    ("change_box all x volume", "must follow"), ("change_box all y volume z volume", "must follow"),
    ("change_box all xy final 1", "orthogonal"),
    ("change_box all x scale 1.1 x volume", "must follow"), ("change_box all x scale 1.1 units latice", "did you mean lattice"),
    ("change_box all x scal 2", "did you mean scale"), ("change_box all boundary p p", "3 values"),
    ("change_box all boundary p p q", "letters"),
    ("change_box all triclinic xy final 0.2 ortho", "tilted"),
    ("dump 1 all atom 10 none\nchange_box all triclinic", "dumps"),
])
def test_mistakes(line, message):
    session = asemd(BOX)
    *before, line = line.splitlines()
    for text in before:
        session.execute(text)
    box, x = session.scene.system.box, session.scene.system.x.copy()
    with pytest.raises(InputError, match=message):
        session.execute(line)
    assert session.scene.system.box is box and (session.scene.system.x == x).all()


def test_flat_mistakes():
    session = asemd(FLAT)
    for line in ("change_box all z scale 2", "change_box all x scale 2 z volume", "change_box all triclinic xz final 1",
                 "change_box all boundary p p f"):
        with pytest.raises(InputError, match="2d"):
            session.execute(line)
