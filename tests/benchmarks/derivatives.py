"""Derivatives of users' expressions: rounding errors, time from text to source, speed of the source.

``python -m tests.benchmarks.derivatives`` prints a Markdown table. An error is given as a multiple of
2^-53 (|r dF/dr| + sum |c dF/dc| + |F|), c being the constants that the expression names, against derivatives of 60 digits.
"""
from __future__ import annotations

import argparse
import math
import re
import statistics
import subprocess
import sys
import time
from unittest.mock import patch

import mpmath
import numba
import numpy as np

from asemd import calculus, expression
from asemd.expression import Compiled, compiled_function
from tests.benchmarks import compare

NEAR = (1e-8, 1e-5, 1e-3, 0.03, 0.3, 0.9, 1.4)          # from a rest length: the variable of bonds and angles
AWAY = (0.55, 0.8, 1.0, 1.1225, 1.3, 1.7, 2.4)          # between atoms
TURN = (1e-8, 1e-4, 0.7, math.pi / 2, 2.1, math.pi - 1e-6, -math.pi + 1e-9)      # torsion angles
EXPRESSIONS = {
    "k*r^2;k=250.0": NEAR,
    "0.5*k*r*r;k=250.7": NEAR,
    "k*(r-c)^2;k=500.3;c=0.96": AWAY,
    "k/2*(r-c)^2-d;k=500.3;c=1.1;d=3.3": AWAY,
    "k2*r^2+k3*r^3+k4*r^4;k2=300.1;k3=-100.7;k4=50.3": NEAR,
    "k*(r^2-c^2)^2;k=7.3;c=1.12": AWAY,
    "d*(1-exp(-a*r))^2;d=3.5;a=2.25": NEAR,
    "d*(exp(-a*r)-1)^2-d;d=3.5;a=2.25": NEAR,
    "d*(1-exp(-a*(r-c)))^2;d=4.1;a=1.9;c=1.1": AWAY,
    "d*z*(z-2);z=exp(-a*(r-c));d=4.1;a=1.9;c=1.1": AWAY,
    "d*(exp(-2*a*(r-c))-2*exp(-a*(r-c)));d=4.1;a=1.9;c=1.1": AWAY,
    "-0.5*k*s^2*log(1-(r/s)^2);k=30.3;s=1.53": NEAR,
    "-0.5*k*s^2*log((1-r/s)*(1+r/s));k=30.3;s=1.53": NEAR,
    "-0.5*k*s^2*log(1-(r/s)^2)+4*e*((g/r)^12-(g/r)^6)+e;k=30.3;s=2.53;e=1.1;g=1.07": AWAY,
    "4*e*((g/r)^12-(g/r)^6);e=0.9;g=1.1": AWAY,
    "a*exp(-r/b)-c/r^6;a=1000.7;b=0.31;c=29.3": AWAY,
    "q*erfc(a*r)/r;q=33.1;a=0.83": AWAY,
    "q*(1-erf(a*r))/r;q=33.1;a=1.83": AWAY,
    "k*(1-cos(r))^2;k=2.3": NEAR,
    "k*(1+cos(n*r-d));k=1.7;n=3;d=3.14159265358979": TURN,
    "k*(1+d*cos(n*r));k=4.5;d=-1;n=3": TURN,
    "a+b*cos(r)+c*cos(r)^2+d*cos(r)^3;a=1.1;b=-2.3;c=0.7;d=0.3": TURN,
    "k1*(1+cos(r))+k2*(1-cos(2*r))+k3*(1+cos(3*r));k1=0.7;k2=-0.3;k3=1.9": TURN,
    "k*tanh(4*r);k=2.3": NEAR,
    "select(step(r-c),k*(r-c)^2,0);k=12.3;c=0.93": AWAY,
    "k*abs(r-c)^3+min(r,1.2)^2;k=12.3;c=0.93": AWAY,
    "log(1+r)^2+sqrt(1+r^2)": NEAR,
    "14.4*y*z/r*(0.02817*exp(-0.20162*x)+0.28022*exp(-0.4029*x)+0.50986*exp(-0.94229*x)+0.18175*exp(-3.1998*x));"
    "x=r/s;s=0.127;y=6;z=14": AWAY,
    "f*(a*exp(-l*r)-b*exp(-m*r))*(1-exp(-p*(r-c)^2))^2;f=0.5*(1+cos(3.1*(r-0.5)/2.7));a=13.7;b=3.46;l=3.48;m=2.21;p=3.3;c=1.1": AWAY,
}


def plain(text: str) -> Compiled:
    """The same without the rewriting against cancellation."""
    with patch("sympy.codegen.rewriting.optimize", lambda e, rules: e):
        return fresh(text)


def fresh(text: str) -> Compiled:
    """An expression as source, not from disk."""
    with patch.object(expression, "source_of", calculus.differentiated):
        return expression.differentiate.__wrapped__(text, "r")


WAYS = {"asemd": fresh, "without rewriting": plain}


# ------------------------------------------------------------------ measures ---

