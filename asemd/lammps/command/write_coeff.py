"""``write_coeff file``: the coefficients of all styles as commands, to ``include`` in another script.

Styles whose coefficients LAMMPS leaves out (hybrids, tables) are written too. Source: LAMMPS manual, write_coeff.
"""
from __future__ import annotations

from collections.abc import Iterator

from asemd.errors import InputError
from asemd.forcefield import CATEGORIES, Interactions
from asemd.lammps.setup_log import report_mixing
from asemd.pairing import complete
from asemd.words import exactly


def run(session, args):
    path = exactly(args, 1, "write_coeff")[0]
    system, interactions = session.scene.need_system("write_coeff"), session.scene.interactions
    if not any(interactions.uses.values()):
        raise InputError("write_coeff: there is no pair, bond, angle, dihedral or improper style yet")
    report_mixing(session)
    lines = ["# LAMMPS coeff file via write_coeff of asemd"]
    for category in ("pair", *(c for c in CATEGORIES if c != "pair")):
        if interactions.uses[category] and system.counts["ntypes" if category == "pair" else f"n{category}types"]:
            words = _pairs(interactions, system.counts["ntypes"]) if category == "pair" else _bonded(interactions, category)
            lines += ["# " + " ".join([f"{category}_style", *interactions.style_line(category)])]
            lines += [" ".join([f"{category}_coeff", *w]) for w in words] + [""]
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
    except OSError as e:
        raise InputError(f"write_coeff: cannot write {path}: {e.strerror or e}") from None


def _pairs(interactions: Interactions, ntypes: int) -> Iterator[list[str]]:
    """All pairs of types, mixed ones too."""
    lines = [((i, j), -1, ["none"]) for i, j in interactions.none["pair"]]
    for k, (use, filled) in enumerate(complete(interactions, ntypes)):
        name = use.label.split() if interactions.hybrid["pair"] else []
        lines += [(pair, k, [*name, *use.style.format_coeff(c)]) for pair, c in filled.items()]
    for (i, j), _, words in sorted(lines, key=lambda line: line[:2]):
        yield [str(i), str(j), *words]


def _bonded(interactions: Interactions, category: str) -> Iterator[list[str]]:
    """The main lines of all types, then those of each cross term."""
    at = 2 if interactions.hybrid[category] else 1
    lines = interactions.coeff_lines(category)
    marks = list(dict.fromkeys(_mark(line, at) for line in lines))
    for mark in sorted(marks, key=bool):
        yield from (line for line in lines if _mark(line, at) == mark)


def _mark(line: list[str], at: int) -> str:
    """The word that names a cross term."""
    return line[at] if line[at:] and line[at] in ("bb", "ba", "ub", "mbt", "ebt", "at", "aat", "bb13", "aa") else ""
