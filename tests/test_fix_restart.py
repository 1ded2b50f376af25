"""Fixes go on from a restart file, written between two runs or in the midst of one, as if nothing had happened."""
from __future__ import annotations

import warnings

import numpy as np
import pytest
from scripted import script, write_data
from wheel import ran

NVE, RIGID = "fix 1 all nve", "neigh_modify exclude molecule/intra all\ncomm_modify cutoff 11.5"
P = "0 500 100"
BATH = ["ecouple", "econserve", "f_1", "press"]
TILT = "change_box all triclinic xy delta 1.5 xz delta -1 yz delta 0.7 remap units box"
# name: (commands before the fixes, which the file keeps; commands of both sessions; values)
CASES = {
    "nvt": ("", ["fix 1 all nvt temp 300 350 50 tchain 2"], BATH),
    "npt": ("", [f"fix 1 all npt temp 300 350 50 aniso {P} nreset 7"], [*BATH, "f_1[20]"]),
    "npt tri": (TILT, [f"fix 1 all npt temp 300 350 50 tri {P}"], [*BATH, "f_1[20]"]),
    "npt bias": ("", ["compute t all temp/com", f"fix 1 all npt temp 300 350 50 iso {P}", "fix_modify 1 temp t"], BATH),
    "nph": ("", [f"fix 1 all nph iso {P}"], BATH),
    "nph one": ("", [f"fix 1 all nph x {P}"], BATH),
    "temp/csvr": ("", [NVE, "fix 2 all temp/csvr 300 350 20 77"], ["f_2", "econserve"]),
    "temp/csld": ("", [NVE, "fix 2 all temp/csld 300 350 20 77"], ["f_2", "econserve"]),
    "temp/berendsen": ("", [NVE, "fix 2 all temp/berendsen 300 350 20"], ["f_2", "econserve"]),
    "temp/rescale": ("", [NVE, "fix 2 all temp/rescale 5 300 350 0 1"], ["f_2", "econserve"]),
    "press/berendsen": ("", [NVE, "fix 2 all press/berendsen iso 0 3000 100 modulus 9e3"], ["press", "lx"]),
    "langevin": ("", [NVE, "fix 2 all langevin 300 350 50 77 zero yes"], ["press"]),
    "gjf": ("", ["fix 1 all gjf 300 300 50 77 vel vhalf"], ["pe"]),
    "rigid/nvt": ("", [RIGID, "fix 1 all rigid/nvt molecule temp 300 350 20"], ["f_1", "press", "ecouple"]),
    "rigid/npt": ("", [RIGID, "fix 1 all rigid/npt/small molecule temp 300 400 20 iso 100 50 50"], ["f_1", "press", "vol", "ecouple"]),
    "deform": ("", [NVE, "fix 2 all deform 1 x final 0 11 y scale 1.05 z vel -0.002 units box remap x"], ["lx", "ly", "lz", "press"]),
    "nvt/sllod": (TILT, ["fix 1 all nvt/sllod temp 300 300 50", "fix 2 all deform 1 xy erate 0.0005 remap v"], ["f_1", "xy", "press"]),
    "ti/spring": ("", [NVE, "fix 2 all ti/spring 5.0 15 10"], ["f_2", "f_2[1]", "econserve"]),
    "spring/self": ("", [NVE, "fix 2 all spring/self 3.0"], ["f_2", "pe"]),
    "ave/time": ("", [NVE, "variable t equal temp", "fix 2 all ave/time 2 5 10 v_t"], ["f_2"]),
    "ave/correlate": ("", [NVE, "variable t equal temp", "fix 2 all ave/correlate 2 5 20 v_t type auto"], ["f_2[2][3]"]),
    "store/state": ("", [NVE, "fix 2 all store/state 0 x vy"], []),
    "property/atom": ("fix 3 all property/atom d_a i_b\nset group some d_a 2.5 i_b 3", [NVE, "fix 3 all property/atom d_a i_b"], []),
    "nphug": ("", ["fix 1 all nphug temp 1 1 50 z 5000 5000 100"], [*BATH, "f_1[1]", "f_1[2]"]),
    "msst": ("", ["fix 1 all msst z 0.05 q 25 mu 0.1 tscale 0 p0 -9000"], [*BATH, "f_1[1]", "f_1[2]"]),
}
ANEW = "thermo_modify norm no\n"


def end(text: str, values: list[str], last: str) -> dict:
    """The state after a script."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with ran(text + "\n" + "\n".join(f"variable value{k} equal {f}" for k, f in enumerate(values)) + "\n" + last) as lmp:
            s, fixes = lmp.scene.system, lmp.scene.fixes
            out = {"x": s.box.unwrap(s.x, s.image), "v": s.v.copy(), "box": np.vstack([s.box.origin, s.box.cell]),
                   "values": np.array([lmp.extract_variable(f"value{k}") for k in range(len(values))])}
            out |= {f"own {name}": np.array(array, float) for name, array in s.extra.items()}
            if "2" in fixes and fixes["2"].style == "store/state":
                out["kept"] = fixes["2"].per_atom()
            return out


def assert_same(a: dict, b: dict) -> None:
    assert a.keys() == b.keys()
    for name, array in a.items():
        assert b[name] == pytest.approx(array, rel=1e-9, abs=1e-10 * max(1.0, abs(array).max(initial=0.0))), name


@pytest.mark.parametrize("name", CASES)
def test_goes_on(name, tmp_path):
    """Runs with ``start`` and ``stop``, for ramps and schedules are those of the whole."""
    before, fixes, values = CASES[name]
    write_data(tmp_path / "data")
    lines, run, r = "\n".join(fixes), "run 20 start 0 stop 40", tmp_path / "r"
    head, again = script(tmp_path / "data") + f"{before}\n{lines}\n", f"{ANEW}{lines}\n"
    two = end(head, values, f"{run}\nwrite_restart {r}\n{run}")
    assert_same(two, end(f"read_restart {r}\n{again}", values, run))
    whole = end(head, values, f"restart 20 {r}.*\nrun 40")
    assert_same(whole, end(f"read_restart {r}.20\n{again}", values, run))
