"""Checks that styles and fixes bring along: their method ``check_stability(case)``."""
from __future__ import annotations

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding


@static("styles and fixes")
def own(case: Case) -> list[Finding]:
    owners = [use.style for uses in case.interactions.uses.values() for use in uses] + list(case.fixes.values())
    mine = [o for o in owners if hasattr(o, "check_stability")]
    if not mine:
        raise DoesNotApply("none in use has a check of its own")
    return [finding for o in mine for finding in o.check_stability(case)] or [
        Finding("ok", "styles and fixes", f"{len(mine)} looked at their own numbers.")]
