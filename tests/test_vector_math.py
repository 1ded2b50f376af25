"""exp, log, erfc, sin, cos and atan2: digits against mpmath, the plain Python twins, and whether loops become vector code."""
from __future__ import annotations

import math
import os
import platform
import re
import time

import mpmath as mp
import numba
import numpy as np
import pytest

from asemd.kernels import bits, vector_math
from asemd.kernels.generate import Builder, plain_source
from asemd.kernels.whole_power import whole_power

LOOPS = """
def loop_{name}(x, out):
    for k in range(x.size):
        out[k] = vector_{name}(x[k])
"""


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(40):
        yield


def build(single: bool):
    b = Builder("vector functions in loops")
    b.line("real = np.float32" if single else "real = np.float64")
    vector_math.paste(b, single)
    for name in ("exp", "log", "erfc", "sin", "cos"):
        b.text(LOOPS.format(name=name).strip())
    return b.build()


@pytest.fixture(scope="module")
def double():
    return build(False)


@pytest.fixture(scope="module")
def single():
    return build(True)


def points(name: str, single: bool) -> np.ndarray:
    rng = np.random.default_rng(11)
    if name == "exp":
        top, low = (88.0, -87.0) if single else (709.0, -708.0)
        x = np.concatenate([rng.uniform(low, top, 1500), rng.uniform(-1, 1, 700), rng.normal(size=300) * 1e-6, [0.0, 1.0, low, top]])
    elif name == "log":
        span = 37 if single else 300
        x = np.concatenate([10.0 ** rng.uniform(-span, span, 1200), rng.uniform(0.6, 1.6, 1200), 1 + rng.normal(size=300) * 1e-7, [1.0]])
    elif name in ("sin", "cos"):
        top = 1e3 if single else 1e6
        corners = rng.integers(-300, 300, 400) * (math.pi / 4)
        x = np.concatenate([rng.uniform(-4, 4, 1200), rng.uniform(-top, top, 700), rng.normal(size=300) * 1e-6, corners, [0.0, top]])
    else:
        top = 9.0 if single else 26.0
        x = np.concatenate([rng.uniform(0, 6, 1500), rng.uniform(-6, top, 700), 10.0 ** rng.uniform(-8, 0, 300), [0.0, 1.0]])
    return x.astype(np.float32 if single else np.float64)


def ulps(name: str, got: np.ndarray, x: np.ndarray) -> float:
    """The largest error in units of the last digit."""
    worst = 0.0
    for g, v in zip(got, x):
        want = getattr(mp, name)(mp.mpf(float(v)))
        last = abs(np.spacing(got.dtype.type(want))) if want else np.finfo(got.dtype).tiny
        worst = max(worst, float(abs(mp.mpf(float(g)) - want) / mp.mpf(float(last))))
    return worst


@pytest.mark.parametrize(("name", "limit"), [("exp", 1.5), ("log", 1.5), ("erfc", 4.0), ("sin", 1.0), ("cos", 1.0)])
@pytest.mark.parametrize("single_precision", [False, True])
def test_digits(name, limit, single_precision, double, single):
    module = single if single_precision else double
    x = points(name, single_precision)
    out = np.empty_like(x)
    getattr(module, f"loop_{name}")(x, out)
    error = ulps(name, out, x)
    assert error <= limit * (1.5 if single_precision else 1.0), f"{name}: {error:.2f} ulp"
    print(f"{name} {'single' if single_precision else 'double'}: {error:.2f} ulp")


@pytest.mark.parametrize("name", ["exp", "log", "erfc", "sin", "cos"])
def test_plain_python_agrees(name, double):
    x = points(name, False)[::20]
    out = np.empty_like(x)
    getattr(double, f"loop_{name}")(x, out)
    plain = np.array([getattr(vector_math, f"vector_{name}")(float(v)) for v in x])
    assert plain == pytest.approx(out, rel=2e-15, abs=1e-300)


@pytest.fixture(scope="module")
def angles():
    b = Builder("atan2 in a loop")
    b.line("from asemd.kernels.fuse import madd")
    b.text(plain_source(vector_math.vector_atan2), vector_math.OPTIONS)
    b.text("def loop(y, x, out):\n    for k in range(x.size):\n        out[k] = vector_atan2(y[k], x[k])")
    return b.build()


def test_atan2(angles):
    rng = np.random.default_rng(5)
    y, x = rng.normal(size=3000), rng.normal(size=3000)
    y[:1500] *= 10.0 ** rng.uniform(-30, 0, 1500)      # near 0 and 180 degrees
    x[700:1000] *= 10.0 ** rng.uniform(-30, 0, 300)    # near 90
    x[2500:], y[2500:] = np.cos(t := np.linspace(-math.pi, math.pi, 500)), np.sin(t)
    out = np.empty_like(x)
    angles.loop(y, x, out)
    error = max(float(abs(mp.mpf(g) - mp.atan2(a, b)) / abs(np.spacing(g))) for g, a, b in zip(out.tolist(), y.tolist(), x.tolist()))
    print(f"atan2: {error:.2f} ulp")
    assert error < (1.5 if os.environ.get("NUMBA_DISABLE_JIT") else 0.8)


