"""Bonded forces at stiff and singular geometry against 50-digit references, in units of the error that the condition of each case allows.

bar = 2^-53 (sum over difference vectors |dF/dd| |d| + sum over coefficients |dF/dc| |c| + |F|): one rounding, amplified by the condition.
"""
from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest

from asemd import style as registry
from asemd import units
from asemd.kernels.state import cell_arrays
from asemd.testing import styles

LIMIT = 8.0
PARENT = {"bond": [(0, 1)], "angle": [(0, 1), (2, 1)], "dihedral": [(0, 1), (1, 2), (3, 2)], "improper": [(0, 1), (1, 2), (3, 2)],
          "umbrella": [(1, 0), (2, 0), (3, 0)]}


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(60):
        yield


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def coordinate(kind, d):
    """The internal coordinate of difference vectors `d`, all digits."""
    if kind == "bond":
        return mp.sqrt(dot(d[0], d[0]))
    if kind == "angle":
        n = cross(d[0], d[1])
        return mp.atan2(mp.sqrt(dot(n, n)), dot(d[0], d[1]))
    if kind == "umbrella":
        n = cross(d[0], d[1])
        side = dot(d[2], d[0]) / mp.sqrt(dot(d[0], d[0])) + dot(d[2], d[1]) / mp.sqrt(dot(d[1], d[1]))
        q = cross(n, d[2])
        return mp.atan2(dot(n, d[2]), mp.sqrt(dot(q, q)) * (-1 if side > 0 else 1))
    a, b = cross(d[0], d[1]), cross(d[2], d[1])
    return mp.atan2(dot(cross(b, a), d[1]) / mp.sqrt(dot(d[1], d[1])), dot(a, b))


def deg(v):
    return v * mp.pi / 180


def fene(r, K, R0, eps, sig):
    rest = 4 * eps * ((sig / r) ** 12 - (sig / r) ** 6) + eps if r < mp.mpf(2) ** (mp.mpf(1) / 6) * sig else 0
    return -K * R0**2 / 2 * mp.log(1 - (r / R0) ** 2) + rest


def fene_nm(r, K, R0, E0, r0, n, m):
    rest = E0 / (n - m) * (m * (r0 / r) ** n - n * (r0 / r) ** m) if r < r0 else 0
    return -K * R0**2 / 2 * mp.log(1 - (r / R0) ** 2) + rest


def gaussian(r, T, n, *terms):
    def term(A, w, c):
        return A / (w * mp.sqrt(mp.pi / 2)) * mp.exp(-2 * (r - c) ** 2 / w**2)
    return -T * mp.log(sum(term(*terms[k:k + 3]) for k in range(0, len(terms), 3)))


def mesocnt(t, K, K_B, B):
    d = mp.pi - t
    return K * d**2 if d < deg(B) else K * deg(B) ** 2 + K_B * (d - deg(B))


