"""Is the box neutral where charges act over long distances?"""
from __future__ import annotations

import numpy as np

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

NEUTRAL = 1e-4      # of the mean size of a charge, for each atom: what rounded charges in a data file add up to


@static("net charge")
def net_charge(case: Case) -> list[Finding]:
    name, q = "net charge", case.system.q
    charged = [u.style for u in case.interactions.uses["pair"] if u.style.charged]
    if q is None or not np.any(q) or not charged:
        raise DoesNotApply("no charges act on each other")
    total, size = float(np.sum(q)), float(np.abs(q).mean())
    limit = NEUTRAL * size * len(q)
    far = [s.name for s in charged if "/long" in s.name or "/msm" in s.name]
    periodic = case.system.box.periodic[:case.system.dimension].any()
    if abs(total) <= limit:
        return [Finding("ok", name, f"The charges add up to {total:.3g}.", value=total, limit=limit)]
    text = f"The charges add up to {total:.6g}."
    if far:
        return [Finding("warning", name, f"{text} With a long-range sum ({far[0]}) a uniform background neutralises the box: the pressure "
                        "and energies of different boxes cannot be compared.", value=total, limit=limit,
                        advice="add counter ions, or look for atoms whose charge was not set")]
    advice = "add counter ions, or look for atoms whose charge was not set" if periodic else ""
    return [Finding("note", name, text, value=total, limit=limit, advice=advice)]
