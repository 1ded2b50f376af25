"""``run_style verlet`` and ``run_style respa N n1 n2 ... keyword level ...``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.registry import plain_name
from asemd.respa import FORCES, Levels
from asemd.words import choice, exactly, take, whole

SPLIT = ("inner", "middle", "outer", "hybrid")


def run(session, args):
    scene = session.scene
    scene.need_system("run_style")
    style = choice(plain_name(take(args, 1, "run_style")[0]), ("verlet", "respa"), "run_style")
    if style == "verlet":
        exactly(args[1:], 0, "run_style verlet")
        scene.respa = None
        return
    levels = _levels(args[1:])
    session.print("Respa levels:")
    for level in range(1, levels.n + 1):
        session.print(f"  {level} = {' '.join(levels.forces(level))}".rstrip())
    _check(levels)
    scene.respa = levels


def _levels(words: list[str]) -> Levels:
    what = "run_style respa"
    n = whole(take(words, 1, what)[0], f"{what}: number of levels")
    if n < 1:
        raise InputError(f"{what}: the number of levels must be positive, got {n}")
    factors = [whole(w, f"{what}: loop factors") for w in take(words[1:], n - 1, f"{what} {n}: loop factors")]
    if any(f < 1 for f in factors):
        raise InputError(f"{what}: loop factors must be positive, got {' '.join(map(str, factors))}")
    level, words = {}, words[n:]
    while words:
        key = words[0]
        if key in SPLIT:
            raise InputError(f"{what} {key} is not supported: forces of pairs are on one level, use the keyword pair")
        if key not in FORCES:
            raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, (*FORCES, *SPLIT))}")
        level[key] = whole(take(words[1:], 1, f"{what} {key}")[0], f"{what} {key}")
        if not 1 <= level[key] <= n:
            raise InputError(f"{what} {key}: level {level[key]} is outside the valid range 1 to {n}")
        words = words[2:]
    level.setdefault("bond", 1)
    for before, kind in zip(FORCES, FORCES[1:4]):
        level.setdefault(kind, level[before])
    level.setdefault("pair", n)
    level.setdefault("kspace", level["pair"])
    return Levels(factors, level)


def _check(levels: Levels) -> None:
    for a, b in zip(FORCES, FORCES[1:]):
        if levels.level[a] > levels.level[b]:
            raise InputError(f"run_style respa: {b} (level {levels.level[b]}) must not be on a level below {a} (level {levels.level[a]})")
