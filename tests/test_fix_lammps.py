"""Fixes move atoms as LAMMPS does: positions, velocities and outputs after two runs of a small bonded liquid."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data

NVE = "fix 1 all nve"
CASES = {
    "nve": ([NVE], []),
    "nve group": (["fix 1 some nve"], []),
    "nve/limit": (["fix 1 all nve/limit 0.005"], ["f_1"]),
    "nve/limit group": (["fix 1 some nve/limit 0.01"], ["f_1"]),
    "nvt": (["fix 1 all nvt temp 300 300 100"], ["f_1"]),
    "nvt ramp, one link": (["fix 1 all nvt temp 200 400 10 tchain 1"], ["f_1"]),
    "nvt chain, loops, drag": (["fix 1 some nvt temp 200 400 20 tchain 5 tloop 3 drag 0.2"], ["f_1", "ecouple", "econserve"]),
    "nvt other temperature": (["compute t all temp", "compute_modify t extra/dof 0", "fix 1 some nvt temp 200 400 20",
                               "fix_modify 1 temp t"], ["f_1"]),
    "langevin friction": ([NVE, "fix 2 all langevin 0 0 50 77"], []),
    "langevin tally": ([NVE, "fix 2 some langevin 0 0 50 77 tally yes scale 1 2.0 zero yes"], ["f_2", "ecouple"]),
    "langevin gjf vfull": (["fix 2 all langevin 0 0 50 77 gjf vfull", NVE], []),
    "langevin gjf strong": (["fix 2 all langevin 0 0 0.3 77 zero yes gjf vfull", NVE], []),
    **{f"gjf method {m} {v}": ([f"fix 1 all gjf 0 0 {damp} 77 vel {v} method {m}"], [])
       for m, v, damp in (("1", "vhalf", 1.5), ("2", "vfull", 1.5), ("3", "vhalf", 3.0), ("4", "vfull", 50), ("5", "vhalf", 0.5),
                          ("6", "vfull", 0.5), ("7 0.3", "vhalf", 0.9), ("8", "vhalf", 2.0))},
    "temp/rescale": ([NVE, "fix 2 all temp/rescale 1 300 400 10 0.5"], ["f_2"]),
    "temp/rescale every": ([NVE, "fix 2 some temp/rescale 3 300 400 10 1.0"], ["f_2"]),
    "temp/rescale variable": ([NVE, "fix 2 some temp/rescale 3 v_warm 400 10 1.0"], ["f_2"]),
    "temp/berendsen": ([NVE, "fix 2 all temp/berendsen 300 400 20"], ["f_2"]),
    "temp/berendsen other temperature": ([NVE, "fix 2 some temp/berendsen 300 300 20", "fix_modify 2 temp thermo_temp"], ["f_2"]),
    "temp/berendsen variable": ([NVE, "fix 2 some temp/berendsen v_warm 300 20"], ["f_2"]),
    **{f"{fix.split()[0]} without the bias of {temp}": (
        ["velocity all set 0.004 0.002 0.0 sum yes",
         f"compute t {temp}", NVE, f"fix 2 {group} {fix}", "fix_modify 2 temp t", "compute p all pressure t"],
        ["c_t", "c_p", *(["c_t[1]", "c_t[4]"] if "out bin" not in temp else []), *(["f_2"] if tally else [])])
       for group, fix, temp, tally in (
           ("all", "temp/berendsen 300 400 20", "all temp/com", True),
           ("some", "temp/berendsen v_warm 300 20", "some temp/partial 1 0 1", True),
           ("all", "temp/berendsen 300 300 20", "all temp/region half", True),
           ("some", "temp/rescale 3 300 400 10 0.7", "some temp/rotate", True),
           ("all", "temp/rescale 2 300 400 10 0.7", "all temp/profile 1 1 0 xz 2 2", True),
           ("all", "temp/rescale 2 300 400 10 0.7", "all temp/profile 1 0 0 y 2 out bin", True),
           ("all", "temp/berendsen 300 300 20", "all temp/ramp vy -0.004 0.008 x 2 9 units box", True),
           ("all", "langevin 0 0 50 77", "all temp/com", False),
           ("some", "langevin 0 0 50 77 tally yes zero yes", "some temp/partial 0 1 1", True),
           ("all", "langevin 0 0 50 77 scale 2 0.5", "all temp/region half", False))},
    **{f"velocity {words} bias {temp}": (["velocity all set 0.01 0.02 NULL sum yes", f"compute t {temp}",
                                          f"velocity {words} temp t bias yes", NVE], ["c_t"])
       for words in ("all create 200 1234", "some create 200 1234 sum yes", "all scale 77")
       for temp in ("all temp/com", "some temp/partial 1 0 1", "all temp/region half")},
    "temp/csvr": ([NVE, "fix 2 some temp/csvr 300 400 20 6282"], ["f_2", "ecouple"]),
    "temp/csld": ([NVE, "fix 2 some temp/csld v_warm 400 20 6282"], ["f_2", "ecouple"]),
    "setforce": (["fix 2 some setforce 0.1 NULL 0.0", NVE], ["f_2[1]", "f_2[2]", "f_2[3]"]),
    "setforce region": (["fix 2 some setforce 0.1 NULL 0.0 region half", NVE], ["f_2[1]", "f_2[2]", "f_2[3]"]),
    "setforce variables": (["fix 2 all setforce v_one v_along NULL", NVE], ["f_2[1]", "f_2[2]", "f_2[3]"]),
    "addforce": (["fix 2 some addforce 0.1 0.2 0.0", "fix_modify 2 energy yes virial yes", NVE],
                 ["f_2", "f_2[1]", "f_2[2]", "f_2[3]", "pe", "press", "pxx", "pxy", "pxz", "pyz"]),
    "addforce region": (["fix 2 some addforce 0.1 0.0 0.3 region half", NVE], ["f_2", "f_2[1]", "f_2[3]"]),
    "addforce variables": (["fix 2 all addforce v_one v_along 0.1", "fix_modify 2 virial yes", NVE], ["f_2", "f_2[2]", "press", "pxy"]),
    "addforce energy": (["fix 2 all addforce v_along 0.0 0.0 energy v_well", "fix_modify 2 energy yes", NVE], ["f_2", "pe"]),
    "addforce every": (["fix 2 some addforce 0.1 0.2 0.0 every 3", NVE], ["f_2", "f_2[1]"]),
    "momentum linear": ([NVE, "fix 2 some momentum 4 linear 1 1 0"], []),
    "momentum both": ([NVE, "fix 2 some momentum 4 linear 1 0 1 angular"], []),
    "momentum/chunk": ([NVE, "compute c all chunk/atom molecule", "fix 2 all momentum/chunk 4 c linear 1 0 1 angular"], []),
    "momentum/chunk rescale": ([NVE, "compute c all chunk/atom type", "fix 2 all momentum/chunk 3 c linear 1 1 1 rescale"], []),
    "momentum/chunk group": ([NVE, "group g molecule 3:5", "compute c all chunk/atom molecule",
                              "fix 2 g momentum/chunk 2 c linear 1 1 1 angular rescale"], []),
    "momentum rescale": ([NVE, "fix 2 all momentum 1 angular rescale"], []),
    "enforce2d": ([NVE, "fix 2 all enforce2d"], ["temp", "press", "pxx", "pxy"]),
    "enforce2d nvt": (["fix 1 all nvt temp 300 300 50", "fix 2 all enforce2d"], ["f_1", "temp", "press"]),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fixes")
    for dimension in (2, 3):
        write_data(folder / f"data{dimension}", dimension)
    out = {}
    for name, (commands, values) in CASES.items():
        dimension = 2 if "2d" in name else 3
        out[name] = {"data": str(folder / f"data{dimension}"), "dimension": dimension, "commands": commands, "values": values,
                     "runs": ["run 20", "run 10 start 0 stop 60"]}
    return out


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    return by_lammps(cases, tmp_path_factory.mktemp("lammps"))


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    for ours, theirs in zip(measure(Lammps, cases[name]), expected[name], strict=True):
        for key in ("x", "v"):
            a, b = np.array(ours[key]), np.array(theirs[key])
            assert abs(a - b).max() <= 2e-12 * abs(b).max(), key
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-10, abs=1e-9), formula
