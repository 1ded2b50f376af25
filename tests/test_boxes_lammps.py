"""A box that is driven, and momentum or heat that is: positions, velocities, box and outputs as LAMMPS has them."""
from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data

NVE = "fix 1 all nve"
BOX = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi", "xy", "xz", "yz", "press", "temp"]
TILTED = "change_box all triclinic"
CASES = {
    "deform erate": ([NVE, "fix 2 all deform 1 x erate 0.001 y trate -0.001"], BOX),
    "deform final delta": ([NVE, "fix 2 all deform 3 x final 0.5 13 y delta -0.2 0.3 z scale 1.1 units box"], BOX),
    "deform vel volume": ([NVE, "fix 2 all deform 1 x vel 0.01 y volume"], BOX),
    "deform volume two": ([NVE, "fix 2 some deform 2 y trate 0.001 x volume z volume remap x"], BOX),
    "deform volume of two": ([NVE, "fix 2 some deform 1 y trate 0.001 x erate 0.002 z volume remap none"], BOX),
    "deform wiggle": ([NVE, "fix 2 all deform 1 z wiggle 1.0 40 remap v"], BOX),
    "deform tilt": ([TILTED, NVE, "fix 2 all deform 1 xy erate 0.002 xz vel 0.01 units box"], BOX),
    "deform variable": ([TILTED, NVE, "variable d equal 0.02*step", "variable r equal 0.02",
                         "fix 2 all deform 1 x variable v_d v_r xy variable v_d v_r"], BOX),
    "deform flip x": ([TILTED, NVE, "fix 2 all deform 1 xy erate 0.05"], BOX),
    "deform flip v": ([TILTED, NVE, "fix 2 all deform 1 xy erate 0.05 remap v"], BOX),
    "deform flip every": ([TILTED, NVE, "fix 2 all deform 4 xy erate -0.05 xz erate 0.06 remap x"], BOX),
    "deform flip yz": ([TILTED, NVE, "fix 2 some deform 1 yz erate -0.05 xz erate 0.03 remap v"], BOX),
    "deform flip none": ([TILTED, NVE, "fix 2 all deform 1 yz erate -0.02 flip no"], BOX),
    "deform flip variable": ([TILTED, NVE, "variable d equal 0.6*step", "variable r equal 0.6",
                              "fix 2 all deform 1 xy variable v_d v_r remap v"], BOX),
    "deform tilt trate wiggle": (["change_box all triclinic xy final 1.0", NVE,
                                  "fix 2 all deform 1 xy trate 0.05 xz wiggle 3.0 25.0 units box"], BOX),
    "deform one corner": ([NVE, "fix 2 all deform 1 x final 0.1 12.4 y delta -0.4 0.1 z volume remap v units box"], BOX),
    "temp/deform": ([TILTED, NVE, "compute t all temp/deform", "compute u some temp/deform",
                     "fix 2 all deform 1 x erate 0.004 xy vel 0.1 z volume remap v"], ["c_t", "c_t[1]", "c_t[4]", "c_u"]),
    "sllod shear": ([TILTED, "fix 2 all deform 1 xy erate 0.002 remap v", "fix 1 all nvt/sllod temp 300 300 50"],
                    ["f_1", "econserve", *BOX]),
    "sllod flip": (["fix 1 all nvt/sllod temp 300 400 50 psllod yes tchain 3 drag 0.1", TILTED,
                    "fix 2 all deform 2 xy erate 0.03 yz erate -0.001 remap v"], ["f_1", *(f"f_1[{k}]" for k in range(1, 13))]),
    "sllod stretch": (["fix 1 all nvt/sllod temp 300 400 50", "compute t all temp/deform", "compute_modify t extra/dof 0",
                       "fix 2 all deform 1 y trate 0.001 x volume z volume remap v", "fix_modify 1 temp t"], ["f_1", "c_t"]),
    "sllod sub-steps": ([TILTED, "fix 2 all deform 1 xy erate 0.002 remap v", "fix 1 all nvt/sllod temp 300 300 50 tloop 3 tchain 2"],
                        ["f_1", *BOX]),
    "sllod profile": ([TILTED, "fix 2 all deform 1 xy erate 0.002 remap v", "compute t all temp/profile 1 0 1 y 3",
                       "fix 1 all nvt/sllod temp 300 300 50", "fix_modify 1 temp t"], ["f_1", "c_t", *BOX]),
    "sllod partial": ([TILTED, "compute t all temp/partial 0 1 1", "fix 1 all nvt/sllod temp 300 300 50 psllod yes tchain 2",
                       "fix_modify 1 temp t", "fix 2 all deform 1 xy erate 0.002 z vel 0.01 remap v units box"], ["f_1", "c_t"]),
    "deform levels": ([TILTED, "run_style respa 2 2 bond 1 pair 2", "fix 2 all deform 2 xy erate 0.03 remap v",
                       "fix 1 all nvt/sllod temp 300 300 50"], ["f_1", *BOX]),
    "heat": ([NVE, "fix 2 all heat 1 0.5"], ["f_2", "etotal"]),
    "heat region": ([NVE, "fix 2 all heat 2 -0.2 region half", "fix 3 some heat 3 0.1"], ["f_2", "f_3"]),
    "heat variables": ([NVE, "variable h equal 0.001*step", "fix 2 all heat 1 v_h", "fix 3 all heat 2 v_along region half"],
                       ["f_2", "f_3"]),
    "ehex": ([NVE, "fix 2 all ehex 1 5.0 region half", "fix 3 some ehex 3 -0.1"], ["f_2", "f_3", "etotal"]),
    "ehex hex": ([NVE, "fix 2 some ehex 2 5.0 hex"], ["f_2"]),
    "viscosity": ([NVE, "fix 2 all viscosity 5 x z 4"], ["f_2"]),
    "viscosity swaps": ([NVE, "fix 2 all viscosity 3 y x 4 swap 4 vtarget 0.005"], ["f_2"]),
    "viscosity same direction": ([NVE, "fix 2 some viscosity 4 z z 4 vtarget INF swap 2"], ["f_2"]),
    "thermal/conductivity": ([NVE, "fix 2 all thermal/conductivity 5 z 4"], ["f_2"]),
    "thermal/conductivity swaps": ([NVE, "fix 2 some thermal/conductivity 3 y 6 swap 3"], ["f_2"]),
    "accelerate/cos": ([NVE, "fix 2 all accelerate/cos 0.001", "compute c all viscosity/cos", "compute d some viscosity/cos"],
                       ["c_c", *(f"c_c[{k}]" for k in range(1, 8)), "c_d", "c_d[7]", "press"]),
    "deform v lengths": ([NVE, "fix 2 all deform 1 x erate 0.004 y trate -0.004 z volume remap v"], BOX),
}
RELAX = {
    "relax iso": (["fix 1 all box/relax iso 1000.0 vmax 0.001"], ["f_1", *BOX]),
    "relax aniso": (["min_style sd", "fix 1 all box/relax aniso 1000.0 vmax 0.002 fixedpoint 0 0 0"], ["f_1", *BOX]),
    "relax couple": (["fix 1 all box/relax x 1000.0 y 1000.0 z 500.0 couple xy vmax 0.002 nreset 2"], ["f_1", *BOX]),
    "relax partial": (["min_modify line backtrack", "fix 1 some box/relax x 0.0 dilate partial"], ["f_1", *BOX]),
    "relax tri": (["change_box all triclinic", "fix 1 all box/relax tri 1000.0 vmax 0.001"], ["f_1", *BOX]),
    "relax stress": (["change_box all triclinic xy final 1.0 xz final -0.5", "min_modify norm max",
                      "fix 1 all box/relax x 1000.0 y 500.0 xy 200.0 scalexz no vmax 0.001 nreset 3"], ["f_1", *BOX]),
    "relax plane": (["fix 1 all box/relax x 1000.0 y 1000.0 couple xy vmax 0.002"], ["f_1", *BOX]),
    "relax 2d couple": (["fix 1 all box/relax x 1000.0 y 1000.0 couple xy vmax 0.001", "fix 2 all enforce2d"], ["f_1", *BOX]),
    "relax 2d": (["fix 1 all box/relax iso 1000.0 vmax 0.001", "fix 2 all enforce2d"], ["f_1", *BOX]),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    folder = tmp_path_factory.mktemp("boxes")
    out = {}
    for dimension in (2, 3):
        write_data(folder / f"data{dimension}", dimension)
    for table, runs in ((CASES, ["run 20", "run 30 start 0 stop 60"]), (RELAX, ["minimize 0 0 6 100", "minimize 0 0 4 100"])):
        for name, (commands, values) in table.items():
            dimension = 2 if "2d" in name else 3
            out[name] = {"data": str(folder / f"data{dimension}"), "dimension": dimension, "commands": commands, "values": values,
                         "runs": runs}
    return out


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    return by_lammps(cases, tmp_path_factory.mktemp("lammps"))


@pytest.mark.parametrize("name", [*CASES, *RELAX])
def test_like_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    made = partial(start, "-compat", "lammps") if name == "sllod sub-steps" else Lammps
    for ours, theirs in zip(measure(made, cases[name]), expected[name], strict=True):
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-10, abs=1e-9), formula
        for key in ("x", "v"):
            a, b = np.array(ours[key]), np.array(theirs[key])
            assert abs(a - b).max() <= 5e-12 * abs(b).max(), key


def start(*words, cmdargs):
    from asemd.lammps import Lammps
    return Lammps(cmdargs=[*cmdargs, *words])


def test_sub_steps_share_the_flow(cases):
    """Sub-steps of the chain change nothing but its accuracy; with LAMMPS's numbers the flow acts once in each."""
    case = cases["sllod sub-steps"]
    one = {**case, "commands": [c.replace("tloop 3", "tloop 1") for c in case["commands"]]}
    single, several, theirs = (np.array(measure(partial(start, *words), c)[-1]["v"])
                               for c, words in ((one, ()), (case, ()), (case, ("-compat", "lammps"))))
    assert abs(several - single).max() < 1e-3 * abs(theirs - single).max() > 0.0
