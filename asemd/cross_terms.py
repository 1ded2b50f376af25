"""Bonded styles whose coefficients stand on several lines: the main ones, and a line for each cross term that begins with its mark.

``angle_coeff 1 109.5 75 5 1`` and ``angle_coeff 1 bb 10 1.5 1.5`` belong together; in a data file the section says the mark.
"""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from asemd.errors import InputError
from asemd.style import Parameter, Style


class CrossTermStyle(Style):
    """A style with cross terms (the class2 family).

    Parameters
    ----------
    marks : mapping
        Mark -> names of its coefficients, ``{"bb": "M bb_r1 bb_r2"}``; the other coefficients are the main ones. Several groups may stand
        on one line, each after its mark: ``109.5 75 5 1 bb 10 1.5 1.5``.
    """

    def __init__(self, category: str, name: str, function, *, marks: Mapping[str, str], **options):
        super().__init__(category, name, function, **options)
        marked = {mark: tuple(names.split()) for mark, names in marks.items()}
        known = {p.name: p for p in self.coeff}
        main = tuple(n for n in known if not any(n in names for names in marked.values()))
        self.groups: dict[str, tuple[Parameter, ...]] = {
            mark: tuple(known[n] for n in names) for mark, names in {"": main, **marked}.items()}
        self.coeff = tuple(p for group in self.groups.values() for p in group)

    def parse_coeff(self, words, settings):
        starts = [i for i, word in enumerate(words) if word in self.groups and word]
        if not starts or starts[0] > 0:
            starts.insert(0, 0)
        values: dict[str, Any] = {}
        for begin, end in zip(starts, [*starts[1:], len(words)]):
            mark = words[begin] if words[begin:end] and words[begin] in self.groups else ""
            command = f"{self.category}_coeff {self.name} {mark}".rstrip()
            if self.groups[mark][0].name in values:
                raise InputError(f"{command}: {mark} appears twice")
            given = words[begin + bool(mark):end]
            if len(given) != len(self.groups[mark]):
                raise InputError(f"{command} needs {' '.join(p.name for p in self.groups[mark])}, "
                                 f"got {len(given)} value{'s' * (len(given) != 1)}")
            values |= {p.name: p.read(word, command) for p, word in zip(self.groups[mark], given)}
        self.check(values, settings)
        return values

    def join(self, old, new):
        return {**old, **new}

    def missing(self, coeff):
        return [mark or "the main ones" for mark, group in self.groups.items() if group[0].name not in coeff]

    def coeff_lines(self, coeff):
        return [[mark] * bool(mark) + [p.write(coeff[p.name]) for p in group if p.name in coeff]
                for mark, group in self.groups.items() if group[0].name in coeff]

    def format_coeff(self, coeff):
        return [word for line in self.coeff_lines(coeff) for word in line]
