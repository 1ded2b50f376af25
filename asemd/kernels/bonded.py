"""The compiled loop of a bonded style: one per internal coordinate, specialised for what is asked for."""
from __future__ import annotations

import ast
import functools
import math
from collections.abc import Callable, Sequence

from asemd.kernels import angle, bond, bond_history, dihedral, dipole, image, vectors
from asemd.kernels.generate import Builder, plain_source
from asemd.style import VECTORS, Style

ANGLE = ("theta", "r12", "r32", "r13")
TORSION = ("phi", "r12", "r23", "r34", "theta1", "theta2")


def report(bad, item, value):
    """Remember the first item that is outside the domain of its style."""
    if bad[0] == 0.0:
        bad[0], bad[1], bad[2] = 1.0, item, value


def push(out, atom, fx, fy, fz):
    """Add to the force on an atom."""
    out[0, atom] += fx
    out[1, atom] += fy
    out[2, atom] += fz


def total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz):
    acc[0] += energy
    acc[2] += vxx
    acc[3] += vyy
    acc[4] += vzz
    acc[5] += vxy
    acc[6] += vxz
    acc[7] += vyz


def share(atom, part, energy, vxx, vyy, vzz, vxy, vxz, vyz, atom_energy, atom_virial):
    """Equal shares for the atoms of an item, as LAMMPS counts energy and stress per atom."""
    atom_energy[atom] += part * energy
    atom_virial[0, atom] += part * vxx
    atom_virial[1, atom] += part * vyy
    atom_virial[2, atom] += part * vzz
    atom_virial[3, atom] += part * vxy
    atom_virial[4, atom] += part * vxz
    atom_virial[5, atom] += part * vyz


def chart(style: Style) -> tuple[str, ...]:
    """The coordinates that the loop of a style hands to `evaluate`."""
    if style.coordinates[0] == "ax":
        return VECTORS[:6] if style.category == "angle" else VECTORS
    if style.coordinates[0] in ("phi", "chi"):
        return TORSION
    if style.coordinates[0] == "gamma":
        return style.coordinates
    return ANGLE if style.category == "angle" else ("r",)


def _loop(style: Style) -> Callable:
    if style.category == "bond":
        return bond_history.bond if style.history else bond.bond
    if style.coordinates[0] == "ax":
        return vectors.three if style.category == "angle" else vectors.four
    if style.coordinates[0] == "gamma":
        return dipole.dipole
    if style.category == "angle":
        return angle.angle
    return dihedral.torsion


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


def _coefficients(style: Style) -> list[str]:
    """The arguments of a style's function after the coordinates, looked up for type t."""
    rows = {n: k for k, n in enumerate(n for n in style.arguments if n not in style.arrays)}
    return [f"arrays[{style.arrays.index(n)}]" if n in style.arrays else f"coeff[{rows[n]}, t]" for n in style.arguments]


def _adapter(style: Style) -> str:
    """`evaluate(coordinates, type, coeff, arrays)`: the style's function with its coefficients looked up."""
    call = f"potential({', '.join([*style.coordinates, *_coefficients(style)])})"
    handed = chart(style)
    if style.category == "bond":
        past = ", rate=0.0, reference=1.0" if style.history else ""
        return f"def evaluate(r, t, coeff, arrays{past}):\n    return {call}"
    head = f"def evaluate({', '.join(handed)}, t, coeff, arrays):\n"
    if style.coordinates == ("chi",):      # chi = |phi|
        zeros = ", 0.0" * (len(handed) - 1)
        return f"{head}    chi = abs(phi)\n    e, slope = {call}\n    return e, slope if phi >= 0.0 else -slope{zeros}"
    if handed == style.coordinates:
        return f"{head}    return {call}"
    names = ["e"] + [f"d_{c}" for c in style.coordinates]
    back = ["e"] + [f"d_{c}" if c in style.coordinates else "0.0" for c in handed]
    return f"{head}    {', '.join(names)} = {call}\n    return {', '.join(back)}"


def source(style: Style, *, energy: bool = True, per_atom: bool = False, periodic: bool = True, orthogonal: bool = True) -> Builder:
    """The text of the module that holds the kernel `loop`; arguments as in `kernel`."""
    b = Builder(f"Forces of {style.category}_style {style.name}.")
    b.constant("ENERGY", bool(energy))
    b.constant("PER_ATOM", bool(per_atom))
    b.constant("PERIODIC", bool(periodic))
    if style.coordinates[0] == "ax":
        for name, atom in zip(("CENTRE", "A", "B", "C"), vectors.order(style)):
            b.constant(name, atom)
    else:
        for name in chart(style)[1:]:
            b.constant(name.upper(), name in style.coordinates)
    if style.history:
        for name, value in dict(BREAKS=style.breaks != "", REFERENCE=style.remembers != "", RATE="rate" in style.coordinates).items():
            b.constant(name, value)
    if chart(style) == TORSION:
        b.constant("ARMS", len(style.coordinates) > 1)
        b.constant("CHI", style.coordinates == ("chi",))
        b.constant("STRAIGHT", style.straight is not None and (energy or per_atom))
    *helpers, function = style.functions()
    for helper in helpers:
        b.text(plain_source(helper), cache=False)
    text = plain_source(function, "potential")
    b.text(text if energy or per_atom else without_energy(text), cache=False)
    b.text(_adapter(style), cache=False)
    if style.straight and (energy or per_atom):
        b.text(plain_source(style.straight, "on_line"), cache=False)
        b.text(f"def straight(t, coeff, arrays):\n    return on_line({', '.join(_coefficients(style))})", cache=False)
    if periodic:
        b.text(plain_source(image.closest_orthogonal if orthogonal else image.closest_general, "closest"), cache=False)
    for f in (report, push) + (total,) * energy + (share,) * per_atom:
        b.text(plain_source(f), cache=False)
    b.text(plain_source(_loop(style), "loop"))
    return b


@functools.cache
def kernel(style: Style, *, energy: bool, per_atom: bool, periodic: bool, orthogonal: bool) -> Callable:
    """The compiled loop of a bonded style.

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
    return source(style, energy=energy, per_atom=per_atom, periodic=periodic, orthogonal=orthogonal).build().loop


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
