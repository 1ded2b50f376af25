"""Lattices: spacings, orientation, mistakes."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd

from asemd.errors import InputError
from asemd.lattice import BASIS, Lattice

# spacings LAMMPS prints, with 8 digits
SPACINGS = [
    ("lj", 3, "none 2.0", "2 2 2"),
    ("lj", 3, "sc 0.8442", "1.0580793 1.0580793 1.0580793"),
    ("lj", 3, "bcc 0.8442", "1.3330964 1.3330964 1.3330964"),
    ("lj", 3, "fcc 0.8442", "1.6795962 1.6795962 1.6795962"),
    ("lj", 3, "hcp 0.8442", "1.1876539 2.0570768 1.9394306"),
    ("lj", 3, "diamond 0.8442", "2.1161586 2.1161586 2.1161586"),
    ("metal", 3, "hcp 3.52", "3.52 6.0968188 5.7481359"),
    ("lj", 2, "sq 0.8442", "1.0883719 1.0883719 1.0883719"),
    ("lj", 2, "sq2 0.8442", "1.5391903 1.5391903 1.5391903"),
    ("lj", 2, "hex 0.8442", "1.1695317 2.0256884 1.1695317"),
    ("metal", 3, "fcc 3.52 orient x 1 1 0 orient y -1 1 0 orient z 0 0 1 origin 0.1 0.2 0.3", "4.9780317 4.9780317 3.52"),
    ("metal", 3, "fcc 3.52 orient x 1 1 1 orient y 1 -1 0 orient z 1 1 -2 spacing 1 2 3", "3.52 7.04 10.56"),
    ("metal", 3, "custom 3.52 a1 1 0 0 a2 0.5 1 0 a3 0 0 0.5 basis 0 0 0 basis .5 .5 .5", "5.28 3.52 1.76"),
    ("lj", 3, "custom 0.8 a1 1 0 0 a2 0.5 1 0 a3 0 0 0.5 basis 0 0 0 basis .5 .5 .5", "2.5649639 1.7099759 0.85498797"),
]


@pytest.mark.parametrize("units, dimension, words, spacings", SPACINGS)
def test_spacings(units, dimension, words, spacings):
    session = asemd(f"units {units}\ndimension {dimension}\nlattice {words}")
    assert " ".join(f"{s:.8g}" for s in session.scene.lattice.spacings) == spacings
    assert (f"Lattice spacing in x,y,z = {spacings}\n" in "".join(session.told)) == (not words.startswith("none"))


@pytest.mark.parametrize("style", BASIS)
def test_density(style):
    dimension = 2 if style in ("sq", "sq2", "hex") else 3
    lattice = Lattice(style, 0.7, density=True, dimension=dimension)
    volume = np.prod(lattice.spacings[:dimension])
    assert len(lattice.basis) / volume == pytest.approx(0.7, rel=1e-14)


def test_box_and_back():
    lattice = Lattice("fcc", 3.5, orient=((1, 1, 1), (1, -1, 0), (1, 1, -2)), origin=(0.1, 0.2, 0.3))
    cells = np.random.default_rng(0).normal(size=(20, 3))
    assert np.allclose(lattice.from_box(lattice.to_box(cells)), cells, atol=1e-13)


def test_points_fill_a_rotated_box():
    """The number of points in a large box follows from the density, whatever the orientation."""
    lattice = Lattice("bcc", 2.0, orient=((2, 1, 0), (-1, 2, 0), (0, 0, 1)))
    lo, hi = np.zeros(3), np.full(3, 31.0)
    found = sum(int(((x >= lo) & (x < hi)).all(axis=1).sum()) for x, _ in lattice.points(lo, hi))
    assert found == pytest.approx(31.0**3 / 4.0, rel=0.03)


@pytest.mark.parametrize("words, message", [
    ("fcc", "scale"), ("foo 1", "unknown style"), ("fccc 1", "did you mean fcc"), ("fcc -1", "positive"), ("fcc x", "number"),
    ("sq 1", "2d"), ("fcc 3 basis 0 0 0", "custom"), ("custom 3 a1 1 0 0", "basis"), ("fcc 3 origin 1 0 0", "origin"),
    ("none 3 origin 0 0 0", "scale only"), ("custom 1 basis 0 0 0 a1 0 0 0", "plane"), ("custom 1 basis 0 0 0 a1 1", "3 values"),
    ("custom 1 basis 0 0 1", "below 1"), ("fcc 3 orient x 1 1 0", "orthogonal"), ("fcc 3 orient x 1 1 0 orient y 1 -1 0", "right-handed"),
    ("fcc 3 orient w 1 1 0", "x, y or z"), ("fcc 3 orient x 1.5 1 0", "whole"), ("fcc 3 spacing 0 1 1", "spacings"),
    ("fcc 3 orgin 0 0 0", "did you mean origin"), ("fcc nan", "finite"),
])
def test_mistakes(words, message):
    with pytest.raises(InputError, match=message):
        asemd(f"units metal\nlattice {words}")
