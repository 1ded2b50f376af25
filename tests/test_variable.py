"""The formula language; expected values are those of LAMMPS (22 Jul 2025)."""
from __future__ import annotations

import math

import numpy as np
import pytest

from asemd.errors import InputError
from asemd.variable import Clock, Variables


class Provider:
    """Three atoms, one compute per atom, one with a vector."""

    def __init__(self):
        self.now = Clock(step=0, begin=0, end=100, dt=0.5)

    def clock(self):
        return self.now

    def thermo(self, keyword):
        if keyword != "vol":
            raise InputError(f"unknown word {keyword!r}")
        return 8.0

    def atoms(self, name):
        return {"x": np.array([1.0, 2.0, 4.0]), "id": np.array([5.0, 6.0, 7.0])}[name]

    def row(self, atom_id):
        return {5: 0, 6: 1, 7: 2}[atom_id]

    def has(self, kind, id, what):
        return what == "per_atom" if id == "pa" else what != "per_atom"

    def per_atom(self, kind, id, column):
        return np.array([10.0, 20.0, 30.0])

    def reference(self, kind, id, index):
        return {(): 3.0, (2,): 22.0, (1, 2): 12.0}[tuple(index)]

    def vector(self, kind, id, column):
        return np.array([1.0, 2.0, 6.0])

    def group(self, name):
        return np.array([True, name == "all", True])

    def region(self, name):
        return np.array([True, True, False])

    def group_function(self, name, mask, word):
        return float(mask.sum()) if name == "count" else {"x": 1.0, "y": 2.0}[word]

    def defined(self, category, name):
        return (category, name) == ("compute", "pa")


@pytest.fixture
def variables():
    return Variables(Provider())


@pytest.mark.parametrize("formula, value", [
    ("5%3", 2), ("-5%3", -2), ("-2^2", 4), ("-(2^2)", -4), ("2^3^2", 64), ("10-4-3", 3), ("2*3%4", 2), ("1==1.0", 1), ("!0", 1),
    ("1|^1", 0),
    ("1 && 0 || 1", 1), ("1 > 2 || 3 >= 3", 1), ("1 + 2*(3 - 1)", 5), ("round(2.5)", 3), ("round(-2.5)", -2), ("floor(-1.2)", -2),
    ("ceil(1.2)", 2),
    ("ternary(1,2,3)", 2), ("2e3+1.e-2*.5", 2000.005), ("PI", math.pi), ("yes+off", 1), ("sqrt(2)", math.sqrt(2)),
    ("ln(exp(2))", 2), ("log(100)", 2),
    ("atan2(1,2)", math.atan2(1, 2)), ("abs(-3)", 3), ("vol/2", 4), ("x[6]", 2), ("c_g", 3), ("c_g[2]", 22), ("c_a[1][2]", 12),
    ("c_pa[6]", 20),
    ("sum(c_g)", 9), ("ave(c_g)", 3), ("trap(c_g)", 5.5), ("max(c_g)-min(c_g)", 5), ("slope(c_g)", 2.5), ("count(all)", 3),
    ("count(all,r)", 2),
    ("xcm(all,y)", 2), ("version", 20250722), ("is_defined(compute,pa)", 1),
])
def test_values(variables, formula, value):
    assert variables.evaluate(formula) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("step, expected", [
    (0, [10, 10, 10, 10, 10, 10]), (10, [33, 13, 20, 30, 15, 20]), (55, [78, 57, 100, 60, None, 56]),
    (100, [325, 122, 200, 120, None, None]),
])
def test_functions_of_the_step(variables, step, expected):
    variables.provider.now.step = step
    formulas = ["logfreq2(10,4,10)", "logfreq3(10,25,1000)", "logfreq(10,3,10)", "stagger(30,10)", "stride(10,50,5)",
                "stride2(0,100,10,20,56,2)"]
    never = 2.0**63 - 1024
    assert [variables.evaluate(f) for f in formulas] == [never if e is None else e for e in expected]


