"""Workflows that are LAMMPS scripts: small versions give the numbers of their README files, and numbers known from elsewhere."""
from __future__ import annotations

from pathlib import Path

import numpy as np
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


def test_solvation(tmp_path):
    """Two programs have the same g(r) of one trajectory; places of first maxima, and hydrogen bonds."""
    result = run("solvation", tmp_path, cells=7, equil=200, steps=500)
    assert result["differs from compute rdf by"] < 0.25 and result["temperature"] == pytest.approx(280, abs=40)      # it was at rest before
    water, oxygen = result["shells"]["water"], result["shells"]["C=O to H of water"]
    assert water["maximum"] == pytest.approx(2.75, abs=0.11) and 2.2 < water["height"] < 3.4 and 1.5 < oxygen["maximum"] < 2.3


def test_glass_transition(tmp_path):
    """A small melt that is cooled fast becomes a glass, which shrinks half as fast; the bend is above that of the README file.

    Two melts of this size scatter, as another processor's last digits do: bend 0.48 with a standard deviation of 0.03, expansion of the
    glass 0.146 with 0.009, of the melt 0.315 with 0.021, density 1.061 with 0.0014 (28 melts).
    """
    result = run("glass-transition", tmp_path, melts=2, chains=20, equil=4000, steps=20000)
    (bend, _), (glass, _), (melt, _), (density, _) = (result[name] for name in
                                                      ("Tg", "expansion of the glass", "expansion of the melt", "density at 0.2"))
    assert 0.35 < bend < 0.61 and 0.11 < glass < 0.183 and 0.23 < melt < 0.40 and glass < 0.75 * melt
    assert density == pytest.approx(1.061, abs=0.008)
    curve = result["curves"][0]
    assert len(curve[0]) > 50 and curve[0][0] == pytest.approx(0.8, abs=0.08) and curve[0][-1] == pytest.approx(0.2, abs=0.03)


def test_melting(tmp_path):
    """The melting line of R. Agrawal and D. A. Kofke (1995), densities of E. A. Mastny and J. J. de Pablo (2007).

    Limits are four standard deviations of twelve such runs: temperature 0.009, densities 0.5 and 0.9 %.
    """
    result = run("melting", tmp_path, cells=4, long=12, equil=1000, steps=4000, start=0.68)
    assert result["T published"] == pytest.approx(0.768, abs=0.001) and result["T"] == pytest.approx(0.78, abs=0.04)
    assert result["pressure"] == pytest.approx(1.0, abs=0.15) and result["conserved to"] < 1e-3
    assert result["crystal"] == pytest.approx(result["crystal published"], rel=0.02)
    assert result["liquid"] == pytest.approx(result["liquid published"], rel=0.045)
    assert result["planes in the crystal"] > max(0.35, 2.5 * result["planes in the liquid"])


def test_stress_strain(tmp_path):
    """Small glasses, stretched ten times faster: stiff before yield and not after it, at constant volume then; their sides are free.

    Limits are four standard deviations of twelve such pairs of glasses: modulus 31.7 with 7, Poisson's ratio 0.40 with 0.04, yield stress
    1.47 with 0.25, flow stress 1.43 with 0.09, volume 0.015 with 0.0024.
    """
    result = run("stress-strain", tmp_path, glasses=2, chains=20, equil=3000, cool=8000, steps=8000)
    modulus, poisson, limit, flow, volume, sides = (result[name][0] for name in ("Young's modulus", "Poisson's ratio", "yield stress",
                                                                                 "flow stress", "volume gained", "stress across"))
    assert 5 < modulus < 60 and 0.24 < poisson < 0.57 and 0.005 < volume < 0.025
    assert 0.5 < limit < 2.5 and 1.0 < flow < 1.9 and abs(sides) < 0.02
    strain, across, *_ = result["curves"][0]
    assert len(strain) == 200 and strain[-1] == pytest.approx(0.25, abs=0.001) and across[-1] == pytest.approx(-0.1, abs=0.015)


def test_network_breaking(tmp_path):
    """No bond breaks until the strands are nearly taut, then those along x do, and the stress falls; the pull is that of the formula."""
    result = run("network-breaking", tmp_path, nodes=3, beads=6, squeeze=2000, equil=1000, steps=10000)
    r = np.linspace(1.0, 1.12, 12001)
    bond = 1200 * (r - 1.3) ** 2 * (r - 0.75) * (r - 1.55) + 4 * (r**-12 - r**-6)
    assert result["strongest bond"] == pytest.approx(np.gradient(bond, r).max(), rel=1e-4)
    taut = result["taut"]
    assert taut == pytest.approx(3 * 7 * 0.97 / (513 / 0.85) ** (1 / 3)) and result["temperature"] == pytest.approx(1.0, abs=0.15)
    ratio, _, broken = np.array(result["curve"])
    assert broken[ratio < 0.75 * taut].max() < 3 and result["first break"] < 1.15 * taut
    assert 0.85 * taut < result["stretch at the peak"] < 1.4 * taut
    assert 0.2 < result["of all strands at once"] < 0.9 and result["last stress"] < 0.65 * result["peak stress"]
    assert 9 <= result["broken along x"] <= result["broken"] < 60 and result["broken along x"] > 0.6 * result["broken"]
