"""Every improper style at planar, upright, collinear, tiny and stiff geometry against 50-digit references; coefficients on several lines.

bar = 2^-53 (sum over difference vectors |dF/dd| |d| + sum over coefficients |dF/dc| |c| + |F|): one rounding, amplified by the condition.
"""
from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest
from wheel import ask, ran

from asemd import style as registry
from asemd import units
from asemd.errors import AsemdError
from asemd.kernels import bonded
from asemd.lammps import Lammps
from asemd.testing import styles

pytestmark = pytest.mark.filterwarnings("ignore:no fixes with time integration")
LIMIT = 8.0


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(80):
        yield


# ------------------------------------------------------------------ formulas of the manual, nothing rearranged ---

def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def norm(a):
    return mp.sqrt(dot(a, a))


def cosine(a, b):
    return dot(a, b) / (norm(a) * norm(b))


def rise(a, b, c):
    """Sine of the angle of c with the plane of a and b."""
    n = cross(a, b)
    return dot(n, c) / (norm(n) * norm(c))


def deg(v):
    return v * mp.pi / 180


def class2(x, K, chi0, M1, M2, M3, t1, t2, t3):
    a, b, c = minus(x[0], x[1]), minus(x[2], x[1]), minus(x[3], x[1])
    chi = (mp.asin(rise(b, c, a)) + mp.asin(rise(c, a, b)) + mp.asin(rise(a, b, c))) / 3
    d1, d2, d3 = mp.acos(cosine(a, b)) - deg(t1), mp.acos(cosine(a, c)) - deg(t2), mp.acos(cosine(b, c)) - deg(t3)
    return K * (chi - deg(chi0)) ** 2 + M1 * d1 * d3 + M2 * d1 * d2 + M3 * d2 * d3


def cossq(x, K, chi0):
    return K / 2 * mp.cos(mp.acos(cosine(minus(x[1], x[0]), minus(x[3], x[2]))) - deg(chi0)) ** 2


def torsion(x):
    """The angle between the planes of atoms 1 2 3 and 2 3 4."""
    b1, b2, b3 = minus(x[1], x[0]), minus(x[2], x[1]), minus(x[3], x[2])
    n, m = cross(b1, b2), cross(b2, b3)
    return mp.atan2(norm(b2) * dot(b1, m), dot(n, m))


def spokes(x):
    return minus(x[1], x[0]), minus(x[2], x[0]), minus(x[3], x[0])


def omega(a, b, c):
    w = abs(mp.asin(rise(a, b, c)))
    return mp.pi - w if cosine(a, c) + cosine(b, c) > 0 else w


def fourier(x, K, C0, C1, C2, every):
    a, b, c = spokes(x)
    return K * sum(C0 + C1 * mp.cos(w) + C2 * mp.cos(2 * w) for w in [omega(a, b, c)] + [omega(b, c, a), omega(c, a, b)] * int(every))


def inversion(x, K, w0):
    a, b, c = spokes(x)
    return K / 3 * sum((abs(mp.asin(s)) - deg(w0)) ** 2 for s in (rise(a, b, c), rise(b, c, a), rise(c, a, b)))


def ring(x, K, t0):
    a, b, c = minus(x[0], x[1]), minus(x[2], x[1]), minus(x[3], x[1])
    return K / 6 * (cosine(a, b) + cosine(a, c) + cosine(b, c) + 3 * mp.cos(deg(t0))) ** 6


def height(x):
    n = cross(minus(x[2], x[1]), minus(x[3], x[1]))
    return dot(n, minus(x[0], x[1])) / norm(n)


def umbrella(x, K, w0):
    c = mp.cos(omega(*spokes(x)))
    return K * (1 - c) if w0 == 0 else K / 2 / mp.sin(deg(w0)) ** 2 * (c - mp.cos(deg(w0))) ** 2


