"""Wrapping, shortest images and LAMMPS's frame, for any box."""
from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from asemd.box import Box
from asemd.errors import InputError, SimulationError

number = st.floats(-50, 50, allow_subnormal=False)
pbc = st.lists(st.booleans(), min_size=3, max_size=3)


@st.composite
def boxes(draw):
    cell = draw(arrays(float, (3, 3), elements=st.floats(-9, 9)))
    lengths = np.linalg.norm(cell, axis=1)
    assume((lengths > 0.5).all() and abs(np.linalg.det(cell)) > 0.05 * lengths.prod())
    if draw(st.booleans()):
        cell = np.diag(lengths)
    return Box(draw(arrays(float, 3, elements=number)), cell, ["pp" if p else "ff" for p in draw(pbc)])


@given(boxes(), arrays(float, (5, 3), elements=st.floats(-1e4, 1e4)))
@example(Box(np.array([0.0, 0.0, 1.0]), 3.0 * np.array([[0, 1, 1], [1, 1, 0], [1, 1, 1]]), ["pp", "ff", "pp"]), np.zeros((5, 3)))
def test_wrap_puts_atoms_inside_and_image_flags_lead_back(box, x):
    new, image = x.copy(), np.zeros(x.shape, np.int32)
    box.wrap(new, image)
    p = box.periodic
    s = box.fractional(new)[:, p]
    assert (s >= 0).all() and (s < 1).all()
    assert not image[:, ~p].any()
    np.testing.assert_allclose(box.unwrap(new, image), x, atol=1e-8)
    again = new.copy()
    box.wrap(again, image)
    assert np.array_equal(again, new), "a wrapped atom stays where it is"


@given(st.floats(-40, 40), st.floats(0.5, 30), st.floats(-1e3, 1e3))
def test_aligned_box_ends_in_lo_hi_exactly(lo, length, at):
    box = Box.from_lammps([lo] * 3, [lo + length] * 3)
    x, image = np.array([[at, lo, np.nextafter(lo, -np.inf)]]), np.zeros((1, 3), np.int32)
    box.wrap(x, image)
    assert (x >= box.lo).all() and (x < box.hi).all()


@pytest.mark.parametrize("far", [10**6, -10**6, 3 * 10**6 + 1])
def test_digits_survive_a_million_boxes(far):
    length, place = 10.1, 3.7
    x0 = place + far * length
    box = Box.from_lammps([0, 0, 0], [length] * 3)
    x, image = np.array([[x0, 1.0, 1.0]]), np.zeros((1, 3), np.int32)
    box.wrap(x, image)
    exact = float(Fraction(x0) - far * Fraction(length))
    assert image[0, 0] == far
    assert abs(x[0, 0] - exact) <= np.spacing(abs(x0))
    tilted = Box.from_lammps([0, 0, 0], [length] * 3, (3.0, 1.0, -2.0))
    x, image = np.array([[x0, 1.0, 1.0]]), np.zeros((1, 3), np.int32)
    tilted.wrap(x, image)
    assert image[0, 0] == far
    assert abs(x[0, 0] - exact) <= 4 * np.spacing(abs(x0))


def test_wrap_keeps_what_lammps_keeps():
    """An atom a rounding below lo goes to lo, not one image away; an atom at hi goes to lo of the next image."""
    box = Box.from_lammps([0, 0, 0], [10, 10, 10])
    x, image = np.array([[-1e-17, 10.0, 30.0]]), np.zeros((1, 3), np.int32)
    box.wrap(x, image)
    assert x.tolist() == [[0, 0, 0]] and image.tolist() == [[0, 1, 3]]


def test_wrap_names_the_atom_that_is_not_finite():
    box = Box.from_lammps([0, 0, 0], [10, 10, 10])
    with pytest.raises(SimulationError, match="row 1"):
        box.wrap(np.array([[0, 0, 0], [0, np.nan, 0]]), np.zeros((2, 3), np.int32))
    with pytest.raises(SimulationError, match="row 1 is 1e\\+299 boxes away"):
        box.wrap(np.array([[0, 0, 0], [0, 1e300, 0]]), np.zeros((2, 3), np.int32))


@settings(max_examples=60)
@given(boxes(), arrays(float, (4, 3), elements=st.floats(-30, 30)))
def test_minimum_image_is_the_shortest_of_many(box, d):
    near, shift = box.minimum_image(d)
    np.testing.assert_allclose(near, d + shift @ box.cell, atol=1e-9)
    assert not shift[:, ~box.periodic].any()
    around = np.array(list(itertools.product(*(range(-3, 4) if p else (0,) for p in box.periodic))))
    best = np.linalg.norm(near[:, None] + around @ box.cell, axis=2).min(axis=1)
    np.testing.assert_allclose(np.linalg.norm(near, axis=1), best, rtol=1e-9, atol=1e-9)


