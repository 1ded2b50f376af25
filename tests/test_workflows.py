"""The workflows run and give the numbers their README files promise, on smaller systems."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import asemd

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = sorted(p.parent.name for p in (ROOT / "workflows").glob("*/run.py"))


def run(name: str, folder: Path, *options: str, picture: str = "melt.png") -> dict:
    env = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1])}
    pytest.importorskip("matplotlib")
    command = [sys.executable, str(ROOT / "workflows" / name / "run.py"), "--folder", str(folder), *options]
    done = subprocess.run(command, env=env, cwd=folder, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert (folder / picture).stat().st_size > 5000
    return json.loads((folder / "result.json").read_text())


def test_polymer_melt(tmp_path):
    result = run("polymer-melt", tmp_path, "--chains", "40", "--beads", "50", "--steps", "5000")
    assert result["temperature"] == pytest.approx(1.0, abs=0.03)
    assert result["bond"] == pytest.approx(0.965, abs=0.002) and result["longest_bond"] < 1.3
    assert result["pressure"] == pytest.approx(4.9, abs=0.2)
    per_bond = np.array(result["internal_distances"]) / np.arange(1, 50)
    assert per_bond[0] == pytest.approx(0.965**2, rel=0.01)
    assert 1.55 < per_bond[9] < 1.95 and 1.2 < per_bond[-1] < 2.5      # 40 chains: their ends scatter by 13 %
    histogram = np.array(result["bond_histogram"])
    assert histogram.sum() * 0.4 / 60 == pytest.approx(1.0, abs=0.02)


def test_polymer_melt_can_be_read_again(tmp_path):
    """What the workflow builds is an ordinary data file."""
    import importlib.util
    spec = importlib.util.spec_from_file_location("polymer_melt", ROOT / "workflows" / "polymer-melt" / "run.py")
    melt = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(melt)
    melt.build(tmp_path / "melt.data", 5, 20)
    atoms = asemd.read(tmp_path / "melt.data")
    assert len(atoms) == 100 and len(atoms.topology.bonds) == 95 and atoms.pbc.all()
    lengths = [atoms.get_distance(i, j, mic=True) for i, j in atoms.topology.bonds]
    assert np.allclose(lengths, 0.97, atol=1e-9)


def test_lj_melt(tmp_path):
    result = run("lj-melt", tmp_path, "--cells", "6", "--steps", "1000")
    assert result["temperature"] == pytest.approx(0.70, abs=0.04) and result["drift"] < 6e-3
    assert result["peak"] == pytest.approx(1.08, abs=0.05) and result["height"] == pytest.approx(3.0, abs=0.4)


@pytest.mark.parametrize("name, expected, methods", [("viscosity", 0.84, 6), ("thermal_conductivity", 3.5, 5)])
def test_transport(tmp_path, name, expected, methods):
    """All routes run; runs of seconds come within a factor of the value, those of minutes stand in docs/transport.md."""
    result = run(name, tmp_path, "--quick", picture=f"{name}.png")
    assert len(result) == methods
    for method, (value, error) in result.items():
        assert 0.2 * expected < value < 4 * expected and error > 0.0, method
    rows = (tmp_path / "result.csv").read_text().splitlines()
    assert len(rows) == 1 + methods + 2 and rows[0].startswith("method") and "+-" in (tmp_path / "result.md").read_text()


def test_statistics_of_transport(tmp_path, monkeypatch):
    """Block errors, gradients between layers and Green-Kubo integrals of data whose answer is known."""
    monkeypatch.syspath_prepend(str(ROOT / "workflows"))
    import transport
    blocks = np.random.default_rng(2).normal(3.0, 0.5, 400)
    mean, error = transport.estimate(blocks)
    assert mean == pytest.approx(blocks.mean()) and error == pytest.approx(blocks.std(ddof=1) / 20)
    assert transport.estimate(blocks, lambda m: 1 / m)[1] == pytest.approx(error / mean**2, rel=0.02)
    for width in (1, 2):        # a tent: up from the lower layers to those in the middle, down again
        z = (np.arange(24) - (width - 1) / 2) % 24
        assert transport.slope(0.3 * np.minimum(z, 24 - z), 48.0, width) == pytest.approx(0.15)
    t = np.arange(0, 400, 4)
    table = "\n".join(f"{k} {s} 1 {np.exp(-s * 0.005 / 0.2)} {np.exp(-s * 0.005 / 0.2)}" for k, s in enumerate(t))
    (tmp_path / "green-kubo.dat").write_text("# a\n" + "".join(f"{b} {len(t)}\n{table}\n" for b in range(4)))
    (value, error), (times, values, _) = transport.green_kubo(tmp_path, 5.0, 1.9)
    assert value == pytest.approx(1.0, rel=2e-3) and error == pytest.approx(0.0, abs=1e-12)
    assert times[-1] == pytest.approx(t[-1] * 0.005) and values[-1] == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize("name", WORKFLOWS)
def test_shape_of_a_workflow(name):
    folder = ROOT / "workflows" / name
    assert (folder / "README.md").exists()
    script = (folder / "run.py").read_text()
    assert len(script.splitlines()) < 100
    assert "import _" not in script and "._" not in script       # public names only


def test_validation(tmp_path):
    """Each input agrees with LAMMPS; a second call compares nothing again."""
    from asemd.testing import oracle
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    result = run("validation", tmp_path, "--steps", "5", picture="validation.png")
    assert [Path(row["parameters"]["path"]).name for row in result] == ["in.melt", "in.mixture", "in.pairs"]
    for row in result:
        assert not row["error"] and row["results"]["agree"] == "yes", row
        assert max(row["results"][k] for k in ("energy", "force", "virial")) < 1e-12 and row["results"]["rows"] < 1e-9, row
