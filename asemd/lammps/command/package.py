"""``package style args...``: without effect; threads are chosen with ``--threads``."""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    take(args, 1, "package")
    session.print("  package: no effect; choose threads with --threads and precision with --precision")