def test_minimum_image_of_a_strongly_tilted_box():
    box = Box.from_lammps([0, 0, 0], [10, 10, 10], (95.0, -63.0, 41.0))
    d = np.random.default_rng(1).uniform(-200, 200, (50, 3))
    near, _ = box.minimum_image(d)
    reference = Box.from_lammps([0, 0, 0], [10, 10, 10], (-5.0, -3.0, 1.0))     # the same lattice, reduced
    back = reference.minimum_image(d)[0]
    grid = np.array(list(itertools.product(range(-2, 3), repeat=3))) @ reference.cell
    want = np.linalg.norm(back[:, None] + grid, axis=2).min(axis=1)
    np.testing.assert_allclose(np.linalg.norm(near, axis=1), want, rtol=1e-12)


@given(boxes())
def test_to_lammps_keeps_the_shape(box):
    other, rotation = box.to_lammps()
    assert other.is_lammps_frame and other.boundary == box.boundary
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(box.cell @ rotation, other.cell, atol=1e-10)
    assert other.volume == pytest.approx(box.volume)
    assert np.sign(np.linalg.det(rotation)) == np.sign(np.linalg.det(box.cell))


def test_from_lammps():
    box = Box.from_lammps([-1, 0, 2], [9, 20, 5], (1, 2, 3), ("p", "fs", "mm"))
    assert box.lo.tolist() == [-1, 0, 2] and box.hi.tolist() == [9, 20, 5] and box.tilt.tolist() == [1, 2, 3]
    assert box.boundary == ("pp", "fs", "mm") and box.periodic.tolist() == [True, False, False]
    assert box.triclinic and box.is_lammps_frame and box.volume == pytest.approx(600)
    assert Box.from_lammps([0] * 3, [1] * 3).triclinic is False
    assert Box.from_lammps([0] * 3, [1] * 3, triclinic=True).triclinic is True


@pytest.mark.parametrize(("call", "word"), [
    (lambda: Box.from_lammps([0, 0, 0], [1, 0, 1]), "ylo"),
    (lambda: Box([0, 0, 0], [[1, 0, 0], [2, 0, 0], [0, 0, 1]]), "volume"),
    (lambda: Box([0, 0, 0], np.eye(3), ("pf", "pp", "pp")), "both faces"),
    (lambda: Box([0, 0, 0], np.eye(3), ("pp", "pp", "q")), "p f s m"),
    (lambda: Box([0, np.nan, 0], np.eye(3)), "NaN"),
    (lambda: Box.from_ase(np.zeros((3, 3)), [True, False, False]), "vector a is zero"),
    (lambda: Box([0, 0, 0], [[0, 1, 0], [1, 0, 0], [0, 0, 1]]).lo, "frame"),
])
def test_errors(call, word):
    with pytest.raises(InputError, match=word):
        call()


@given(arrays(float, (6, 3), elements=number), st.integers(0, 7), arrays(float, (3, 3), elements=st.floats(-9, 9)))
def test_missing_ase_vectors_are_completed_around_the_atoms(x, which, cell):
    missing = np.array([which & 1, which & 2, which & 4], bool)
    lengths = np.linalg.norm(cell, axis=1)
    assume((lengths > 0.5).all() and abs(np.linalg.det(cell)) > 0.05 * lengths.prod())
    given_cell = np.where(missing[:, None], 0.0, cell)
    box = Box.from_ase(given_cell, ~missing, positions=x)
    assert np.array_equal(box.cell[~missing], cell[~missing])
    assert box.periodic.tolist() == (~missing).tolist()
    s = box.fractional(x)[:, missing]
    assert (s > -1e-9).all() and (s < 1 + 1e-9).all()


def test_no_cell_at_all_gives_an_aligned_box():
    box = Box.from_ase(np.zeros((3, 3)), False, positions=[[0, 0, 0], [1, 5, 2]])
    assert box.aligned and box.boundary == ("ss", "ss", "ss")


def test_shrink_wrap_like_lammps():
    x = np.array([[1.0, 1, 1], [9, 9, 9]])
    box = Box.from_lammps([0, -2, 0], [10, 18, 10], boundary=("s", "m", "f")).shrink_wrapped(x)
    np.testing.assert_allclose([box.lo, box.hi], [[0.999, -2, 0], [9.001, 18, 10]], rtol=0, atol=1e-14)
    box = Box.from_lammps([0, -2, 0], [10, 18, 10], boundary=("fs", "sm", "p")).shrink_wrapped(x)
    np.testing.assert_allclose([box.lo, box.hi], [[0, 0.998, 0], [9.001, 18, 10]], rtol=0, atol=1e-14)
    moved = box.shrink_wrapped(x + [0, 12, 0])
    np.testing.assert_allclose([moved.lo, moved.hi], [[0, 12.998, 0], [9.001, 21.002, 10]], rtol=0, atol=1e-13)
