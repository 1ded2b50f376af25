r"""AIREBO-M: `pair airebo` with Morse energies between molecules, $\epsilon\big[(1-e^{-\alpha(r-r_0)})^2-1\big]$, for high pressures."""
from __future__ import annotations

import math

from asemd.kernels import bond_order as kernels
from asemd.pair.airebo import AIREBO, OPTIONS, WORDS
from asemd.style import register


def attraction(r, p):
    """Morse energy of two atoms and its derivative."""
    e = p[20] * math.exp(-p[21] * r)
    return p[19] * e * (e - 2.0), -2.0 * p[19] * p[21] * e * (e - 1.0)


class Morse(AIREBO):
    title, morse = "AIREBO-M", True

    def attraction(self, p, pair, unit):
        """Depth, exp(alpha r0), alpha."""
        return p[f"epsilonM_{pair}"] * unit, math.exp(p[f"alphaM_{pair}"] * p[f"reqM_{pair}"]), p[f"alphaM_{pair}"]


HELPERS = tuple(attraction if f is kernels.attraction else f for f in kernels.HELPERS)
morse = register(Morse("airebo/morse", helpers=HELPERS, example="CH.airebo-m C", doc=__doc__,
               see="T. C. O'Connor, J. W. Andzelm, M. O. Robbins, J. Chem. Phys. 142, 024903 (2015)", **WORDS, **OPTIONS))
morse.reads = morse.name
