"""``balance ...``: without effect, since atoms are not spread over processors."""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    session.scene.need_system("balance")
    take(args, 1, "balance")
    session.print("  balance: no effect, there is one process")