ENERGY = {     # straight from the manual, nothing rearranged
    ("bond", "harmonic", "300 1.1"): lambda r, K, r0: K * (r - r0) ** 2,
    ("bond", "morse", "80 1.2 1.1"): lambda r, D, a, r0: D * (1 - mp.exp(-a * (r - r0))) ** 2,
    ("bond", "fene", "30 1.5 1 1"): fene,
    ("bond", "fene/expand", "30 1.3 1 1 0.2"): lambda r, K, R0, eps, sig, shift: fene(r - shift, K, R0, eps, sig),
    ("bond", "fene/expand", "30 1.7 1 1 -0.2"): lambda r, K, R0, eps, sig, shift: fene(r - shift, K, R0, eps, sig),
    ("bond", "fene/nm", "30 1.5 1.3 1.1 12 6"): fene_nm,
    ("bond", "fene/nm", "30 1.5 1.3 1.31 9.5 6.25"): fene_nm,
    ("bond", "class2", "1.1 300 -500 700"): lambda r, r0, *k: sum(v * (r - r0) ** (i + 2) for i, v in enumerate(k)),
    ("bond", "class2", "1.1 3e8 -5e8 7e8"): lambda r, r0, *k: sum(v * (r - r0) ** (i + 2) for i, v in enumerate(k)),
    ("bond", "gaussian", "300 1 0.01 0.098 1.1"): gaussian,
    ("bond", "gaussian", "300 3 0.0003 0.657 1.61 0.0050 0.360 1.07 0.0048 0.157 1.31"): gaussian,
    ("bond", "gromos", "80 1.1"): lambda r, K, r0: K * (r**2 - r0**2) ** 2,
    ("bond", "harmonic/shift", "10 1.1 1.4"): lambda r, U, r0, rc: U / (r0 - rc) ** 2 * ((r - r0) ** 2 - (rc - r0) ** 2),
    ("bond", "harmonic/shift/cut", "10 1.1 1.5"):
        lambda r, U, r0, rc: U / (r0 - rc) ** 2 * ((r - r0) ** 2 - (rc - r0) ** 2) if r <= rc else mp.mpf(0),
    ("bond", "nonlinear", "100 1.1 38.9000001"): lambda r, e, r0, b: e * (r - r0) ** 2 / (b**2 - (r - r0) ** 2),
    ("bond", "nonlinear", "100 1.1 50"): lambda r, e, r0, b: e * (r - r0) ** 2 / (b**2 - (r - r0) ** 2),
    ("bond", "mm3", "100 1.1"): lambda r, K, r0: K * (r - r0) ** 2 * (
        1 - mp.mpf("2.55") * (r - r0) + mp.mpf(7) / 12 * mp.mpf("2.55") ** 2 * (r - r0) ** 2),
    ("angle", "harmonic", "75 110.1"): lambda t, K, t0: K * (t - deg(t0)) ** 2,
    ("angle", "harmonic", "75 180"): lambda t, K, t0: K * (t - deg(t0)) ** 2,
    ("angle", "mesocnt", "buckling custom 400 50 15"): mesocnt,
    ("angle", "mesocnt", "harmonic custom 400"): lambda t, K: K * (mp.pi - t) ** 2,
    ("angle", "cosine", "75"): lambda t, K: K * (1 + mp.cos(t)),
    ("angle", "cosine/squared", "75 110.1"): lambda t, K, t0: K * (mp.cos(t) - mp.cos(deg(t0))) ** 2,
    ("angle", "cosine/shift", "10 45"): lambda t, U, t0: -U / 2 * (1 + mp.cos(t - deg(t0))),
    ("dihedral", "harmonic", "3 1 3"): lambda p, K, d, n: K * (1 + d * mp.cos(n * p)),
    ("dihedral", "harmonic", "3 -1 6"): lambda p, K, d, n: K * (1 + d * mp.cos(n * p)),
    ("dihedral", "charmm", "1.2 5 37 0"): lambda p, K, n, d, w: K * (1 + mp.cos(n * p - deg(d))),
    ("dihedral", "opls", "1.74 -0.157 0.279 0.9"):
        lambda p, *k: sum(v / 2 * (1 - (-1) ** i * mp.cos(i * p)) for i, v in enumerate(k, 1)),
    ("dihedral", "multi/harmonic", "20 -10 5 7 -3"): lambda p, *a: sum(v * mp.cos(p) ** i for i, v in enumerate(a)),
    ("improper", "harmonic", "40 0"): lambda p, K, c0: K * (abs(p) - deg(c0)) ** 2,
    ("improper", "harmonic", "40 35"): lambda p, K, c0: K * (abs(p) - deg(c0)) ** 2,
    ("improper", "cvff", "80 -1 6"): lambda p, K, d, n: K * (1 + d * mp.cos(n * p)),
    ("improper", "umbrella", "100 0"): lambda w, K, w0: K * (1 - mp.cos(w)),
    ("improper", "umbrella", "100 54"): lambda w, K, w0: K / 2 / mp.sin(deg(w0)) ** 2 * (mp.cos(w) - mp.cos(deg(w0))) ** 2,
}


def turned(x, shift=0.0):
    """The same geometry in a general orientation."""
    a, b = 0.7, -1.2
    q = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, math.cos(b), -math.sin(b)], [0, math.sin(b), math.cos(b)]])
    return np.array(x) @ q.T + np.array([0.317, -0.211, 0.129]) + shift


