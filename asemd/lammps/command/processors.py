"""``processors Px Py Pz ...``: checked and without effect; threads are chosen with ``--threads``."""
from __future__ import annotations

from asemd.words import take, whole


def run(session, args):
    for word in take(args, 3, "processors"):
        if word != "*":
            whole(word, "processors")
    session.print("  1 by 1 by 1 MPI processor grid asked for by asemd; the processors command has no effect")
