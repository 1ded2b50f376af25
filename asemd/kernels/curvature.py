"""First and second derivatives of a style by its own coordinates, for many items at once: a compiled loop made from its functions."""
from __future__ import annotations

from functools import cache
from types import FunctionType

from asemd.kernels.generate import Builder, plain_source


def _loop(coordinates: int, call: str, second: bool, lookup: str) -> str:
    lines = ["def loop(q, ti, tj, qq, coeff, constants, arrays, slope, second):", "    for m in range(q.shape[0]):", f"        {lookup}"]
    answer = ", ".join(["e", *(f"slope[m, {a}]" for a in range(coordinates))])
    lines.append(f"        {answer} = potential({call})")
    lines.append("        if not math.isfinite(e):\n            slope[m, 0] = math.inf")
    if second and coordinates == 1:
        lines.append(f"        second[m, 0, 0] = curvature({call})")
    elif second:
        lines.append(f"        rows = curvature({call})")
        lines += [f"        second[m, {a}, {b}] = rows[{a}][{b}]" for a in range(coordinates) for b in range(coordinates)]
    return "\n".join(lines)


def _called(function) -> list:
    """Functions of styles that a function calls, and what these call, the innermost first."""
    found = [f for f in map(function.__globals__.get, function.__code__.co_names) if isinstance(f, FunctionType) and f is not function]
    return list(dict.fromkeys(inner for f in found for inner in (*_called(f), f)))


def _build(title: str, helpers, function, d2, text: str):
    b = Builder(title)
    for helper in helpers:
        b.text(plain_source(helper), cache=False)
    b.text(plain_source(function, "potential"), cache=False)
    if d2 is not None:
        for inner in [f for f in _called(d2) if f is not function and f not in helpers]:
            b.text(plain_source(inner), cache=False)
        b.text(plain_source(d2, "curvature"), cache=False)
    b.text(text)
    return b.build().loop


@cache
def of_style(style, d2):
    """The loop of a bonded style; `d2`: its second derivatives, or None for slopes only.

    Returns
    -------
    callable
        ``f(q, types, types, empty, coeff, constants, arrays, slope, second)``: `q (m, nc)` coordinates, fills `slope (m, nc)` and
        `second (m, nc, nc)`; a slope of inf: outside the domain.
    """
    rows = [n for n in style.arguments if n not in style.arrays]
    words = [f"q[m, {a}]" for a in range(len(style.coordinates))]
    words += [f"arrays[{style.arrays.index(n)}]" if n in style.arrays else f"coeff[{rows.index(n)}, t]" for n in style.arguments]
    *helpers, function = style.functions()
    text = _loop(len(style.coordinates), ", ".join(words), d2 is not None, "t = ti[m]")
    return _build(f"Second derivatives of {style.category}_style {style.name}.", helpers, function, d2, text)


@cache
def of_part(part, d2, row: int, constant: int, array: int):
    """The loop of one part of a pair style; `row`, `constant`, `array`: where its coefficients begin in the tables.

    Returns
    -------
    callable
        As `of_style`, with two types and the product of charges `qq (m,)`, for the coordinate ``r2`` or ``r``.
    """
    words = ["q[m, 0]"] + ["qq[m]"] * part.charged + [f"coeff[{row + 2 + k}, ti[m], tj[m]]" for k in range(len(part.rows))]
    words += [f"constants[{constant + k}]" for k in range(len(part.constants))] + [f"arrays[{array + k}]" for k in range(len(part.arrays))]
    text = _loop(1, ", ".join(words), d2 is not None, "t = 0")
    return _build(f"Second derivatives of {part.function.__name__}.", (), part.function, d2, text)
