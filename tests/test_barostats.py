"""Barostats driven from ASE: the cell follows, runs in pieces are one run."""
from __future__ import annotations

import numpy as np
import pytest
from ase import units
from test_dynamics import hot_argon

from asemd import MolecularDynamics
from asemd.fix.npt import NPT


def barostat(shape="aniso"):
    return NPT(temperature=80.0, damping=100 * units.fs, pressure=0.0, pressure_damping=500 * units.fs, shape=shape)


def test_the_cell_follows():
    """Positions, cell and energy belong together, and the corner of the cell stays."""
    atoms = hot_argon()
    before = atoms.cell.array.copy()
    MolecularDynamics(atoms, 2 * units.fs, [barostat()]).run(40)
    assert abs(atoms.cell.array - before).max() > 1e-3
    other = hot_argon()
    other.set_cell(atoms.cell)
    other.positions = atoms.positions
    assert atoms.get_potential_energy() == pytest.approx(other.get_potential_energy(), rel=1e-10)
    assert atoms.get_stress() == pytest.approx(other.get_stress(), abs=1e-10)


def test_runs_in_pieces_continue():
    results = []
    for pieces in ((40,), (15, 25)):
        atoms = hot_argon()
        dynamics = MolecularDynamics(atoms, 2 * units.fs, [barostat()])
        for steps in pieces:
            dynamics.run(steps)
        results.append(np.vstack([atoms.positions, atoms.cell.array]))
    assert abs(results[0] - results[1]).max() < 1e-9