def geometries(category, name):
    """Name -> positions: ordinary, and as near to singular as doubles allow."""
    if category == "bond":
        lengths = {"ordinary": 1.3, "equilibrium": 1.1 + 1e-7, "short": 0.7, "limit": 1.5 * (1 - 1e-8)}
        if name in ("fene", "fene/nm"):
            lengths |= {"close": 1e-6}
        elif name != "fene/expand":
            lengths |= {"tiny": 1e-9, "long": 40.0}
        return {n: turned([[0, 0, 0], [r, 0, 0]]) for n, r in lengths.items()} | {"far": turned([[0, 0, 0], [1.2, 0, 0]], 1e7)}
    if category == "angle":
        out = {"ordinary": turned([[1.1, 0, 0], [0, 0, 0], [-0.4, 1.2, 0.1]]), "arms": turned([[1e-3, 0, 0], [0, 0, 0], [50.0, 70.0, 0]])}
        for e in (1e-2, 1e-5, 1e-8):
            out[f"near 180, {e:g}"] = turned([[1.1, 0, 0], [0, 0, 0], [-1.3 * math.cos(e), 1.3 * math.sin(e), 0]])
            out[f"near 0, {e:g}"] = turned([[1.1, 0, 0], [0, 0, 0], [1.3 * math.cos(e), 1.3 * math.sin(e), 0]])
        return out
    if name == "umbrella":
        out = {"ordinary": turned([[0, 0, 0.3], [1, 0.1, 0], [-0.5, 0.9, 0], [-0.4, -0.8, 0.1]])}
        for e in (1e-2, 1e-5, 1e-8):
            out[f"planar, {e:g}"] = turned([[0, 0, 0], [1, 0.1, 0], [-0.5, 0.9, 0], [-0.4, -0.8, e]])
            out[f"upright, {e:g}"] = turned([[0, 0, 0], [1, 0.1, 0], [-0.5, 0.9, 0], [-e, -e, 1.1]])
            out[f"line, {e:g}"] = turned([[0, 0, 0], [1, 0.0, 0], [-1.2, e, 0], [-0.1, -0.8, 0.3]])
        return out
    out = {}
    near = [(f"{base}, {e:g}", math.radians(base) + e) for base in (0, 180, 90) for e in (1e-2, 1e-5, 1e-8)]
    for title, phi in [("ordinary", 1.1), *near]:
        out[f"phi {title}"] = turned([[-0.5, 1.0, 0], [0, 0, 0], [1.4, 0, 0], [1.9, 1.1 * math.cos(phi), 1.1 * math.sin(phi)]])
    for e in (1e-2, 1e-4, 1e-7):
        out[f"one end in line, {e:g}"] = turned([[-1.1, e, 0], [0, 0, 0], [1.4, 0, 0], [1.8, 0.7, 0.8]])
        out[f"both ends in line, {e:g}"] = turned([[-1.1, e, 0], [0, 0, 0], [1.4, 0, 0], [2.6, 0.6 * e, 0.8 * e]])
    return out


def reference(kind, energy, coeff, x):
    """Forces (n, 3) and bar, with derivatives taken at 60 digits by central differences of step 1e-20."""
    pairs = PARENT[kind]
    d = [[mp.mpf(float(x[i][a])) - mp.mpf(float(x[j][a])) for a in range(3)] for i, j in pairs]
    c = [mp.mpf(w) for w in coeff]
    sizes = [mp.sqrt(dot(v, v)) for v in d]

    def total(d, c):
        return energy(coordinate(kind, d), *c)

    def moved(d, k, a, h):
        return [[v + h * (m == k and b == a) for b, v in enumerate(row)] for m, row in enumerate(d)]

    def pull(d, c):
        """Minus the derivative by each difference vector."""
        out = []
        for k in range(len(d)):
            h = mp.mpf(10) ** -22 * sizes[k] * mp.mpf(10) ** -3
            out.append([-(total(moved(d, k, a, h), c) - total(moved(d, k, a, -h), c)) / (2 * h) for a in range(3)])
        return out

    def atoms(p):
        f = [[mp.mpf(0)] * 3 for _ in x]
        for (i, j), row in zip(pairs, p):
            for a in range(3):
                f[i][a] += row[a]
                f[j][a] -= row[a]
        return f

    def norm(f):
        return max(mp.sqrt(dot(v, v)) for v in f)

    forces = atoms(pull(d, c))
    bar = norm(forces)
    for k in range(len(d)):
        part = mp.mpf(0)
        for a in range(3):
            h = mp.mpf(10) ** -12 * sizes[k]
            step = atoms(pull(moved(d, k, a, h), c))
            part += norm([[(p - q) / h for p, q in zip(u, v)] for u, v in zip(step, forces)]) ** 2
        bar += mp.sqrt(part) * sizes[k]
    for k in range(len(c)):
        if c[k] == 0 or coeff[k] in ("1", "-1", "3", "5", "6"):      # whole numbers have no error
            continue
        h = c[k] * mp.mpf(10) ** -12
        step = atoms(pull(d, [v + h * (m == k) for m, v in enumerate(c)]))
        bar += norm([[(p - q) / h for p, q in zip(u, v)] for u, v in zip(step, forces)]) * abs(c[k])
    return forces, bar * mp.mpf(2) ** -53


