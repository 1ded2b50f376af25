"""Both neighbour lists against a brute-force sum over all images, in cells made to break them."""
from __future__ import annotations

import itertools

import numpy as np
import pytest
from brute import CELLS, PAIRS, PERIODIC, engine_of, errors, make, scattered
from hypothesis import given, settings
from hypothesis import strategies as st

from asemd.engine import Engine, Settings
from asemd.errors import SimulationError
from asemd.forcefield import Interactions
from asemd.kernels import columns
from asemd.neighbor import image_shifts

ATOMS = {"flat": 30, "tiny": 3, "tiny and tilted": 3}


@pytest.mark.parametrize("mode", ["cluster", "plain"])
@pytest.mark.parametrize("name", CELLS)
def test_cells(name, mode):
    rng = np.random.default_rng(5)
    cell, seen = CELLS[name], set()
    for periodic in PERIODIC if name in ("orthogonal", "tiny", "tiny and tilted") else PERIODIC[-1::-3]:
        origin = rng.normal(0, 3, 3)
        system = make(scattered(ATOMS.get(name, 60), cell, origin, rng), cell, periodic, rng, origin)
        engine, error = errors(system, mode)
        seen.add(engine.mode)
        assert error < 1e-12, periodic
    assert mode in seen or name.startswith("tiny") or name in ("flat", "strongly tilted")


@given(st.integers(1, 40), st.integers(1, 40))
def test_columns_are_numbered_once(nx, ny):
    numbers = [columns.column(a, b, nx, ny) for a in range(nx) for b in range(ny)]
    assert sorted(numbers) == list(range(nx * ny))
    assert [columns.stands(c, nx, ny) for c in numbers] == list(itertools.product(range(nx), range(ny)))


@pytest.mark.parametrize("threads", [1, 3])
def test_a_plate_of_many_strips(threads):
    rng = np.random.default_rng(8)
    cell = np.diag([10.0, 44.0, 2.5])
    system = make(scattered(880, cell, 0, rng), cell, (True, True, False), rng)
    engine, error = errors(system, "cluster", threads=threads)
    assert engine.list.ny > 2 * columns.STRIP and error < 1e-12


@pytest.mark.parametrize("threads", [2, 3])
@pytest.mark.parametrize("mode", ["cluster", "plain"])
def test_threads_agree(mode, threads):
    rng = np.random.default_rng(6)
    system = make(scattered(100, CELLS["triclinic"], 0, rng), CELLS["triclinic"], (True, True, True), rng)
    _, error = errors(system, mode, threads=threads)
    assert error < 1e-12


@pytest.mark.parametrize("mode", ["cluster", "plain"])
@pytest.mark.parametrize("n", [0, 1, 2, 7, 8, 9, 17, 64, 65])
def test_numbers_of_atoms(n, mode):
    rng = np.random.default_rng(n)
    for periodic in ((True, True, True), (False, True, False)):
        system = make(scattered(n, np.eye(3) * 4.2, 1.5, rng), np.eye(3) * 4.2, periodic, rng, (1.5, 1.5, 1.5))
        assert errors(system, mode)[1] < 1e-12


@pytest.mark.parametrize("mode", ["cluster", "plain"])
def test_all_atoms_in_a_corner_of_a_large_box(mode):
    rng = np.random.default_rng(2)
    x = np.concatenate([scattered(30, np.eye(3) * 3.5, -1.7, rng), scattered(2, np.eye(3) * 2, 60, rng)])
    for periodic in ((True, True, True), (False, False, False), (True, False, True)):
        assert errors(make(x, np.eye(3) * 100.0, periodic, rng), mode)[1] < 1e-12


@pytest.mark.parametrize("mode", ["cluster", "plain"])
def test_sparse_gas(mode):
    rng = np.random.default_rng(3)
    x = scattered(40, np.eye(3) * 200.0, 0, rng)
    assert errors(make(np.concatenate([x, x[:5] + 0.9]), np.eye(3) * 200.0, (True, True, True), rng), mode)[1] < 1e-12


@pytest.mark.parametrize("periodic", [(True, True, True), (False, False, False)])
def test_empty_space_makes_no_cell_larger(periodic):
    """Columns of a drop are about as narrow with an atom far away in a box of 10^9 times its volume as without."""
    rng = np.random.default_rng(8)
    drop = scattered(300, np.eye(3) * 9.0, 0, rng)
    widths = []
    for x, length in ((drop, 12.0), (np.concatenate([drop, [[9e3, 8e3, 7e3]]]), 1e4)):
        system = make(x, np.eye(3) * length, periodic, rng)
        engine, plain = engine_of(system, "cluster"), engine_of(system, "plain")
        forces = plain.compute().forces.copy()
        assert engine.mode == "cluster" and np.abs(engine.compute().forces - forces).max() < 1e-12 * np.abs(forces).max()
        widths.append(engine.list.bins.widths[:2] / (engine.list.nx, engine.list.ny))
    assert (widths[1] < 5.0 * widths[0]).all()


@pytest.mark.parametrize("mode", ["cluster", "plain"])
def test_slab_in_vacuum(mode):
    rng = np.random.default_rng(4)
    cell = np.diag([5.0, 5.0, 40.0])
    x = scattered(60, np.diag([5.0, 5.0, 3.0]), (0, 0, 18.0), rng)
    for periodic in ((True, True, False), (True, True, True)):
        assert errors(make(x, cell, periodic, rng), mode)[1] < 1e-12


