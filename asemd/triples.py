"""Potential files whose entries are triples of elements with numbers: sw, tersoff, vashishta and others."""
from __future__ import annotations

from collections.abc import Collection
from itertools import product

from asemd.errors import InputError, Where
from asemd.potential_file import PotentialFile

Triple = tuple[str, str, str]


def read_triples(file: PotentialFile, elements: Collection[str], names: str,
                 complete: bool = True) -> dict[Triple, tuple[dict[str, float], Where]]:
    """The entries of the file whose three elements are among `elements`, each with its numbers by name and its place.

    Parameters
    ----------
    names : str
        Names of the numbers after the elements, in their order.
    complete : bool
        Every triple of the elements must be there.

    Raises
    ------
    InputError
        An entry is too short, is there twice or missing; the message names file and line.
    """
    found: dict[Triple, tuple[dict[str, float], Where]] = {}
    for record in file.records(3 + len(names.split())):
        key = record.word(), record.word(), record.word()
        if not all(e in elements for e in key):
            continue
        if key in found:
            raise InputError(f"{file.what}: the entry {' '.join(key)} is there twice, first in line {found[key][1].line}", record.where)
        found[key] = record.numbers(names), record.where
    missing = [key for key in product(elements, repeat=3) if key not in found]
    if complete and missing:
        listed = ", ".join(" ".join(key) for key in missing[:4]) + (", ..." if len(missing) > 4 else "")
        raise InputError(f"{file.what}: {file.name} has no entry for {listed}")
    return found
