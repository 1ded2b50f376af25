"""Every dihedral style near and at its singular geometries, against its formula with 60 digits.

Errors count in units of one rounding amplified by the condition of the case: 2^-53 (sum over difference vectors |dF/dd| |d| + sum over
coefficients |dF/dc| |c| + |F|), and the same for the energy.
"""
from __future__ import annotations

import math
import statistics
from functools import cache

import mpmath as mp
import numpy as np
import pytest

from asemd import style as registry
from asemd.testing import styles

LIMIT = 8.0
PAIRS = [(0, 1), (1, 2), (3, 2)]
NAMES = ("phi", "r12", "r23", "r34", "theta1", "theta2")
WITHOUT_FORMULA = {"table", "table/cut", "lepton"}      # their numbers come from a file or an expression of the user


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


def coordinates(f, g, h):
    """phi r12 r23 r34 theta1 theta2 of the vectors x1 - x2, x2 - x3, x4 - x3."""
    a, b = cross(f, g), cross(h, g)
    return [mp.atan2(dot(cross(b, a), g) / size(g), dot(a, b)), size(f), size(g), size(h), mp.atan2(size(a), -dot(f, g)),
            mp.atan2(size(b), dot(g, h))]


def deg(v):
    return v * mp.pi / 180


def series(k, phi):
    return sum(v * mp.cos(n * phi) for n, v in enumerate(k, 1))


def class2(p, r12, r23, r34, t1, t2, K1, p1, K2, p2, K3, p3, A1, A2, A3, r2, B1, B2, B3, C1, C2, C3, r1, r3, D1, D2, D3, E1, E2, E3, a1, a2,
           M, b1, b2, N, s1, s3):
    main = sum(K * (1 - mp.cos(n * p - deg(d))) for n, (K, d) in enumerate([(K1, p1), (K2, p2), (K3, p3)], 1))
    bonds = (r23 - r2) * series([A1, A2, A3], p) + (r12 - r1) * series([B1, B2, B3], p) + (r34 - r3) * series([C1, C2, C3], p)
    angles = (t1 - deg(a1)) * series([D1, D2, D3], p) + (t2 - deg(a2)) * series([E1, E2, E3], p)
    return main + bonds + angles + M * (t1 - deg(b1)) * (t2 - deg(b2)) * mp.cos(p) + N * (r12 - s1) * (r34 - s3)


def spherical(p, r12, r23, r34, t1, t2, *terms):
    return sum(C * (u - mp.cos(K * (p - deg(a)))) * (v - mp.cos(L * (t1 - deg(b)))) * (w - mp.cos(M * (t2 - deg(c))))
               for C, K, a, u, L, b, v, M, c, w in zip(*[iter(terms)] * 10))


def quadratic(p, K, p0):
    d = p - deg(p0)
    return K * (d - 2 * mp.pi * (1 if d > mp.pi else -1 if d < -mp.pi else 0)) ** 2


def shift_exp(p, U, t, a):
    u = (1 + mp.cos(p - deg(t))) / 2
    return -U * u * (1 + a * (u - 1) / 2) if abs(a) < mp.mpf("0.001") else -U * (mp.exp(a * u) - 1) / (mp.exp(a) - 1)


def charmm(p, K, n, d, w):
    return K * (1 + mp.cos(n * p - deg(d)))


def fourier(p, *terms):
    return sum(K * (1 + mp.cos(n * p - deg(d))) for K, n, d in zip(*[iter(terms)] * 3))


def polynomial(p, *a):
    return sum(v * mp.cos(p) ** i for i, v in enumerate(a))


def opls(p, *k):
    return sum(v / 2 * (1 - (-1) ** i * mp.cos(i * p)) for i, v in enumerate(k, 1))


def helix(p, A, B, C):
    return A * (1 - mp.cos(p)) + B * (1 + mp.cos(3 * p)) + C * (1 + mp.cos(p + mp.pi / 4))


def restricted(p, K, p0):
    return K * (mp.cos(p) - mp.cos(deg(p0))) ** 2 / mp.sin(p) ** 2


CLASS2 = ("100 75 100 70 80 60 mbt 3.5945 0.1704 -0.549 1.5228 ebt 0.3417 0.3264 -0.9036 0.1368 0 -0.808 1.0119 1.101 "
          "at 0.4 -0.185 -0.7963 -2.022 0 -0.3991 110.2453 105.127 aat -13.5271 110.2453 105.127 bb13 2.5 1.0119 1.101")
