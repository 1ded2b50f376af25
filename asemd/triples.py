"""Potential files whose entries are triples of elements with numbers: sw, tersoff, vashishta and others."""
from __future__ import annotations

from collections.abc import Collection
from itertools import product

import numpy as np

from asemd.errors import InputError, Where
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
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


class TripleStyle(ManyBody):
    """A style whose file has an entry for each triple of elements and whose kernel takes one table by triples of types.

    Attributes
    ----------
    names : str
        Numbers of an entry in the file's order.
    columns : sequence of str
        Those of the kernel's table: numbers of the entry, or what `row` makes of them; the first is how far the entry reaches.
    energies : sequence of str
        Numbers that are energies, or those times a length.
    positive : str
        Numbers that must not be negative.
    """

    names = positive = ""
    columns: tuple[str, ...] | list[str] = ()
    energies: tuple[str, ...] = ()

    def read(self, file, elements, settings):
        found = read_triples(file, elements, self.names)
        for key, (p, where) in found.items():
            self.check_entry(p, lambda text, key=key, where=where: InputError(f"{file.what}: entry {' '.join(key)}: {text}", where))
        return {key: p for key, (p, _) in found.items()}

    def check_entry(self, p, error) -> None:
        """Refuse numbers that make no sense: ``raise error(message)``."""
        wrong = [n for n in self.positive.split() if p[n] < 0.0]
        if wrong:
            raise error(f"{wrong[0]} must not be negative, got {p[wrong[0]]:g}")

    def row(self, p, units) -> dict[str, float]:
        """Columns that are not numbers of the file; energies in `p` are those of the scene."""
        return {}

    def shortened(self, settings) -> float:
        """What is added to distances before they are compared with the reach."""
        return 0.0

    def numbers(self, settings) -> list[float]:
        """Constants of the kernel."""
        return [0.0]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, n = element_of(filled, ntypes), ntypes + 1
        rows, three = np.zeros((1, n, n)), np.zeros((n, n, n, len(self.columns)))
        served = {t for pair in filled for t in pair}
        for (a, b), c in filled.items():
            unit = self.unit_factor(c, units)
            for i, j in {(a, b), (b, a)}:
                for k in served:
                    p = c["data"][element[i], element[j], element[k]]
                    p = {**p, **{name: p[name] * unit for name in self.energies}}
                    p |= self.row(p, units)
                    three[i, j, k] = [p[name] for name in self.columns]
        reach = three[..., 0]
        farthest = np.maximum(reach.max(axis=1), reach.max(axis=2)) - self.shortened(settings)
        for i, j in filled:
            rows[0, i, j] = rows[0, j, i] = max(farthest[i, j], farthest[j, i], 0.0) ** 2
        return PairTables(rows, np.array(self.numbers(settings)), (three,))
