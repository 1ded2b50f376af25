"""Is every atom in the box, and is the box wide enough for the cutoff and the molecules?"""
from __future__ import annotations

import numpy as np

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

FAR = 1e6       # boxes: so far away that positions lose digits


@static("atoms in the box")
def inside(case: Case) -> list[Finding]:
    name, system = "atoms in the box", case.system
    strange = np.flatnonzero(~np.isfinite(system.x).all(axis=1))
    if len(strange):
        return [Finding("error", name, f"The position of atom {case.ids(strange)[0]} is not a number.", case.ids(strange),
                        advice="look at the program that wrote the positions")]
    s, found = system.box.fractional(system.x)[:, :system.dimension], []
    faces = system.box.boundary[:system.dimension]
    for k, (lower, upper) in enumerate(faces):
        out = np.flatnonzero((s[:, k] < 0.0) & (lower == "f") | (s[:, k] >= 1.0) & (upper == "f"))
        if len(out):
            far = out[np.argsort(-np.abs(s[out, k] - 0.5))]
            allowed = case.scene is not None and case.scene.thermo.lost != "error"
            found.append(Finding("warning" if allowed else "error", name, f"{_count(len(out), 'atom')} outside the fixed faces along "
                                 f"{'xyz'[k]}: {_list(case.ids(far))}. They are lost as the run begins.", case.ids(far), len(out), 0,
                                 "make the box larger, or use a shrink-wrapped boundary (s) there"))
    periodic = system.box.periodic[:system.dimension]
    away = np.abs(s[:, periodic]).max(axis=1, initial=0.0)
    if away.max(initial=0.0) > FAR:
        row = int(np.argmax(away))
        found.append(Finding("warning", name, f"Atom {case.ids(row)[0]} is {away[row]:.3g} box lengths away: so far out positions have "
                             "few digits left.", case.ids(row), away[row], FAR, "write wrapped positions with image flags"))
    return found or [Finding("ok", name, f"{system.n} atoms", value=f"{system.n} of {system.n}")]


@static("box and cutoff")
def width(case: Case) -> list[Finding]:
    """Cells narrower than twice the cutoff are computed right here, with all images; half the cutoff is rarely meant."""
    name, system = "box and cutoff", case.system
    periodic = system.box.periodic & (np.arange(3) < system.dimension)
    if not periodic.any() or not case.engine.has_pairs:
        raise DoesNotApply("no pair forces across a periodic face")
    widths = 1.0 / np.linalg.norm(np.linalg.inv(system.box.cell), axis=0)
    k = int(np.argmin(np.where(periodic, widths, np.inf)))
    narrow, cutoff = float(widths[k]), case.engine.cutoff
    if narrow >= 2.0 * cutoff:
        return [Finding("ok", name, f"The narrowest periodic width is {narrow:.4g}.", value=narrow, limit=2.0 * cutoff)]
    text = (f"The box is {narrow:.4g} wide along {'abc'[k]}, less than twice the cutoff {cutoff:.4g}: every atom sees several images of "
            "its neighbours" + (", and itself" if narrow < cutoff else "") + ".")
    advice = "fine for a crystal; for a liquid replicate the box or use a shorter cutoff"
    return [Finding("warning" if narrow < cutoff else "note", name, text, value=narrow, limit=2.0 * cutoff, advice=advice)]


def _count(n: int, what: str) -> str:
    return f"{n} {what} is" if n == 1 else f"{n} {what}s are"


def _list(ids, most: int = 5) -> str:
    return " ".join(map(str, ids[:most])) + (" ..." if len(ids) > most else "")
