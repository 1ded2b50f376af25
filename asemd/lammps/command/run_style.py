"""``run_style verlet``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.registry import plain_name
from asemd.words import take


def run(session, args):
    if plain_name(take(args, 1, "run_style")[0]) != "verlet":
        raise InputError(f"run_style {args[0]} is not supported: only verlet is")
