r"""Are angles and torsions near the geometry at which their forces have no direction, or no bound?

The force of an angle at 180 (or 0) degrees points nowhere unless :math:`dE/d\theta` vanishes there; that of a torsion on its end atoms
is :math:`(dE/d\phi) / (r \sin\theta)` and grows without bounds as an angle within it gets straight, unless the style takes care of it.
"""
from __future__ import annotations

import math

import numpy as np

from asemd import coordinates
from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

ANGLE = math.radians(2.0)
TORSION = math.radians(6.0)
WEAK = 0.05         # kT per radian: slopes below this matter to nobody
BOUND = 5.0         # how much larger than at right angles a torsion's torque over its arm may get
SAMPLES = 24
SMOOTH = ("a style that is flat at 180 degrees (cosine, cosine/squared, charmm with 180 at rest) is smooth there; otherwise look whether "
          "the atoms are meant to be on a line")
BENT = ("an angle potential that keeps the atoms off the line (cosine/squared/restricted), or dihedral style cosine/squared/restricted or "
        "table/cut, which vanish there")


@static("straight angles")
def straight_angles(case: Case) -> list[Finding]:
    name, found, any_angle = "straight angles", [], False
    kt = case.units.boltz * case.temperature
    for items in case.items:
        theta = items.column("theta")
        if items.category != "angle" or theta is None:
            continue
        any_angle = True
        inward = np.minimum(theta, np.pi - theta)
        near = np.flatnonzero((inward < ANGLE) & case.vibrates("angle", items.atoms))
        if not len(near):
            continue
        q = items.q[near].copy()
        q[:, items.style.coordinates.index("theta")] = np.where(theta[near] < 1.0, 1e-5, np.pi - 1e-5)
        slope = np.abs(items.slopes(q, items.types[near])[:, 0])
        bad = near[slope > WEAK * kt]
        if len(bad):
            worst = bad[int(np.argmin(inward[bad]))]
            ids, steep = case.ids(items.atoms[worst]), float(slope.max())
            rest = items.rest(int(items.types[worst]))
            close = math.isfinite(rest) and min(rest, 180.0 - rest) < 15.0
            text = (f"{_angles(len(bad))} nearly straight or folded back, such as {'-'.join(map(str, ids))} with "
                    f"{math.degrees(theta[worst]):.3f} degrees: there the force of angle style {items.style.name} has a size "
                    f"({steep / kt:.3g} kT per radian) but no direction, and turns from one step to the next.")
            limit = 180.0 - math.degrees(ANGLE) if theta[worst] > 1.0 else math.degrees(ANGLE)
            found.append(Finding("note" if close or case.gentle else "warning", name, text, ids, math.degrees(theta[worst]), limit, SMOOTH))
    if not any_angle:
        raise DoesNotApply("no angles")
    return found or [Finding("ok", name, "No angle is where its force has no direction.", limit=f"{math.degrees(ANGLE):g} deg")]


@static("torsions on a line")
def straight_torsions(case: Case) -> list[Finding]:
    name, found, any_torsion = "torsions on a line", [], False
    kt = case.units.boltz * case.temperature
    for items in case.items:
        if items.category != "dihedral" or items.style.coordinates[0] != "phi":
            continue
        any_torsion = True
        x = case.system.x[items.atoms]
        f, g, h = (case.system.box.minimum_image(x[:, a] - x[:, b])[0] for a, b in ((0, 1), (1, 2), (3, 2)))
        with np.errstate(all="ignore"):
            bend = np.stack([coordinates.angle_between(f, -g), coordinates.angle_between(g, h)], axis=1)
        line = np.minimum(bend, np.pi - bend).min(axis=1)
        near = np.flatnonzero((line < TORSION) & case.vibrates("dihedral", items.atoms))
        if not len(near):
            continue
        torque = _torque(items, near)
        arm = np.sin(np.maximum(line[near], 1e-9))
        bad = near[(torque > WEAK * kt) & (torque / arm > BOUND * kt)]
        if len(bad):
            worst = bad[int(np.argmin(line[bad]))]
            ids = case.ids(items.atoms[worst])
            text = (f"{_torsions(len(bad))} three atoms nearly on a line, such as {'-'.join(map(str, ids))} "
                    f"({math.degrees(line[worst]):.3g} degrees from straight): the force of dihedral style {items.style.name} on its end "
                    "atoms grows as 1 / sin of that angle.")
            severity = "note" if case.gentle else "warning"
            found.append(Finding(severity, name, text, ids, math.degrees(line[worst]), math.degrees(TORSION), BENT))
    if not any_torsion:
        raise DoesNotApply("no torsions")
    return found or [Finding("ok", name, "No torsion has three atoms on a line.", limit=f"{math.degrees(TORSION):g} deg")]


def _torque(items, rows: np.ndarray) -> np.ndarray:
    """(m,) largest slope by phi over a turn, at the present angles and lengths."""
    most = np.zeros(len(rows))
    for phi in np.linspace(-np.pi, np.pi, SAMPLES, endpoint=False) + 0.05:
        q = items.q[rows].copy()
        q[:, 0] = phi
        most = np.maximum(most, np.abs(np.nan_to_num(items.slopes(q, items.types[rows])[:, 0], posinf=0.0, neginf=0.0)))
    return most


def _angles(n: int) -> str:
    return "1 angle is" if n == 1 else f"{n} angles are"


def _torsions(n: int) -> str:
    return "1 torsion has" if n == 1 else f"{n} torsions have"
