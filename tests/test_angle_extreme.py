"""Every angle style near and at 0 and 180 degrees and at other extremes, against its formula with 60 digits.

Errors count in units of one rounding amplified by the condition of the case: 2^-53 (sum over difference vectors |dF/dd| |d| + sum over
coefficients |dF/dc| |c| + |F|).
"""
from __future__ import annotations

import math
import statistics

import mpmath as mp
import numpy as np
import pytest

from asemd import style as registry
from asemd.kernels import bonded
from asemd.testing import styles

LIMIT, MEDIAN = 4.0, 0.5
WITHOUT_FORMULA = {"dipole", "lepton", "mesocnt", "table"}     # of dipoles; from an expression, a parameter set or a file


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(60):
        yield


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def size(v):
    return mp.sqrt(dot(v, v))


def coordinates(a, b):
    """theta, r12, r32, r13 of the vectors from the middle atom."""
    return mp.atan2(size(cross(a, b)), dot(a, b)), size(a), size(b), size([p - q for p, q in zip(a, b)])


def deg(v):
    return v * mp.pi / 180


def power_series(d, *k):
    return sum(v * d ** n for n, v in enumerate(k, 2))


def class2(t, u, v, w, t0, *c):
    d, (M, r1, r2, N1, N2, s1, s2) = t - deg(t0), c[-7:]
    return power_series(d, *c[:-7]) + M * (u - r1) * (v - r2) + N1 * (u - s1) * d + N2 * (v - s2) * d


def gaussian(t, u, v, w, T, *terms):
    return -T * mp.log(sum(A / (width * mp.sqrt(mp.pi / 2)) * mp.exp(-2 * (t - deg(c)) ** 2 / width ** 2)
                           for A, width, c in zip(*[iter(terms)] * 3)))


def shift_exp(t, u, v, w, U, t0, a):
    x = (1 + mp.cos(t - deg(t0))) / 2
    return -U * x * (1 + a * (x - 1) / 2) if abs(a) < mp.mpf("0.001") else -U * (mp.exp(a * x) - 1) / (mp.exp(a) - 1)


def mm3(t, u, v, w, K, t0):
    d = t - deg(t0)
    factors = [mp.mpf(w) for w in "1 -0.802141 0.183837 -0.131664 0.237090".split()]
    return K * power_series(d, *factors)


def harmonic(t, u, v, w, K, t0, *rest):
    return K * (t - deg(t0)) ** 2


def periodic(t, u, v, w, C, B, n):
    return 2 * C / n ** 2 * (1 - B * (-1) ** int(n) * mp.cos(n * t))


def delta(t, u, v, w, K, t0):
    return K * (1 - mp.cos(t - deg(t0)))


def shift(t, u, v, w, U, t0):
    return -U / 2 * (1 + mp.cos(t - deg(t0)))


def squared(t, u, v, w, K, t0):
    return K * (mp.cos(t) - mp.cos(deg(t0))) ** 2


def restricted(t, u, v, w, K, t0):
    return squared(t, u, v, w, K, t0) / mp.sin(t) ** 2


def fourier(t, u, v, w, K, C0, C1, C2):
    return K * (C0 + C1 * mp.cos(t) + C2 * mp.cos(2 * t))


def fourier_simple(t, u, v, w, K, c, n):
    return K * (1 + c * mp.cos(n * t))


