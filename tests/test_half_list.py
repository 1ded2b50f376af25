"""LAMMPS's order of pairs from bins, against its definition written out."""
from __future__ import annotations

import numpy as np
import pytest

from asemd.kernels.half_list import pairs


def defined(x, n, bins, reach):
    """Each pair (i, j) of atom i, its own bin first, then bins above it from the lowest on, places in the order of storage."""
    out = []
    for i in range(n):
        mine = []
        for j in range(len(x)):
            d, step = x[j] - x[i], tuple((bins[j] - bins[i])[::-1])
            if j == i or d @ d > reach * reach:
                continue
            if step == (0, 0, 0):
                if j > i and (j < n or tuple(d[::-1]) >= (0.0, 0.0, 0.0)):
                    mine.append((step, j))
            elif step > (0, 0, 0):
                mine.append((step, j))
        out += [(i, j) for _, j in sorted(mine)]
    return out


@pytest.mark.parametrize("length, reach, atoms", [((5.0, 5.0, 5.0), 1.3, 60), ((9.0, 3.0, 1.0), 2.0, 40), ((30.0, 30.0, 30.0), 6.0, 50),
                                                  ((4.0, 4.0, 0.0), 1.1, 50), ((2.0, 2.0, 2.0), 5.0, 20)])
def test_order(length, reach, atoms):
    rng = np.random.default_rng(atoms)
    width = np.array([max(w, 1.0) / max(int(w / (0.5 * reach)), 1) for w in length])
    x = rng.uniform(-0.3, 1.3, (3 * atoms, 3)) * length
    x[3], x[atoms + 3] = x[2], x[2]                      # atoms and an image that coincide
    x[atoms + 4] = x[4] + [0.1, 0.0, 0.0]                # an image at the same height
    bins = np.floor(x / width).astype(np.int64)
    slot, code = rng.permutation(len(x)).astype(np.int32), rng.integers(0, 27, len(x)).astype(np.int32)
    want = np.array(defined(x, atoms, bins, reach))
    assert len(want) > 10
    for guess in (0, 10**5):
        i, j, image = pairs(x, atoms, bins, width, reach, slot, code, guess)
        np.testing.assert_array_equal(i, slot[want[:, 0]])
        np.testing.assert_array_equal(j, slot[want[:, 1]])
        np.testing.assert_array_equal(image, code[want[:, 1]])
