"""What a run of the script would warn of before its first step."""
from __future__ import annotations

from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

# the others are for your information
SERIOUS = ("extent > half", "integrated more than once", "is negative", "have no energy", "should be used with")


@static("script")
def warned(case: Case) -> list[Finding]:
    if not case.warnings:
        raise DoesNotApply("the script gives no warning")
    return [Finding("warning" if any(s in text for s in SERIOUS) else "note", "script", text) for text in case.warnings]