CLASS2 = "bb 10.0 1.5 1.4 ba 20.0 10.0 1.5 1.3"
FORMULAS = [     # straight from the manual, nothing rearranged
    ("charmm", "75 110.1 50 3", lambda t, u, v, w, K, t0, Ku, ru: K * (t - deg(t0)) ** 2 + Ku * (w - ru) ** 2),
    ("class2", f"110.1 75 5.2 1 {CLASS2}", class2), ("class2/p6", f"110.1 75 5.2 1 -0.5 0.3 {CLASS2}", class2),
    ("cosine", "75", lambda t, u, v, w, K: K * (1 + mp.cos(t))),
    ("cosine/delta", "75 110.1", delta), ("cosine/delta", "75 180", delta), ("cosine/delta", "75 0", delta),
    *(("cosine/periodic", f"75 {B} {n}", periodic) for B, n in ((1, 1), (-1, 1), (1, 2), (-1, 3), (1, 4), (-1, 6), (3, 5))),
    ("cosine/shift", "10 45", shift), ("cosine/shift", "10 180", shift),
    *(("cosine/shift/exp", f"10 45 {a}", shift_exp) for a in ("2", "-3", "0.0007", "0.002", "0", "40", "-30", "300")),
    ("cosine/squared", "75 110.1", squared), ("cosine/squared", "75 180", squared), ("cosine/squared", "75e6 0", squared),
    ("cosine/squared/restricted", "75 110.1", restricted), ("cosine/squared/restricted", "75 180", restricted),
    ("cosine/squared/restricted", "75 0", restricted),
    ("cross", "200 80 75 0.95 1.3 107", lambda t, u, v, w, K, B0, B1, r1, r2, t0:
        K * (u - r1) * (v - r2) + (B0 * (u - r1) + B1 * (v - r2)) * (t - deg(t0))),
    ("fourier", "75 1 0.5 0.3", fourier), ("fourier", "75 0.3 0.3 -0.075", fourier),
    ("fourier/simple", "100 -1 3", fourier_simple), ("fourier/simple", "100 0.7 1.5", fourier_simple),
    ("fourier/simple", "100 1 4", fourier_simple),
    ("gaussian", "300 2 0.0128 0.375 80.0 0.0730 0.148 123.0", gaussian),
    ("gaussian", "300 3 0.1 0.02 20 0.2 0.01 90 3 0.015 179", gaussian),
    ("harmonic", "75 110.1", harmonic), ("harmonic", "75e6 180", harmonic), ("harmonic", "75 0", harmonic),
    ("mm3", "75 110.1", mm3), ("mm3", "75 175", mm3),
    ("quartic", "129.1948 56.8726 -25.9442 -14.2221", lambda t, u, v, w, t0, *k: power_series(t - deg(t0), *k)),
    ("sdk", "300 107", harmonic), ("spica", "300 107 0", harmonic),
]
TITLES = [f"{name}-{words[:24]}" for name, words, _ in FORMULAS]
WHOLE = {"cosine/periodic": (1, 2), "fourier/simple": (2,)}      # coefficients that are counts, not measured


def numbers(name: str, words: str) -> list[str]:
    """The coefficients in order: without marks, and without the number of terms."""
    out = [w for w in words.split() if not w[0].isalpha()]
    return out[:1] + out[2:] if name == "gaussian" else out


def turned(x, shift=0.0):
    """The same geometry in a general orientation."""
    a, b = 0.7, -1.2
    q = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, math.cos(b), -math.sin(b)], [0, math.sin(b), math.cos(b)]])
    return np.array(x) @ q.T + np.array([0.317, -0.211, 0.129]) + shift


def three(theta, u=1.1, v=1.3):
    return np.array([[u, 0, 0], [0, 0, 0], [v * math.cos(theta), v * math.sin(theta), 0]])


def geometries():
    out = {"ordinary": three(1.9), "sharp": three(0.6), "unequal arms": three(2.0, 1e-3, 50.0), "small": 1e-3 * three(1.4),
           "large": 1e3 * three(2.4), "tiny": 1e-6 * three(1.0), "equilibrium": three(math.radians(110.1) + 1e-7)}
    for e in (1e-2, 1e-5, 1e-8):
        out[f"near 180, {e:g}"] = np.array([[1.1, 0, 0], [0, 0, 0], [-1.3 * math.cos(e), 1.3 * math.sin(e), 0]])
        out[f"near 0, {e:g}"] = np.array([[1.1, 0, 0], [0, 0, 0], [1.3 * math.cos(e), 1.3 * math.sin(e), 0]])
    return {title: turned(x) for title, x in out.items()} | {"far": turned(three(1.9), 1e7)}