@pytest.mark.parametrize("mode", ["cluster", "plain"])
def test_slab_in_a_tilted_cell_with_vacuum(mode):
    """Only part of a tilted, non-periodic direction is filled; periodic images stay what they are."""
    rng = np.random.default_rng(4)
    for name in ("triclinic", "most negative tilt", "left-handed"):
        for k in range(3):
            x = scattered(60, CELLS[name], 0, rng)
            cell = CELLS[name] * np.where(np.arange(3) == k, 3.0, 1.0)[:, None]
            assert errors(make(x, cell, np.arange(3) != k, rng), mode)[1] < 1e-12, (name, k)


@pytest.mark.parametrize("mode", ["cluster", "plain"])
@pytest.mark.parametrize("name", ["orthogonal", "triclinic", "rotated"])
def test_atoms_on_faces_and_outside(name, mode):
    """Lattice sites on all faces, edges and corners, and the same atoms moved by whole cell vectors."""
    rng, cell, origin = np.random.default_rng(7), CELLS[name], np.array([0.3, -0.7, 11.0])
    s = np.array(list(itertools.product(np.arange(5) / 5, repeat=3)))[:100]
    s = np.where(rng.random((100, 1)) < 0.5, s, s + rng.integers(-3, 4, s.shape))
    assert errors(make(s @ cell + origin, cell, (True, True, True), rng, origin), mode)[1] < 3e-12


@pytest.mark.parametrize("mode", ["cluster", "plain"])
def test_two_dimensions(mode):
    """The third direction is not periodic in forces, whatever its boundary."""
    rng = np.random.default_rng(9)
    grid = np.array(list(itertools.product(range(9), repeat=2)), float)
    x = np.column_stack([grid + rng.uniform(-0.1, 0.1, grid.shape), np.zeros(81)])
    system = make(x, np.diag([9.0, 9.0, 1.0]), (True, True, True), rng, (0, 0, -0.5), dimension=2)
    engine, error = errors(system, mode, periodic=(True, True, False))
    assert error < 1e-12 and np.all(system.f[:, 2] == 0)
    assert engine.mode == mode


def test_the_mode_follows_size_and_width():
    rng = np.random.default_rng(1)
    for n, length, mode in ((31, 8.0, "plain"), (32, 8.0, "cluster"), (40, 2.1, "cluster"), (40, 2.0, "plain")):
        system = make(scattered(n, np.eye(3) * length, 0, rng), np.eye(3) * length, (True,) * 3, rng)
        engine = Engine(system, Interactions.build(pair=PAIRS))
        assert engine.mode == mode, engine.why


@settings(max_examples=25, derandomize=True, deadline=None)
@given(st.integers(0, 2**31), st.floats(0.2, 12.0), st.floats(0.2, 8.0), st.floats(-3.0, 3.0), st.integers(1, 40), st.integers(0, 7))
def test_any_cell(seed, a, b, tilt, n, pbc):
    """Random cells of all shapes with atoms at least a little apart, both lists."""
    rng = np.random.default_rng(seed)
    cell = np.diag([max(a, 1.0), max(b, 1.0), 4.0]) + np.tril(rng.uniform(-1, 1, (3, 3)) * tilt, -1)
    cell = cell[rng.permutation(3)] @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    periodic = tuple(bool(pbc >> k & 1) for k in range(3))
    volume = abs(np.linalg.det(cell))
    n = max(1, min(n, int(volume / 1.5)))
    for mode in ("cluster", "plain"):
        system = make(scattered(n, cell, 0, np.random.default_rng(seed)), cell, periodic, np.random.default_rng(seed))
        assert errors(system, mode)[1] < 1e-10


def test_image_shifts_and_their_opposites():
    vectors, opposite = image_shifts(CELLS["tiny and tilted"], np.array([True, False, True]), 2.0)
    assert np.allclose(vectors[0], 0) and opposite[0] == 0
    assert np.allclose(vectors[opposite], -vectors)
    assert np.allclose((vectors @ np.linalg.inv(CELLS["tiny and tilted"]))[:, 1], 0)


def test_position_that_is_not_a_number_is_named():
    rng = np.random.default_rng(1)
    system = make(scattered(40, np.eye(3) * 6, 0, rng), np.eye(3) * 6, (True,) * 3, rng)
    system.id = system.id + 100
    system.x[16, 1] = np.nan
    with pytest.raises(SimulationError, match="atom 117: position is not finite"):
        Engine(system, Interactions.build(pair=PAIRS), Settings()).compute()


def test_a_list_is_kept_while_nobody_moves_by_half_the_skin():
    rng = np.random.default_rng(1)
    system = make(scattered(300, np.eye(3) * 8, 0, rng), np.eye(3) * 8, (True,) * 3, rng)
    x = system.x.copy()
    engine = Engine(system, Interactions.build(pair=PAIRS), Settings(skin=0.4))
    engine.move(x)
    for shift, builds in ((0.19, 1), (0.21, 2), (0.39, 2), (-0.1, 3)):
        y = x.copy()
        y[5, 0] += shift
        engine.move(y)
        assert engine.builds == builds, shift
        again = Engine(make(y, np.eye(3) * 8, (True,) * 3, rng), Interactions.build(pair=PAIRS), Settings())
        again.system.type, again.system.q = system.type, system.q
        again.update(again.system)
        assert np.allclose(engine.collect().forces, again.compute().forces, atol=1e-9)