def reference(text: str):
    """Slope (function of r and of the named constants) in mpmath, and the constants."""
    formula, *definitions = text.replace("^", "**").split(";")
    named, parts = {}, []
    for d in reversed(definitions):
        name, value = d.split("=")
        try:
            named[name] = mpmath.mpf(float(value))
        except ValueError:
            parts.append(f"{name} = {value}")
    functions = {n: getattr(mpmath, n) for n in "exp log cos sin tanh sqrt erf erfc".split()}
    functions |= {"abs": abs, "min": min, "step": lambda x: mpmath.mpf(x >= 0), "select": lambda c, a, b: a if c else b}

    def literal(source):
        return re.sub(r"(?<![\w.*])(\d+\.\d+)", r"mpf(\1)", source)

    def energy(r, constants):
        scope = {**functions, **constants, "r": r, "mpf": mpmath.mpf}
        for p in parts:
            exec(literal(p), scope)
        return eval(literal(formula), scope)

    return (lambda r, c, n=1: mpmath.diff(lambda y: energy(y, c), r, n)), named


def errors(text: str, ways: dict[str, Compiled]) -> dict[str, list[float]]:
    out: dict[str, list[float]] = {name: [] for name in ways}
    with mpmath.workdps(60):
        slope, named = reference(text)
        for x in EXPRESSIONS[text]:
            r = mpmath.mpf(x)
            want = slope(r, named)
            bar = abs(want) + abs(slope(r, named, 2) * r)
            for name, c in named.items():
                h = abs(c) * mpmath.mpf(10)**-20 if name != "n" else 0
                if h:
                    bar += abs(c * (slope(r, {**named, name: c + h}) - slope(r, {**named, name: c - h})) / (2 * h))
            for name, compiled in ways.items():
                got = slope_function(compiled)(*map(np.float64, (x, *compiled.constants)))
                error = abs(mpmath.mpf(float(got)) - want) if math.isfinite(got) else mpmath.inf
                out[name].append(float(error / (bar * mpmath.mpf(2)**-53)) if error else 0.0)
    return out


def slope_function(compiled: Compiled, energy: bool = False):
    arguments = [expression.ARGUMENT, *(f"p{k}" for k in range(len(compiled.constants)))]
    value = f"{compiled.energy}, {compiled.slope}" if energy else compiled.slope
    lines = [*compiled.lines, f"return {value}"]
    return compiled_function("slope", f"def slope({', '.join(arguments)}):\n" + "".join(f"    {line}\n" for line in lines))


def speed(compiled: Compiled, places, samples: int) -> float:
    """Nanoseconds for energy and slope of one interaction, compiled."""
    one = numba.njit(fastmath={"contract"}, error_model="numpy")(slope_function(compiled, energy=True))

    @numba.njit
    def total(x, energy, slope, constants):
        for k in range(len(x)):
            energy[k], slope[k] = one(x[k], *constants)

    x = np.resize(np.array(places), 2000)
    energy, slope, constants = np.empty_like(x), np.empty_like(x), tuple(compiled.constants)
    total(x, energy, slope, constants)
    seconds = []
    for _ in range(20 * samples):
        begin = time.perf_counter()
        total(x, energy, slope, constants)
        seconds.append(time.perf_counter() - begin)
    return min(seconds) / len(x) * 1e9


def milliseconds(way, text: str) -> float:
    begin = time.perf_counter()
    way(text)
    return 1e3 * (time.perf_counter() - begin)


def import_seconds(samples: int) -> list[float]:
    code = "import numpy, time; t = time.perf_counter(); import sympy; print(time.perf_counter() - t)"
    return sorted(float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(samples))


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--samples", type=int, default=9)
    samples = p.parse_args().samples
    fresh("r")      # imports sympy
    worst: dict[str, list[float]] = {name: [] for name in WAYS}
    took: dict[str, list[float]] = {name: [] for name in WAYS}
    ratio: dict[str, list[float]] = {name: [] for name in WAYS}
    print("| expression | " + " | ".join(f"{n}: worst error, ms, ns" for n in WAYS) + " |\n|---|" + "---|" * len(WAYS))
    for text in EXPRESSIONS:
        compiled, row = {}, []
        for name, way in WAYS.items():
            took[name].append(milliseconds(way, text))
            compiled[name] = way(text)
        each = errors(text, compiled)
        ns = {name: speed(c, EXPRESSIONS[text], samples) for name, c in compiled.items()}
        for name in WAYS:
            worst[name] += each[name]
            ratio[name].append(ns[name] / ns["asemd"])
            row.append(f"{max(each[name]):.2g}, {took[name][-1]:.2g}, {ns[name]:.1f}")
        print(f"| `{text}` | " + " | ".join(row) + " |", flush=True)
    totals = [f"median {statistics.median(worst[n]):.2g}, worst {max(worst[n]):.2g}, above 8: {sum(e > 8 for e in worst[n])} of "
              f"{len(worst[n])}; {statistics.median(took[n]):.2g} ms; {statistics.median(ratio[n]):.2f} x time" for n in WAYS]
    print("| all | " + " | ".join(totals) + " |")
    print("import of sympy after numpy:", ", ".join(f"{s:.2f}" for s in import_seconds(samples)), "s;", compare.machine())


if __name__ == "__main__":
    main()
