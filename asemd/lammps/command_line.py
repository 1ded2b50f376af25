"""A command line with LAMMPS's switches in any place: which words are theirs, which are the command, the script and asemd's options.

LAMMPS's switches have one dash (or two) and up to any number of values; the script may stand before, between or behind them.
"""
from __future__ import annotations

import os
from collections.abc import Collection, Sequence

from asemd.errors import InputError, nearest
from asemd.lammps.switches import KNOWN, SHORT, Switches, is_switch, parse

OWN = ("log", "threads", "precision", "compat")       # with two dashes an option of asemd
OPTIONS = ("-threads", "-precision", "-compat")       # with one dash, too: LAMMPS has no such switches
# what follows is no script though it be a file
VALUED = ("--html", "--import", "--log", "--output", "-o", "--apply", "--folder", *(f"-{w}" for w in OPTIONS))


def split(words: Sequence[str], commands: Collection[str]) -> tuple[list[str], Switches]:
    """Command, script and options on one side, LAMMPS's switches on the other.

    Without a command, a script or a switch means ``run``, as in LAMMPS.

    Parameters
    ----------
    words : sequence of str
    commands : collection of str
        Names of asemd's commands.

    Raises
    ------
    InputError
        A switch that does not exist or lacks values; a word that is neither a command nor a file.
    """
    words = ["--help" if w in ("-h", "-help") else f"-{w}" if w in OPTIONS else w for w in words]
    rest: list[str] = []
    taken: list[list[str]] = []
    as_lammps = any(_name(w) == "in" for w in words)        # then every word belongs to a switch
    i = 0
    while i < len(words):
        name, end = _name(words[i]), i + 1
        if name:
            least, most = KNOWN[name]
            if name == "suffix" and words[i + 1:i + 2] != ["hybrid"]:
                most = 1
            known = as_lammps or any(w in commands for w in rest)
            while end < len(words) and (most is None or end - i <= most) and not is_switch(words[end]):
                if words[end] in commands and not known and end - i > least:
                    break
                end += 1
            taken.append(words[i:end])
            more = words[end:end + 1]
            if most == 0 and more and not (is_switch(more[0]) or more[0] in commands or more[0] == "-" or os.path.isfile(more[0])):
                raise InputError(f"{words[i]} takes no value, got {more[0]!r}")
        elif is_switch(words[i]) and words[i][1] not in "-o":      # -o is an option of asemd
            raise InputError(f"unknown switch {words[i]!r}{nearest(words[i][1:], KNOWN)}")
        else:
            rest.append(words[i])
        i = end
    if not as_lammps and not _has_script(rest, commands):
        rest += _last_value(taken)
    return _with_command(rest, commands, bool(taken)), parse([w for switch in taken for w in switch])


def _name(word: str) -> str:
    """The full name of a switch of LAMMPS; empty for other words."""
    if not is_switch(word):
        return ""
    bare = word[2:] if word.startswith("--") else word[1:]
    name = SHORT.get(bare, bare) if word[1] != "-" or len(bare) > 1 else bare
    return name if name in KNOWN and not (word.startswith("--") and name in OWN) else ""


def _has_script(rest: list[str], commands: Collection[str]) -> bool:
    return any((w == "-" or os.path.isfile(w)) and w not in commands and (k == 0 or rest[k - 1] not in VALUED) for k, w in enumerate(rest))


def _last_value(taken: list[list[str]]) -> list[str]:
    """The script that stands behind a switch with any number of values, such as ``-var x 1 in.file``: taken off it."""
    for switch in reversed(taken):
        least, most = KNOWN[_name(switch[0])]
        if most is None and len(switch) - 1 > least and (switch[-1] == "-" or os.path.isfile(switch[-1])):
            return [switch.pop()]
    return []


def _with_command(rest: list[str], commands: Collection[str], switched: bool) -> list[str]:
    if any(w in commands for w in rest) or "--help" in rest or "--version" in rest:
        return rest
    unknown = [w for w in rest[:1] if not w.startswith("-") and not os.path.isfile(w)]
    if (switched or _has_script(rest, ())) and not (unknown and rest[1:] and not rest[1].startswith("-")):
        return ["run", *rest]
    if unknown:
        raise InputError(f"{unknown[0]} is neither a command nor a file{nearest(unknown[0], commands)}: asemd run in.file runs a script, "
                         f"other commands are {' '.join(c for c in commands if c != 'run')}")
    return rest
