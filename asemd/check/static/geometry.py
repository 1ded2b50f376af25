"""Do the bonds and angles of the structure fit their rest values? Factors of 10 are nm and Angstrom, of 57.3 degrees and radians."""
from __future__ import annotations

import math

import numpy as np
from scipy.integrate import trapezoid

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

RATIO = 2.0             # of the median length of a type to its rest length
SMALL = 3.2             # degrees: rest angles below this are rare, and as radians they would cover the half circle
OFF = 50.0              # degrees between the median angle and the rest angle
POINTS = 60
STRAINED = 10.0         # kT of an item: less is no mistake, but a soft one


@static("rest lengths")
def lengths(case: Case) -> list[Finding]:
    name, found, looked, kt = "rest lengths", [], False, case.units.boltz * case.temperature
    for items in case.items:
        r = items.column("r")
        if items.category != "bond" or r is None:
            continue
        for kind in np.unique(items.types):
            rest = items.rest(int(kind))
            mine = np.flatnonzero(items.types == kind)
            if not math.isfinite(rest) or rest <= 0.0 or not case.vibrates("bond", items.atoms[mine]).any():
                continue
            looked = True
            middle = float(np.median(r[mine]))
            ratio = middle / rest
            if not 1.0 / RATIO < ratio < RATIO and _cost(items, mine, "r", rest, middle) > STRAINED * kt:
                text = (f"Bonds of type {kind} ({items.style.name}) are {middle:.4g} long (median of {len(mine)}), their rest length is "
                        f"{rest:.4g}")
                ids = case.ids(items.atoms[mine[int(np.argmax(np.abs(r[mine] - rest)))]])
                text += f": a factor of {max(ratio, 1.0 / ratio):.3g}."
                found.append(Finding("note" if case.relaxes else "warning", name, text, ids, middle, rest, _lengths_advice(ratio)))
    if not looked:
        raise DoesNotApply("no bonds with a rest length")
    return found or [Finding("ok", name, "Bonds are about as long as their rest lengths.", limit=f"factor {RATIO:g}")]


def _cost(items, mine: np.ndarray, name: str, rest: float, now: float) -> float:
    """Energy from the rest value to `now`, the other coordinates being those of an item in the middle; inf outside the domain."""
    q = np.repeat(items.q[mine[len(mine) // 2]][None], POINTS, axis=0)
    column = items.style.coordinates.index(name)
    q[:, column] = np.linspace(rest, now, POINTS)
    slope = items.slopes(q, np.full(POINTS, items.types[mine[0]]))[:, column]
    return float(trapezoid(slope, q[:, column])) if np.isfinite(slope).all() else math.inf


def _lengths_advice(ratio: float) -> str:
    factor = max(ratio, 1.0 / ratio)
    if 7.0 < factor < 14.0:
        return "coefficients in nm and positions in Angstrom, or the other way round?"
    return "is this the right bond type? are molecules unwrapped across a periodic face that is missing?"


@static("rest angles")
def angles(case: Case) -> list[Finding]:
    name, found, looked, kt = "rest angles", [], False, case.units.boltz * case.temperature
    for items in case.items:
        theta = items.column("theta")
        if items.category != "angle" or theta is None:
            continue
        for kind in np.unique(items.types):
            rest = items.rest(int(kind))
            mine = np.flatnonzero(items.types == kind)
            if not math.isfinite(rest):
                continue
            looked = True
            middle = math.degrees(float(np.median(theta[mine])))
            if 0.0 < rest < SMALL:
                text = (f"Angle type {kind} ({items.style.name}) is at rest at {rest:g} degrees; as radians that would be "
                        f"{math.degrees(rest):.4g} degrees, and the angles of the structure are near {middle:.4g}.")
                found.append(Finding("warning", name, text, case.ids(items.atoms[mine[0]]), rest, SMALL,
                                     f"angles are in degrees in scripts: {math.degrees(rest):.5g}?"))
            elif abs(middle - rest) > OFF and case.settled and _cost(items, mine, "theta", *np.radians([rest, middle])) > STRAINED * kt:
                text = (f"Angles of type {kind} ({items.style.name}) are near {middle:.4g} degrees (median of {len(mine)}), their rest "
                        f"angle is {rest:g}.")
                found.append(Finding("warning", name, text, case.ids(items.atoms[mine[0]]), middle, rest,
                                     "is this the right angle type? is the middle atom the second one?"))
    if not looked:
        raise DoesNotApply("no angles with a rest angle")
    return found or [Finding("ok", name, "Angles are about what their rest angles are.", limit=f"{OFF:g} deg")]


@static("phases")
def phases(case: Case) -> list[Finding]:
    """Angles among other coefficients (phases of torsions, rest values of impropers) that look like radians."""
    name, found, looked = "phases", [], False
    for category in ("dihedral", "improper"):
        for use in case.interactions.uses[category]:
            words = [p.name for p in use.style.coeff if p.unit == "angle"]
            for kind, coeff in use.coeff.items():
                for word in words:
                    value = coeff.get(word)
                    if not isinstance(value, (int, float)):
                        continue
                    looked = True
                    parts = math.degrees(abs(value)) / 15.0     # 30, 45, 60, 90, 120, 180 degrees
                    if 0.5 < abs(value) < 6.3 and abs(parts - round(parts)) < 1e-3:
                        text = (f"{category.capitalize()} type {kind} ({use.style.name}) has {word} = {value:g} degrees, which as radians "
                                f"would be {math.degrees(value):.4g} degrees.")
                        found.append(Finding("warning", name, text, (), value, None,
                                             f"angles are in degrees in scripts: {math.degrees(value):.4g}?"))
    if not looked:
        raise DoesNotApply("no coefficients that are angles")
    return found or [Finding("ok", name, "Phases look like degrees.")]
