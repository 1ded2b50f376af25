"""The compiled loops of bonded styles.

Two modules make the forces of a style: the loop over blocks of items (`asemd.kernels.block`) with the geometry of its coordinates, compiled
once for all styles that take the same ones, and `evaluate`, the style's function for the columns of a block, which the loop calls by its
address.
"""
from __future__ import annotations

import ast
import functools
import math
from collections.abc import Callable, Sequence
from types import ModuleType

import numpy as np
from numba import config

from asemd.kernels import algebra, angle, block, bond, bond_history, dihedral, dipole, image, vector_math, vectors, volume
from asemd.kernels.algebra import ROW
from asemd.kernels.generate import Builder, plain_source
from asemd.kernels.hooks import bound
from asemd.kernels.paste import paste
from asemd.kernels.state import aligned
from asemd.style import VECTORS, Style
from asemd.topology import ATOMS

ANGLE = ("theta", "r12", "r32", "r13")
TORSION = ("phi", "r12", "r23", "r34", "theta1", "theta2")
PAST = ("rate", "reference")        # what a bond with a past can have besides; no derivatives
ROWS = {angle: {"SHAPE": 1, "NORMAL": 1}, dihedral: {"SHAPE": 1, "SIDE": 1, "FLAT": 1}, dipole: {"SHAPE": 1, "NORMAL": 3},
        vectors: {"VALUE": 1}}
INNER = "no_cpython_wrapper=True"       # called from the same module only
NO_TABLE = np.zeros((1, 1))


def chart(style: Style) -> tuple[str, ...]:
    """The coordinates that the geometry of a style can offer it."""
    first = style.coordinates[0]
    if first == "ax":
        return VECTORS[:6] if style.category == "angle" else VECTORS
    if first in ("phi", "chi"):
        return TORSION
    if style.category == "bond":
        return ("r",)
    return ANGLE if style.category == "angle" and first != "gamma" else style.coordinates[:1]


def _geometry(style: Style) -> ModuleType:
    """The module with the geometry of a style's coordinates."""
    first = style.coordinates[0]
    return {"ax": vectors, "gamma": dipole}.get(first) or {"bond": bond, "angle": angle}.get(style.category, dihedral)


@functools.cache
def layout(style: Style) -> dict[str, int]:
    """The rows of a block for the coordinates of a style, 0 for what it has not, and how many there are (`asemd.kernels.block`)."""
    module, names = _geometry(style), chart(style) + PAST * style.history
    used = [n for n in names if n in style.coordinates or n == names[0]]
    slopes = [_slope(n) for n in used if n not in PAST]
    count = {bond: 1, dipole: 1, angle: 2}.get(module, ATOMS[style.category] - 1)
    widths = dict.fromkeys([f"{kind}{k + 1}" for kind in "VF" for k in range(count)], 3)
    widths |= dict.fromkeys([] if module is vectors else map(str.upper, used), 1)
    widths |= dict.fromkeys([*slopes, "E"], 1) | ROWS.get(module, {}) | ({"SIDE": 1} if style.edge else {}) | {"P": 0}
    rows, top = dict.fromkeys([*map(str.upper, names), *map(_slope, names), "SHAPE", "SIDE"], 0), 0
    for name, width in widths.items():
        rows[name], top = top, top + width
    if module is vectors:      # the coordinates are those of V1, V2, V3
        rows |= {n.upper(): VECTORS.index(n) for n in names}
    rows.setdefault("VALUE", rows[names[0].upper()])
    return rows | {"D": rows[slopes[0]], "SLOPES": len(slopes), "VECTORS": count, "STRESS": 0 if module is dipole else count,
                   "ATOMS": ATOMS[style.category]}


def _slope(coordinate: str) -> str:
    """The name of the row of the derivative by a coordinate: D12 of r12."""
    return "D" + coordinate.upper().removeprefix("R")


class _WithoutEnergy(ast.NodeTransformer):
    """``return E, dE`` becomes ``return 0.0, dE``; an energy that is a constant of `math` (inf) takes the derivatives along."""

    def visit_Return(self, node):
        value = node.value
        if isinstance(value, ast.Tuple):
            first = value.elts[0]
            if isinstance(first, ast.Attribute):
                value.elts = [first] * len(value.elts)
            else:
                value.elts[0] = ast.Constant(0.0)
        return node


def without_energy(source: str) -> str:
    """The source of a style's function without its energy, for steps that need forces only; logarithms that nobody reads go with it."""
    return ast.unparse(ast.fix_missing_locations(_WithoutEnergy().visit(ast.parse(source))))