CHAIN, FIRST, SECOND = [(0, 1), (1, 2), (3, 2)], [(1, 0), (2, 0), (3, 0)], [(0, 1), (2, 1), (3, 1)]
CASES = [     # name, coefficients, energy of the positions, difference vectors
    ("harmonic", "40 0", lambda x, K, c: K * (abs(torsion(x)) - deg(c)) ** 2, CHAIN),
    ("harmonic", "4e7 35", lambda x, K, c: K * (abs(torsion(x)) - deg(c)) ** 2, CHAIN),
    ("cvff", "80 -1 6", lambda x, K, d, n: K * (1 + d * mp.cos(n * torsion(x))), CHAIN),
    ("cvff", "80 1 2", lambda x, K, d, n: K * (1 + d * mp.cos(n * torsion(x))), CHAIN),
    ("umbrella", "100 0", umbrella, FIRST),
    ("umbrella", "1e8 54", umbrella, FIRST),
    ("class2", "45 0 aa 0 0 0 110 115 120", class2, SECOND),
    ("class2", "45 12 aa 12 -9 15 109.5 115 121", class2, SECOND),
    ("class2", "4.5e7 0 aa 1e7 1e7 1e7 180 180 180", class2, SECOND),
    ("cossq", "4 0", cossq, CHAIN),
    ("cossq", "4e6 20", cossq, CHAIN),
    ("cossq", "4 90", cossq, CHAIN),
    ("fourier", "3 1 -1 0 0", fourier, FIRST),
    ("fourier", "3e6 1 0.5 0.7 1", fourier, FIRST),
    ("inversion/harmonic", "18 0", inversion, FIRST),
    ("inversion/harmonic", "18e6 12", inversion, FIRST),
    ("ring", "80 70.5", ring, SECOND),
    ("ring", "80e6 109.47", ring, SECOND),
    ("ring", "80 180", ring, SECOND),
    ("distance", "80 30", lambda x, K2, K4: K2 * height(x) ** 2 + K4 * height(x) ** 4, FIRST),
    ("distharm", "25e6 0.3", lambda x, K, d0: K * (height(x) - d0) ** 2, FIRST),
    ("sqdistharm", "25 0.09", lambda x, K, d0: K * (height(x) ** 2 - d0) ** 2, FIRST),
]


# ------------------------------------------------------------------ geometry ---

def turned(x, rng, shift=0.0, spread=0.5):
    """The same geometry in a general orientation, somewhere near the origin."""
    return np.array(x, float) @ np.linalg.qr(rng.normal(size=(3, 3)))[0].T + rng.uniform(-spread, spread, 3) + shift