def test_ramps(variables):
    variables.provider.now = Clock(step=25, begin=0, end=100, dt=0.5)
    assert variables.evaluate("ramp(1,3)") == 1.5
    assert variables.evaluate("vdisplace(1,2)") == 26.0
    assert variables.evaluate("swiggle(1,2,50)") == pytest.approx(1 + 2 * math.sin(2 * math.pi * 12.5 / 50))
    assert variables.evaluate("cwiggle(1,2,50)") == pytest.approx(1 + 2 * (1 - math.cos(2 * math.pi * 12.5 / 50)))


def test_random_numbers_are_those_of_lammps(variables):
    assert variables.evaluate("random(0,1,1234)") == 0.65446245670318603516
    assert variables.evaluate("normal(0,1,1234)") == pytest.approx(-1.088887946993161604, rel=1e-15)
    assert variables.evaluate("random(0,1,1)") == 0.28788578510284423828      # one generator for all: the first seed counts


@pytest.mark.parametrize("formula, message", [
    ("1/0", "division by 0"), ("sqrt(-1)", "sqrt"), ("ln(0)", "ln"), ("1 2", "unexpected"), ("1+", "missing"), ("(1", r"\)"),
    ("sqr(2)", "did you mean sqrt"),
    ("sqrt(1,2)", "1 argument"), ("foo", "foo"), ("v_nope", "undefined variable nope"), ("x", "per atom"),
    ("gmask(all)", "atom-style"), ("1 $ 2", "invalid character"),
])
def test_errors(variables, formula, message):
    with pytest.raises(InputError, match=message):
        variables.evaluate(formula)


def test_circular_definition(variables):
    variables.define("a", "equal", ["v_b"])
    variables.define("b", "equal", ["v_a"])
    with pytest.raises(InputError, match="circular"):
        variables.value("a")


def test_definitions(variables):
    variables.define("i", "index", ["one", "two"])
    variables.define("i", "index", ["ignored"])
    assert variables.value("i") == "one"
    assert not variables.advance(["i"]) and variables.value("i") == "two"
    assert variables.advance(["i"])
    with pytest.raises(InputError, match="undefined variable i"):
        variables.value("i")
    variables.define("l", "loop", ["3", "10", "pad"])
    assert variables.value("l") == "03"
    variables.define("e", "equal", ["1", "+", "2"])
    assert variables.value("e") == "3"
    variables.define("e", "equal", ["1/3"])
    assert variables.value("e") == "0.333333333333333"
    with pytest.raises(InputError, match="style equal"):
        variables.define("e", "string", ["x"])
    variables.define("f", "format", ["e", "%.3f"])
    assert variables.value("f") == "0.333"
    variables.define("e", "delete", [])
    assert "e" not in variables.table
    with pytest.raises(InputError, match="unknown or not supported"):
        variables.define("w", "worlds", ["1"])
    with pytest.raises(InputError, match="letters"):
        variables.define("a-b", "equal", ["1"])


def test_atom_style(variables):
    variables.define("a", "atom", ["2*x+c_pa*gmask(some)"])
    assert variables.per_atom("a", 3).tolist() == [12.0, 4.0, 38.0]
    assert variables.evaluate("v_a[7]") == 38.0
    variables.define("m", "atom", ["rmask(r)*id"])
    assert variables.per_atom("m", 3).tolist() == [5.0, 6.0, 0.0]
    variables.define("c", "atom", ["1.5"])
    assert variables.per_atom("c", 3).tolist() == [1.5, 1.5, 1.5]
    with pytest.raises(InputError, match="one number"):
        variables.evaluate("v_a")


def test_references_go_through_variables(variables):
    variables.define("a", "equal", ["press + v_b"])
    variables.define("b", "equal", ["c_one[2]"])
    assert {"press", "c_one"} <= variables.references("v_a")
