"""``pair_write itype jtype N r|rsq|bitmap inner outer file keyword [qi qj]``: a pair potential as a section of a table file.

Of embedded-atom potentials the part between pairs is written, without embedding energies, as in LAMMPS.
"""
from __future__ import annotations

import math
import warnings

import numpy as np

from asemd import units as unit_styles
from asemd.compute._pairs import check_pairwise
from asemd.embedded import pair_part
from asemd.errors import InputError, InputWarning
from asemd.kspace import solve
from asemd.lammps import live_coefficients
from asemd.lammps.table_write import append, one_type
from asemd.pair.table import Grid
from asemd.words import choice, number, whole


def squares(style: str, n: int, inner: float, outer: float) -> np.ndarray:
    """Squared distances in the order of the file."""
    i = np.arange(n)
    if style == "r":
        return np.square(inner + (outer - inner) * i / (n - 1))
    if style == "rsq":
        return inner * inner + (outer * outer - inner * inner) * i / (n - 1)
    grid = Grid(inner, outer, n, "pair_write")
    out = np.empty(len(grid.r2))
    out[grid.line] = grid.r2
    return out


def is_embedded(term) -> bool:
    """Whether it is an embedded-atom potential, whose part between pairs can be written."""
    return getattr(term.style, "packable", False)


def chosen(session, ntypes: int, units) -> list:
    """The pair styles that act on the two atoms; of ``hybrid/molecular`` the one of the first two atoms, as in LAMMPS."""
    system = session.scene.system
    for fill in (live_coefficients.fill, live_coefficients.scale):
        fill(session)
    scene = session.scene
    if scene.interactions.needs_solver:       # what it leaves to pairs
        solve(system, scene.interactions, units, scene.neighbor.skin)
    terms = scene.interactions.pair_terms(ntypes, units)
    check_pairwise([term for term in terms if not is_embedded(term)])
    if not any(term.molecules for term in terms):
        return terms
    which = "other" if system.n > 1 and system.molecule[0] != system.molecule[1] else "same"
    terms = [term for term in terms if term.molecules == which]
    warnings.warn("pair_write: hybrid/molecular has two energies for each pair of types, the table is the one of atoms of "
                  + ("one molecule" if which == "same" else "two molecules"), InputWarning, stacklevel=2)
    return terms


def pair_value(terms, i: int, j: int, r2: float, qq: float) -> tuple[float, float]:
    """Energy and force of two atoms of types i and j, without special factors; factors per atom (``hybrid/scaled``) have no energy."""
    energy = force = 0.0
    r = math.sqrt(r2)
    for term in terms:
        if np.ndim(term.use.factor):
            continue
        if is_embedded(term):
            e, f = pair_part(term.tables, i, j, r2)
            energy, force = energy + term.use.factor * e, force + term.use.factor * f
            continue
        row = constant = array = 0
        for part in term.style.parts:
            cut2, offset, *values = term.tables.rows[row:row + 2 + len(part.rows), i, j].tolist()
            values += term.tables.constants[constant:constant + len(part.constants)].tolist()
            values += term.tables.arrays[array:array + len(part.arrays)]
            row, constant, array = row + 2 + len(part.rows), constant + len(part.constants), array + len(part.arrays)
            if r2 < cut2:
                try:
                    e, slope = part.function(r2 if part.coordinate == "r2" else r, *[qq] * part.charged, *values)
                except ArithmeticError:
                    return math.inf, math.inf
                energy += term.use.factor * (e - offset)
                force -= term.use.factor * (2.0 * r * slope if part.coordinate == "r2" else slope)
    return energy, force


def run(session, args):
    what = "pair_write"
    if len(args) not in (8, 10):
        raise InputError(f"{what} needs itype jtype N style inner outer file keyword, and two charges or none, got {len(args)} values")
    scene, system = session.scene, session.scene.need_system(what)
    i, j = (one_type(session, "pair", w, what) for w in args[:2])
    n = whole(args[2], f"{what}: N")
    style = choice(args[3], ("r", "rsq", "bitmap"), f"{what}: style")
    inner, outer = (number(w, f"{what}: inner and outer") for w in args[4:6])
    path, keyword = args[6:8]
    qi, qj = (number(w, f"{what}: charge") for w in args[8:]) if len(args) > 8 else (1.0, 1.0)
    if n < 2:
        raise InputError(f"{what}: there must be at least 2 table values, got {n}")
    if not 0.0 < inner < outer:
        raise InputError(f"{what}: inner must be above 0 and outer above inner, got {inner:g} {outer:g}")
    if not scene.interactions.uses["pair"]:
        raise InputError(f"{what} command before pair_style is defined")
    units = unit_styles.get(system.units)
    terms = chosen(session, system.counts["ntypes"], units)
    qq = scene.interactions.coulomb_constant(units) / scene.interactions.dielectric * qi * qj
    r2 = squares(style, n, inner, outer)
    values = np.array([pair_value(terms, i, j, s, qq) for s in r2.tolist()])
    r = np.sqrt(r2)
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(bad):
        raise InputError(f"{what}: energy or force at {r[bad[0]]:g} is not finite")
    head = {"r": f"N {n} R", "rsq": f"N {n} RSQ", "bitmap": f"N {len(r)} BITMAP"}[style] + f" {inner:.15g} {outer:.15g}"
    name = scene.interactions.style_name("pair")
    append(session, what, path, f"Pair potential {name} for atom types {i} {j}: i,r,energy,force", keyword, head,
           (r, values[:, 0], values[:, 1]))
