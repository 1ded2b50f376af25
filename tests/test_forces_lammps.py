"""Fixes that change forces and positions do what LAMMPS's do: positions, velocities and outputs after two runs of a small liquid."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data

NVE = "fix 1 all nve"
THREE, FOUR, SEVEN = ([f"f_2[{k}]" for k in range(1, n + 1)] for n in (3, 4, 7))
CASES = {
    "aveforce": (["fix 2 some aveforce 0.1 NULL -0.2", NVE], THREE),
    "aveforce variable region": (["fix 2 some aveforce v_one 0.0 NULL region half", NVE], THREE),
    "addtorque": (["fix 2 some addtorque 10 0 -30", "fix_modify 2 energy yes", NVE], ["f_2", *THREE, "pe"]),
    "addtorque variable": (["fix 2 all addtorque v_warm v_one 0.5", NVE], ["f_2", *THREE]),
    "lineforce": (["fix 2 some lineforce 1 2 -0.5", NVE], []),
    "planeforce": (["fix 2 some planeforce 0 1 0.5", NVE], []),
    "nve/noforce": (["fix 1 some nve/noforce"], []),
    "viscous": (["fix 2 all viscous 0.01 scale 2 3.5 scale 3 0.5", NVE], []),
    "drag": (["fix 2 some drag 1 2 3 0.4 2.5", NVE], THREE),
    "drag plane": (["fix 2 some drag 11 NULL -3 0.4 0.0", NVE], THREE),
    "gravity vector": (["fix 2 some gravity 0.02 vector 1 1 -2", "fix_modify 2 energy yes", NVE], ["f_2", "pe"]),
    "gravity chute": (["fix 2 all gravity 0.02 chute 30", NVE], ["f_2"]),
    "gravity spherical variable": (["variable g equal 0.01*(1+step)", "fix 2 all gravity v_g spherical v_warm 30", NVE], ["f_2"]),
    "spring tether": (["fix 2 some spring tether 5.0 3 NULL 4 1.5", "fix_modify 2 energy yes", NVE], ["f_2", *FOUR, "pe"]),
    "spring tether short": (["fix 2 some spring tether 5.0 3 2 4 30", NVE], ["f_2", *FOUR]),
    "spring couple": (["group others type 2", "fix 2 some spring couple others 5.0 1 2 NULL 1.5", NVE], ["f_2", *FOUR]),
    "spring couple overlap": (["group most id 3:50", "fix 2 some spring couple most 5.0 1 2 3 9.5", NVE], ["f_2", *FOUR]),
    "spring/self": (["run 3", "fix 2 some spring/self 5.0", "fix_modify 2 energy yes", NVE], ["f_2", "pe"]),
    "spring/self xz": (["fix 2 some spring/self v_one xz", NVE], ["f_2"]),
    "spring/self by atom": (["fix 2 some spring/self v_along y", NVE], ["f_2"]),
    "spring/rg": (["fix 2 some spring/rg 20.0 4.5", NVE], ["f_2"]),
    "spring/rg NULL": (["fix 2 some spring/rg 20.0 NULL", NVE], ["f_2"]),
    "smd cvel tether": (["fix 2 some smd cvel 5.0 0.01 tether 3 NULL 4 1.5", "fix_modify 2 virial yes", NVE], [*SEVEN, "press", "pxy"]),
    "smd cfor tether": (["fix 2 some smd cfor 5.0 tether 3 2 NULL 1.5", NVE], SEVEN),
    "smd cvel couple": (["group others type 2", "fix 2 some smd cvel 5.0 0.01 couple others auto auto NULL 1.5", NVE], SEVEN),
    "smd cvel couple along": (["group others type 2",
                               "fix 2 some smd cvel 5.0 -0.01 couple others 1 auto 2 1.5", "fix_modify 2 virial yes", NVE],
                              [*SEVEN, "press", "pxz"]),
    "smd cfor couple": (["group others type 2", "fix 2 some smd cfor 5.0 couple others auto auto auto 1.5", NVE], SEVEN),
    "smd cfor couple along": (["group others type 2", "fix 2 some smd cfor 5.0 couple others 1 2 NULL 1.5", NVE], SEVEN),
}
RUNS = ["run 20", "run 10 start 0 stop 60"]


def make_cases(folder) -> dict[str, dict]:
    for dimension in (2, 3):
        write_data(folder / f"data{dimension}", dimension)
    out = {}
    for name, (commands, values) in CASES.items():
        dimension = 2 if "2d" in name else 3
        out[name] = {"data": str(folder / f"data{dimension}"), "dimension": dimension, "commands": commands, "values": values, "runs": RUNS}
    return out


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    return make_cases(tmp_path_factory.mktemp("forces"))


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
