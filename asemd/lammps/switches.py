"""LAMMPS's command line switches."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from asemd.errors import InputError, nearest

SHORT = {"v": "var", "l": "log", "sc": "screen", "e": "echo", "nc": "nocite", "i": "in", "sf": "suffix", "pk": "package"}
KNOWN = ("var", "log", "screen", "echo", "nocite", "in", "suffix", "package", "compat", "threads", "precision", "cap")


@dataclass
class Switches:
    """What the switches said.

    Attributes
    ----------
    input, log, screen : str or None
        Paths; log and screen may be ``none``; screen None is the terminal.
    variables : list of (name, values)
    suffix : str
        Accepted and without effect: asemd has one implementation of each style.
    compat : str
        ``lammps``: follow LAMMPS where its forces are not the gradient of its energy.
    """

    input: str | None = None
    log: str | None = "log.lammps"
    screen: str | None = None
    echo: str = "log"
    variables: list[tuple[str, list[str]]] = field(default_factory=list)
    suffix: str = ""
    package: list[str] = field(default_factory=list)
    compat: str = ""
    threads: int = 1
    precision: str = "double"
    cap: int | None = None         # limit on the steps of every run and minimisation
    nocite: bool = False
    safe: bool = False              # refuse what a script from a stranger must not do


def parse(words: Sequence[str]) -> Switches:
    """Read switches such as ``-var x 10 -log none``.

    Raises
    ------
    InputError
        Unknown switch or wrong number of values.
    """
    out, i = Switches(), 0
    words = [str(w) for w in words]
    while i < len(words):
        word = words[i]
        name = word.lstrip("-")
        name = SHORT.get(name, name)
        if not word.startswith("-") or name not in KNOWN:
            raise InputError(f"unknown switch {word!r}{nearest(name, KNOWN)}")
        end = i + 1
        while end < len(words) and not is_switch(words[end]):
            end += 1
        _apply(out, name, word, words[i + 1:end])
        i = end
    return out


def is_switch(word: str) -> bool:
    """A word that starts a new switch; negative numbers are values."""
    return len(word) > 1 and word[0] == "-" and not (word[1].isdigit() or word[1] == ".")


def _apply(out: Switches, name: str, word: str, values: list[str]) -> None:
    if name == "nocite":
        count = (0, 0)
    elif name == "var":
        count = (2, None)
    elif name == "package":
        count = (1, None)
    else:
        count = (1, 2 if name == "suffix" else 1)
    if len(values) < count[0] or (count[1] is not None and len(values) > count[1]):
        raise InputError(f"switch {word} needs {'a name and at least one value' if name == 'var' else 'one value'}, got {len(values)}")
    if name == "var":
        out.variables.append((values[0], values[1:]))
    elif name == "package":
        out.package.append(" ".join(values))
    elif name == "suffix":
        out.suffix = " ".join(values)
    elif name == "nocite":
        out.nocite = True
    elif name == "threads":
        out.threads = whole(values[0], word)
    elif name == "cap":
        out.cap = whole(values[0], word)
    elif name == "precision":
        out.precision = one_of(values[0], ("double", "mixed"), word)
    elif name == "compat":
        out.compat = one_of(values[0], ("lammps",), word)
    elif name == "echo":
        out.echo = one_of(values[0], ("none", "screen", "log", "both"), word)
    else:
        setattr(out, "input" if name == "in" else name, values[0])


def whole(word: str, switch: str) -> int:
    try:
        value = int(word)
    except ValueError:
        value = -1
    if value < (0 if "cap" in switch else 1):
        raise InputError(f"{switch} needs a positive whole number, got {word!r}")
    return value


def one_of(word: str, choices: tuple[str, ...], switch: str) -> str:
    if word not in choices:
        raise InputError(f"{switch} must be one of {' '.join(choices)}, got {word!r}")
    return word
