"""``run_style verlet`` and ``run_style respa N n1 n2 ... keyword level ...``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.registry import plain_name
from asemd.respa import FORCES, PIECES, Levels
from asemd.words import choice, exactly, number, take, whole

KEYWORDS = (*FORCES, *PIECES, "hybrid")
WHAT = "run_style respa"


def run(session, args):
    scene = session.scene
    scene.need_system("run_style")
    style = choice(plain_name(take(args, 1, "run_style")[0]), ("verlet", "respa"), "run_style")
    if style == "verlet":
        exactly(args[1:], 0, "run_style verlet")
        scene.respa = None
        return
    interactions = scene.interactions
    levels = _levels(args[1:], len(interactions.uses["pair"]) if interactions.hybrid["pair"] else 0)
    session.print("Respa levels:")
    for level in range(1, levels.n + 1):
        session.print(f"  {level} = {' '.join(levels.forces(level))}".rstrip())
    _check_order(levels)
    if not all(levels.forces(level) for level in range(1, levels.n + 1)):
        session.warn("One or more respa levels compute no forces")
    _check_cuts(levels)
    scene.respa = levels


def _levels(words: list[str], sub_styles: int) -> Levels:
    n = whole(take(words, 1, WHAT)[0], f"{WHAT}: number of levels")
    if n < 1:
        raise InputError(f"{WHAT}: the number of levels must be positive, got {n}")
    factors = [whole(w, f"{WHAT}: loop factors") for w in take(words[1:], n - 1, f"{WHAT} {n}: loop factors")]
    if any(f < 1 for f in factors):
        raise InputError(f"{WHAT}: loop factors must be positive, got {' '.join(map(str, factors))}")
    levels, words = Levels(factors), words[n:]
    cuts: dict[str, tuple[float, ...]] = {}

    def level_of(word: str, key: str) -> int:
        level = whole(word, f"{WHAT} {key}")
        if not 1 <= level <= n:
            raise InputError(f"{WHAT} {key}: level {level} is outside the valid range 1 to {n}")
        return level

    while words:
        key, words = words[0], words[1:]
        if key not in KEYWORDS:
            raise InputError(f"{WHAT}: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        if key == "hybrid":
            if not sub_styles:
                raise InputError(f"{WHAT} hybrid needs a pair_style hybrid, and that before it")
            levels.hybrid = [level_of(w, key) for w in take(words, sub_styles, f"{WHAT} hybrid with {sub_styles} sub-styles")]
            words = words[sub_styles:]
            continue
        values = take(words, 3 if key in ("inner", "middle") else 1, f"{WHAT} {key}")
        levels.level[key], words = level_of(values[0], key), words[len(values):]
        cuts[key] = tuple(number(w, f"{WHAT} {key}") for w in values[1:])
    _fill(levels)
    if "inner" in cuts:
        levels.cuts = cuts["inner"] + cuts.get("middle", cuts["inner"])
    return levels


def _fill(levels: Levels) -> None:
    """Refuse keywords that exclude each other, and give the other forces their default levels."""
    level, pieces = levels.level, [p for p in PIECES if p in levels.level]
    if "pair" in level and pieces:
        raise InputError(f"{WHAT}: cannot set both pair and {pieces[0]}: the pair force is on one level, or split")
    if levels.hybrid and ("pair" in level or pieces):
        raise InputError(f"{WHAT}: cannot set both hybrid and {(['pair'] * ('pair' in level) + pieces)[0]}")
    if "middle" in level and not {"inner", "outer"} <= set(level):
        raise InputError(f"{WHAT}: cannot set middle without inner and outer")
    if ("inner" in level) != ("outer" in level):
        raise InputError(f"{WHAT}: must set both inner and outer")
    level.setdefault("bond", 1)
    for before, kind in zip(FORCES, FORCES[1:4]):
        level.setdefault(kind, level[before])
    if levels.hybrid:
        level.setdefault("kspace", max(levels.hybrid))
    elif pieces:
        level.setdefault("kspace", level["outer"])
    else:
        level.setdefault("pair", levels.n)
        level.setdefault("kspace", level["pair"])


def _check_order(levels: Levels) -> None:
    at = levels.level
    chains = [FORCES[:4]] if levels.hybrid else [[kind for kind in (*FORCES[:4], "pair", "inner", "outer", "kspace") if kind in at]]
    if "middle" in at:
        chains.append(["inner", "middle"])
    for chain in chains:
        for a, b in zip(chain, chain[1:]):
            if at[a] > at[b]:
                raise InputError(f"{WHAT}: invalid order of forces, {b} (level {at[b]}) must not be on a level below {a} (level {at[a]})")


def _check_cuts(levels: Levels) -> None:
    if levels.cuts:
        a, b, c, d = levels.cuts
        if b < a:
            raise InputError(f"{WHAT} inner: cutoffs are invalid, the second ({b:g}) must not be below the first ({a:g})")
        if "middle" in levels.level and not b <= c <= d:
            raise InputError(f"{WHAT} middle: cutoffs are invalid, {c:g} and {d:g} must not be below {b:g}, nor the second below the first")
