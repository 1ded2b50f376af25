r"""Lennard-Jones switched off between inner and outer, as in lj/charmm/coul/charmm, and coul/long up to cut_coul, for a long-range solver.

epsilon14 and sigma14 (default: epsilon, sigma) are used, without switch, by dihedral_style charmm for the ends of a dihedral.
MacKerell et al., J. Phys. Chem. B 102, 3586 (1998).
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.pair.coul_long import coul_long
from asemd.pair.lj_charmm_coul_charmm import OPTIONS as CHARMM
from asemd.pair.lj_charmm_coul_charmm import CharmmPair, lj_charmm
from asemd.pairstyle import PairStyle, pair_sum


class CharmmLongPair(CharmmPair):
    """Its Coulomb part has one cutoff."""

    def parse_settings(self, words):
        values = PairStyle.parse_settings(self, words)
        if not 0.0 <= values["inner"] < values["outer"]:
            raise InputError(f"pair_style {self.name}: inner = {values['inner']:g} must be less than outer = {values['outer']:g} and not "
                             "negative")
        return values

    def constants(self, settings):
        lo, hi = settings["inner"], settings["outer"]
        return {**settings, "inner2": lo * lo, "outer2": hi * hi, "scale": 1.0 / ((hi - lo) * (hi + lo)) ** 3}


OPTIONS = CHARMM | dict(
    cls=CharmmLongPair, settings="inner outer [cut_coul]", defaults=CHARMM["defaults"] | {"cut_coul": "outer"},
    settings_example="8.0 10.0 9.0", see="LAMMPS manual, pair_style lj/charmm/coul/long")
pair_sum("lj/charmm/coul/long", (lj_charmm, "outer"), (coul_long, "cut_coul"), splits=True, **OPTIONS)