def geometries(pairs):
    """Name -> positions (4, 3): ordinary, and as near to singular as doubles allow."""
    ordinary = np.array([[0, 0, 0.3], [1.1, 0.1, 0], [-0.5, 0.9, 0], [-0.4, -0.8, 0.1]])
    out = {"ordinary": ordinary, "small": 1e-3 * ordinary, "large": 1e3 * ordinary}
    out["one arm short"] = np.array([[0, 0, 0], [1.1, 0.1, 0], [-0.5e-6, 0.9e-6, 1e-7], [-0.4, -0.8, 0.3]])
    out["two arms short"] = np.array([[0, 0, 0], [1.1, -1.1, -0.6], [-2.5e-5, -0.9e-5, -2.4e-5], [-0.7e-7, -1.1e-6, 0.8e-6]])
    out["two others close"] = np.array([[0, 0, 0], [1.1, 0.1, 0], [-0.5, 0.9, 0.2], [-0.5 + 1e-6, 0.9 - 3e-6, 0.2 + 2e-6]])
    out["two others close, long"] = np.array([[0, 0, 0], [0.4, 0.1, 0], [-5e2, 9e2, 2e2], [-5e2 + 1e-3, 9e2 - 3e-3, 2e2 + 2e-3]])
    out["arms folded, of all lengths"] = [[0, 0, 0], [0.24, 0.88, 0.95], [1.15e-6, 4.26e-6, 4.59e-6], [1.05e-4, 3.86e-4, 4.17e-4]]
    for e in (1e-3, 1e-8):
        out[f"planar, {e:g}"] = [[0, 0, 0], [1, 0.1, 0], [-0.5, 0.9, 0], [-0.4, -0.8, e]]
        out[f"planar, all on one side, {e:g}"] = [[0, 0, 0], [1, 0.1, 0], [0.5, 0.9, 0], [0.9, 0.7, e]]
        out[f"upright, {e:g}"] = [[0, 0, 0], [1, 0.1, 0], [-0.5, 0.9, 0], [-e, -e, 1.1]]
        out[f"two arms in line, {e:g}"] = [[0, 0, 0], [1, 0, 0], [-1.2, e, 0.2 * e], [-0.1, -0.8, 0.3]]
        out[f"two arms folded, {e:g}"] = [[0, 0, 0], [1, 0, 0], [1.2, e, 0], [-0.1, -0.8, 0.3]]
        out[f"all in line, {e:g}"] = [[0, 0, 0], [1, 0, 0], [-1.2, 0.6 * e, 0.8 * e], [-0.7, -e, 0]]
        out[f"all folded, {e:g}"] = [[0, 0, 0], [1, 0, 0], [1.2, 0.6 * e, 0.8 * e], [0.7, -e, 0]]
        out[f"others in line, {e:g}"] = [[0.1, 0.7, 0.3], [1, 0, 0], [-1.2, e, 0], [0.2, 0, 0.7 * e]]
    if pairs is SECOND:
        out = {title: np.array(x)[[1, 0, 2, 3]] for title, x in out.items()}
    if pairs is CHAIN:
        del out["one arm short"]
        for e in (1e-3, 1e-8):
            for base in (0, 90, 180):
                p = math.radians(base) + e
                out[f"torsion {base}, {e:g}"] = [[-0.5, 1, 0], [0, 0, 0], [1.4, 0, 0], [1.9, 1.1 * math.cos(p), 1.1 * math.sin(p)]]
    rng = np.random.default_rng(4)
    close = [[1.1, 0.3, -0.2], [0.4, 0.9, 0.5], [1.2e-6, -0.7e-6, 2e-7], [3e-7, 1.1e-6, -0.9e-6]]
    return {title: turned(x, rng) for title, x in out.items()} | {
        "far": turned(ordinary, rng, 1e7), "last two close, at the origin": turned(close, rng, spread=0.0)}


def reference(energy, pairs, words, x):
    """Forces (4, 3) and bar, with one-sided derivatives of 60-digit energies (steps far below what doubles see)."""
    c = [mp.mpf(w) for w in words]
    x = [[mp.mpf(float(v)) for v in row] for row in x]
    sizes = [norm(minus(x[i], x[j])) for i, j in pairs]
    # positions from the difference vectors: each difference moves the atoms on its far side
    root = ({0, 1, 2, 3} - {i for i, _ in pairs}).pop()

    def side(k):
        moved, rest = {pairs[k][0]}, [p for m, p in enumerate(pairs) if m != k]
        for _ in range(3):
            for i, j in rest:
                if (i in moved) != (j in moved) and root not in (i, j):
                    moved |= {i, j}
        return moved

    sides = [side(k) for k in range(3)]

    def shifted(x, atoms, a, h):
        return [[v + h * (i in atoms and b == a) for b, v in enumerate(row)] for i, row in enumerate(x)]

    def forces(x, c):
        e, h, out = energy(x, *c), mp.mpf(10) ** -40 * min(sizes), []
        for i in range(4):
            out.append([-(energy(shifted(x, {i}, a, h), *c) - e) / h for a in range(3)])
        return out

    def change(f, g, h):
        return max(norm([(p - q) / h for p, q in zip(u, v)]) for u, v in zip(f, g))

    f = forces(x, c)
    bar = max(norm(row) for row in f)
    for k in range(3):
        h = sizes[k] * mp.mpf(10) ** -22
        bar += sizes[k] * mp.sqrt(sum(change(forces(shifted(x, sides[k], a, h), c), f, h) ** 2 for a in range(3)))
    for k, word in enumerate(words):
        if c[k] != 0 and word not in ("1", "-1", "2", "6"):      # whole numbers have no error
            h = c[k] * mp.mpf(10) ** -22
            bar += abs(c[k]) * change(forces(x, [v + h * (m == k) for m, v in enumerate(c)]), f, h)
    return f, bar * mp.mpf(2) ** -53