def _entry(row: int) -> str:
    return f"b[k + {ROW * row}]"


def source(style: Style, *, energy: bool) -> Builder:
    """The text of the module that holds `evaluate`: the function of a style, with or without its energy, for the columns of a block."""
    b, rows = Builder(f"{style.category}_style {style.name}."), layout(style)
    b.line("from asemd.kernels.algebra import narrow")
    b.line("from asemd.kernels.block import as_table, block_function")
    *helpers, function = style.functions()
    for helper in helpers:
        b.text(plain_source(helper), INNER, cache=False)
    text = plain_source(function, "potential")
    b.text(text if energy else without_energy(text), INNER, cache=False)

    numbers = [n for n in style.arguments if n not in style.arrays]
    words = {n: _entry(rows["P"] + k) for k, n in enumerate(numbers)} | {n: f"array{k}" for k, n in enumerate(style.arrays)}
    coefficients = [words[n] for n in style.arguments]
    coordinates = [f"abs({_entry(rows['PHI'])})" if n == "chi" else _entry(rows[n.upper()]) for n in style.coordinates]
    by = [n for n in style.coordinates if n not in PAST]
    results, places = ["e", *(f"d_{n}" for n in by)], [rows["E"], *(rows["D" if n == "chi" else _slope(n)] for n in by)]

    lines = ["def evaluate(n, b, table, rows, columns):", "    narrow()"]
    lines += [f"    array{k} = as_table(table, rows, columns)" for k, _ in enumerate(style.arrays)]
    lines += ["    for k in range(n):", f"        {', '.join(results)} = potential({', '.join(coordinates + coefficients)})"]
    if style.coordinates == ("chi",):      # chi = |phi|; in the plane neither side is the one to be pushed to
        lines.append(f"        d_chi = -d_chi if {_entry(rows['PHI'])} < 0.0 else d_chi")
        lines.append(f"        d_chi = 0.0 if {_entry(rows['SIDE'])} == 0.0 and math.isfinite(d_chi) else d_chi")
    if style.straight and energy:
        b.text(plain_source(style.straight, "on_line"), INNER, cache=False)
        lines.append(f"        e = on_line({', '.join(coefficients)}) if math.isnan({_entry(rows['SIDE'])}) and math.isfinite(e) else e")
    lines += [f"        {_entry(row)} = {name}" for row, name in zip(places[not energy:], results[not energy:])]
    if rows["D"] not in places:
        lines.append(f"        {_entry(rows['D'])} = 0.0")
    b.line("@block_function")
    b.line("\n".join(lines))
    return b


def loop_source(style: Style, *, periodic: bool = True, orthogonal: bool = True) -> Builder:
    """The text of the module that holds `loop`, the same for all styles of the same coordinates."""
    module, straight = _geometry(style), periodic and orthogonal
    constants = dict(layout(style), SKEW=periodic and not orthogonal, HISTORY=style.history or module is dipole,
                     BLOCK=block.BLOCK)
    if module is vectors:
        places = vectors.order(style)
        constants |= dict(zip(("CENTRE", "A", "B", "C"), places)) | {"THREE": len(places) > 3, "CHAIN": style.chain}
    if style.history:
        constants["BREAKS"] = style.breaks != ""
    return _loops(module, bond_history if style.history else module, straight, tuple(constants.items()))


@functools.cache
def _loops(module: ModuleType, past: ModuleType, straight: bool, items: tuple) -> Builder:
    b, constants = Builder(f"Loop over items, coordinates of {module.__name__}."), dict(items)
    b.line("from asemd.kernels.block import call")
    b.line(f"from asemd.kernels.algebra import {', '.join(f.__name__ for f in algebra.FUNCTIONS)}")
    b.line("from asemd.kernels.fuse import madd")
    b.text(plain_source(vector_math.vector_atan2), f"{INNER}, {vector_math.OPTIONS}", cache=False)
    if constants["SIDE"]:
        for function in volume.FUNCTIONS:
            b.text(plain_source(function), INNER, cache=False)
    if constants["SKEW"]:
        b.text(plain_source(image.closest_general), INNER, cache=False)
    parts = {"sides_of": image.sides_orthogonal if straight else image.sides_any, "skewed": image.block_general,
             "closest": image.from_block_orthogonal if straight else image.from_block}
    parts |= {f.__name__: f for f in (block.odd, block.coefficients, block.report, block.sums, block.shares)}
    parts |= {name: getattr(module, name) for name in ("gather", "geometry", "gradient", "scatter")}
    if constants["SIDE"]:
        parts |= {"settle": module.settle}
    if constants["HISTORY"]:
        parts |= {"recall": past.recall, "part": past.part}
    texts = [plain_source(f, name, constants=constants) for name, f in parts.items()]
    b.text(paste(plain_source(block.forces, "loop", constants=constants), texts, constants))
    return b


