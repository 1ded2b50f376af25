"""Pair energies of two types as a function of their distance, and the pairs of a scene that are close."""
from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from asemd.errors import AsemdError, SimulationError

SHRINK = 0.985      # steps inwards when a wall of energy is looked for
APART = 5e-3        # of a distance
INNERMOST = 1e-3    # of the cutoff
TYPES = 60          # of more types than this only pairs of the same type are looked at


def interaction(case, i: int, j: int, kind: int = 0, qq: float = 0.0) -> Callable[[float], tuple[float, float]]:
    """The pair energy of types `i` and `j`, and its slope: functions of the distance, ``inf`` where there is none.

    Parameters
    ----------
    kind : int
        1, 2, 3: with the weights of 1-2, 1-3, 1-4 pairs.
    qq : float
        Product of the charges and the Coulomb constant, energy times distance; 0: without what depends on charges.
    """
    pieces = []
    rules = case.engine.exclusions
    for term in tabled(case):
        weights = term.weights(rules.weight_lj, rules.weight_coul, rules.keep)
        weight, coulomb, whole = float(weights[0][kind]), float(weights[1][kind]), float(weights[1][0])
        if weight == coulomb == 0.0 or term.molecules == ("other" if kind else "same"):
            continue
        row = constant = array = 0
        for part in term.style.parts:
            table, numbers, arrays = term.tables.rows, term.tables.constants, term.tables.arrays
            cut2, offset = float(table[row, i, j]), float(table[row + 1, i, j])
            values = [float(table[row + 2 + k, i, j]) for k in range(len(part.rows))]
            values += [float(c) for c in numbers[constant:constant + len(part.constants)]] + list(arrays[array:array + len(part.arrays)])
            if cut2 > 0.0 and (qq or not part.charged):
                radii = [_radius(case, t) for t in (i, j)] if part.sized else []
                values = [qq] * part.charged + radii + values
                pieces.append((part.function, part.coordinate == "r2", cut2, offset, values,
                               whole if part.long else coulomb if part.charged else weight))
                if part.long and not part.charged and weight != whole:
                    pieces.append((lambda r, c=values[0] * (whole - weight): (c / r**6, -6.0 * c / r**7), False, cut2, 0.0, [], 1.0))
                if part.long and part.charged and coulomb != whole:
                    pieces.append((lambda r, c=qq * (coulomb - whole): (c / r, -c / (r * r)), False, cut2, 0.0, [], 1.0))
            row, constant, array = row + 2 + len(part.rows), constant + len(part.constants), array + len(part.arrays)

    def of(r: float) -> tuple[float, float]:
        total = slope = 0.0
        for function, squared, cut2, offset, values, weight in pieces:
            if r * r < cut2:
                try:
                    e, d = function(r * r if squared else r, *values)
                except (ArithmeticError, ValueError, IndexError):
                    return math.inf, math.inf
                total += weight * (e - offset)
                slope += weight * d * (2.0 * r if squared else 1.0)
        return (total, slope) if math.isfinite(total) else (math.inf, math.inf)
    return of


def why_none(case) -> str:
    """Why a scene has no energies of single pairs."""
    many = list(dict.fromkeys(t.style.name for t in case.engine.many_terms))
    if not many:
        return "no pair forces"
    return f"{', '.join(many)}: many-body forces are no sum over pairs; first step and fastest vibration look at them"


def _radius(case, t: int) -> float:
    """Mean radius of the atoms of a type."""
    return float(case.system.extra["radius"][case.system.type == t].mean())


def tabled(case) -> list:
    """The terms of pair styles that are functions of the distance of two atoms."""
    return [t for t in case.engine.pair_terms if getattr(t, "tables", None) is not None and t.style.parts]


def type_pairs(case) -> list[tuple[int, int]]:
    """Pairs of types i <= j of which there are atoms."""
    used = [int(t) for t in np.unique(case.system.type)]
    if len(used) > TYPES:
        return [(t, t) for t in used]
    return [(i, j) for k, i in enumerate(used) for j in used[k:]]


def wall(case, energies, kind: int = 0) -> dict[tuple[int, int], tuple[float, ...]]:
    """For each pair of types the largest distances at which the pair energy, coming from the cutoff, reaches these `energies`.

    Returns
    -------
    dict
        (i, j), i <= j -> distances; 0 where an energy is never reached.
    """
    out, known = {}, {}
    for i, j in type_pairs(case):
        key = tuple(t.tables.rows[:, i, j].tobytes() for t in tabled(case))
        if key not in known:
            known[key] = _wall(interaction(case, i, j, kind), _cut(case, i, j), energies)
        out[i, j] = known[key]
    return out


def _cut(case, i: int, j: int) -> float:
    return max(cutoffs(case, i, j), default=0.0)


def cutoffs(case, i: int, j: int) -> list[float]:
    """Where parts of the interaction of two types end, in ascending order."""
    return sorted({math.sqrt(float(c)) for t in tabled(case) for c in np.ravel(t.tables.rows[t.cut_rows, i, j]) if c > 0.0})


def _wall(of: Callable[[float], tuple[float, float]], cut: float, energies) -> tuple[float, ...]:
    found = []
    r = cut * (1.0 - 1e-9)
    for wanted in sorted(energies):
        outer = r
        while r > INNERMOST * cut and of(r)[0] < wanted:
            outer, r = r, SHRINK * r
        if not r > INNERMOST * cut:
            return (*found, *[0.0] * (len(energies) - len(found)))
        inner = r
        for _ in range(30):
            middle = 0.5 * (inner + outer)
            inner, outer = (inner, middle) if of(middle)[0] < wanted else (middle, outer)
        found.append(0.5 * (inner + outer))
    return tuple(found)


def curvature(of: Callable[[float], tuple[float, float]], r: float) -> float:
    """Second derivative of a pair energy, from slopes so far apart that they see nothing of the cells of a table."""
    h = APART * r
    return (of(r + h)[1] - of(r - h)[1]) / (2.0 * h)


def close_pairs(case, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of rows that interact, excluded ones left out, closer than `reach`; the shortest first.

    Returns
    -------
    pairs (m, 2), distances (m,), kinds (m,)
        Kind 0: ordinary pairs; 1, 2, 3: 1-2, 1-3, 1-4 pairs with another weight than those.

    Raises
    ------
    AsemdError
        There is no list, because an atom is lost or not anywhere.
    """
    e = case.engine
    if e.mode == "none":
        return np.zeros((0, 2), int), np.zeros(0), np.zeros(0, int)
    if not e.builds:
        e.load()
    s = e.state
    reach = min(reach, e.reach)
    if e.mode == "cluster" and not e.expanded:
        i, j, code = e.exclusions.mark(e.k, s.x, s.row, *e.list.expand(e.k, s, reach), e.list.shifts, e.cell, e.periodic)
        shifts = e.list.shifts
    else:
        (i, j, code), shifts = e.plain, e.plain_shifts
    d = s.x[:, i] - s.x[:, j] - shifts[code >> 2].T
    r = np.sqrt((d * d).sum(axis=0))
    near = np.flatnonzero(r < reach)
    near = near[np.argsort(r[near])]
    return np.column_stack([s.row[i[near]], s.row[j[near]]]), r[near], code[near] & 3


def can_list(case) -> AsemdError | None:
    """Why there is no list of pairs; None if there is one."""
    try:
        close_pairs(case, 1e-6)
    except (AsemdError, ArithmeticError) as e:
        return e if isinstance(e, AsemdError) else SimulationError(str(e))
    return None