def sample(name, words):
    style = registry.find("improper", name)
    return styles.Sample(style, style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, units.get("lj")))


def test_every_style_has_a_reference():
    with_forces = {n for n in registry.names("improper") if registry.find("improper", n).function}
    assert with_forces == {case[0] for case in CASES}


@pytest.mark.parametrize(("name", "words", "energy", "pairs"), CASES, ids=[f"{c[0]} {c[1]}" for c in CASES])
def test_forces_keep_their_digits(name, words, energy, pairs):
    s = sample(name, words)
    numbers = [w for w in words.split() if w != "aa"]
    errors = {}
    for title, x in geometries(pairs).items():
        want, bar = reference(energy, pairs, numbers, x)
        got = s.run(x.T)
        assert not got.bad[0], title
        errors[title] = float(max(norm([mp.mpf(float(p)) - q for p, q in zip(u, v)]) for u, v in zip(got.forces.T, want)) / bar)
        exact = energy([[mp.mpf(float(v)) for v in row] for row in x], *map(mp.mpf, numbers))
        work = np.linalg.norm(got.forces, axis=0).max() * np.linalg.norm(x - x[0], axis=1).max()
        assert got.acc[0] == pytest.approx(float(exact), rel=1e-14, abs=1e-14 * work + 1e-15 * float(numbers[0])), title
    worst = max(errors, key=errors.get)
    assert errors[worst] <= LIMIT, f"{worst}: the error is {errors[worst]:.3g} times what the condition allows"
    assert np.median(list(errors.values())) < 0.5


@pytest.mark.parametrize(("name", "words", "pairs"), [(c[0], c[1], c[3]) for c in CASES], ids=[f"{c[0]} {c[1]}" for c in CASES])
def test_direction_undefined_is_finite(name, words, pairs):
    s = sample(name, words)
    k = float(words.split()[0])
    for title, x in {"planar": [[0, 0, 0], [1, 0, 0], [-0.5, 0.9, 0], [-0.4, -0.8, 0]],
                     "upright": [[0, 0, 0], [1, 0, 0], [0, 1.1, 0], [0, 0, 0.9]],
                     "two arms in line": [[0, 0, 0], [1, 0, 0], [-1.2, 0, 0], [-0.4, -0.8, 0.3]],
                     "two arms folded": [[0, 0, 0], [1, 0, 0], [1.2, 0, 0], [-0.4, -0.8, 0.3]],
                     "others in line": [[0.1, 0.7, 0.3], [1, 0, 0], [-1.2, 0, 0], [0.2, 0, 0]],
                     "two others at one place": [[0.1, 0.7, 0.3], [1, 0, 0], [1, 0, 0], [0.2, 0.5, 0]],
                     "all in line": [[0, 0, 0], [1, 0, 0], [-1.2, 0, 0], [0.7, 0, 0]]}.items():
        x = np.array(x)[[1, 0, 2, 3] if pairs is SECOND else [0, 1, 2, 3]]
        a = s.run(x.T)
        if pairs is CHAIN and title == "two others at one place":
            assert a.bad[0] or name == "cossq"          # the torsion's middle bond
            continue
        assert not a.bad[0] and np.isfinite(a.forces).all() and np.isfinite(a.acc).all(), title
        assert np.abs(a.forces.sum(axis=1)).max() <= 1e-14 * (k + np.abs(a.forces).max()), title
        if title == "planar" and name in ("umbrella", "fourier", "inversion/harmonic", "sqdistharm", "distance"):
            assert not a.forces.any()                   # neither side is preferred


