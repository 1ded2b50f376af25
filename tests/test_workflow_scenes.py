"""Workflows that are LAMMPS scripts: small versions give the numbers of their README files, and numbers known from elsewhere."""
from __future__ import annotations

from pathlib import Path

import pytest
from test_workflow_numbers import run
from wheel import ask, ran


def test_ramachandran(tmp_path):
    """The minima of the README file, and where the map of a few copies is lowest."""
    result = run("ramachandran", tmp_path, windows=6, steps=400)
    expected = {"C7eq": (0.0, -81.3, 70.6), "C5": (0.92, -151.4, 170.6), "C7ax": (2.05, 69.7, -67.7)}
    for name, (energy, *angles) in expected.items():
        assert result["minima"][name][0] == pytest.approx(energy, abs=0.006)
        assert result["minima"][name][1:] == pytest.approx(angles, abs=0.2)
    phi, psi = result["lowest"]
    assert phi < -30 and (psi > 30 or psi < -150) and 0 < result["right half"] < 8


def test_peptide_like_lammps():
    """The energies of the script, term by term."""
    folder = Path(__file__).parents[1] / "workflows" / "ramachandran"
    lines = [f"variable folder index {folder}", f"include {folder}/in.peptide", "run 0"]
    words = ["ebond", "eangle", "edihed", "eimp", "evdwl", "ecoul"]
    want = ask("lmp = ran(given['lines'])\nanswer = [lmp.get_thermo(w) for w in given['words']]", lines=lines, words=words)
    lmp = ran(lines)
    assert [lmp.get_thermo(w) for w in words] == pytest.approx(want, rel=1e-12, abs=1e-12)
    lmp.close()
