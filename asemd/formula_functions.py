"""Operators and functions of formulas: arithmetic, functions of the timestep, what a group function takes, sums over vectors.

Source: the LAMMPS manual page of ``variable``; each is on one number and `each` applies it to per-atom values.
"""
from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asemd.errors import InputError, Undefined

Value = float | np.ndarray
NEVER = 2.0**63 - 1024     # the step that no run reaches


@dataclass
class Clock:
    """Steps and timestep that ``ramp``, ``stagger`` and their relatives look at.

    Outside a run, ``ramp`` has its first value, and the time of ``vdisplace`` and its relatives begins at step 0.
    """

    step: int = 0
    begin: int = 0
    end: int = 0
    dt: float = 0.0
    running: bool = True


# ------------------------------------------------------------- arithmetic ---

def each(function: Callable[..., float], *values: Value) -> Value:
    """Apply to numbers, or to each element of per-atom values and vectors."""
    sizes = {v.size for v in values if isinstance(v, np.ndarray)}
    if len(sizes) > 1:
        raise InputError(f"vectors of different lengths in a formula: {' and '.join(map(str, sorted(sizes)))}")
    if sizes:
        if function in FAST:        # the same roundings, many times as fast
            return FAST[function](*values)
        return np.array([function(*row) for row in np.broadcast(*values)], float)
    return function(*values)


def whole(value: float, what: str) -> int:
    """The whole part of a finite number."""
    if not math.isfinite(value):
        raise Undefined(f"{what}: {value:g} is not a whole number")
    return int(value)


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        raise Undefined("division by 0 in a formula")
    return a / b


def _modulo(a: float, b: float) -> float:
    if b == 0.0:
        raise Undefined("modulo 0 in a formula")
    return math.fmod(a, b) if math.isfinite(a) and not math.isnan(b) else math.nan


def _power(a: float, b: float) -> float:
    try:
        return math.pow(a, b)
    except OverflowError:
        return math.inf if a > 0 or b % 2 == 0 else -math.inf
    except ValueError:
        raise Undefined(f"invalid power {a:g} ^ {b:g} in a formula") from None


def _minus(a: float, b: float) -> float:
    return a - b


def _plus(a: float, b: float) -> float:
    return a + b


def _times(a: float, b: float) -> float:
    return a * b


FAST: dict[Callable[..., float], Callable[..., np.ndarray]] = {_plus: np.add, _minus: np.subtract, _times: np.multiply}


BINARY = (
    {"||": lambda a, b: float(a != 0.0 or b != 0.0), "|^": lambda a, b: float((a != 0.0) != (b != 0.0))},
    {"&&": lambda a, b: float(a != 0.0 and b != 0.0)},
    {"==": lambda a, b: float(a == b), "!=": lambda a, b: float(a != b)},
    {"<": lambda a, b: float(a < b), "<=": lambda a, b: float(a <= b), ">": lambda a, b: float(a > b), ">=": lambda a, b: float(a >= b)},
    {"+": _plus, "-": _minus},
    {"*": _times, "/": _divide, "%": _modulo},
    {"^": _power},
)


def _domain(name: str, function: Callable[[float], float], ok: Callable[[float], bool]) -> Callable[[float], float]:
    def checked(x: float) -> float:
        if not ok(x):
            raise Undefined(f"{name}({x:g}) is not defined")
        try:
            return function(x)
        except OverflowError:
            return math.inf
    return checked


def _any(x: float) -> bool:
    return True


MATH: dict[str, tuple[int, Callable[..., float]]] = {
    "sqrt": (1, _domain("sqrt", math.sqrt, lambda x: x >= 0.0)),
    "exp": (1, _domain("exp", math.exp, _any)),
    "ln": (1, _domain("ln", math.log, lambda x: x > 0.0)),
    "log": (1, _domain("log", math.log10, lambda x: x > 0.0)),
    "abs": (1, abs), "sin": (1, _domain("sin", math.sin, math.isfinite)),
    "cos": (1, _domain("cos", math.cos, math.isfinite)), "tan": (1, _domain("tan", math.tan, math.isfinite)), "atan": (1, math.atan),
    "asin": (1, _domain("asin", math.asin, lambda x: -1.0 <= x <= 1.0)),
    "acos": (1, _domain("acos", math.acos, lambda x: -1.0 <= x <= 1.0)),
    "atan2": (2, math.atan2),
    "ceil": (1, lambda x: float(np.ceil(x))), "floor": (1, lambda x: float(np.floor(x))),
    "round": (1, lambda x: float(np.floor(x + 0.5))), "sign": (1, lambda x: math.copysign(1.0, x)),
    "ternary": (3, lambda a, b, c: b if a != 0.0 else c),
}


# ------------------------------------------------- functions of the timestep ---

def _whole(*values: float) -> list[int]:
    return [whole(v, "a function of the timestep") for v in values]


def _require(ok: bool, name: str, rule: str) -> None:
    if not ok:
        raise InputError(f"{name}() needs {rule}")


