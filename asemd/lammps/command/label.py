"""``label ID``: a place that ``jump`` may go to."""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    take(args, 1, "label")
