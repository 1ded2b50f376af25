"""Sections of table files, as ``bond_write``, ``angle_write``, ``dihedral_write`` and ``pair_write`` append them."""
from __future__ import annotations

import datetime
import functools
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from asemd import units as unit_styles
from asemd.coordinates import pairs_of
from asemd.errors import InputError
from asemd.lammps import live_coefficients
from asemd.lammps.setup_log import report_mixing
from asemd.style import VECTORS, Style
from asemd.words import exactly, whole

# atoms 1, 2, 3 of an angle and 1 to 4 of a dihedral: bonds of length 1 (dihedral 2-3: 2), right angles in the dihedral
CORNER = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
BENT = np.array([[1.0, 0.0, -1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])


def append(session, command: str, path: str, title: str, keyword: str, head: str, columns) -> None:
    """Append one section to a table file, which gets its first line if it is new.

    Parameters
    ----------
    title, head : str
        What the comment says (``Bond potential ...``), and the line of parameters.
    columns : (3, n)
        Coordinate, energy, force.

    Raises
    ------
    InputError
        The file names another unit style, or cannot be written.
    """
    units, file = session.scene.system.units, Path(path)
    today = f"{datetime.date.today():%Y-%m-%d}"
    rows = "".join(f"{i:8d} {x:< 22.15g} {e:< 22.15g} {f:< 22.15g}\n" for i, (x, e, f) in enumerate(np.transpose(columns).tolist(), 1))
    try:
        new = not file.exists()
        first = "" if new else file.read_text(errors="replace").partition("\n")[0]
        named, date = re.search(r"UNITS:\s*(\S+)", first), re.search(r"DATE:\s*(\S+)", first)
        if named and named[1] != units:
            raise InputError(f"{command}: cannot append to {path}, a table file with UNITS: {named[1]}, while units are {units}")
        with file.open("a") as out:
            out.write(f"# DATE: {today} UNITS: {units} Created by {command}\n" * new)
            out.write(f"# {title}\n\n{keyword}\n{head}\n\n{rows}")
    except OSError as e:
        raise InputError(f"{command}: cannot write to file {path}: {e.strerror}") from None
    session.print(f"{'Creating' if new else 'Appending to'} table file {path} with DATE: {today if new else date[1] if date else ''}")
    report_mixing(session)


def one_type(session, category: str, word: str, command: str) -> int:
    """A type by its number or label."""
    system = session.scene.need_system(command)
    for number, label in system.labels.get("atom" if category == "pair" else category, {}).items():
        if word == label:
            return number
    t, n = whole(word, f"{command}: type"), system.counts["ntypes" if category == "pair" else f"n{category}types"]
    if not 1 <= t <= n:
        raise InputError(f"{command}: invalid {'atom' if category == 'pair' else category} type {t}, there are {n}")
    return t


def style_of(session, category: str, t: int, command: str) -> tuple[Style, dict, Callable]:
    """The style of a type, its coefficients, and its function of the coordinates alone."""
    interactions, system = session.scene.interactions, session.scene.need_system(command)
    if not interactions.uses[category]:
        raise InputError(f"{command} command before {category}_style is defined")
    live_coefficients.fill(session, category)
    for use in interactions.uses[category]:
        if t in use.coeff:
            style = use.style.bind(use.settings, use.coeff, interactions.compat)
            beyond = [name for name in style.coordinates if name in ("rate", "reference", "gamma")]
            if beyond:
                one = "the length" if category == "bond" else "the angle"
                raise InputError(f"{command}: {category} style {style.name} depends on more than {one}: it has no table")
            if style.function is None:
                return style, use.coeff[t], lambda *q: (0.0,) * (1 + len(q))
            packed = style.pack(use.settings, {t: use.coeff[t]}, t, unit_styles.get(system.units))
            rows, arrays = iter(packed.coeff[:, t].tolist()), iter(packed.arrays)
            given = {name: next(arrays if name in style.arrays else rows) for name in style.arguments}
            return style, use.coeff[t], functools.partial(style.function, **given)
    raise InputError(f"{command}: {category} type {t} is none, it has no table" if t in interactions.none[category] else
                     f"{command}: {category}_coeff {t} is not set")


def run_bonded(session, args, category: str, words: int, points: Callable) -> None:
    """A command that writes the table of a bonded style.

    Parameters
    ----------
    words : int
        How many words the command has: type, N, [range,] file, keyword.
    points : callable
        ``points(style, n, args)`` gives the written coordinate and, for each point, those the style asks for and their derivatives by it.
    """
    command = f"{category}_write"
    exactly(args, words, command)
    t = one_type(session, category, args[0], command)
    n = whole(args[1], f"{command}: N")
    if n < 2:
        raise InputError(f"{command}: there must be at least 2 table values, got {n}")
    style, coeff, function = style_of(session, category, t, command)
    x, places, paths = points(style, n, args)
    energies, forces = [], []
    for value, place, path in zip(x, places, paths):
        e, *slopes = function(*place)
        force = -sum(a * b for a, b in zip(slopes, path) if b)
        if not (math.isfinite(e) and math.isfinite(force)):
            raise InputError(f"{command}: {value:g} is outside the domain of {category} style {style.name}: "
                             f"{style.domain or 'its energy is not finite'}")
        energies.append(e)
        forces.append(force if category == "bond" else math.radians(force))
    head = f"N {n}" + " DEGREES" * (category == "dihedral")
    rest = style.rest_value(coeff)
    if category == "angle" and math.isnan(rest):      # a reader would take 180 degrees
        rest = x[int(np.argmin(energies))]
    if category != "dihedral" and math.isfinite(rest):
        head += f" EQ {rest:.15g}"
    name = session.scene.interactions.style_name(category)
    title = f"{category.capitalize()} potential {name} for {category} type {t}: i,{'r' if category == 'bond' else 'theta'},energy,force"
    append(session, command, args[-2], title, args[-1], head, (x, energies, forces))


def chain(style: Style, atoms: np.ndarray, tangent: np.ndarray, named: dict[str, tuple[float, float]]) -> tuple[list, list]:
    """Coordinates of a style and their derivatives as the last of `atoms` moves along `tangent`: those `named`, or its vectors."""
    if style.coordinates[:1] == ("ax",):
        moves = np.zeros_like(atoms)
        moves[-1] = tangent
        x, dx = ([v for i, j in pairs_of(style) for v in (a[i] - a[j]).tolist()] for a in (atoms, moves))
        named = dict(zip(VECTORS, zip(x, dx)))
    pairs = [named[c] for c in style.coordinates]
    return [a for a, _ in pairs], [b for _, b in pairs]