@pytest.mark.parametrize(("category", "name", "words"), list(ENERGY))
def test_forces_keep_their_digits(category, name, words):
    style = registry.find(category, name)
    s = styles.Sample(style, style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, units.get("lj")))
    kind = "umbrella" if name == "umbrella" else category
    for title, x in geometries(category, name).items():
        want, bar = reference(kind, ENERGY[category, name, words], [w for w in words.split() if w[0] not in "bch"], x)
        got = s.run(x.T)
        assert not got.bad[0], title
        error = max(mp.sqrt(sum((mp.mpf(float(p)) - q) ** 2 for p, q in zip(u, v))) for u, v in zip(got.forces.T, want))
        assert error <= LIMIT * bar, f"{title}: error {mp.nstr(error, 3)} is {mp.nstr(error / bar, 3)} times what the condition allows"


@pytest.mark.parametrize(("category", "name", "words"), [k for k in ENERGY if k[0] != "bond"])
def test_direction_undefined_is_finite(category, name, words):
    style = registry.find(category, name)
    s = styles.Sample(style, style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, units.get("lj")))
    line = np.array([[-1.1, 0, 0], [0, 0, 0], [1.4, 0, 0], [1.85, 1.1, 0]]).T
    for x in (line, line[:, ::-1], line * np.array([[1], [0], [1]])):
        a = s.run(x[:, :3] if category == "angle" else x)
        assert not a.bad[0] and np.isfinite(a.forces).all()
        assert np.abs(a.forces.sum(axis=1)).max() <= 1e-13 * (1 + np.abs(a.forces).max())


def test_images_in_a_strongly_tilted_cell():
    style = registry.find("bond", "harmonic")
    s = styles.Sample(style, style.pack({}, {1: style.parse_coeff(["250", "1.2"], {})}, 1, units.get("lj")))
    vectors = np.array([[10.0, 0, 0], [34.0, 10.0, 0], [-27.0, 42.0, 10.0]])
    x = turned([[0, 0, 0], [1.03, 0, 0]]).T
    moved = x.copy()
    moved[:, 1] += np.array([3, -2, 1]) @ vectors
    a = s.run(x)
    b = s.run(moved, cell=cell_arrays(vectors, np.ones(3, bool)), periodic=True, orthogonal=False)
    assert b.forces == pytest.approx(a.forces, abs=1e-10)
    assert b.acc[0] == pytest.approx(a.acc[0], rel=1e-10)


@pytest.mark.parametrize("scale", [1e-3, 1e3, 1e-12, 1e12])
def test_scaled_geometry_gives_scaled_forces(scale):
    for category, name, words in [k for k in ENERGY if k[0] != "bond"]:
        style = registry.find(category, name)
        s = styles.sample(style)
        s.packed = style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, units.get("lj"))
        x = s.x.reshape(3, styles.ITEMS, -1)
        x = (x - x[:, :, :1]).reshape(3, -1)
        a, b = s.run(x), s.run(scale * x)
        assert b.forces * scale == pytest.approx(a.forces, rel=1e-9, abs=1e-10 * np.abs(a.forces).max())