NEARLY_FLAT = [     # by less than the rounding of positions, also with two or all arms nearly on one line
    [[87.77844903113595, -18.08947505185405, 38.734995291462425], [18.316100658217287, 11.243921248042152, 10.744260947732162],
     [94.80464678719801, -21.05671593423808, 41.56378111374282], [-84.59359927343314, 57.50963285048083, 22.039730865713793]],
    [[-0.6328243737988577, -0.822138820746607, -0.1198867737155116], [-0.37317629052138956, -0.9291035941522163, 0.8511697085075909],
     [-0.07119749820100385, -1.0526149958063484, 1.9760467622708289], [-0.6439457637676744, -0.81760459400701, -0.1612411623545349]],
    [[-0.8291224533725476, 2.111435402765178, 4.122435444584586], [0.2222437431071369, 0.399473497892159, 0.43125712216872714],
     [-0.7033366223067364, 1.9064570509528618, 3.6751179481905223], [0.8865759619286655, -0.6822722230547464, -1.9010875149003428]],
    [[0.0, 0.0, 0.0], [-0.5767775255394412, -0.11969293014053238, -1.3566996424653124],
     [0.4127038867495104, 0.08513647335700719, 0.9788692973948562], [-1.0190781089286713, -0.21086026524396556, -2.4069585598123346]],
    # on the other side than their rounded differences
    [[-0.0007861438992652875, 0.0009773545836510987, 0.0004681677793679277], [0.0, 0.0, 0.0],
     [-0.016839097367118753, 0.02093478309685654, 0.010028057126736292], [3.5741919214422038, -4.438870486562226, -2.121142625599837]],
    [[-1.0293049097741807, -0.45006307368672466, -0.18801948379339048], [0.0, 0.0, 0.0],
     [-1.220582904930379, -0.1533931800282736, -0.15140665072448242], [0.7220673138630187, 0.628138622660727, 0.19067698421062695]],
]


@pytest.mark.parametrize(("name", "words", "energy"), [
    ("harmonic", "40 90", lambda x, K, c: K * (abs(torsion(x)) - deg(c)) ** 2), ("inversion/harmonic", "18 80", inversion)])
@pytest.mark.parametrize("number", range(len(NEARLY_FLAT)))
def test_the_side_of_a_plane_is_told_to_the_last_bit(name, words, energy, number):
    """There the force jumps from one side to the other, which no condition number knows."""
    s, x = sample(name, words), np.array(NEARLY_FLAT[number])
    with mp.workdps(110):
        rows, e = [[mp.mpf(float(v)) for v in row] for row in x], []
        h = mp.mpf(10) ** -50
        for i in range(4):
            for a in range(3):
                ends = [[[v + sign * h * (i == j and a == b) for b, v in enumerate(row)] for j, row in enumerate(rows)] for sign in (1, -1)]
                e.append(float((energy(ends[1], *map(mp.mpf, words.split())) - energy(ends[0], *map(mp.mpf, words.split()))) / (2 * h)))
    want = np.array(e).reshape(4, 3)
    for turn in range(3):
        got = s.run(np.roll(x, turn, axis=1).T)
        assert not got.bad[0]
        assert np.abs(np.roll(got.forces.T, -turn, axis=1) - want).max() <= 1e-3 * np.abs(want).max()
        level = x.copy()                             # exactly in a plane, and in no plane of the axes
        level[:, 2] = level[:, 1]
        assert not s.run(np.roll(level, turn, axis=1).T).forces.any()


@pytest.mark.parametrize("chi", [0, 180])
def test_harmonic_in_its_plane_is_pushed_to_neither_side(chi):
    s, side = sample("harmonic", "40 35"), 1.1 if chi == 0 else -1.1
    x = np.array([[-0.5, 1, 0], [0, 0, 0], [1.4, 0, 0], [1.9, side, 0]])
    a = s.run(x.T)
    assert not a.bad[0] and not a.forces.any() and not a.acc[2:].any()
    assert a.acc[0] == pytest.approx(40 * math.radians(chi - 35) ** 2, rel=1e-15)
    x[3, 2] = 1e-20                                # a direction, though chi is the same double
    up = s.run(x.T).forces[2, 3]
    assert up == pytest.approx(-80 * math.radians(chi - 35) / side, rel=1e-14)