def test_atan2_on_the_axes(angles):
    y, x = np.array([0.0, 0.0, -0.0, -0.0, 2.0, -2.0, 3.0, -3.0, 5e-324]), np.array([1.0, -1.0, 1.0, -1.0, 0.0, -0.0, 3.0, -3.0, -1.0])
    out = np.empty_like(x)
    angles.loop(y, x, out)
    assert out.tolist() == [math.atan2(a, b) for a, b in zip(y, x)] and np.signbit(out).tolist() == np.signbit(y).tolist()
    angles.loop(np.array([math.nan, 1.0]), np.array([1.0, math.nan]), out)
    assert np.isnan(out[:2]).all()


def test_pow(double):
    for x, y in ((2.0, 0.5), (1.3, 12.0), (7.5, -6.0), (0.01, 2.25)):
        assert double.vector_pow(x, y) == pytest.approx(x**y, rel=1e-14)


def test_edges(double):
    x = np.array([-708.5, -1e9, -math.inf, 1e9, math.nan, -0.0])
    out = np.empty_like(x)
    double.loop_exp(x, out)
    assert not out[:3].any() and out[3] == pytest.approx(math.exp(709.4), rel=1e-12) and math.isnan(out[4]) and out[5] == 1.0
    double.loop_erfc(np.array([30.0, 1e300, math.inf, -30.0, math.nan, 0.0]), out)
    assert not out[:3].any() and out[3] == 2.0 and math.isnan(out[4]) and out[5] == pytest.approx(1.0, rel=1e-15)


def test_bits():
    for x in (1.0, 0.7, 0.71, 3.5, 1e-200, 7e180, math.sqrt(0.5), math.sqrt(2.0)):
        k, m = bits.exponent(x), bits.significand(x)
        assert math.ldexp(m, int(k)) == x and 0.7071 < m < 1.41422
    assert bits.power_of_two(-3.0) == 0.125
    assert bits.upper_half(1.0 + 2.0**-50) == 1.0


def test_roots_and_inverses():
    b = Builder("roots in loops")
    b.line("from asemd.kernels.fuse import madd")
    vector_math.paste_roots(b)
    for name in ("root", "inverse"):
        b.text(LOOPS.format(name=name).strip())
    module = b.build()
    x = 10.0 ** np.random.default_rng(5).uniform(-37, 37, 3000)
    for name, exact in (("root", lambda v: 1 / mp.sqrt(v)), ("inverse", lambda v: 1 / v)):
        out = np.empty_like(x)
        getattr(module, f"loop_{name}")(x, out)
        want = [exact(mp.mpf(float(v))) for v in x]
        worst = max(abs(mp.mpf(float(got)) - w) / np.spacing(float(w)) for got, w in zip(out, want))
        assert worst < 1.5, name


@pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="nothing is compiled")
@pytest.mark.parametrize("argument", ["-x[k] * x[k]", "-abs(x[k])", "x[k] + 1.0"])
def test_exp_of_what_has_a_sign_is_vectorised(argument):
    """Where the compiler knows that an end of the interval is never reached, it must not make branches."""
    b = Builder("exp of a square")
    vector_math.paste(b)
    b.text(f"def loop(x, out):\n    for k in range(x.size):\n        out[k] = vector_exp({argument})")
    loop = numba.njit(error_model="numpy")(b.build().loop.py_func)
    loop(np.ones(64), np.ones(64))
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("looks at x86 registers only")
    code = "".join(loop.inspect_asm().values())
    assert re.search(r"mulpd|fmadd\d+pd", code), "no packed arithmetic"


@pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="nothing is compiled")
@pytest.mark.parametrize("name", ["exp", "log", "erfc", "sin", "cos"])
def test_loops_are_vectorised(name, double):
    x = points(name, False)[:2000]
    out = np.empty_like(x)
    loop = numba.njit(error_model="numpy")(getattr(double, f"loop_{name}").py_func)      # code from the disk cache cannot be looked at
    loop(x, out)
    best = math.inf
    for _ in range(20):
        start = time.perf_counter()
        for _ in range(10):
            loop(x, out)
        best = min(best, time.perf_counter() - start)
    print(f"{name}: {best / 10 / x.size * 1e9:.2f} ns each")
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("looks at x86 registers only")
    code = "".join(loop.inspect_asm().values())
    assert re.search(r"mulpd|fmadd\d+pd", code), f"{name}: no packed arithmetic"


ROOTS = """
def roots(x, out):
    rough_roots()
    for k in range(x.size):
        out[k] = vector_root(x[k])
"""


@pytest.mark.parametrize("count", [4096, 3])
def test_roots_of_doubles(count):
    """1 / sqrt(x) by estimates, in vectors and one by one, to two units of the last digit."""
    b = Builder("roots in a loop")
    b.line("from asemd.kernels.fuse import madd, rough_roots")
    vector_math.paste_roots(b)
    b.text(ROOTS.strip())
    x = 10.0 ** np.random.default_rng(5).uniform(-36, 36, count)
    out = np.empty_like(x)
    b.build().roots(x, out)
    exact = np.array([float(1 / mp.sqrt(mp.mpf(float(v)))) for v in x])
    assert np.abs(out / exact - 1.0).max() < 4.5e-16


@pytest.mark.parametrize("n", [0, 1, 2, 3, 7, 8, 11, 63, 64])
def test_whole_powers(n):
    for x in np.random.default_rng(3).uniform(-3.0, 3.0, 50).tolist():
        exact = mp.mpf(x) ** n
        assert abs(whole_power(x, n) - exact) <= 1.2e-16 * n * abs(exact)
