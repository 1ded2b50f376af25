r"""Pair style dpd whose coefficient is the strength of the noise, sigma, instead of the friction, gamma = sigma^2 / (2 kT).

As in LAMMPS without ``fix shardlow``.  Espanol and Warren, Europhys. Lett. 30, 191 (1995).
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.pair.dpd import UNITS, NoisyPair, repulsion
from asemd.style import register


class BalancedPair(NoisyPair):
    """Friction follows from fluctuation and dissipation."""

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if values["temperature"] == 0.0:
            raise InputError(f"pair_style {self.name}: temperature must not be 0")
        return values

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        kt = (units.boltz if units else 1.0) * settings["temperature"]
        full = {pair: {**c, "gamma": 0.5 * c["sigma"] ** 2 / kt} for pair, c in filled.items()}
        return super().pack_pairs(settings, full, ntypes, units, shift)


register(BalancedPair("dpd/fdt", [(repulsion, "cut")], settings="temperature cut seed", coeff="a0 sigma [cut]",
                      units={**UNITS, "sigma": "force*time^0.5"}, doc=__doc__, settings_example="1.0 2.5 34387", example="25.0 3.0 2.4",
                      see="LAMMPS manual, pair_style dpd/fdt", shifts=False))
