"""Are bonds near the end of what their style allows: the length at which FENE diverges, quartic breaks, a table ends?"""
from __future__ import annotations

import math

import numpy as np
from scipy.integrate import trapezoid

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

NEAR = 0.75         # of the way from rest to the limit
BARRIER = 15.0      # kT: an end of the domain that costs less than this is met sooner or later
LONGEST = 64.0      # rest lengths up to which a limit is looked for
POINTS = 400
RELAX = "let the structure relax first (minimize, or fix nve/limit with a short timestep), then run"


@static("bond limits")
def bond_limits(case: Case) -> list[Finding]:
    name, found, limited = "bond limits", [], False
    if not any(items.category == "bond" for items in case.items):
        raise DoesNotApply("no bonds" if not len(case.system.topology.bonds) else "no bond style is a function of the length")
    for items in case.items:
        r = items.column("r")
        if items.category != "bond" or r is None:
            continue
        outside = np.flatnonzero(~np.isfinite(items.slope).all(axis=1) & case.vibrates("bond", items.atoms))
        if len(outside):
            worst = outside[int(np.argmax(np.abs(r[outside] - np.median(r))))]
            found.append(_outside(case, items, len(outside), case.ids(items.atoms[worst]), float(r[worst])))
        for kind in np.unique(items.types):
            mine = np.flatnonzero((items.types == kind) & np.isfinite(items.slope).all(axis=1))
            if len(mine):
                more = _near(case, items, int(kind), mine, r)
                limited |= more is not None
                found += more or []
    if not limited and not found:
        raise DoesNotApply("no bond style in use has a limit")
    return found or [Finding("ok", name, f"Every bond is within {NEAR:.0%} of the way from rest to its limit.", limit=NEAR)]


def _outside(case: Case, items, count: int, ids, length: float) -> Finding:
    style = items.style
    text = (f"{count} bond{'s are' if count > 1 else ' is'} outside the domain of bond style {style.name}, such as {ids[0]}-{ids[1]} with "
            f"length {length:.4g}")
    if style.breaks:
        return Finding("note", "bond limits", f"{text}: it breaks at once.", ids, length)
    advice = ("look at the positions (unwrapped across a periodic face?), bring the atoms together with minimize or fix nve/limit under a "
              "bond without a limit (harmonic), then switch the style")
    why = style.domain or "there is no energy there"
    return Finding("note" if case.relaxes else "error", "bond limits", f"{text}: {why}.", ids, length, advice=advice)


def _near(case: Case, items, kind: int, mine: np.ndarray, r: np.ndarray) -> list[Finding] | None:
    """Findings about the bonds of one type; None if it has no limit."""
    name, style = "bond limits", items.style
    rest = items.rest(kind)
    if not (math.isfinite(rest) and rest > 0.0 and _inside(items, kind, rest)):
        rest = float(np.median(r[mine]))
    out, kt = None, case.units.boltz * case.temperature
    for side in (1.0, -1.0):
        end = _end(items, kind, rest, side)
        if end is None:
            continue
        out = out or []
        way = (r[mine] - rest) / (end - rest)
        worst = mine[int(np.argmax(way))]
        ids, severity = case.ids(items.atoms[worst]), "note" if style.breaks else "warning"
        what = f"{'breaks' if style.breaks else 'ends'} at {end:.4g}"
        if way.max() > NEAR:
            text = (f"Bond {ids[0]}-{ids[1]} of type {kind} is {r[worst]:.4g} long, {way.max():.0%} of the way from rest ({rest:.4g}) to "
                    f"where bond style {style.name} {what}; bonds beyond {NEAR:.0%}: {int((way > NEAR).sum())}.")
            out.append(Finding(severity, name, text, ids, float(r[worst]), rest + NEAR * (end - rest), RELAX))
        cost = _cost(items, kind, rest, end)
        if cost < BARRIER * kt:
            text = f"Bonds of type {kind}: bond style {style.name} {what}, which costs only {cost / kt:.2g} kT: some bond will get there"
            text += " and break." if style.breaks else ", and the run ends."
            out.append(Finding(severity, name, text, ids, cost, BARRIER * kt,
                               "" if style.breaks else "make the table longer, or the bond stiffer"))
    return out


def _inside(items, kind: int, r: float) -> bool:
    return bool(np.isfinite(items.slopes(np.array([[r]]), np.array([kind]))).all())


def _end(items, kind: int, rest: float, side: float) -> float | None:
    """Where the domain ends above (`side` 1) or below the rest length; None if only at 0 or not within `LONGEST` rest lengths."""
    grid = rest * (np.geomspace(1.0, LONGEST, 200) if side > 0 else np.geomspace(1.0, 0.05, 200))
    good = np.isfinite(items.slopes(grid[:, None], np.full(len(grid), kind))).all(axis=1)
    if good.all():
        return None
    first = int(np.argmin(good))
    inner, outer = grid[first - 1], grid[first]
    for _ in range(40):
        middle = 0.5 * (inner + outer)
        inner, outer = (middle, outer) if _inside(items, kind, middle) else (inner, middle)
    return float(inner)


def _cost(items, kind: int, rest: float, end: float) -> float:
    """Energy from the rest length to the end of the domain, from the slopes."""
    x = rest + (end - rest) * (1.0 - np.geomspace(1.0, 1e-6, POINTS))
    slope = items.slopes(x[:, None], np.full(POINTS, kind))[:, 0]
    good = np.isfinite(slope)
    return float(trapezoid(slope[good], x[good]))
