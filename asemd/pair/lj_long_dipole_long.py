r"""lj/long/coul/long for charges with point dipoles, whose interactions are those of lj/cut/dipole/long.

The first word says what the attraction -C_6 / r^6 does beyond the cutoff, ``long`` or ``cut`` (``off`` is computed as ``cut``, as in
LAMMPS, and has no solver), the second the same of charges and dipoles,
``long`` or ``off``. Dipoles feel torques. Where dispersion is ``long`` coefficients of unlike types are always mixed ones, and all pairs
have the same cutoff. The solver is ewald/disp or ewald/disp/dipole.
"""
from __future__ import annotations

import inspect
import warnings

from asemd.errors import InputError, InputWarning
from asemd.pair.lj_cut import lj_cut
from asemd.pair.lj_cut_dipole_long import radial
from asemd.pair.lj_long_coul_long import DispersionPair, derived, dispersion, repulsion
from asemd.pairstyle import PairStyle
from asemd.style import register

SOLVERS = frozenset(["ewald/disp", "ewald/disp/dipole"])


class LongDipoles(PairStyle):
    """The parts of the style with charges and dipoles."""

    listed = True
    oriented = "dipole"
    radial = staticmethod(radial)


class Dispersion(PairStyle):
    """The parts of the style without charges and dipoles."""

    takes_tables = False


class DipoleDispersion(DispersionPair):
    def parse_settings(self, words):
        values = super().parse_settings(words)
        if values["dispersion"] == "off" and values["coulomb"] == "long":
            raise InputError(f"pair_style {self.name}: with dispersion off there is no solver for charges and dipoles, in LAMMPS neither; "
                             "write cut long, which is computed in the same way")
        return values

    def form(self, coulomb):
        return Dispersion if coulomb == "off" else LongDipoles

    def needs(self, settings):
        if settings["dispersion"] == "long":
            return SOLVERS
        return SOLVERS | {"ewald/dipole"} if settings["coulomb"] == "long" else frozenset()

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        if settings["dispersion"] == "long":
            coeffs = {(i, i): {k: v for k, v in c.items() if k != "cut_lj"} for (i, j), c in coeffs.items() if i == j}
        return super().filled(coeffs, settings, ntypes, rule, only)

    def check_scene(self, interactions, system):
        if system.q is None or "mu" not in system.extra or "epsilon" in system.extra:
            raise InputError(f"pair style {self.name} needs atoms with charges and dipoles: use atom_style dipole, or hybrid with it")
        for use in interactions.uses["pair"]:
            if use.style is self and use.settings["dispersion"] == "long" and any(i != j for i, j in use.coeff):
                i, j = next(pair for pair in use.coeff if pair[0] != pair[1])
                same = self.filled(use.coeff, use.settings, system.counts["ntypes"], interactions.modified(use, "mix")).get((i, j), {})
                if any(use.coeff[i, j][name] != same.get(name) for name in ("epsilon", "sigma")):
                    warnings.warn(f"pair style {self.name} long mixes coefficients of unlike types: pair_coeff {i} {j} has no effect",
                                  InputWarning, stacklevel=2)


register(DipoleDispersion(
    "lj/long/dipole/long", [lj_cut], [repulsion, dispersion], "cut_lj", coeff="epsilon sigma [cut_lj]", rows="C6", derived=derived,
    mix={"epsilon": "sigma", "sigma": "distance"}, settings_example="long long 10.0", example="0.1 3.0",
    see="LAMMPS manual, pair_style lj/long/dipole/long", doc=inspect.cleandoc(__doc__)))
