"""fix wall/colloid pulls and pushes spheres as LAMMPS does."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

SPHERES = """
units lj
atom_style {style}
boundary {boundary}
lattice sc 0.05
region b block 0 4 0 4 0 3
create_box 2 b
region low block INF 3.5 INF 3.5 INF 2.5
create_atoms 1 region low
displace_atoms all move 1.35 1.3 1.25 units box
{sizes}
velocity all create 0.5 87287
pair_style lj/cut 2.5
pair_coeff * * 0.1 1
group few id 1:25
variable strength equal 1.0+0.01*step
variable place equal -0.5-0.002*step
fix 1 all nve
fix 2 {group} wall/colloid {walls}
fix_modify 2 energy yes virial yes
thermo_style custom step pe press pxx pzz f_2 f_2[1]
thermo_modify norm no
timestep 0.004
run 25
"""
SIZES = "set group all diameter 1.6\nset atom 3 diameter 1.9\nset atom 10*20 diameter 1.2\nset group all mass 1.0"
COMMON = {"style": "sphere", "boundary": "f f f", "sizes": SIZES, "group": "all"}
CASES = {
    "zlo": {"walls": "zlo 0.0 3.0 1.0 5.0 units box"},
    "all sides": {"walls": "xlo 0.1 5 1.0 4 xhi EDGE 4 0.9 4 ylo EDGE 2 1 3 yhi EDGE 2 1.1 3 zlo EDGE 6 1.2 3.5 zhi EDGE 1 1 6 units box"},
    "lattice": {"walls": "zlo -0.1 3.0 1.0 5.0"},
    "variables": {"walls": "zlo v_place v_strength 1.0 5.0 units box xlo -0.2 1 v_strength 6"},
    "group": {"walls": "zlo -0.1 30.0 1.0 5.0 units box", "group": "few"},
    "short": {"walls": "zlo -0.2 30.0 1.0 1.9 units box"},
    "periodic": {"walls": "zlo -0.2 30.0 1.0 3.0 units box pbc yes", "boundary": "p p p"},
}
SCRIPT = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = {key: by_id(lmp, key).tolist() for key in "xvf"} | {
        "values": [lmp.get_thermo(k) for k in ("pe", "press", "pxx", "pzz")] + [lmp.extract_fix("2", 0, 0), lmp.extract_fix("2", 0, 1, 0)]}
    lmp.close()
"""


def text(name: str) -> str:
    return SPHERES.format(**COMMON | CASES[name])


@pytest.fixture(scope="module")
def theirs():
    return ask(SCRIPT, cases={name: lines_of(text(name)) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    session, expected = asemd(text(name)), theirs[name]
    system, fix = session.scene.system, session.scene.fixes["2"]
    order = np.argsort(system.id)
    for key in "xvf":
        want = np.array(expected[key])
        assert getattr(system, key)[order] == pytest.approx(want, abs=1e-11 * np.abs(want).max()), key
    got = [session.last_thermo[k] for k in ("PotEng", "Press", "Pxx", "Pzz")] + [fix.scalar(), fix.vector(1)]
    assert got == pytest.approx(expected["values"], rel=1e-10)
    assert abs(fix.scalar()) > 1e-3


@pytest.mark.parametrize(("changes", "message"), [
    ({"style": "atomic", "sizes": "mass * 1"}, "requires atom attribute radius"),
    ({"sizes": SIZES + "\nset atom 7 diameter 0\nset group all mass 1.0"}, "requires extended particles"),
    ({"walls": "zlo 0 1 1"}, "needs 4 values"), ({"walls": "zlo 0 1 1 0"}, "must be above 0"), ({"walls": ""}, "no walls"),
    ({"walls": "zlo 0 1 1 2 fld yes"}, "fld"), ({"boundary": "p p p"}, "Cannot use zlo wall in periodic z"),
])
def test_messages(changes, message):
    with pytest.raises(InputError, match=message):
        asemd(SPHERES.format(**COMMON | CASES["zlo"] | changes))


def test_spheres_in_the_wall():
    with pytest.raises(Exception, match="on the wall or behind it"):
        asemd(text("zlo").replace("zlo 0.0 3.0", "zlo 0.4 1e-9"))


def test_round_trip():
    fix = asemd(text("zlo").rpartition("fix_modify")[0]).scene.fixes["2"]
    assert fix.to_lammps() == CASES["zlo"]["walls"].split()
