"""ASE's own water models beside the same force fields here: a cluster of rigid molecules in vacuum, turned at random."""
from __future__ import annotations

import numpy as np
import pytest
from ase.calculators import tip3p, tip4p

from asemd import Atoms, ForceField, Topology

FAR = 100.0      # beyond it ASE's models switch charges off
PLACES = np.array([[0.0, 0.0, 0.0], [3.0, 0.3, 0.0], [0.2, 3.1, 0.4], [1.0, 1.0, 3.3]])
RIGID = dict(bond={"zero": {1: (tip3p.rOH,)}}, angle={"zero": {1: (tip3p.angleHOH,)}}, special_bonds="lj/coul 0 0 0")
WITHOUT = {("H", "H"): (0.0, 1.0), ("H", "O"): (0.0, 1.0)}


def cluster(charge: float) -> Atoms:
    rng, n = np.random.default_rng(1), len(PLACES)
    half = np.radians(tip3p.angleHOH) / 2
    arm = tip3p.rOH * np.array([np.sin(half), np.cos(half), 0.0])
    molecule = np.stack([np.zeros(3), arm, arm * [-1, 1, 1]])
    turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in PLACES]
    atoms = Atoms("OH2" * n, np.concatenate([molecule @ turn + place for turn, place in zip(turns, PLACES, strict=True)]),
                  topology=Topology(bonds=[[3 * k, 3 * k + h] for k in range(n) for h in (1, 2)],
                                    angles=[[3 * k + 1, 3 * k, 3 * k + 2] for k in range(n)]))
    atoms.set_initial_charges([-2 * charge, charge, charge] * n)
    return atoms


def test_tip3p():
    atoms, theirs = cluster(tip3p.qH), cluster(tip3p.qH)
    theirs.calc = tip3p.TIP3P(rc=FAR)
    lj = {("O", "O"): (tip3p.epsilon0, tip3p.sigma0), **WITHOUT}
    atoms.calc = ForceField(pair={f"lj/cut {FAR}": lj, f"coul/cut {FAR}": dict.fromkeys(lj, ())}, **RIGID)
    assert atoms.get_potential_energy() == pytest.approx(theirs.get_potential_energy(), rel=1e-12)
    assert atoms.get_forces() == pytest.approx(theirs.get_forces(), abs=1e-13)


def test_tip4p():
    """The site stands at a fixed distance in ASE, at a fixed part of the bisector here: alike in all that moves a rigid molecule."""
    atoms, theirs = cluster(tip4p.qH), cluster(tip4p.qH)
    theirs.calc = tip4p.TIP4P(rc=FAR)
    lj = {("O", "O"): (tip4p.epsilon0, tip4p.sigma0), **WITHOUT}
    atoms.calc = ForceField(pair={f"lj/cut/tip4p/cut 2 1 1 1 0.15 {FAR} {FAR}": lj}, **RIGID)
    assert atoms.get_potential_energy() == pytest.approx(theirs.get_potential_energy(), rel=1e-12)
    arms = atoms.positions.reshape(-1, 3, 3) - PLACES[:, None]
    for f, g in zip(atoms.get_forces().reshape(-1, 3, 3), theirs.get_forces().reshape(-1, 3, 3), strict=True):
        assert f.sum(axis=0) == pytest.approx(g.sum(axis=0), abs=1e-12)
    ours, torques = (np.cross(arms, a.get_forces().reshape(-1, 3, 3)).sum(axis=1) for a in (atoms, theirs))
    assert ours == pytest.approx(torques, abs=1e-12)
