"""What `check_style` says of styles of a user's own: right ones, and ones with the usual mistakes."""
from __future__ import annotations

import math

import pytest

from asemd.style import Style
from asemd.testing import check_style, report_style

SCALE = 2.0


def spring(r, K: "energy/distance^2", r0: "distance"):
    return K * (r - r0) * (r - r0), 2.0 * K * (r - r0)


def spring_d2(r, K, r0):
    return 2.0 * K


def wrong_gradient(r, K: "energy/distance^2", r0: "distance"):
    return K * (r - r0) * (r - r0), K * (r - r0)


def wrong_d2(r, K, r0):
    return -2.0 * K


def short_d2(r, K):
    return 2.0 * K


def logarithm(r, K: "energy", R: "distance"):
    return -K * math.log(1.0 - (r / R) ** 2), 2.0 * K * r / ((R - r) * (R + r))


def not_a_number(r, K: "energy", R: "distance"):
    if r > R:
        return math.nan, math.nan
    return K * r, K


def sine_from_cosine(theta, K: "energy"):
    c = math.cos(theta)
    return K * (1.0 + c), -K * math.sqrt(1.0 - c * c)


def energy_only(phi, K: "energy"):
    return K * (1.0 + math.cos(phi))


def one_missing(phi, r12, K: "energy"):
    return K * r12 * (1.0 + math.cos(phi)), -K * r12 * math.sin(phi)


def constant_of_the_module(r, K: "energy"):
    return SCALE * K * r, SCALE * K


def no_unit(r, K: "energie"):
    return K * r, K


def direction(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy/distance^2"):
    return K * ax * ax, 2.0 * K * ax, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


def mine(category, function, example="50.0 1.5", **options):
    return Style(category, "mine", function, example=example, **options)


def test_right_style():
    style = mine("bond", spring, equilibrium="r0", d2=spring_d2)
    check_style(style)
    assert report_style(style).count("passed") == 11
    report = report_style(mine("bond", spring))
    assert report.count("passed") == 10 and "curvature  left out  it has no second derivatives, the option d2" in report


@pytest.mark.parametrize(("style", "check", "text"), [
    (mine("bond", wrong_gradient), "slope", "dE/dr is not the derivative"),
    (mine("bond", spring, d2=wrong_d2), "curvature", "d2E/dr dr is not that of the energy at r = "),
    (mine("bond", spring, d2=short_d2), "function", "d2 must take the 3 arguments of the function, not 2"),
    (mine("bond", spring, d2=lambda r, K, r0: 2.0 * K), "function", "lambda"),
    (mine("bond", spring, ""), "function", "the example coefficients '' are refused: bond_coeff mine needs K r0, got 0 values"),
    (mine("bond", logarithm), "digits", "plain Python raises ValueError .* at r = 40: return math.inf for the energy"),
    (mine("bond", not_a_number), "digits", "not a number at r = 40: return math.inf for the energy"),
    (mine("bond", constant_of_the_module, "3.0"), "function", "uses SCALE, which machine code does not know"),
    (mine("bond", no_unit, "3.0"), "function", "unit of K: unknown word 'energie'"),
    (mine("angle", sine_from_cosine, "3.0"), "digits", "from 180 degrees forces are off by .* digits cancel"),
    (mine("dihedral", energy_only, "3.0"), "function", "must return the energy and its derivative by phi, 2 numbers, got 1"),
    (mine("dihedral", one_missing, "3.0"), "function", "the energy and its derivatives by phi r12, 3 numbers, got 2"),
    (mine("improper", direction, "3.0"), "invariance", "the energy changes with a rotation"),
], ids=lambda v: v.function.__name__ if isinstance(v, Style) else "")
def test_wrong_style(style, check, text):
    with pytest.raises(AssertionError, match=text) as told:
        check_style(style)
    assert "\n" not in str(told.value).split("assert")[0]
    report = report_style(style)
    assert report.count("\n") == 11 and f"{check:11}FAILED" in report
    if check == "function":
        assert report.count("FAILED") == 1
