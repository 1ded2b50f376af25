r"""E = U(r) for r < cut, with any formula U given as an expression in ``r``; ``zbl(zi, zj, r)`` is the screened nuclear repulsion of
pair style zbl. Pairs of different types are given one by one: formulas do not mix."""
from __future__ import annotations

import copy
from functools import cache

from asemd import units as unit_systems
from asemd.errors import InputError
from asemd.expression import VARIABLE, compiled_function, condense, differentiate
from asemd.expression_style import present, write
from asemd.pairstyle import PairStyle, make_part, pack_parts
from asemd.style import register


class PairExpression(PairStyle):
    """Expressions of one kind (equal up to numbers) share a piece of code, others are told apart by their types."""

    def __init__(self, name: str, **options):
        super().__init__(name, (), settings="cut", coeff="expression [cut]", units={"expression": "word"}, **options)
        example = self.bind({}, {(1, 1): self.parse_coeff(self.example.split(), {})})
        self.parts, self.function = example.parts, example.function

    def parse_coeff(self, words, settings):
        if words and words[0][0] in "'\"":      # blanks inside the quotation marks of a data file
            last = max(k for k, w in enumerate(words) if w[-1] in "'\"")
            words = [" ".join(words[:last + 1]), *words[last + 1:]]
        values = super().parse_coeff(words, settings)
        values["expression"] = condense(values["expression"])
        if not VARIABLE.search(values["expression"]):
            self.compiled(values)
        return values

    def fill(self, values, settings, text_of) -> None:
        """See `asemd.expression_style.ExpressionStyle.fill`."""
        values["current"] = present(values["expression"], text_of)
        self.compiled(values)

    def compiled(self, values, units=None):
        """The expression as source; the constants of ``zbl`` in these units."""
        units = units or unit_systems.get("lj")
        text, given = values.get("current", (values["expression"], ()))
        try:
            return differentiate(text, "r", (*given, ("zbl energy", units.qqr2e * units.qelectron**2), ("zbl length", units.angstrom)))
        except InputError as e:
            raise InputError(f"pair_coeff {self.name}: {e.message}") from None

    def bind(self, settings, coeffs, compat=""):
        written = write(self.name, "r", "r", [], [self.compiled(c) for c in coeffs.values()])
        return bound(self, written.source, written.bend, written.arguments)

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        each = {pair: self.compiled(c, units) for pair, c in filled.items()}
        written = write(self.name, "r", "r", [], each.values())
        full = {pair: dict.fromkeys(written.arguments, 0.0) | c | written.values(each[pair]) for pair, c in filled.items()}
        parts = bound(self, written.source, written.bend, written.arguments).parts
        return pack_parts(parts, {}, full, ntypes, lambda c: self.cutoffs(c, settings), shift)


@cache
def bound(style: PairExpression, source: str, bend: str, arguments: tuple[str, ...]) -> PairExpression:
    """The style with a written function; one object for each source, so that its kernels are found again."""
    twin = copy.copy(style)
    twin.function = compiled_function(style.name, source, __name__)
    twin.function.d2 = compiled_function(style.name, bend, __name__)
    twin.parts = (make_part(twin.function, "cut", arguments),)
    return twin


register(PairExpression("lepton", settings_example="2.5", example="4*eps*((sig/r)^12-(sig/r)^6);eps=0.9;sig=1.1 2.4",
                        see="LAMMPS manual, pair_style lepton", doc=__doc__))