FORMULAS = [     # straight from the manual, nothing rearranged
    ("harmonic", "3 1 3", lambda p, K, d, n: K * (1 + d * mp.cos(n * p))),
    ("harmonic", "3 -1 6", lambda p, K, d, n: K * (1 + d * mp.cos(n * p))),
    ("harmonic", "2e6 1 36", lambda p, K, d, n: K * (1 + d * mp.cos(n * p))),
    ("charmm", "1.2 5 37 0", charmm), ("charmm", "0.7e6 2 180 0", charmm), ("charmmfsw", "1.2 3 180 0", charmm),
    ("fourier", "3 -0.8462 3 0.0 7.5788 1 0 0.138 2 -180.0", fourier), ("fourier", "2 1.3e6 1 33.3 0.4 12 90.0", fourier),
    ("fourier", "2 9.0 1 0 -1.0 3 0", fourier), ("opls", "9.0 0 -1.0 0", opls), ("helix", "9.0 1.0 0", helix),
    ("opls", "1.74 -0.157 0.279 0.9", opls),
    ("multi/harmonic", "20 -10 5 7 -3", polynomial),
    ("nharmonic", "7 20 -10 5 7 -3 0.4 11", polynomial), ("nharmonic", "1 3.0", polynomial),
    ("helix", "80 100 40", helix),
    ("quadratic", "100 80", quadratic), ("quadratic", "1e8 180", quadratic), ("quadratic", "100 -120", quadratic),
    ("cosine/shift/exp", "10 45 2", shift_exp), ("cosine/shift/exp", "10 0 -3", shift_exp), ("cosine/shift/exp", "10 180 40", shift_exp),
    ("cosine/shift/exp", "10 90 0.0007", shift_exp), ("cosine/shift/exp", "10 90 0", shift_exp),
    ("cosine/squared/restricted", "10 120", restricted), ("cosine/squared/restricted", "10 0", restricted),
    ("cosine/squared/restricted", "10 180", restricted), ("cosine/squared/restricted", "10 90", restricted),
    ("class2", CLASS2, class2),
    ("spherical", "2 69.3 1 93.9 1 1 90 0 1 90 0 49.1 0 0 0 1 74.4 1 0 0 0", spherical),
    ("spherical", "1 286.1 2 124 -1 1 90 0.7 2 110 1", spherical),
]
LISTS = {"fourier", "nharmonic", "spherical"}            # the first word is the number of terms
TITLES = [f"{name}-{words[:24]}" for name, words, _ in FORMULAS]


def numbers(name, words):
    """The coefficients in order: without marks, and without the number of terms."""
    return [w for w in words.split() if not w[0].isalpha()][name in LISTS:]


def turned(x, shift=0.0):
    a, b = 0.7, -1.2
    q = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, math.cos(b), -math.sin(b)], [0, math.sin(b), math.cos(b)]])
    return np.array(x) @ q.T + np.array([0.317, -0.211, 0.129]) + shift


def four(phi):
    return np.array([[-0.5, 1.0, 0], [0, 0, 0], [1.4, 0, 0], [1.9, 1.1 * math.cos(phi), 1.1 * math.sin(phi)]])


def geometries():
    out = {"ordinary": turned(four(1.1)), "left": turned(four(-2.3)), "far": turned(four(1.1), 1e7), "small": turned(1e-3 * four(2.1)),
           "large": turned(1e3 * four(-0.7))}
    for base in (0, 90, 180, -90):
        for e in (1e-2, 1e-5, 1e-8, -1e-8):
            out[f"phi {base} {e:+g}"] = turned(four(math.radians(base) + e))
    for e in (1e-2, 1e-5, 1e-8):
        out[f"end in line, {e:g}"] = turned([[-1.1, e, 0], [0, 0, 0], [1.4, 0, 0], [1.8, 0.7, 0.8]])
        out[f"both ends in line, {e:g}"] = turned([[-1.1, e, 0], [0, 0, 0], [1.4, 0, 0], [2.6, 0.6 * e, 0.8 * e]])
        out[f"end folded back, {e:g}"] = turned([[0.6, e, 0], [0, 0, 0], [1.4, 0, 0], [1.8, 0.7, 0.8]])
    out["arms of all lengths"] = turned([[-5e2, 9e2, 3e2], [0, 0, 0], [1.4e-6, 2e-7, 0], [1.3, 0.4, -0.8]])
    out["middle bond long"] = turned([[-5e-6, 9e-6, 3e-6], [0, 0, 0], [1.4e3, 2e2, 0], [1.4e3 + 1e-3, 2e2 + 4e-3, -2e-3]])
    out["cis exactly"] = np.array([[-0.5, 1.0, 0], [0, 0, 0], [1.5, 0, 0], [2.0, 1.25, 0]])
    out["trans exactly"] = np.array([[-0.5, 1.0, 0], [0, 0, 0], [1.5, 0, 0], [2.0, -1.25, 0]])
    out["upright exactly"] = np.array([[-0.5, 1.0, 0], [0, 0, 0], [1.5, 0, 0], [2.0, 0, 1.25]])
    return out


