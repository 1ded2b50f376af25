r"""E = (C / dielectric) U(r, q_i, q_j) for r < cut, with any formula U given as an expression in ``r``, ``qi`` and ``qj``.

The formula must be a product of both charges and a function of the distance. The words ewald, pppm, msm, dispersion and tip4p after the
cutoff say which long-range solvers it may be used with; special pairs are weighed as a whole, as in LAMMPS. Pairs of different types are
given one by one.
"""
from __future__ import annotations

import copy
import re
from functools import cache

from asemd import units as unit_systems
from asemd.errors import InputError, nearest
from asemd.expression import VARIABLE, compiled_function, differentiate
from asemd.expression_style import write
from asemd.pair.lepton import PairExpression
from asemd.pairstyle import PairStyle, make_part, pack_parts
from asemd.style import register

SOLVERS = ("ewald", "pppm", "msm", "dispersion", "tip4p")
CHARGES = (1.0, 1.0)
PROBES = ((0.7, -1.3), (-2.1, -0.4), (0.0, 1.7))
DISTANCES = (0.9, 1.7, 3.1)


class ChargedExpression(PairExpression):
    """Expressions of the distance times both charges."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.charged = True     # its part is written for a scene

    def parse_settings(self, words):
        for word in words[1:]:
            if word not in SOLVERS:
                raise InputError(f"pair_style {self.name}: unknown keyword {word!r}{nearest(word, SOLVERS)}")
        return super().parse_settings(words[:1]) | {"solvers": tuple(words[1:])}

    def format_settings(self, settings):
        return [*super().format_settings(settings), *settings.get("solvers", ())]

    def works_with(self, settings):
        return frozenset(settings.get("solvers", ()))

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if not VARIABLE.search(values["expression"]):
            self.check_charges(values)
        return values

    def fill(self, values, settings, text_of) -> None:
        super().fill(values, settings, text_of)
        self.check_charges(values)

    def check_charges(self, values) -> None:
        """Refuse what is not proportional to both charges."""
        def energy(r, charges):
            compiled = self.compiled(values, None, charges)
            written = write("trial", "r", "r", [], [compiled])
            numbers = written.values(compiled)
            return compiled_function("trial", written.source)(r, *(numbers[n] for n in written.arguments))[0]
        for r in DISTANCES:
            for a, b in PROBES:
                one, other = a * b * energy(r, CHARGES), energy(r, (a, b))
                if abs(one - other) > 1e-9 * max(abs(one), abs(other)):
                    raise InputError(f"pair_coeff {self.name}: the expression must be the product qi*qj times a function of r")

    def compiled(self, values, units=None, charges=CHARGES):
        units = units or unit_systems.get("lj")
        text, given = values.get("current", (values["expression"], ()))
        known = (("qi", charges[0]), ("qj", charges[1]), ("zbl energy", units.qqr2e * units.qelectron**2),
                 ("zbl length", units.angstrom))
        try:
            return differentiate(text, "r", (*given, *known))
        except InputError as e:
            raise InputError(f"pair_coeff {self.name}: {e.message}") from None

    def bind(self, settings, coeffs, compat=""):
        written = write("potential", "r", "r", ["qq"], [self.compiled(c) for c in coeffs.values()])
        return charged(self, written.source, written.bend, written.arguments)

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        each = {pair: self.compiled(c, units) for pair, c in filled.items()}
        written = write("potential", "r", "r", ["qq"], each.values())
        full = {pair: dict.fromkeys(written.arguments, 0.0) | c | written.values(each[pair]) for pair, c in filled.items()}
        parts = charged(self, written.source, written.bend, written.arguments).parts
        return pack_parts(parts, {}, full, ntypes, lambda c: PairStyle.cutoffs(self, c, settings), shift)


@cache
def charged(style: ChargedExpression, source: str, bend: str, arguments: tuple[str, ...]) -> ChargedExpression:
    """The style with a written function; one object for each source, so that its kernels are found again."""
    twin = copy.copy(style)
    both = re.sub(r"^( *)return (.*)$", r"\1energy, slope = \2\n\1return qq * energy, qq * slope", source, flags=re.M)
    twin.function = compiled_function("potential", both, __name__)
    twin.function.__annotations__ = {}
    twin.function.d2 = compiled_function("potential", re.sub(r"return (.*)$", r"return qq * (\1)", bend, flags=re.M), __name__)
    twin.parts = (make_part(twin.function, "cut", arguments),)
    twin.charged = True
    return twin


register(ChargedExpression("lepton/coul", settings_example="2.5", example="qi*qj/r*exp(-k*r);k=0.7 2.4",
                           see="LAMMPS manual, pair_style lepton/coul", doc=__doc__))
