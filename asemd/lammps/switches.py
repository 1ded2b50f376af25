"""LAMMPS's command line switches."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from asemd.errors import InputError, nearest

SHORT = {"v": "var", "l": "log", "sc": "screen", "e": "echo", "nc": "nocite", "i": "in", "sf": "suffix", "pk": "package", "c": "cite",
         "k": "kokkos", "nb": "nonbuf", "p": "partition", "pl": "plog", "ps": "pscreen", "r2data": "restart2data", "r2dump": "restart2dump",
         "sr": "skiprun"}
# switch -> least and largest number of values
KNOWN: dict[str, tuple[int, int | None]] = {
    "var": (2, None), "log": (1, 1), "screen": (1, 1), "echo": (1, 1), "nocite": (0, 0), "cite": (1, 1), "in": (1, 1), "suffix": (1, 3),
    "package": (1, None), "kokkos": (1, None), "nonbuf": (0, 0), "partition": (1, None), "plog": (1, 1), "pscreen": (1, 1),
    "skiprun": (0, 0), "restart2data": (2, None), "restart2dump": (4, None),
    "compat": (1, 1), "threads": (1, 1), "precision": (1, 1), "cap": (1, 1), "watchdog": (1, 1)}


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
    nonbuf : bool
        Write the log at once, line by line.
    compat : str
        ``lammps``: follow LAMMPS where its forces are not the gradient of its energy, and in its tables of charges.
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
    watchdog: bool = True          # stop runs that have come apart, see docs/check.md
    nocite: bool = False
    nonbuf: bool = False
    convert: list[str] = field(default_factory=list)    # commands that -restart2data and -restart2dump stand for
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
        name = word[2:] if word.startswith("--") else word[1:]
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
    least, most = KNOWN[name]
    if len(values) < least or (most is not None and len(values) > most):
        need = {0: "takes no value", 1: "needs one value", 2: "needs a name and at least one value"}.get(least, f"needs {least} values")
        raise InputError(f"switch {word} {need}, got {len(values)}")
    if name == "var":
        out.variables.append((values[0], values[1:]))
    elif name == "package":
        out.package.append(" ".join(values))
    elif name == "suffix":
        out.suffix = " ".join(values)
    elif name in ("nocite", "nonbuf"):
        setattr(out, name, True)
    elif name == "skiprun":
        out.cap = 0
    elif name in ("restart2data", "restart2dump"):
        out.convert = _conversion(name, values)
    elif name in ("partition", "kokkos"):
        _refuse_parallel(name, word, values)
    elif name in ("cite", "plog", "pscreen"):
        return      # logs of partitions, of which there is one, and of citations, of which there are none
    elif name == "threads":
        out.threads = whole(values[0], word)
    elif name == "cap":
        out.cap = whole(values[0], word)
    elif name == "watchdog":
        out.watchdog = one_of(values[0], ("yes", "no"), word) == "yes"
    elif name == "precision":
        out.precision = one_of(values[0], ("double", "mixed"), word)
    elif name == "compat":
        out.compat = one_of(values[0], ("lammps",), word)
    elif name == "echo":
        out.echo = one_of(values[0], ("none", "screen", "log", "both"), word)
    else:
        setattr(out, "input" if name == "in" else name, values[0])


def _conversion(name: str, values: list[str]) -> list[str]:
    """``-restart2data file [remap] out words...`` and ``-restart2dump file [remap] group style out words...`` as commands."""
    remap = values[1] == "remap"
    rest = values[1 + remap:]
    command = "write_data" if name == "restart2data" else "write_dump"
    if not rest:
        raise InputError(f"switch -{name} needs a restart file and the words of {command}")
    return [f"read_restart {values[0]}" + " remap" * remap, f"{command} {' '.join(rest)}"]


def _refuse_parallel(name: str, word: str, values: list[str]) -> None:
    if name == "kokkos":
        if values[0] not in ("off", "no", "false"):
            raise InputError(f"switch {word}: there is no Kokkos here, use {word} off or leave it away")
    elif values not in (["1"], ["1x1"]):
        raise InputError(f"switch {word} {' '.join(values)}: asemd runs one partition on one process, give 1 or start asemd once for each")


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
