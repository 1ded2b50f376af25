"""neigh_modify once, boundaries and box shapes in runs, against LAMMPS."""
from __future__ import annotations

import pytest
from both import asemd, assert_same, lammps

from asemd.errors import InputError

HEAD = """
units lj
dimension {dimension}
boundary {boundary}
{before}
lattice {lattice}
region b {region}
create_box 2 b
create_atoms 1 box
mass * 1
velocity all create {temperature} 87287 loop geom
pair_style lj/cut 2.5
pair_coeff * * 1 1
fix 1 all nve
thermo 5
"""
CUT = "region q block 1 2 1 2 {z}\ngroup g region q\ngroup o subtract all g\ndelete_atoms group o\nrun 30"


def scene(more: str, boundary="p p p", dimension=3, lattice="fcc 0.8442", region="block 0 3 0 3 0 3", before="", temperature=1.0) -> str:
    return HEAD.format(boundary=boundary, dimension=dimension, lattice=lattice, region=region, before=before,
                       temperature=temperature) + more


FLAT = {"dimension": 2, "lattice": "hex 0.8"}
CASES = {
    "once": scene("neigh_modify once yes\nrun 40", region="block 0 5 0 5 0 5", temperature=3.0),
    "once and no more": scene("neigh_modify once yes\nneigh_modify once no\nrun 20", temperature=3.0),
    "buffers": scene("neigh_modify page 200000 one 5000 delay 5 every 5 check no\nrun 10"),
    "m m p": scene("run 30", "m m p"),
    "s s s": scene("run 30", "s s s"),
    "fs ms p": scene(CUT.format(z="INF INF"), "fs ms p"),
    "m m m shrunk": scene(CUT.format(z="INF INF"), "m m m"),
    "f f f": scene(CUT.format(z="1 2"), "f f f"),
    "tilt large": scene("run 20", region="prism 0 3 0 3 0 3 2.2 -1.7 2.0", before="box tilt large"),
    "tilted, shrunk in z": scene("run 20", "p p s", region="prism 0 3 0 3 0 3 0.7 0 0"),
    "tilted, m in y": scene("run 20", "p m p", region="prism 0 3 0 3 0 3 0 0.5 0"),
    "flat tilted": scene("fix 2 all enforce2d\nrun 20", region="prism 0 8 0 6 -0.5 0.5 1.5 0 0", **FLAT),
    "flat shrunk": scene("fix 2 all enforce2d\nrun 20", "s s p", region="block 0 8 0 6 -0.5 0.5", **FLAT),
    "parts of a run": scene("run 10\nrun 15 upto\nrun 5 pre no post no\nrun 10 start 15 stop 40"),
    "run every": scene('variable a equal step\nrun 20 every 7 "print \'at $a\'" "variable b equal 1"\nrun 10 every 5 NULL\n'
                       'run 6 pre no every 3 "velocity all scale 1.5"'),
}


@pytest.fixture(scope="module")
def theirs():
    return lammps(CASES)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_atoms_as_lammps(theirs, name):
    assert_same(asemd(CASES[name]), theirs[name], x=1e-10, v=1e-10)


def test_once_builds_no_list():
    told = "".join(asemd(CASES["once"]).told)
    assert "Neighbor list builds = 0" in told


@pytest.mark.parametrize("line, message", [("neigh_modify once maybe", "yes or no"), ("neigh_modify include g", "not supported")])
def test_mistakes(line, message):
    with pytest.raises(InputError, match=message):
        asemd(scene("")).execute(line)
