"""Bonded styles with a sum of as many terms as the user gives: their number comes first, then the coefficients of each term in turn."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from asemd.errors import InputError
from asemd.style import Packed, Parameter, Style, radians


class SeriesStyle(Style):
    """A style whose coefficients are a number of terms and the coefficients of each.

    Parameters
    ----------
    count : str
        Name of the number of terms.
    term : sequence of Parameter
        Coefficients of one term; those of the second term are called like ``K2``. The function takes ``first``, ``count`` and the array
        ``terms``: a row for each term, those of a type from `first` on, angles in radians.
    """

    def __init__(self, category: str, name: str, function, *, count: str, term: Sequence[Parameter], **options):
        self.count, self.term = count, tuple(term)
        super().__init__(category, name, function, coeff=self.parameters(1), **options)

    def parameters(self, count: int) -> tuple[Parameter, ...]:
        """All coefficients of a type with that many terms."""
        return (Parameter(self.count, "integer"), *(Parameter(f"{p.name}{k}", p.unit) for k in range(1, count + 1) for p in self.term))

    def parse_coeff(self, words, settings):
        command = f"{self.category}_coeff {self.name}"
        form = " ".join(p.name for p in self.parameters(1)) + " ..."
        if not words:
            raise InputError(f"{command} needs {form}, got 0 values")
        count = self.coeff[0].read(words[0], command)
        if count < 1:
            raise InputError(f"{command}: {self.count}, the number of terms, must be 1 or more, got {count}")
        given, size = len(words) - 1, len(self.term)
        if given != count * size:
            raise InputError(f"{command} needs {form}: {count * size} value{'s' * (count * size != 1)} after {self.count} = {count}, "
                             f"got {given}")
        values = {p.name: p.read(word, command) for p, word in zip(self.parameters(count), words)}
        self.check(values, settings)
        return values

    def format_coeff(self, coeff):
        return [p.write(coeff[p.name]) for p in self.parameters(coeff[self.count])]

    def pack(self, settings: Mapping[str, Any], coeffs: Mapping[int, Mapping[str, Any]], ntypes: int, units) -> Packed:
        rows, coeff = [], np.zeros((2, ntypes + 1))
        for t, values in coeffs.items():
            coeff[:, t] = len(rows), values[self.count]
            numbers = [radians(values[p.name]) if p.unit == "angle" else values[p.name] for p in self.parameters(values[self.count])[1:]]
            rows += np.reshape(numbers, (-1, len(self.term))).tolist()
        return Packed(coeff, (np.array(rows, float).reshape(-1, len(self.term)),))
