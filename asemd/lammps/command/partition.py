"""``partition yes|no N command ...``: there is one partition, number 1."""
from __future__ import annotations

from asemd.words import bounds, take, yes_no


def run(session, args):
    style, numbers, name = take(args, 3, "partition")[:3]
    wanted = yes_no(style, "partition")
    bounds(numbers, 1, 1, "partition: number of a partition")      # anything that is allowed is the one there is
    if wanted:
        session.call(name, args[3:])