@pytest.mark.parametrize(("name", "words"), [("harmonic", "40 35"), ("cvff", "80 1 5"), ("cvff", "80 -1 2")])
def test_three_atoms_on_a_line_have_the_energy_of_90_degrees(name, words):
    s, c = sample(name, words), [float(w) for w in words.split()]
    want = c[0] * math.radians(90 - c[1]) ** 2 if name == "harmonic" else c[0] * (1 + c[1] * math.cos(c[2] * math.pi / 2))
    for x in ([[-1, 0, 0], [0, 0, 0], [1.4, 0, 0], [1.9, 1.1, 0.2]], [[-0.4, 1, 0.3], [0, 0, 0], [1.4, 0, 0], [2.6, 0, 0]],
              [[1.0, 2, 3], [2, 3, 4], [3, 4, 5], [4, 5, 6]]):
        a = s.run(np.array(x, float).T)
        assert not a.bad[0] and not a.forces.any() and a.acc[0] == pytest.approx(want, rel=1e-14, abs=1e-25)


@pytest.mark.parametrize("name", ["class2", "umbrella", "fourier", "inversion/harmonic", "ring"])
def test_an_arm_of_length_zero_is_reported(name):
    style = registry.find("improper", name)
    s = sample(name, style.example)
    for k in range(4):
        if k == style.centre - 1:
            continue
        x = np.array([[0, 0, 0.3], [1, 0.1, 0], [-0.5, 0.9, 0], [-0.4, -0.8, 0.1]])
        x[k] = x[style.centre - 1]
        a = s.run(x.T)
        assert a.bad[0] == 1.0 and not a.forces.any()
        text = bonded.describe(style, a.bad[2], [7, 8, 9, 10], 1)
        assert "7 8 9 10" in text and "length 0" in text


# ------------------------------------------------------------------ LAMMPS ---

SCRIPT = """
answer = []
for lines in given["jobs"]:
    lmp = ran(lines)
    answer.append({"energy": lmp.get_thermo("eimp"), "forces": by_id(lmp, "f")})
    lmp.close()
"""
HEAD = """impropers

{0} atoms
{1} impropers
1 atom types
{2} improper types
0 40 xlo xhi
0 40 ylo yhi
0 40 zlo zhi

Masses

1 1.0
"""


def data(x, types, sections="") -> str:
    """Text of a data file with items of four atoms in a row; x (n, 3)."""
    lines = [HEAD.format(len(x), len(types), max(types)), sections, "Atoms # full", ""]
    lines += [f"{i} 1 1 0 {' '.join(map(repr, row))}" for i, row in enumerate(np.asarray(x).tolist(), 1)]
    lines += ["", "Impropers", ""]
    lines += [f"{m + 1} {t} {4 * m + 1} {4 * m + 2} {4 * m + 3} {4 * m + 4}" for m, t in enumerate(types)]
    return "\n".join(lines) + "\n"


def commands(path, improper_style: str, coeffs=()) -> list[str]:
    return ["units lj", "atom_style full", "pair_style zero 8.0", "special_bonds lj/coul 0 1 1", f"improper_style {improper_style}",
            f"read_data {path}", "pair_coeff * *", *coeffs, "thermo_style custom step eimp", "thermo_modify norm no", "run 0 post no"]


def ours(lines: list[str]) -> Lammps:
    return ran(lines, "-compat", "lammps")


def assert_agrees(energy, forces, want, title, force_error=3e-12):
    assert energy == pytest.approx(want["energy"], rel=1e-12), title
    assert forces == pytest.approx(np.array(want["forces"]), abs=force_error * np.abs(want["forces"]).max()), title


FLAT = "40 10"


def flatten(x):
    """Bring the fourth atom of each item near the plane of the others, where LAMMPS's sine has its smallest value (0.001)."""
    a, b, c, d = (x[:, k::4] for k in range(4))
    n = np.cross(b - a, c - a, axis=0)
    n /= np.linalg.norm(n, axis=0)
    d -= n * (((d - a) * n).sum(axis=0) - 5e-4)


