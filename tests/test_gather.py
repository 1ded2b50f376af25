"""Eight atoms at a time between vectors and tables, against numpy."""
from __future__ import annotations

import numpy as np
import pytest

from asemd.kernels.gather import fetch8, gather8, give8, scatter8, take8
from asemd.kernels.target import lanes, njit

MASK, ROW = 0x3FFFFFF, 40


@njit
def take(table, x, q):
    for k in range(0, x.shape[1], 8):
        take8(table, k, x, q)


@njit
def give(table, x):
    for k in range(0, x.shape[1], 8):
        give8(table, k, x)


@njit
def gather(b, table, entries, o, shifts):
    gather8(b, 8, ROW, table, entries, 3, o[0], o[1], o[2], shifts, MASK, False, 0)


@njit
def gather_all(b, table, entries, o, shifts):
    gather8(b, 8, ROW, table, entries, 3, o[0], o[1], o[2], shifts, MASK, True, 5)


@njit
def scatter(b, table, entries):
    scatter8(b, 8, ROW, table, entries, 3, MASK, 3)


@njit
def fetch(table, at):
    fetch8(table, at, False)
    fetch8(table, at, True)


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def test_take_and_give_are_inverse(rng):
    x, q, table = rng.normal(size=(3, 24)), rng.normal(size=24), np.full((24, 4), np.nan)
    take(table, x, q)
    assert (table == np.column_stack([x.T, q])).all()
    y = rng.normal(size=(3, 24))
    expected = x + y
    give(table, y)
    assert (y == expected).all() and not table.any()


@pytest.mark.parametrize("real", [np.float64, np.float32])
def test_gather(rng, real):
    table, shifts, o = rng.normal(size=(50, 4)), rng.normal(size=(27, 4)), rng.normal(size=3)
    shifts[:, 3] = 0.0
    slots, codes = rng.integers(0, 50, 12), rng.integers(0, 27, 12)
    entries = (slots | codes << 26).astype(np.int32)
    b = np.zeros(8 * ROW, real)
    expected = b.copy()
    gather(b, table, entries, o, shifts)
    for d in range(3):
        expected[8 + d * ROW:16 + d * ROW] = table[slots[3:11], d] - o[d]
    assert (b == expected).all()
    gather_all(b, table, entries, o, shifts)
    for d in range(3):
        expected[8 + d * ROW:16 + d * ROW] = (table[slots[3:11], d] + shifts[codes[3:11], d]) - o[d]
    expected[8 + 5 * ROW:16 + 5 * ROW] = table[slots[3:11], 3]
    assert (b == expected).all()


@pytest.mark.parametrize("real", [np.float64, np.float32])
def test_scatter_adds_every_place_of_an_atom(rng, real):
    table, b = rng.normal(size=(6, 4)), rng.normal(size=8 * ROW).astype(real)
    slots = np.array([9, 9, 9, 4, 1, 4, 4, 0, 5, 1, 2, 9])
    expected = table.copy()
    for k, j in enumerate(slots[3:11]):
        expected[j, :3] += b[[8 + k, 8 + k + ROW, 8 + k + 2 * ROW]].astype(float)
    scatter(b, table, (slots | 13 << 26).astype(np.int32))
    assert (table == expected).all()


@pytest.mark.parametrize("at", [0, 8, 10**6, -10**6, 2**60])
def test_fetched_rows_need_not_exist_and_stay(rng, at):
    table = rng.normal(size=(16, 4))
    expected = table.copy()
    fetch(table, at)
    assert (table == expected).all()


@pytest.mark.parametrize("features, expected", [("+avx512f,-prefer-256-bit", (8, 16)), ("+avx2,-avx512f", (8, 8)), (None, (8, 8))])
def test_rows_are_padded_to_the_vectors_of_the_processor(monkeypatch, features, expected):
    monkeypatch.setattr("numba.config.CPU_FEATURES", features)
    assert (lanes(False), lanes(True)) == expected
