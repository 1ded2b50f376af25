"""Ensembles: the workflow that judges them in its quick form, and Langevin dynamics at large friction."""
from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import config

import asemd

WORKFLOW = Path(__file__).resolve().parents[1] / "workflows" / "ensembles"
compiled = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="too slow without the compiler")


@pytest.fixture
def module(monkeypatch):
    """A module of the workflow by its name."""
    monkeypatch.syspath_prepend(str(WORKFLOW))
    return importlib.import_module


def run(folder: Path, *options: str) -> dict:
    for name in ("matplotlib", "physical_validation"):
        pytest.importorskip(name)
    env = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1])}
    done = subprocess.run([sys.executable, str(WORKFLOW / "run.py"), "--folder", str(folder), *options], env=env, cwd=folder,
                          capture_output=True, text=True, timeout=7200)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    for name in ("kinetic.png", "ratios.png"):
        assert (folder / name).stat().st_size > 5000
    result = json.loads((folder / "result.json").read_text())
    lines = (folder / "results.md").read_text().splitlines()
    assert len(lines) == len(result["kinetic"]) + len(result["ratios"]) + 5
    assert len((folder / "kinetic.csv").read_text().splitlines()) == len(result["kinetic"]) + 1
    return result


@compiled
def test_three_ensembles_of_a_liquid(tmp_path):
    result = run(tmp_path, "--quick", "--processes", "1")
    for row in result["kinetic"]:
        # the spread of a right width is known beforehand; that of a width which came out small would be too small itself
        off = abs(row["T of width"] / row["T"] - 1) * np.sqrt(2 * row["samples"])
        wrong = max(off, row["off mean"]) > 3.5 or row["p"] < 2e-4
        assert wrong == row["control"], row         # the thermostat that is known to be wrong is found out
        assert row["T of mean"] == pytest.approx(row["T"], rel=0.02) and row["samples"] > 40
    for row in result["ratios"]:
        assert row["ok"] and row["slope"] == pytest.approx(1.0, abs=4 * row["error"]), row


@compiled
@pytest.mark.slow
def test_every_ensemble(tmp_path):
    """Three quarters of an hour of processor time: ``pytest -m slow tests/test_ensembles.py``."""
    result = run(tmp_path)
    wrong = [row for row in result["kinetic"] + result["ratios"] if not row["ok"] and not row["control"]]
    assert not wrong and any(not row["ok"] for row in result["kinetic"] if row["control"])


@compiled
@pytest.mark.parametrize("scheme", ["baoab", "gjf"])
@pytest.mark.parametrize("friction", [0.2, 2.0])
def test_large_friction_keeps_both_temperatures(module, scheme, friction):
    """Oscillators with omega dt = 0.1: positions within 2 %, velocities within 1 % of the bath."""
    positions, velocities = module("splitting").oscillators(scheme, friction, frames=60)
    assert positions == pytest.approx(1.0, abs=0.02) and velocities == pytest.approx(1.0, abs=0.01)


@compiled
@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["baoab", "gjf"])
def test_large_friction_in_a_liquid(module, scheme):
    """Means of 100 frames of the configurational temperature scatter by more than 1 %."""
    positions, velocities = module("splitting").liquid(scheme, 2.0, frames=1500)
    assert positions == pytest.approx(1.0, abs=0.02) and velocities == pytest.approx(1.0, abs=0.01)


@compiled
def test_what_the_temperature_of_positions_is_made_of(module):
    """Gradient and Laplacian of two spheres, against differences of the energy."""
    import numpy as np
    x, h = np.array([[1.0, 1.0, 1.0], [1.5, 1.8, 1.2]]), 1e-4

    def energy(place):
        s6 = ((x[0] - place) ** 2).sum() ** -3
        return 4.0 * (s6 * s6 - s6)
    shifts = h * np.eye(3)
    gradient = [(energy(x[1] + s) - energy(x[1] - s)) / (2 * h) for s in shifts]
    laplacian = sum(energy(x[1] + s) - 2 * energy(x[1]) + energy(x[1] - s) for s in shifts) / h**2
    square, twice = module("splitting").curvature(x, 10.0, 1.122)
    assert square == pytest.approx(2 * np.dot(gradient, gradient), rel=1e-6) and twice == pytest.approx(2 * laplacian, rel=1e-5)


def test_jackknife_over_blocks(module):
    """Of correlated records of known distributions: the slope is found, and its error is that of repeated records."""
    import numpy as np
    pytest.importorskip("physical_validation")
    checks, rng, found = module("checks"), np.random.default_rng(5), []
    for _ in range(40):
        first, second = (np.repeat(rng.normal(mean, 2.0, 300), 5) for mean in (0.0, 2.0))      # five equal rows: each counts once
        found.append((checks.likelihood(first, second), checks.jackknife(first, second)))
    slopes, errors = np.array(found).T
    assert slopes.mean() == pytest.approx(0.5, abs=4 * slopes.std() / 40**0.5)
    assert errors.mean() == pytest.approx(slopes.std(), rel=0.4)


@pytest.mark.parametrize("liquid, kind", [("LJ liquid", "nvt"), ("rigid water", "shake + nvt"), ("flexible water", "nvt"),
                                          ("polymer melt", "nvt"), ("rigid water", "rigid/nvt/small")])
def test_degrees_of_freedom(module, tmp_path, liquid, kind):
    """What the workflow counts by hand is what compute temp divides by."""
    run, systems, dynamics = module("dynamics").Run(liquid, kind), module("systems"), module("dynamics").DYNAMICS[kind]
    with module("asemd.lammps").Lammps(cmdargs=["-screen", "none", "-log", "none", *systems.prepare(liquid, tmp_path)]) as lmp:
        lmp.file(str(WORKFLOW / systems.LIQUIDS[liquid].script))
        lmp.command("velocity all create 1.0 4711")
        lmp.commands_list(dynamics.commands.format(T=1.0, damp=1.0).split("; "))
        lmp.command("run 0 post no")
        found = lmp.get_thermo("ke") * (lmp.get_natoms() if liquid in ("LJ liquid", "polymer melt") else 1)     # lj: energies per atom
        boltz = module("asemd.units").get(systems.LIQUIDS[liquid].units).boltz
        assert found == pytest.approx(0.5 * run.freedom * boltz * lmp.get_thermo("temp"), rel=1e-9)
