"""Workflows that are LAMMPS scripts: small versions give the numbers of their README files, and numbers known from elsewhere."""
from __future__ import annotations

import pytest
from test_workflow_numbers import run


def test_ramachandran(tmp_path):
    """Minima with CHARMM22: A. D. MacKerell et al., J. Phys. Chem. B 102, 3586 (1998)."""
    pytest.importorskip("MDAnalysis")
    result = run("ramachandran", tmp_path, windows=6, steps=400)
    expected = {"C7eq": (0.0, -81.4, 70.5), "C5": (0.92, -151.4, 170.6), "C7ax": (2.05, 69.7, -67.6)}
    for name, (energy, *angles) in expected.items():
        assert result["minima"][name][0] == pytest.approx(energy, abs=0.006)
        assert result["minima"][name][1:] == pytest.approx(angles, abs=0.5)
    phi, psi = result["lowest"]
    assert phi < -30 and (psi > 30 or psi < -150) and 0 < result["right half"] < 8