def test_agrees_with_lammps(tmp_path):
    todo, jobs = [], []
    for name, words in [(c[0], c[1]) for c in CASES] + [("fourier", "3 1 0.5 0.7"), ("harmonic", FLAT)]:
        s = sample(name, words)
        s.x = styles.sample(s.style, seed=len(todo)).x
        if words == FLAT:
            flatten(s.x)
        path = tmp_path / f"data.{len(todo)}"
        path.write_text(data(s.x.T, [1] * styles.ITEMS))
        main, _, cross_term = words.partition(" aa ")
        coeffs = [f"improper_coeff 1 {main}"] + [f"improper_coeff 1 aa {cross_term}"] * bool(cross_term)
        s.style = s.style.bind({}, {}, "lammps")
        todo.append((f"{name} {words}", s))
        jobs.append(commands(path, name, coeffs))
    for (title, s), want in zip(todo, ask(SCRIPT, jobs=jobs)):
        words = title.partition(" ")[2]
        got = s.run()
        assert_agrees(got.acc[0], got.forces.T, want, title, *([1e-10] if words == FLAT else []))    # LAMMPS: sin^2 = 1 - cos^2


def test_cossq_is_the_gradient_unless_lammps_is_asked_for():
    style = registry.find("improper", "cossq")
    s = styles.sample(style)
    theirs = styles.Sample(style.bind({}, {}, "lammps"), s.packed, s.x)
    a, b = s.run(), theirs.run()
    assert b.items == pytest.approx(a.items, rel=1e-15)
    assert np.abs(a.forces - b.forces).max() > 0.1 * np.abs(a.forces).max()
    styles.check_style(style, ["gradient"])


SECTIONS = """
Improper Coeffs # {0}

1 {1}45 4
2 {2}

AngleAngle Coeffs

1 {1}12 -9 15 109.5 115 121
2 {3}
"""
FILES = {"class2": SECTIONS.format("class2", "", "20 -3", "1 2 3 100 110 120"),
         "hybrid class2 cvff": SECTIONS.format("hybrid", "class2 ", "cvff 5 -1 2", "skip")}


def test_angle_angle_coefficients_in_a_data_file(tmp_path):
    x = styles.sample(registry.find("improper", "class2")).x.T[:8]
    todo = {}
    for k, (name, sections) in enumerate(FILES.items()):
        path, written = tmp_path / f"data.{k}", tmp_path / f"out.{k}"
        path.write_text(data(x, [1, 2], sections))
        first = ours(commands(path, name))
        first.command(f"write_data {written}")
        text = written.read_text()
        assert "Improper Coeffs" in text and "AngleAngle Coeffs" in text and " aa " not in text and ("2 skip" in text) == (k == 1)
        todo[name] = first, commands(path, name), commands(written, name)
    answers = iter(ask(SCRIPT, jobs=[lines for _, *both in todo.values() for lines in both]))
    for name, (first, _, back) in todo.items():
        want = next(answers)
        both = [(first, want), (ours(back), next(answers))]      # both engines read what asemd wrote
        for answer, want in both:
            assert_agrees(answer.get_thermo("eimp"), np.array(answer.gather_atoms("f", 1, 3)).reshape(-1, 3), want, name)


def test_missing_and_wrong_coefficients(tmp_path):
    path = tmp_path / "data"
    path.write_text(data(styles.sample(registry.find("improper", "class2")).x.T[:4], [1]))
    for coeffs, message in (([], "All improper coeffs are not set"),
                            (["improper_coeff 1 45 4"], "All improper coeffs are not set: improper_coeff 1 .* lacks aa"),
                            (["improper_coeff 1 aa 1 2 3 100 100 100"], "lacks the main ones"),
                            (["improper_coeff 1 45 4 1"], "improper_coeff class2 needs K chi0, got 3 values"),
                            (["improper_coeff 1 aa 1 2 3"], "improper_coeff class2 aa needs M1 M2 M3 theta1 theta2 theta3, got 3 values")):
        with pytest.raises(AsemdError, match=message):
            ours(commands(path, "class2", coeffs))
    fourier = registry.find("improper", "fourier")
    assert fourier.parse_coeff("3 1 0.5 0.7".split(), {})["all"] == 1
    for words in ("3 1 0.5", "3 1 0.5 0.7 1.5", "3 1 0.5 0.7 1 1"):
        with pytest.raises(AsemdError, match="improper_coeff fourier"):
            fourier.parse_coeff(words.split(), {})
