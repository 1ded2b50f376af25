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
GROUPS = "region q block 0 1.4 INF INF INF INF\ngroup g region q\nset group g type 2\ngroup o subtract all g\n"
MULTI = GROUPS + "neighbor 0.4 multi\npair_coeff 2 2 1 0.8 2.0\n"
CUT = "region q block 1 2 1 2 {z}\ngroup g region q\ngroup o subtract all g\ndelete_atoms group o\nrun 30"


def scene(more: str, boundary="p p p", dimension=3, lattice="fcc 0.8442", region="block 0 3 0 3 0 3", before="", temperature=1.0) -> str:
    return HEAD.format(boundary=boundary, dimension=dimension, lattice=lattice, region=region, before=before,
                       temperature=temperature) + more


FLAT = {"dimension": 2, "lattice": "hex 0.8"}
CASES = {
    "once": scene("neigh_modify once yes\nrun 40", region="block 0 5 0 5 0 5", temperature=3.0),
    "once and no more": scene("neigh_modify once yes\nneigh_modify once no\nrun 20", temperature=3.0),
    "buffers": scene("neigh_modify page 200000 one 5000 delay 5 every 5 check no\nrun 10"),
    "include": scene(GROUPS + "neigh_modify include g\nrun 30", before="atom_modify first g", temperature=3.0),
    "include and exclude": scene(GROUPS + "group h id < 30\nneigh_modify include g exclude group h h exclude none exclude type 1 1\nrun 20",
                                 before="atom_modify first g"),
    "include in a tilted box": scene(GROUPS + "neigh_modify include g\nrun 20", region="prism 0 3 0 3 0 3 0.7 0.2 -0.3",
                                     before="atom_modify first g"),
    "exclude types": scene(GROUPS + "neigh_modify exclude type 1 2\nrun 30"),
    "exclude groups": scene(GROUPS + "neigh_modify exclude group g g exclude group o g\nrun 30"),
    "exclude and none": scene(GROUPS + "neigh_modify exclude group g g\nneigh_modify exclude none\nrun 10"),
    "exclude in molecules": scene(GROUPS + "set group all mol 1\nset group g mol 2\nneigh_modify exclude molecule/intra o\nrun 30",
                                  before="atom_style bond"),
    "exclude between molecules": scene(GROUPS + "set group all mol 1\nset group g mol 2\nneigh_modify exclude molecule/inter all\nrun 30",
                                       before="atom_style bond"),
    "collections of types": scene(MULTI + "neigh_modify collection/type 2 1 2 every 2\nrun 10\nneigh_modify collection/type 1 1*2\nrun 5"),
    "collections by distance": scene(MULTI + "neigh_modify collection/interval 2 2.0 2.5\nrun 10"),
    "bins and clusters": scene("neigh_modify binsize 1.0 cluster yes every 3 delay 6\nrun 20"),
    "nothing": scene("neigh_modify\nrun 5"),
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
    """LAMMPS does not clear the forces of atoms outside the group of include: what was in memory counts, so each of them comes first."""
    alone = {name for name in CASES if name.startswith("include")}
    answers = lammps({name: case for name, case in CASES.items() if name not in alone})
    return answers | {name: lammps({name: CASES[name]})[name] for name in alone}


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_atoms_as_lammps(theirs, name):
    assert_same(asemd(CASES[name]), theirs[name], x=1e-10, v=1e-10)


def test_once_builds_no_list():
    told = "".join(asemd(CASES["once"]).told)
    assert "Neighbor list builds = 0" in told


@pytest.mark.parametrize("line, message", [
    ("once maybe", "yes or no"), ("include nobody", "unknown group 'nobody'"), ("include o", "must be that of atom_modify first, g"),
    ("include", "include"), ("one 0", "positive"), ("page x", "page"), ("binsize x", "binsize"), ("cluster maybe", "yes or no"),
    ("exclude", "exclude"), ("exclude type 1", "2 values"), ("exclude group g nobody", "nobody"), ("exclude pair 1 1", "expected one of"),
    ("collection/type 1 1*2", "style multi"), ("every 1 delay 5 foo", "unknown keyword 'foo'"), ("delay -1", "zero or positive"),
])
def test_mistakes(line, message):
    with pytest.raises(InputError, match=message):
        asemd(scene(GROUPS, before="atom_modify first g")).execute(f"neigh_modify {line}")


@pytest.mark.parametrize("line, message", [
    ("collection/type 1 1", "type 2 is in no collection"), ("collection/type 2 1 1*2", "type 1 is in two"),
    ("collection/type 0", "positive"),
    ("collection/type 2 1", "2 values"), ("collection/type 1 5", "5"), ("collection/interval 2 2 1", "become larger"),
    ("collection/interval 1 x", "interval"), ("collection/type", "1 value"),
])
def test_wrong_collections(line, message):
    with pytest.raises(InputError, match=message):
        asemd(scene(MULTI)).execute(f"neigh_modify {line}")


def test_include_without_first():
    with pytest.raises(InputError, match="atom_modify first, which was not given"):
        asemd(scene(GROUPS)).execute("neigh_modify include g")


def test_include_in_ase():
    session = asemd(scene(GROUPS + "thermo_modify norm no\nneigh_modify include g\nrun 0", before="atom_modify first g"))
    assert session.scene.to_atoms().get_potential_energy() == pytest.approx(session.last_thermo["E_pair"], rel=1e-12)