@functools.cache
def evaluator(style: Style, energy: bool) -> Callable:
    """The compiled `evaluate` of a style."""
    return source(style, energy=energy).build().evaluate


@functools.cache
def functions(style: Style) -> np.ndarray | list:
    """Where a loop finds `evaluate` without and with energies, once they are needed: addresses, or functions where nothing is compiled."""
    return [None, None] if config.DISABLE_JIT else np.zeros(2, np.int64)


def loop(style: Style, *, energy: bool, per_atom: bool, periodic: bool, orthogonal: bool) -> Callable:
    """The compiled loop for a style, which finds the style in `functions`; arguments as in `kernel`.

    Returns
    -------
    callable
        As `kernel` returns, with the `Thread`, whose level says what is wanted, before the other arguments, `arrays` from `arrays`, and two
        more at the end: `functions` and `room`.
    """
    f = evaluator(style, energy or per_atom)
    functions(style)[int(energy or per_atom)] = f if config.DISABLE_JIT else f.address
    run = loop_source(style, periodic=periodic, orthogonal=orthogonal).build().loop
    return np.errstate(all="ignore")(run) if config.DISABLE_JIT else run


def room(style: Style) -> np.ndarray:
    """The buffer of a block."""
    return aligned(((layout(style)["P"] + len(style.arguments)) * ROW,))


def arrays(style: Style, given: tuple) -> tuple:
    """The arrays that a loop gets: the table of the style comes first."""
    return given if style.arrays else (NO_TABLE, *given)


@functools.cache
def kernel(style: Style, *, energy: bool, per_atom: bool, periodic: bool, orthogonal: bool) -> Callable:
    """The forces of a bonded style.

    Parameters
    ----------
    style : Style
        A bond, angle, dihedral or improper style with a function.
    energy : bool
        Add energy and virial to `acc`.
    per_atom : bool
        Add equal shares of energy and virial to `atom_energy` and `atom_virial`.
    periodic : bool
        False: positions are taken as they are.
    orthogonal : bool
        The cell vectors lie along the axes, with positive lengths.

    Returns
    -------
    callable
        ``f(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad)``: `x` (3, cap) positions, `out` (3, cap)
        forces are added to, `items` (m, k) int32 columns of `x`, `types` (m,) int32, `cell` an `asemd.kernels.state.Cell`, `coeff` (npar,
        ntypes + 1) and `arrays` of `Style.pack`, `lo` and `hi` the range of items, `acc` (8,) energy in 0 and virial xx yy zz xy xz yz in
        2 to 7 are added to, `atom_energy` (cap,), `atom_virial` (6, cap), `bad` (4,): 1, item and coordinate of the
        first item outside the domain.
    """
    run = loop(style, energy=energy, per_atom=per_atom, periodic=periodic, orthogonal=orthogonal)
    level = 2 if per_atom else int(energy)

    def call(x, out, items, types, cell, coeff, given, *rest):
        bound(run, (x, out, items, types, cell, coeff, arrays(style, given), *rest, functions(style), room(style)), level)()
    return call


def describe(style: Style, value: float, ids: Sequence[int], type_: int) -> str:
    """One line for the user about an item that is outside the domain of its style.

    Parameters
    ----------
    value : float
        The coordinate as the kernel reported it (angles in radians; nan: two atoms at one place).
    ids : sequence of int
        Atom ids of the item.
    type_ : int
        Its bond, angle, dihedral or improper type.
    """
    name = chart(style)[0]
    what = f"{style.category} of type {type_} between atoms {' '.join(str(int(i)) for i in ids)}"
    if math.isnan(value):
        return f"{what}: two of its atoms are at the same place, or a position is not a number ({style.category}_style {style.name})"
    shown = "" if name == "ax" else f"{name} = {value:.8g}; " if name == "r" else f"{name} = {math.degrees(value):.8g} degrees; "
    return f"{what} is outside the domain of {style.category}_style {style.name}: {shown}{style.domain or 'its energy is not finite'}"
