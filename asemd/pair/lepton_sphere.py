r"""E = U(r, radi, radj) for r < cut, with any formula U given as an expression in ``r`` and the radii of both atoms (see lepton)."""
from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import cache

from asemd.calculus import Source, source_of
from asemd.errors import InputError
from asemd.expression import ARGUMENT, VARIABLE, compiled_function, condense, parse
from asemd.pairstyle import PairStyle, make_part, pack_parts
from asemd.style import register

RADII = {"radi": "cradi", "radj": "cradj"}


@dataclass(frozen=True)
class Formula:
    """An expression as source, and the numbers in it."""

    source: Source
    numbers: tuple[float, ...]


def written(formulas) -> str:
    """The function for several formulas, which `kind` tells apart."""
    kinds = list(dict.fromkeys(f.source for f in formulas))
    numbers = [f"c{k}" for k in range(max(len(f.numbers) for f in formulas))]
    lines = [f"def lepton_sphere({', '.join(['r', 'radius_i', 'radius_j', 'kind', *numbers])}):", f"    {ARGUMENT} = np.float64(r)",
             "    cradi = np.float64(radius_i)", "    cradj = np.float64(radius_j)"]
    for k, source in enumerate(kinds):
        body = [f"p{n} = {text}" for n, text in enumerate(source.constants)]
        lines.append(f"    if kind == {k}.0:")
        lines += ["        " + line for line in (*body, *source.lines, f"return {source.energy}, {source.slope}")]
    return "\n".join([*lines, "    return np.inf, np.inf"]) + "\n"


class SphereExpression(PairStyle):
    """Expressions of one kind (equal up to numbers) share a piece of code, others are told apart by their types."""

    def __init__(self, name: str, **options):
        super().__init__(name, (), settings="cut", coeff="expression [cut]", units={"expression": "word"}, **options)
        self.sized = True
        twin = self.bind({}, {(1, 1): self.parse_coeff(self.example.split(), {})})
        self.parts, self.function = twin.parts, twin.function

    def parse_coeff(self, words, settings):
        if words and words[0][0] in "'\"":      # blanks inside the quotation marks of a data file
            last = max(k for k, w in enumerate(words) if w[-1] in "'\"")
            words = [" ".join(words[:last + 1]), *words[last + 1:]]
        values = super().parse_coeff(words, settings)
        values["expression"] = condense(values["expression"])
        if VARIABLE.search(values["expression"]):
            raise InputError(f"pair_coeff {self.name}: expressions of radii take no variables of the script, write their values out")
        self.formula(values)
        return values

    def formula(self, values) -> Formula:
        try:
            program = parse(values["expression"], "r", {}, RADII)
            return Formula(source_of(tuple(program.lines)), tuple(map(float, program.constants)))
        except InputError as e:
            raise InputError(f"pair_coeff {self.name}: {e.message}") from None

    def bind(self, settings, coeffs, compat=""):
        return bound(self, written([self.formula(c) for c in coeffs.values()]))

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        if shift:
            raise InputError(f"pair style {self.name} does not have pair_modify shift yes: put the number into the expression")
        each = {pair: self.formula(c) for pair, c in filled.items()}
        parts, kinds = bound(self, written(list(each.values()))).parts, list(dict.fromkeys(f.source for f in each.values()))
        full = {pair: dict.fromkeys(parts[0].rows, 0.0) | filled[pair] | {"kind": float(kinds.index(f.source))}
                | {f"c{k}": v for k, v in enumerate(f.numbers)} for pair, f in each.items()}
        return pack_parts(parts, {}, full, ntypes, lambda c: self.cutoffs(c, settings), False)


@cache
def bound(style: SphereExpression, source: str) -> SphereExpression:
    """The style with a written function; one object for each source, so that its kernels are found again."""
    twin = copy.copy(style)
    twin.function = compiled_function("lepton_sphere", source, __name__)
    rows = source.partition("(")[2].partition(")")[0].split(", ")[3:]
    twin.parts = (make_part(twin.function, "cut", rows),)
    return twin


register(SphereExpression("lepton/sphere", settings_example="2.5", example="4*((sig/r)^12-(sig/r)^6);sig=2*sqrt(radi*radj) 2.4",
                          see="LAMMPS manual, pair_style lepton/sphere", doc=__doc__))
