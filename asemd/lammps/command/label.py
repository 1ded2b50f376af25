"""``label ID``: a place that ``jump`` may go to."""
from __future__ import annotations

from asemd.words import exactly


def run(session, args):
    exactly(args, 1, "label")
