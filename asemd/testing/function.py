"""What a style says of itself: its example line, the arguments of its function, and whether machine code can be made of that."""
from __future__ import annotations

import builtins
import dis
import inspect
import math
import tempfile
from pathlib import Path

import numpy as np

from asemd import units
from asemd.errors import InputError
from asemd.style import Packed, Style


def example_words(style: Style, folder: str) -> list[str]:
    """One valid line of coefficients; a style that reads a table gets one written into `folder`."""
    if not any(p.unit == "path" for p in style.coeff):
        return style.example.split()
    lo, hi = {"bond": (0.2, 3.0), "angle": (0.0, 180.0), "dihedral": (-170.0, 180.0)}[style.category]
    x = np.linspace(lo, hi, 36)
    scale = 1.0 if style.category == "bond" else math.pi / 180.0
    e, f = 5.0 * np.cos(scale * x - 0.4), 5.0 * scale * np.sin(scale * x - 0.4)
    rows = "".join(f"{i} {a!r} {b!r} {c!r}\n" for i, (a, b, c) in enumerate(zip(x.tolist(), e.tolist(), f.tolist()), 1))
    path = Path(folder) / f"{style.category}.table"
    path.write_text(f"# written by asemd\n\nEXAMPLE\nN {len(x)}\n\n{rows}")
    return [{"file": str(path), "KEYWORD": "EXAMPLE"}.get(word, word) for word in style.example.split()]


def example(style: Style) -> tuple[Packed, float]:
    """The example coefficients as kernels take them, and the length of a bond (1 but for bond styles that have a rest length)."""
    with tempfile.TemporaryDirectory() as folder:
        settings = style.parse_settings(style.settings_example.split())
        coeff = style.parse_coeff(example_words(style, folder), settings)
        packed = style.pack(settings, {1: coeff}, 1, units.get("lj"))
    return packed, float(coeff.get(style.equilibrium, 1.0)) if style.category == "bond" else 1.0


def constants(style: Style, packed: Packed) -> list:
    """What a style's function takes after the coordinates."""
    rows = iter(packed.coeff[:, 1].tolist())
    return [packed.arrays[style.arrays.index(n)] if n in style.arrays else next(rows) for n in style.arguments]


def check_function(style: Style) -> None:
    """The function knows its units and names and returns the energy and its derivatives; machine code can be made of it."""
    for p in style.coeff:
        if p.unit not in ("", "angle", "integer", "word", "path"):
            try:
                units.factor(p.unit, "real")
            except (InputError, ValueError, KeyError) as e:
                raise AssertionError(f"{style}: unit of {p.name}: {e}") from None
    try:
        packed, length = example(style)
    except InputError as e:
        raise AssertionError(f"{style}: the example coefficients {style.example!r} are refused: {e.message}") from None
    helpers = {f.__name__ for f in style.functions()}
    for function in filter(None, (*style.functions(), style.d2, style.straight)):
        assert function.__name__ != "<lambda>", f"{style}: machine code cannot be made of a lambda: write a function with def"
        used = {i.argval for i in dis.get_instructions(function) if i.opname == "LOAD_GLOBAL"}
        for name in sorted(used - helpers - {"math", "np"} - set(dir(builtins))):
            raise AssertionError(f"{style}: the function uses {name}, which machine code does not know: write constants out as numbers, "
                                 "hand functions over by Style.functions")
    slopes = [name for name in style.coordinates if name not in ("rate", "reference")]
    values = [length if name.startswith("r") else 1.1 + 0.1 * k for k, name in enumerate(style.coordinates)]
    try:
        answer = style.function(*values, *constants(style, packed))
    except Exception as e:
        at = " ".join(f"{n} = {v:.4g}" for n, v in zip(style.coordinates, values))
        raise AssertionError(f"{style}: the function fails at {at}: {type(e).__name__}: {e}") from None
    if style.d2:
        count, want = len(inspect.signature(style.d2).parameters), len(style.coordinates) + len(style.arguments)
        assert count == want, f"{style}: d2 must take the {want} arguments of the function, not {count}"
    got = len(answer) if isinstance(answer, tuple) else 1
    if got != 1 + len(slopes):
        raise AssertionError(f"{style}: the function must return the energy and its derivative{'s' * (len(slopes) != 1)} by "
                             f"{' '.join(slopes)}, {1 + len(slopes)} numbers, got {got}")