PLACES = geometries()


def moved(d, k, a, h):
    return [[v + h * (m == k and b == a) for b, v in enumerate(row)] for m, row in enumerate(d)]


def point(d):
    """Coordinates, and their derivatives by each of the nine components."""
    rows = []
    for k in range(3):
        for a in range(3):
            h = size(d[k]) * mp.mpf(10) ** -28
            delta = [p - q for p, q in zip(coordinates(*moved(d, k, a, h)), coordinates(*moved(d, k, a, -h)))]
            delta[0] -= 2 * mp.pi * mp.nint(delta[0] / (2 * mp.pi))
            rows.append([v / (2 * h) for v in delta])
    return coordinates(*d), rows


@cache
def points(title):
    """Vectors of a geometry, its `point`, and those a small step along each component."""
    x = PLACES[title]
    d = [[mp.mpf(float(x[i][a])) - mp.mpf(float(x[j][a])) for a in range(3)] for i, j in PAIRS]
    steps = [size(d[k]) * mp.mpf(10) ** -13 for k in range(3)]
    return d, point(d), steps, [point(moved(d, k, a, steps[k])) for k in range(3) for a in range(3)]


def atoms(pull):
    f = [[mp.mpf(0)] * 3 for _ in range(4)]
    for k, (i, j) in enumerate(PAIRS):
        for a in range(3):
            f[i][a] += pull[3 * k + a]
            f[j][a] -= pull[3 * k + a]
    return f


def forces(energy, many, where, c):
    q, jacobian = where
    used = 6 if many else 1
    slopes = []
    for k in range(used):
        h = mp.mpf(10) ** -25
        slopes.append((energy(*(v + h * (m == k) for m, v in enumerate(q[:used])), *c)
                       - energy(*(v - h * (m == k) for m, v in enumerate(q[:used])), *c)) / (2 * h))
    return [-dot(slopes, row[:used]) for row in jacobian]


def norm(pull):
    return max(size(v) for v in atoms(pull))


def reference(title, energy, words, many):
    """Energy, forces, and what one rounding amounts to for each."""
    d, base, steps, others = points(title)
    c = [mp.mpf(w) for w in words]
    e, f = energy(*base[0][:6 if many else 1], *c), forces(energy, many, base, c)
    bar_e, bar_f = abs(e), norm(f)
    for k in range(3):
        change = [norm([(p - q) / steps[k] for p, q in zip(forces(energy, many, others[3 * k + a], c), f)]) for a in range(3)]
        bar_f += size(change) * size(d[k])
        bar_e += size(f[3 * k:3 * k + 3]) * size(d[k])
    for k, word in enumerate(words):
        if c[k] == 0 or ("." not in word and "e" not in word and abs(c[k]) < 7):      # whole numbers have no error
            continue
        h = c[k] * mp.mpf(10) ** -20
        near = [v + h * (m == k) for m, v in enumerate(c)]
        bar_f += norm([(p - q) / h for p, q in zip(forces(energy, many, base, near), f)]) * abs(c[k])
        bar_e += abs((energy(*base[0][:6 if many else 1], *near) - e) / h * c[k])
    return e, atoms(f), bar_e * mp.mpf(2) ** -53, bar_f * mp.mpf(2) ** -53


def sample(name, words):
    style = registry.find("dihedral", name)
    return styles.Sample(style, style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, None))


def diverges(name, words, title):
    """Planar molecules with cosine/squared/restricted, unless phi0 is that angle."""
    if name != "cosine/squared/restricted" or title not in ("cis exactly", "trans exactly"):
        return False
    return words.split()[1] != {"cis exactly": "0", "trans exactly": "180"}[title]


def test_every_style_has_a_formula():
    named = {name for name, _, _ in FORMULAS} | WITHOUT_FORMULA
    assert {n for n in registry.names("dihedral") if registry.find("dihedral", n).function} <= named


