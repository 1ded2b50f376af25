"""Second derivatives of embedded-atom and other many-body potentials."""
from __future__ import annotations

import warnings

import numpy as np
import pytest
from ase.build import bulk
from ase.optimize import BFGS
from ase.units import GPa, second
from test_embedded import potentials, small  # noqa: F401
from test_embedded_calculator import names
from test_hessian import compare, differences

import asemd
from asemd import elastic
from asemd.errors import InputError, InputWarning


def alloy(tmp_path, style, cells=2, seed=2):
    atoms = bulk("Ar", a=4.1, cubic=True) * (cells, cells, cells)
    atoms.rattle(0.15, rng=np.random.default_rng(seed))
    atoms.symbols[::3] = "Kr"
    atoms.calc = asemd.EAM(names(small(tmp_path, style), "Ar", "Kr"), style=style)
    return atoms


@pytest.mark.parametrize("style", ["eam/alloy", "eam/fs"])
def test_embedded_atoms(tmp_path, style):
    compare(alloy(tmp_path, style), tolerance=1e-7, h=2e-6)      # second derivatives of the splines jump


@pytest.mark.parametrize("style", ["adp", "eam/cd"])
def test_others_by_differences(tmp_path, style):
    atoms = alloy(tmp_path, style, 1)
    with pytest.raises(InputError, match=f"no second derivatives of pair style {style}; numerical=True"):
        atoms.calc.get_hessian(atoms)
    got, want = atoms.calc.get_hessian(atoms, numerical=True).toarray(), differences(atoms, 1e-4)
    assert np.abs(got - want).max() < 1e-5 * np.abs(want).max()


def test_phonons_of_copper(potentials):  # noqa: F811
    """The highest frequency of the crystal at rest, from the matrix of a supercell."""
    primitive = bulk("Cu", a=3.615)
    atoms = bulk("Cu", a=3.615, cubic=True) * (4, 4, 4)
    atoms.calc = asemd.EAM.from_file("Cu_mishin1.eam.alloy")
    hessian = atoms.calc.get_hessian(atoms)
    assert np.abs(hessian - hessian.T).max() < 1e-12
    values = np.linalg.eigvalsh(hessian.toarray() / primitive.get_masses()[0])
    assert np.abs(values[:3]).max() < 1e-10 and values[3] > 0.01
    terahertz = np.sqrt(values[-1]) / (2.0 * np.pi) * second * 1e-12
    assert terahertz == pytest.approx(7.82, abs=0.03)      # longitudinal, at the edge of the zone


@pytest.mark.parametrize("style", ["eam/alloy", "eam/fs"])
def test_elastic_constants_analytic_and_by_differences(tmp_path, style):
    """Two kinds of atoms whose places the symmetry does not fix."""
    atoms = bulk("Ar", "hcp", a=3.0, c=4.9)
    atoms.symbols[1] = "Kr"
    atoms.positions[1] += 0.02, 0.03, -0.05
    atoms.calc = asemd.EAM(names(small(tmp_path, style), "Ar", "Kr"), style=style)
    with BFGS(atoms, logfile=None) as optimizer:
        optimizer.run(fmax=1e-7, steps=200)
    born, mixed = elastic._differences(atoms.calc, atoms)
    analytic = elastic._analytic(atoms.calc, atoms)
    np.testing.assert_allclose(analytic[0], born, atol=2e-5 * np.abs(born).max())
    np.testing.assert_allclose(analytic[1], mixed, atol=2e-5 * np.abs(mixed).max())
    still = atoms.calc.get_elastic_constants(atoms, relaxed=False)
    moving = atoms.calc.get_elastic_constants(atoms)
    assert np.linalg.eigvalsh(still - moving).min() > -1e-12 and not np.allclose(still, moving)


