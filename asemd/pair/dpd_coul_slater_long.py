r"""Pair style dpd with charges that are smeared out exponentially: the sum of dpd up to cut and of coul/slater/long up to cut_coul.

Charges of a pair of types interact within cut_coul if its coefficient charged is yes; what a long-range solver adds is that of all charges.
Gonzalez-Melchor et al., J. Chem. Phys. 125, 224107 (2006).
"""
from __future__ import annotations

import copy

from asemd.errors import InputError
from asemd.pair.coul_slater_long import coul_slater_long
from asemd.pair.dpd import UNITS, NoisyPair, repulsion
from asemd.style import register


class ChargedNoisyPair(NoisyPair):
    """Its pieces: repulsion with friction and noise, and Coulomb."""

    def __init__(self, name, parts, **options):
        super().__init__(name, parts, **options)
        self._pieces = [self._piece(part) for part in self.parts]

    def _piece(self, part) -> ChargedNoisyPair:
        out = copy.copy(self)
        out.parts, out.charged = (part,), part.charged
        out.stirred = out.listed = not part.charged
        out.solvers = self.solvers if part.charged else frozenset()
        return out

    def pieces(self):
        return self._pieces

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if values["charged"] not in ("yes", "no"):
            raise InputError(f"pair_coeff {self.name}: charged must be yes or no, got {values['charged']!r}")
        return values

    def cutoffs(self, coeff, settings):
        return [cut if coeff["charged"] == "yes" or not part.charged else 0.0
                for part, cut in zip(self.parts, super().cutoffs(coeff, settings), strict=True)]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        noisy = len(self.parts) == 1 and not self.charged
        return (super() if noisy else super(NoisyPair, self)).pack_pairs(settings, filled, ntypes, units, shift)


register(ChargedNoisyPair("dpd/coul/slater/long", [(repulsion, "cut"), (coul_slater_long, "cut_coul")],
                          settings="temperature cut seed lamda cut_coul", coeff="a0 gamma charged [cut]",
                          units={**UNITS, "charged": "word"}, doc=__doc__, settings_example="1.0 2.5 34387 1.5 5.0",
                          example="25.0 4.5 yes 2.4", see="LAMMPS manual, pair_style dpd/coul/slater/long", shifts=False))