def _ramp(c: Clock, x: float, y: float) -> float:
    return x + (y - x) * ((c.step - c.begin) / (c.end - c.begin) if c.running and c.end != c.begin else 0.0)


def _stagger(c: Clock, x: float, y: float) -> float:
    x, y = _whole(x, y)
    _require(x > 0 and y > 0 and x > y, "stagger", "x > y > 0")
    low = c.step // x * x
    return float(low + y if c.step - low < y else low + x)


def _logfreq(c: Clock, x: float, y: float, z: float) -> float:
    x, y, z = _whole(x, y, z)
    _require(x > 0 and y > 0 and 0 < y < z, "logfreq", "x > 0 and 0 < y < z")
    if c.step < x:
        return float(x)
    low = x
    while c.step >= z * low:
        low *= z
    multiple = c.step // low
    return float((multiple + 1) * low if multiple < y else low * z)


def _logfreq2(c: Clock, x: float, y: float, z: float) -> float:
    x, y, z = _whole(x, y, z)
    _require(x > 0 and y > 0 and z > 1, "logfreq2", "x, y > 0 and z > 1")
    if c.step < x:
        return float(x)
    low = x
    while c.step >= z * low:
        low *= z
    k = max(1, int((c.step / low - 1) * y / (z - 1)) - 1)       # close to the one, not beyond it
    while math.ceil(low * (1 + k * (z - 1) / y)) <= c.step:
        k += 1
    return float(math.ceil(low * (1 + k * (z - 1) / y)))


def _logfreq3(c: Clock, x: float, y: float, z: float) -> float:
    x, y, z = _whole(x, y, z)
    _require(x > 0 and y > 1 and z - x + 1 >= y, "logfreq3", "x > 0, y > 1 and at least y steps from x to z")
    if c.step < x:
        return float(x)
    if c.step > z:
        raise InputError(f"logfreq3({x},{y},{z}) has no step after {c.step}")
    exact, step, factor = float(x), x, (z / x) ** (1.0 / (y - 1))
    while step <= c.step:
        exact, step = exact * factor, step + 1
        step = max(step, math.ceil(exact))
    return float(step if c.step == z else min(step, z))


def _stride(c: Clock, x: float, y: float, z: float) -> float:
    x, y, z = _whole(x, y, z)
    _require(0 <= x <= y and z > 0, "stride", "0 <= x <= y and z > 0")
    if c.step < x:
        return float(x)
    step = x + ((c.step - x) // z + 1) * z
    return float(step) if step <= y else NEVER


def _stride2(c: Clock, x: float, y: float, z: float, a: float, b: float, d: float) -> float:
    x, y, z, a, b, d = _whole(x, y, z, a, b, d)
    _require(0 <= x <= y and 0 <= a <= b and z > 0 and d > 0, "stride2", "x <= y, a <= b, z > 0 and d > 0")
    _require(a >= x and b <= y, "stride2", "a and b between x and y")
    if c.step < x:
        step = x
    elif c.step < a:
        step = min(x + ((c.step - x) // z + 1) * z, a)
    elif c.step < b:
        step = min(a + ((c.step - a) // d + 1) * d, b)
        step = step if (c.step - a) // d * d + a + d <= b else b + z
    else:
        step = b + ((c.step - b) // z + 1) * z
    return float(step) if step <= y else NEVER


def _wave(omega: float, function: Callable[[float], float]) -> float:
    if not math.isfinite(omega):
        raise InputError("swiggle() and cwiggle() need a period that is not 0")
    return function(omega)


def _elapsed(c: Clock) -> float:
    return (c.step - (c.begin if c.running else 0)) * c.dt


STEP: dict[str, tuple[int, Callable[..., float]]] = {
    "ramp": (2, _ramp), "stagger": (2, _stagger), "logfreq": (3, _logfreq), "logfreq2": (3, _logfreq2), "logfreq3": (3, _logfreq3),
    "stride": (3, _stride), "stride2": (6, _stride2),
    "vdisplace": (2, lambda c, x, v: x + v * _elapsed(c)),
    "swiggle": (3, lambda c, x, a, t: x + a * _wave(_divide(2.0 * math.pi, t) * _elapsed(c), math.sin)),
    "cwiggle": (3, lambda c, x, a, t: x + a * (1.0 - _wave(_divide(2.0 * math.pi, t) * _elapsed(c), math.cos))),
}

# words a group function takes besides group and region
GROUP = {"count": 0, "mass": 0, "charge": 0, "xcm": 1, "vcm": 1, "fcm": 1, "bound": 1, "gyration": 0, "ke": 0, "angmom": 1, "torque": 1,
         "inertia": 1, "omega": 1}


def _slope(v: np.ndarray) -> float:
    t = np.arange(v.size, dtype=float)
    t -= t.mean()
    return float((t * (v - v.mean())).sum() / (t * t).sum())


REDUCE: dict[str, Callable[[np.ndarray], float]] = {
    "sum": np.sum, "min": np.min, "max": np.max, "ave": np.mean, "slope": _slope,
    "trap": lambda v: np.sum(v) - 0.5 * (v[0] + v[-1]),
}