def test_elastic_constants_of_copper(potentials):  # noqa: F811
    """Those that the potential was published with, in GPa."""
    atoms = bulk("Cu", a=3.615, cubic=True)
    atoms.calc = asemd.EAM.from_file("Cu_mishin1.eam.alloy")
    c = atoms.calc.get_elastic_constants(atoms) / GPa
    assert c[0, 0] == pytest.approx(169.9, abs=0.6) and c[0, 1] == pytest.approx(122.6, abs=0.6) and c[3, 3] == pytest.approx(76.2, abs=0.6)
    np.testing.assert_allclose(c[3:, :3], 0.0, atol=1e-9)


def test_elastic_constants_of_pairs_and_others(tmp_path):
    atoms = bulk("Ar", a=5.2, cubic=True)
    atoms.calc = asemd.ForceField(pair={"lj/cut 8.5": {("Ar", "Ar"): (0.0104, 3.4)}})
    c = atoms.calc.get_elastic_constants(atoms)
    np.testing.assert_allclose(c, elastic._differences(atoms.calc, atoms)[0] / atoms.get_volume(), atol=1e-6 * c[0, 0])
    other = alloy(tmp_path, "adp", 1)
    with pytest.raises(InputError, match="no second derivatives by strain of pair style adp: numerical=True"):
        other.calc.get_elastic_constants(other)
    assert other.calc.get_elastic_constants(other, relaxed=False, numerical=True).shape == (6, 6)
    atoms.cell = None
    with pytest.raises(InputError, match="a cell with three vectors"):
        atoms.calc.get_elastic_constants(atoms)


@pytest.mark.parametrize("solver", ["ewald 1e-8", "pppm 1e-6"])
def test_crystals_of_ions_by_differences(solver):
    """Second derivatives of a solver are differences of its forces: against differences of all forces, and of stresses."""
    salt = bulk("NaCl", "rocksalt", a=5.6)
    salt.set_initial_charges([1, -1])
    salt.calc = asemd.ForceField(pair={"lj/cut/coul/long 6.0": {("Na", "Na"): (0.01, 2.4), ("Cl", "Cl"): (0.014, 3.6)}}, kspace=solver)
    with pytest.raises(InputError, match=f"kspace_style {solver.split()[0]}; numerical=True"):
        salt.calc.get_hessian(salt)
    with pytest.raises(InputError, match=f"by strain of kspace_style {solver.split()[0]}: numerical=True"):
        salt.calc.get_elastic_constants(salt)
    exact, h = salt.calc.get_hessian(salt, numerical=True).toarray(), 1e-3
    for k in range(3):
        forces = []
        for sign in (1, -1):
            moved = salt.copy()
            moved.positions[0, k] += sign * h
            moved.calc = salt.calc
            forces.append(moved.get_forces())
        column = (forces[1] - forces[0]).ravel() / (2 * h)
        assert np.abs(column - exact[k]).max() < 1e-3 * np.abs(exact).max()
    c, pressure = salt.calc.get_elastic_constants(salt, numerical=True), -salt.get_stress()[0]
    stress = []
    for sign in (1, -1):
        moved = salt.copy()
        moved.calc = salt.calc.copy()
        moved.set_cell(salt.cell.array @ (np.eye(3) + np.diag([sign * h, 0, 0])), scale_atoms=True)
        stress.append(moved.get_stress())
    slope = (stress[0] - stress[1]) / (2 * h)
    assert slope[0] == pytest.approx(c[0, 0] - pressure, rel=1e-3) and slope[1] == pytest.approx(c[0, 1] + pressure, rel=1e-3)


def test_elastic_constants_of_what_is_not_at_rest(tmp_path):
    atoms = bulk("Ar", a=5.2, cubic=True)
    atoms.calc = asemd.ForceField(pair={"lj/cut 8.5": {("Ar", "Ar"): (0.0104, 3.4)}})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atoms.calc.get_elastic_constants(atoms)
    atoms.rattle(0.05, seed=1)
    with pytest.warns(InputWarning, match="forces act, which would move atoms by about 0.*relax"):
        atoms.calc.get_elastic_constants(atoms)
    atoms.pbc = (1, 1, 0)
    with pytest.raises(InputError, match="periodic in all of them, here pbc is 1 1 0"):
        atoms.calc.get_elastic_constants(atoms)