@pytest.mark.parametrize(("name", "words", "energy"), FORMULAS, ids=TITLES)
def test_digits(name, words, energy):
    s, many, ratios = sample(name, words), name in ("class2", "spherical"), []
    for title, x in PLACES.items():
        got = s.run(np.ascontiguousarray(x.T))
        if diverges(name, words, title):
            assert got.bad[0] and not got.forces.any(), title
            continue
        if "restricted" in name and (title == "cis exactly" or title == "trans exactly"):
            assert not got.bad[0] and not got.forces.any() and got.acc[0] == 0.0, title       # 0 / 0 in the formula
            continue
        assert not got.bad[0], title
        e, f, bar_e, bar_f = reference(title, energy, numbers(name, words), many)
        error = max(size([mp.mpf(float(p)) - q for p, q in zip(u, v)]) for u, v in zip(got.forces.T, f))
        assert error <= LIMIT * bar_f, f"{title}: the error of the forces is {mp.nstr(error / bar_f, 3)} times what the condition allows"
        rest = 1e-29 * max(abs(float(w)) for w in numbers(name, words))       # a square is not 0 where its base is one rounding off 0
        assert abs(mp.mpf(got.acc[0]) - e) <= LIMIT * bar_e + rest, f"{title}: energy {got.acc[0]!r}, should be {mp.nstr(e, 17)}"
        ratios.append(float(error / bar_f) if bar_f else 0.0)
    assert statistics.median(ratios) < 0.4


LINE = np.array([[-1.1, 0, 0], [0, 0, 0], [1.4, 0, 0], [1.85, 1.1, 0.3]])
BACK = np.array([[0.7, 0, 0], [0, 0, 0], [1.4, 0, 0], [1.85, 1.1, 0.3]])
RODS = np.array([[-1.1, 0, 0], [0, 0, 0], [1.4, 0, 0], [2.6, 0, 0]])


TURNED = np.array([[1.0, 2, 3], [2, 3, 4], [3, 4, 5], [3, 4.5, 6]])


@pytest.mark.parametrize(("name", "words", "energy"), FORMULAS, ids=TITLES)
def test_arms_in_line(name, words, energy):
    """No torsional force, and the energy of 90 degrees or the mean over a turn."""
    s, many, c = sample(name, words), name in ("class2", "spherical"), [mp.mpf(w) for w in numbers(name, words)]
    for x in (LINE, LINE[::-1], BACK, BACK[::-1], RODS, TURNED):
        a = s.run(np.ascontiguousarray(x.T))
        assert not a.bad[0] and np.isfinite(a.forces).all()
        assert np.abs(a.forces.sum(axis=1)).max() <= 1e-13 * (1 + np.abs(a.forces).max())
        assert many or not a.forces.any()
        if name in ("harmonic", "charmm", "charmmfsw", "fourier"):
            want = sum(energy(2 * mp.pi * k / 101, *c) for k in range(101)) / 101
        elif name == "cosine/shift/exp":
            want = energy(deg(c[1]) + mp.pi / 2, *c)
        else:
            d = [[mp.mpf(float(p - q)) for p, q in zip(x[i], x[j])] for i, j in PAIRS]
            want = energy(*[mp.pi / 2, *coordinates(*d)[1:]][:6 if many else 1], *c)
        assert a.acc[0] == pytest.approx(float(want), rel=1e-13, abs=1e-26)


def test_energy_of_arms_in_line_is_the_same_per_atom_and_without_it():
    s = sample("harmonic", "3 1 3")
    assert s.run(np.ascontiguousarray(LINE.T), per_atom=False).acc[0] == 3.0
    assert s.run(np.ascontiguousarray(LINE.T), energy=False).energies.sum() == 3.0


