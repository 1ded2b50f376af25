"""Reading the words of a command: numbers, yes or no, ranges with an asterisk; each says what was wrong where."""
from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

from asemd.errors import InputError, nearest

BIG = 1.0e20    # LAMMPS's INF in regions
LARGEST = 2**62     # sums of two such numbers still fit into 64 bits


def real(word: str) -> float:
    """`float` of a word without what only Python reads: underscores, and digits of other alphabets.

    Raises
    ------
    ValueError
        Not a number.
    """
    if "_" in word or not word.isascii():
        raise ValueError(word)
    return float(word)


def number(word: str, what: str) -> float:
    """A finite number.

    Raises
    ------
    InputError
        Not a number, nan or inf; the message starts with `what`.
    """
    try:
        value = real(word)
    except ValueError:
        raise InputError(f"{what}: expected a number, got {word!r}") from None
    if not math.isfinite(value):
        raise InputError(f"{what}: expected a finite number, got {word!r}")
    return value


def whole(word: str, what: str) -> int:
    """A whole number."""
    if not re.fullmatch(r"[+-]?[0-9]+", word):
        raise InputError(f"{what}: expected a whole number, got {word!r}")
    if len(word) > 4000 or abs(int(word)) > LARGEST:      # Python refuses to read numbers of more than 4300 digits
        raise InputError(f"{what}: {word} is too large")
    return int(word)


def yes_no(word: str, what: str) -> bool:
    """LAMMPS's logical words."""
    if word in ("yes", "on", "true", "1"):
        return True
    if word in ("no", "off", "false", "0"):
        return False
    raise InputError(f"{what}: expected yes or no, got {word!r}")


def choice(word: str, choices: Iterable[str], what: str) -> str:
    """One of several words."""
    choices = list(choices)
    if word not in choices:
        raise InputError(f"{what}: expected one of {' '.join(choices)}, got {word!r}{nearest(word, choices)}")
    return word


def bounds(word: str, lo: int, hi: int, what: str, labels: Mapping[int, str] | None = None) -> tuple[int, int]:
    """First and last number of ``n``, ``*``, ``*n``, ``n*`` or ``m*n`` (both included), or of a type label.

    Parameters
    ----------
    lo, hi : int
        What an open end means; numbers outside are an error.
    labels : mapping of int to str, optional
        Names of the numbers.
    """
    for number_, label in (labels or {}).items():
        if word == label:
            return number_, number_
    match = re.fullmatch(r"(-?[0-9]+)|(-?[0-9]*)\*(-?[0-9]*)", word)
    if not match:
        raise InputError(f"{what}: expected a number or a range such as 2*4, got {word!r}{nearest(word, (labels or {}).values())}")
    if len(word) > 4000:
        raise InputError(f"{what}: {word} is too large")
    if match[1] is not None:
        first = last = int(match[1])
    else:
        first = int(match[2]) if match[2] else lo
        last = int(match[3]) if match[3] else hi
    if lo <= last < first <= hi:
        raise InputError(f"{what}: the range {word} is empty, its first number is above its last one")
    if first < lo or last > hi or first > last:
        raise InputError(f"{what}: {word} is outside the valid range {lo} to {hi}")
    return first, last


def take(words: list[str], n: int, what: str) -> list[str]:
    """The first n words, or an error that says how many there are."""
    if len(words) < n:
        raise InputError(f"{what} needs {n} value{'s' * (n != 1)}, got {len(words)}")
    return words[:n]


def exactly(words: list[str], n: int, what: str) -> list[str]:
    """All words, of which there must be n."""
    if len(words) != n:
        raise InputError(f"{what} needs {n} value{'s' * (n != 1)}, got {len(words)}")
    return words