def reference(energy, coeff, whole, x):
    """Forces (3, 3), bar and energy at 60 digits, with derivatives by central differences."""
    a, b = ([mp.mpf(float(x[i][k])) - mp.mpf(float(x[1][k])) for k in range(3)] for i in (0, 2))
    c = [mp.mpf(w) for w in coeff]

    def pull(d, c):
        out = []
        for k in range(2):
            h = mp.mpf(10) ** -25 * size(d[k])
            for m in range(3):
                def moved(s, k=k, m=m, h=h):
                    return [[v + s * h * (i == k and j == m) for j, v in enumerate(row)] for i, row in enumerate(d)]
                out.append(-(energy(*coordinates(*moved(1)), *c) - energy(*coordinates(*moved(-1)), *c)) / (2 * h))
        f, g = out[:3], out[3:]
        return [f, [-p - q for p, q in zip(f, g)], g]

    def largest(p, q, h):
        return max(size([(s - t) / h for s, t in zip(u, v)]) for u, v in zip(p, q))

    forces, still = pull([a, b], c), [[0] * 3] * 3
    bar = largest(forces, still, 1)
    for k in range(2):
        part = mp.mpf(0)
        for m in range(3):
            h = mp.mpf(10) ** -14 * size([a, b][k])
            d = [[v + h * (i == k and j == m) for j, v in enumerate(row)] for i, row in enumerate([a, b])]
            part += largest(pull(d, c), forces, h) ** 2
        bar += mp.sqrt(part) * size([a, b][k])
    for k in range(len(c)):
        if c[k] and k not in whole:
            h = c[k] * mp.mpf(10) ** -14
            bar += largest(pull([a, b], [v + h * (m == k) for m, v in enumerate(c)]), forces, h) * abs(c[k])
    return forces, bar * mp.mpf(2) ** -53, energy(*coordinates(a, b), *c)


def prepared(name, words):
    style = registry.find("angle", name)
    return styles.Sample(style, style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, None))


@pytest.mark.parametrize(("name", "words", "energy"), FORMULAS, ids=TITLES)
def test_forces_keep_their_digits(name, words, energy):
    s, ratios = prepared(name, words), {}
    for title, x in geometries().items():
        want, bar, e = reference(energy, numbers(name, words), WHOLE.get(name, ()), x)
        got = s.run(x.T)
        assert not got.bad[0], title
        error = max(size([mp.mpf(float(p)) - q for p, q in zip(u, v)]) for u, v in zip(got.forces.T, want))
        ratios[title] = float(error / bar) if bar else float(error != 0)
        pull = max(size(v) * size([mp.mpf(float(p)) for p in x[i] - x[1]]) for i, v in ((0, want[0]), (2, want[2])))
        assert abs(got.acc[0] - e) <= mp.mpf(2) ** -53 * (40 * abs(e) + 40 * pull + 40 * abs(mp.mpf(words.split()[0]))), f"{title}: energy"
    worst = max(ratios, key=ratios.get)
    assert ratios[worst] <= LIMIT, f"{worst}: {ratios[worst]:.2g} times what the condition allows"
    assert statistics.median(ratios.values()) <= MEDIAN, ratios


def test_every_style_has_a_formula():
    forces = {n for n in registry.names("angle") if registry.find("angle", n).function}
    assert {name for name, _, _ in FORMULAS} == forces - WITHOUT_FORMULA


@pytest.mark.parametrize(("name", "words", "energy"), FORMULAS, ids=TITLES)
def test_exactly_straight_and_folded(name, words, energy):
    """Along coordinate axes, where the angle is 0 or 180 degrees to the last bit."""
    s = prepared(name, words)
    for axis in range(3):
        for arm in (-1.3, 1.3):
            x = np.zeros((3, 3))
            x[axis] = [1.1, 0.0, arm]
            a, diverges = s.run(x), name == "cosine/squared/restricted" and words != ("75 180" if arm < 0 else "75 0")
            assert bool(a.bad[0]) == diverges
            if diverges:
                assert "diverges at 0 and 180 degrees" in bonded.describe(s.style, a.bad[2], [4, 5, 6], 1)
                continue
            assert np.isfinite(a.forces).all() and np.abs(a.forces.sum(axis=1)).max() <= 1e-15 * np.abs(a.forces).max()
            across = np.delete(a.forces, axis, axis=0)
            assert not across.any()                  # nothing says which way to bend
            # what is left are the forces along the bonds, which are those of the formula
            if len(s.style.coordinates) == 1:
                assert not a.forces.any()


def test_lammps_forces_are_behind_compat():
    for name, words in (("mm3", "75 100"), ("fourier/simple", "100 -1 3")):
        s = prepared(name, words)
        x = three(2.3).T
        mine = s.run(x)
        s.style = s.style.bind({}, {}, "lammps")
        theirs = s.run(x)
        assert theirs.acc[0] == pytest.approx(mine.acc[0], rel=1e-14) and np.abs(theirs.forces - mine.forces).max() > 1e-3
