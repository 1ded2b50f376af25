"""What ``kspace_modify`` says of a long-range solver, as values by keyword; a solver takes those it knows and checks the rest.

Ranges are those that hold for every solver: the order of an interpolation, say, is any whole number here, and pppm alone allows 2 to 7.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from asemd import words as read
from asemd.errors import InputError, nearest

# what holds where nothing is said; order None: 5 for pppm, 10 for msm
DEFAULTS: dict[str, Any] = {
    "mesh": (0, 0, 0), "mesh/disp": (0, 0, 0), "order": None, "order/disp": 5, "minorder": 2, "overlap": True, "force": -1.0,
    "gewald": 0.0, "gewald/disp": 0.0, "slab": 1.0, "wire": 1.0, "compute": True, "cutoff/adjust": True, "fftbench": False,
    "collective": False, "diff": "ik", "kmax/ewald": (0, 0, 0), "mix/disp": "pair", "force/disp/real": -1.0,
    "force/disp/kspace": -1.0, "splittol": 1e-6, "pressure/scalar": True, "disp/auto": False}
SAME = {"eigtol": "splittol"}       # another name of a keyword
THREE = ("mesh", "mesh/disp", "kmax/ewald")
SLAB = ("nozforce", "ew2d")


def _mesh(values: list[str], what: str) -> tuple[int, ...]:
    three = tuple(read.whole(v, what) for v in values)
    if any(three) and min(three) < 1:
        raise InputError(f"{what}: the three numbers must be all 0 or all positive, got {' '.join(values)}")
    return three


def _vectors(values: list[str], what: str) -> tuple[int, ...]:
    three = tuple(read.whole(v, what) for v in values)
    if min(three) < 0:
        raise InputError(f"{what}: the three numbers must not be negative, got {' '.join(values)}")
    return three


def _above_one(values: list[str], what: str, names: tuple[str, ...] = ()) -> float | str:
    if values[0] in names:
        return values[0]
    try:
        value = read.number(values[0], what)
    except InputError:
        raise InputError(f"{what}: expected a number{''.join(f' or {n}' for n in names)}, got {values[0]!r}") from None
    if value <= 1.0:
        raise InputError(f"{what}: the extended volume must be larger than 1, got {values[0]}")
    return value


def _least(values: list[str], what: str) -> int:
    if (value := read.whole(values[0], what)) < 2:
        raise InputError(f"{what}: must be at least 2, got {value}")
    return value


def _below_one(values: list[str], what: str) -> float:
    if (value := read.number(values[0], what)) >= 1.0:
        raise InputError(f"{what}: must be smaller than 1, got {values[0]}")
    return value


def _one(reader: Callable[[str, str], Any]) -> Callable[[list[str], str], Any]:
    return lambda values, what: reader(values[0], what)


READERS: dict[str, Callable[[list[str], str], Any]] = {
    **{key: _one(read.yes_no) for key, value in DEFAULTS.items() if isinstance(value, bool)},
    **{key: _one(read.number) for key, value in DEFAULTS.items() if isinstance(value, float)}, "mesh": _mesh, "mesh/disp": _mesh,
    "kmax/ewald": _vectors, "order": _one(read.whole), "order/disp": _one(read.whole), "minorder": _least,
    "slab": partial(_above_one, names=SLAB), "wire": _above_one, "splittol": _below_one,
    "diff": _one(lambda word, what: read.choice(word, ("ad", "ik"), what)),
    "mix/disp": _one(lambda word, what: read.choice(word, ("pair", "geom", "none"), what))}


def parse(words: Sequence[str]) -> dict[str, Any]:
    """The words after ``kspace_modify`` as keyword -> value; the last of equal keywords holds.

    Raises
    ------
    InputError
        An unknown keyword, values that are missing or out of range.
    """
    out, words = {}, list(words)
    while words:
        keyword, *words = words
        what, keyword = f"kspace_modify {keyword}", SAME.get(keyword, keyword)
        if keyword not in READERS:
            raise InputError(f"unknown kspace_modify keyword {keyword!r}{nearest(keyword, READERS)}")
        values = read.take(words, 3 if keyword in THREE else 1, what)
        out[keyword] = READERS[keyword](values, what)
        words = words[len(values):]
    return out


def to_words(settings: dict[str, Any]) -> list[str]:
    """Words after ``kspace_modify`` that make the settings again."""
    out = []
    for keyword, value in settings.items():
        values = value if isinstance(value, (tuple, list)) else (value,)
        out += [keyword, *(("no", "yes")[v] if isinstance(v, bool) else v if isinstance(v, str) else repr(v) for v in values)]
    return out
