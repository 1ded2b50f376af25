"""The random generators: known values, jumps, statistics."""
from __future__ import annotations

import math
import os
import subprocess
import sys
import time

import numpy as np
import pytest

from asemd.errors import InputError
from asemd.kernels import random as counter
from asemd.kernels.marsaglia import normals
from asemd.marsaglia import Marsaglia
from asemd.random import MODULUS, ParkMiller, gaussian_at, position_seeds, uniform_at


def naive_uniform(state):
    state = 16807 * state % MODULUS
    return state, state * (1.0 / MODULUS)


def naive_gaussian(state, n):
    out, saved = [], None
    while len(out) < n:
        if saved is not None:
            out.append(saved)
            saved = None
            continue
        while True:
            state, a = naive_uniform(state)
            state, b = naive_uniform(state)
            a, b = 2.0 * a - 1.0, 2.0 * b - 1.0
            rsq = a * a + b * b
            if 0.0 < rsq < 1.0:
                break
        factor = math.sqrt(-2.0 * math.log(rsq) / rsq)
        out.append(b * factor)
        saved = a * factor
    return np.array(out)


def naive_seed(seed, coordinates):
    h = 0
    for byte in int(seed).to_bytes(4, "little") + np.asarray(coordinates, "<f8").tobytes():
        h = (h + (byte - 256 if byte > 127 else byte)) & 0xFFFFFFFF
        h = (h + (h << 10)) & 0xFFFFFFFF
        h ^= h >> 6
    h = (h + (h << 3)) & 0xFFFFFFFF
    h ^= h >> 11
    h = (h + (h << 15)) & 0xFFFFFFFF
    state = h & 0x7FFFFFF or 1
    for _ in range(5):
        state, _ = naive_uniform(state)
    return state


def test_park_millers_check_value():
    """The published check of a right implementation: 10000 steps from 1."""
    generator = ParkMiller(1)
    generator.uniform(10000)
    assert generator.state == 1043618065


def test_uniform_in_pieces_is_the_same_stream():
    whole = ParkMiller(4711).uniform(1000)
    g = ParkMiller(4711)
    parts = np.concatenate([g.uniform(1), [g.uniform()], g.uniform(0), g.uniform(600), g.uniform(398)])
    state, expected = 4711, []
    for _ in range(1000):
        state, u = naive_uniform(state)
        expected.append(u)
    assert np.array_equal(whole, parts) and np.array_equal(whole, expected)
    g = ParkMiller(4711)
    g.skip(1000)
    assert g.state == state


@pytest.mark.parametrize("pieces", [[999], [1, 2, 3, 993], [500, 0, 499], [1] * 20])
def test_gaussian_equals_the_plain_loop(pieces):
    g = ParkMiller(87287)
    got = np.concatenate([g.gaussian(n) for n in pieces])
    assert np.array_equal(got, naive_gaussian(87287, len(got)))


def test_seeds_from_positions():
    x = np.random.default_rng(1).normal(size=(50, 3)) * 10
    states = position_seeds(12345, x)
    assert states.tolist() == [naive_seed(12345, row) for row in x]
    for i in range(50):
        state = int(states[i])
        expected = naive_gaussian(state, 3)
        assert np.array_equal(gaussian_at(states, 3)[i], expected)
        assert uniform_at(states, 1)[i, 0] == naive_uniform(state)[1]


@pytest.mark.parametrize("seed", [0, -5])
def test_bad_seed(seed):
    with pytest.raises(InputError, match="positive"):
        ParkMiller(seed)
    with pytest.raises(InputError, match="positive"):
        position_seeds(seed, np.zeros((1, 3)))


def test_speed():
    x = np.random.default_rng(1).normal(size=(32000, 3))
    ParkMiller(5).uniform(96000)
    start = time.perf_counter()
    ParkMiller(5).gaussian(96000)
    gaussian_at(position_seeds(5, x), 3)
    assert time.perf_counter() - start < 1.0


# the counter generator of compiled loops

def draws(function, seed, steps, rows, ks):
    from numba import njit, vectorize
    compiled = njit(counter.uniform)
    namespace = {"np": np, "math": math, "uniform": compiled}
    exec(compile(_source(function), "counter", "exec"), namespace)
    f = vectorize(namespace[function.__name__])
    return f(np.int64(seed), *np.broadcast_arrays(*np.ix_(steps, rows, ks)))


def _source(function):
    import inspect
    return inspect.getsource(function)


def counters():
    with np.errstate(over="ignore"):
        return draws(counter.uniform, 1234, np.arange(40), np.arange(500), np.arange(4)), \
            draws(counter.normal, 1234, np.arange(40), np.arange(500), np.arange(3))


def test_counter_statistics():
    u, g = counters()
    n = u.size
    assert 0.0 <= u.min() and u.max() < 1.0 and len(np.unique(u)) == n
    assert abs(u.mean() - 0.5) < 4 / math.sqrt(12 * n)
    assert abs(u.var() - 1 / 12) < 4 * math.sqrt(1 / 180 / n)
    counts = np.histogram(u, 64, (0, 1))[0]
    assert ((counts - n / 64) ** 2).sum() / (n / 64) < 63 + 4 * math.sqrt(2 * 63)
    n = g.size
    assert abs(g.mean()) < 4 / math.sqrt(n) and abs(g.var() - 1) < 4 * math.sqrt(2 / n)
    assert abs((g**4).mean() - 3) < 4 * math.sqrt(96 / n)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_counter_neighbours_are_uncorrelated(axis):
    u, _ = counters()
    u = np.moveaxis(u, axis, 0) - 0.5
    for lag in (1, 2, 3):
        a, b = u[lag:], u[:-lag]
        assert abs((a * b).mean() * 12) < 4 / math.sqrt(a.size)
        assert abs(((a * a - 1 / 12) * (b * b - 1 / 12)).mean() * 180) < 4 / math.sqrt(a.size)


def test_counter_seeds_differ():
    with np.errstate(over="ignore"):
        a, b = (draws(counter.uniform, s, np.arange(5), np.arange(200), np.arange(3)) for s in (1, 2))
    assert abs(((a - 0.5) * (b - 0.5)).mean() * 12) < 4 / math.sqrt(a.size)


def test_counter_without_compiler_gives_the_same_numbers():
    u, g = counters()
    code = ("import numpy as np\nfrom asemd.kernels.random import uniform, normal\n"
            "print([uniform(1234, s, r, k) for s, r, k in [(0, 0, 0), (3, 499, 3), (39, 7, 1)]])\n"
            "print([normal(1234, s, np.int32(r), k) for s, r, k in [(0, 0, 0), (3, 499, 2), (39, 7, 1)]])\n"
            "uniform(1234, 5, np.int32(-1), 0)")
    out = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True,
                         env={**os.environ, "NUMBA_DISABLE_JIT": "1"}).stdout.replace("np.float64", "")
    a, b = (eval(line) for line in out.splitlines())
    assert a == [u[0, 0, 0], u[3, 499, 3], u[39, 7, 1]]
    assert np.allclose(b, [g[0, 0, 0], g[3, 499, 2], g[39, 7, 1]], rtol=1e-14)


def test_compiled_normal_numbers_are_those_of_the_stream():
    """Also after an odd number of them, of which one is left over."""
    one, other = Marsaglia(4711), Marsaglia(4711)
    found = np.concatenate([normals(one, 7), normals(one, 1), [one.gaussian()], normals(one, 4)])
    assert found.tolist() == [other.gaussian() for _ in range(13)]
    assert one.uniform() == other.uniform()
