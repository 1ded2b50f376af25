"""Slabs in boxes whose base is no rectangle: the same energy, forces and pressure as in a rectangular box of twice the size."""
from __future__ import annotations

import ase
import numpy as np
import pytest
from wheel import ask, ran

import asemd
from asemd.errors import InputError

EDGE, HEIGHT = 9.0, 14.0
A, B = np.array([EDGE, 0.0, 0.0]), np.array([0.5 * EDGE, 0.75**0.5 * EDGE, 0.0])
HEXAGONAL = f"prism 0 {EDGE} 0 {B[1]} 0 {HEIGHT} {B[0]} 0 0"
RECTANGLE = f"block 0 {EDGE} 0 {2 * B[1]} 0 {HEIGHT}"


def charges(n: int = 10) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    s, q = rng.uniform(0.02, 0.98, (n, 2)), rng.uniform(-1.0, 1.0, n)
    return s[:, :1] * A + s[:, 1:] * B + np.outer(rng.uniform(3.0, 9.0, n), [0.0, 0.0, 1.0]), q - q.mean()


def lines(box: str, x, q, solver: str, modify: str = "slab 3.0", accuracy: str = "1e-5") -> list[str]:
    pair = "lj/long/coul/long cut long 5" if "disp" in solver else "coul/long 5"
    return ["units real", "atom_style charge", "boundary p p f", "box tilt large", f"region r {box}", "create_box 1 r",
            *(f"create_atoms 1 single {a} {b} {c}" for a, b, c in x), "mass 1 10",
            *(f"set atom {k} charge {c}" for k, c in enumerate(q, 1)),
            f"pair_style {pair}", "pair_coeff * * " + "0.1 1.0" * ("disp" in solver), "pair_modify table 0",
            f"kspace_style {solver} {accuracy}",
            f"kspace_modify {modify} gewald 0.45", "thermo_modify norm no", "run 0"]


def measured(lmp):
    pressure = [lmp.get_thermo(k) for k in ("pxx", "pyy", "pzz", "pxy")]
    return lmp.get_thermo("elong"), np.array(pressure), np.array(lmp.gather_atoms("f", 1, 3)).reshape(-1, 3)


@pytest.mark.parametrize("solver, accuracy, near", [("ewald", "1e-7", 1e-10), ("ewald/disp", "1e-7", 1e-10), ("pppm", "1e-6", 2e-5)])
def test_hexagonal_base(solver, accuracy, near):
    """Sums over all waves that matter agree to round-off, meshes, which differ, to the accuracy."""
    x, q = charges()
    double = np.vstack([x, x + B])
    double[:, :2] %= [EDGE, 2 * B[1]]
    energy, pressure, forces = measured(ran(lines(HEXAGONAL, x, q, solver, accuracy=accuracy)))
    twice, same, as_before = measured(ran(lines(RECTANGLE, double, np.tile(q, 2), solver, accuracy=accuracy)))
    assert energy == pytest.approx(0.5 * twice, rel=near)
    np.testing.assert_allclose(forces, as_before[:len(x)], atol=near * np.abs(forces).max())
    np.testing.assert_allclose(pressure, same, atol=10.0 * near * np.abs(same).max())


@pytest.mark.parametrize("modify", ["slab 3.0", "slab nozforce"])
def test_ewald_disp_has_the_numbers_of_lammps(modify):
    x, q = charges()
    script = lines(HEXAGONAL, x, q, "ewald/disp", modify)
    want = ask("lmp = ran(given['lines'])\nanswer = [lmp.get_thermo(k) for k in ('elong', 'pxx', 'pyy', 'pzz', 'pxy')] "
               "+ list(lmp.gather_atoms('f', 1, 3))", lines=script)
    energy, pressure, forces = measured(ran(script))
    assert [energy, *pressure] == pytest.approx(want[:5], rel=1e-9)
    np.testing.assert_allclose(forces.ravel(), want[5:], atol=1e-9 * np.abs(forces).max())


def test_from_ase():
    """A slab on a hexagonal cell; forces are the gradient."""
    x, q = charges()
    atoms = ase.Atoms("X10", positions=x, cell=[A, B, [0.0, 0.0, HEIGHT]], pbc=(True, True, False), masses=np.ones(10))
    atoms.set_initial_charges(q)
    atoms.calc = asemd.ForceField(pair={"coul/long 5.0": {("X", "X"): ()}}, kspace="pppm 1e-5",
                                  kspace_modify="slab 3.0 gewald 0.45 mesh 24 24 80")
    force, h = atoms.get_forces()[3, 2], 1e-3
    energies = []
    for step in (-h, h):
        moved = atoms.copy()
        moved.calc = atoms.calc
        moved.positions[3, 2] += step
        energies.append(moved.get_potential_energy())
    assert force == pytest.approx((energies[0] - energies[1]) / (2.0 * h), rel=1e-3)


def test_vectors_across_the_slab_must_stand_upright():
    x, q = charges()
    with pytest.raises(InputError, match="third box vector along z"):
        ran(lines(HEXAGONAL.replace(" 0 0", " 1 0"), x, q, "ewald"))