def test_trans_is_plus_180_degrees_in_every_orientation():
    """A sine of -0.0 must not make it -180."""
    s = sample("spherical", "1 1 0.5 100 0 0 90 2 0 90 2")
    want = -math.cos(0.5 * (math.pi - math.radians(100)))
    flat = np.array([[[-0.5, 1.0], [0, 0], [1.5, 0], [2.0, -1.25]], [[-1.5, 2.0], [-0.5, -2.25], [1.0, 1.5], [1.75, -1.5]]])
    for x in (turn @ np.append(f, np.zeros((4, 1)), axis=1).T for f in flat for p in ([0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [2, 1, 0])
              for turn in (sign * np.eye(3)[p] for sign in np.array(np.meshgrid(*[[1, -1]] * 3)).T.reshape(-1, 3, 1))):
        for y in (x, x[:, ::-1]):
            if dot(*(np.cross(u, y[:, 1] - y[:, 2]) for u in (y[:, 0] - y[:, 1], y[:, 3] - y[:, 2]))) < 0.0:
                assert s.run(np.ascontiguousarray(y)).acc[0] == pytest.approx(want, rel=1e-14)


@pytest.mark.parametrize("number", range(3))
def test_quadratic_turns_back_opposite_its_angle(number):
    phi0 = (80.0, 0.0, 180.0)[number]
    s = sample("quadratic", f"10 {phi0}")
    for side in (1, -1):
        phi = math.radians(phi0 + side * 180.0 - side * 1e-6)
        a = s.run(np.ascontiguousarray(turned(four(phi)).T))
        assert a.acc[0] == pytest.approx(10 * (math.pi - math.radians(1e-6)) ** 2, rel=1e-13)
        torque = 20 * (math.pi - math.radians(1e-6)) / 1.1
        assert np.linalg.norm(a.forces[:, 3]) == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize(("name", "words", "energy", "x"), [
    ("cosine/squared/restricted", "10 180", restricted, [
        [-84.40239282893808, 16.367102093153093, 40.49353985147081], [0.0, 0.0, 0.0],
        [-0.0016352626590263796, 0.00047084931071754454, -0.00010858893446446109],
        [-0.00623223456051981, 0.0017944780912559533, -0.000413847755875851]]),
    ("cosine/squared/restricted", "10 120", restricted, [
        [5739.597373775359, -6543.035881394847, 8871.552387767053], [0.04874562473506394, 0.20763401066701737, 0.3745245507742545],
        [-2.0928385185217744, 1.338483851035869, -3.081181177618179], [3.4705547671819654, -1.598185691120287, 5.896144657120774]]),
    ("quadratic", "1e8 180", quadratic, [
        [0.6072476869603722, 0.052519355620196384, 1.5963113178045103], [0.9323333371689213, 0.999618378029405, 0.7859699193171736],
        [0.5567189934608264, 1.7752069514337583, 0.2864099930889769], [0.4702081591351041, 1.1722061323835873, 0.771551638364504]]),
], ids=["cis", "trans", "opposite"])
def test_torsion_within_rounding_of_a_plane(name, words, energy, x):
    """1e-10 rad from it and three atoms 1e-7 from a line: so singular there that positions must give the angle to the last digit."""
    x = np.array(x)
    d = [[mp.mpf(float(x[i][a])) - mp.mpf(float(x[j][a])) for a in range(3)] for i, j in PAIRS]
    want = np.array([[float(v) for v in row] for row in atoms(forces(energy, False, point(d), [mp.mpf(w) for w in words.split()]))])
    got = sample(name, words).run(np.ascontiguousarray(x.T))
    assert not got.bad[0] and np.abs(got.forces.T - want).max() <= 1e-2 * np.abs(want).max()


@pytest.mark.parametrize(("name", "words", "text"), [
    ("fourier", "0", "number of terms"),
    ("fourier", "2 1.0 1 0.0", "6 values after m = 2, got 3"), ("fourier", "1 1.0 -1 0", "multiplicity"),
    ("fourier", "1 1.0 1.5 0", "whole number"), ("fourier", "", "needs m K1 n1 d1"), ("nharmonic", "2 1.0 2.0 3.0", "2 values after n = 2"),
    ("nharmonic", "x 1.0", "whole number"), ("spherical", "1 1 1 0 1 1 90 0 1 90", "10 values after n = 1, got 9"),
    ("class2", "mbt 1 2 3", "needs A1 A2 A3 mbt_r2"), ("class2", "75 169 45 10 24", "needs K1 phi1"), ("quadratic", "100", "needs K phi0"),
    ("charmmfsw", "1.2 3 180 1.5", "charmmfsw: incorrect weight"), ("charmmfsw", "1.2 -3 180 1", "charmmfsw: incorrect multiplicity"),
])
def test_refused(name, words, text):
    with pytest.raises(registry.InputError, match=text):
        registry.find("dihedral", name).parse_coeff(words.split(), {})


@pytest.mark.parametrize("atom", range(4))
@pytest.mark.parametrize("category", ["dihedral", "improper"])
def test_a_position_that_is_no_number_is_reported(category, atom):
    """And not taken for three atoms on a line."""
    x = four(1.1)
    x[atom, 1] = math.nan
    for name in ("harmonic", "class2", "cvff", "charmm", "umbrella"):
        if name in registry.names(category):
            a = styles.sample(registry.find(category, name)).run(np.ascontiguousarray(x.T))
            assert a.bad[0] and not a.forces.any()
