"""Atoms into slots: the order of a stable sort by columns and cells, whoever does it."""
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asemd.kernels.cluster import CLUSTER
from asemd.kernels.columns import column
from asemd.neighbor import EVERYWHERE, kernels

FAR, STEP = np.array([90.0, 91.0, 92.0]), 7.0


def sort(x, row, threads, grid, void, capacity):
    """What the pieces make of slots in the unit cell: slots in use, x, v, row, cell_start, column_start, column_of."""
    k, ns, (nx, ny, nz) = kernels(True), len(row), grid
    xs, v, rows = np.full((3, capacity), -5.0), np.full((3, capacity), -6.0), np.full(capacity, -1, np.int32)
    xs[:, :ns], v[:, :ns], rows[:ns] = x, 2.0 * x, row
    copies = np.zeros((3, capacity)), np.zeros((3, capacity)), np.zeros(capacity, np.int32)
    counts, key = np.full((threads, nx * ny * nz), 99, np.int32), np.zeros(capacity, np.int32)
    starts, columns = np.zeros((nx * ny, nz + 1), np.int32), np.zeros(nx * ny + 1, np.int32)
    of = np.zeros(capacity // CLUSTER + 2, np.int32)
    edges = [ns * t // threads for t in range(threads + 1)]
    for t in range(threads):
        k.bin_atoms(xs, v, rows, *edges[t:t + 2], np.zeros(3), np.eye(3), nx, ny, nz, *copies, counts[t], key, EVERYWHERE)
    found = k.assign(counts, xs, v, rows, ns, nx, ny, nz, *copies, starts, columns, of, FAR, STEP, void)
    for t in range(threads if found >= 0 else 0):
        k.move(*edges[t:t + 2], *copies, key, counts[t], xs, v, rows)
    return found, xs, v, rows, starts, columns, of


def wanted(x, row, grid, void):
    """Rows by slot, by definition."""
    nx, ny, nz = grid
    cells: dict[int, list[int]] = {}
    for i in np.flatnonzero(row >= 0):
        a, b, c = (min(int(s * m), m - 1) for s, m in zip(x[:, i], grid))
        cells.setdefault(column(a, b, nx, ny) * nz + c, []).append(int(row[i]))
    out: list[int] = []
    for c in range(nx * ny):
        last = nz
        for z in range(nz):
            here = cells.get(c * nz + z, [])
            if here:
                out += [-1] * (-len(out) % CLUSTER if z - last > void + 1 else 0)
                last = z
            out += here
        out += [-1] * (-len(out) % CLUSTER)
    return out


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 10**6), n=st.integers(0, 70), empty=st.integers(0, 20), threads=st.integers(1, 4), void=st.integers(0, 6),
       grid=st.tuples(st.integers(1, 3), st.integers(1, 9), st.integers(1, 12)))
def test_order(seed, n, empty, threads, void, grid):
    rng = np.random.default_rng(seed)
    row = rng.permutation(np.concatenate([np.arange(n), np.full(empty, -1)])).astype(np.int32)
    x = rng.random((3, n + empty))
    x[2, rng.random(n + empty) < 0.5] *= 0.1
    order = wanted(x, row, grid, void)
    capacity = len(order) + CLUSTER + int(rng.integers(3)) * CLUSTER + n + empty
    found, xs, v, rows, starts, columns, of = sort(x, row, threads, grid, void, capacity)
    assert found == len(order)
    np.testing.assert_array_equal(rows[:found + CLUSTER], order + [-1] * CLUSTER)
    there, where = rows[:found] >= 0, {int(r): i for i, r in enumerate(row)}
    old = [where[int(r)] for r in rows[:found][there]]
    np.testing.assert_array_equal(xs[:, :found][:, there], x[:, old])
    np.testing.assert_array_equal(v[:, :found][:, there], 2.0 * x[:, old])
    gone = np.flatnonzero(rows[:found + CLUSTER] < 0)
    np.testing.assert_array_equal(xs[:, gone], FAR[:, None] + np.outer([1.0, 0.0, 0.0], gone % CLUSTER * STEP))
    assert not v[:, gone].any()
    assert columns[0] == 0 and columns[-1] == found and not (columns % CLUSTER).any()
    for c in range(grid[0] * grid[1]):
        assert (of[columns[c] // CLUSTER:columns[c + 1] // CLUSTER] == c).all()
        assert columns[c] <= starts[c, 0] and starts[c, -1] <= columns[c + 1] and (np.diff(starts[c]) >= 0).all()
    again = sort(x, row, 1, grid, void, capacity)
    for a, b in zip((xs, v, rows, starts), again[1:]):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("threads", [1, 3])
def test_without_room_atoms_stay_where_they_were(threads):
    rng = np.random.default_rng(5)
    row = np.arange(40, dtype=np.int32)
    row[7:11] = -1
    x = rng.random((3, 40))
    need = len(wanted(x, row, (2, 3, 4), 0)) + CLUSTER
    for capacity in (40, need - CLUSTER, need - 1):
        found, xs, v, rows, *_ = sort(x, row, threads, (2, 3, 4), 0, max(40, capacity))
        assert found == -need
        np.testing.assert_array_equal(rows[:40], row)
        np.testing.assert_array_equal(xs[:, :40], x)
        np.testing.assert_array_equal(v[:, :40], 2.0 * x)
    assert sort(x, row, threads, (2, 3, 4), 0, need)[0] == need - CLUSTER
