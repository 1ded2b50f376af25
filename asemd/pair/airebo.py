r"""Reactive potential of hydrocarbons (AIREBO): bonds with orders, dispersion between molecules, torsions.

$$E=\sum_{i<j}\big[E^{REBO}_{ij}+E^{LJ}_{ij}\big]+\sum_{kijl}E^{TORSION}_{kijl},\quad
E^{REBO}=w(r)\Big[\Big(1+\frac Qr\Big)Ae^{-\alpha r}-b_{ij}\sum_nB_ne^{-\beta_nr}\Big]$$

with the bond order $b_{ij}=\tfrac12(p_{ij}+p_{ji})+\pi^{rc}_{ij}+T_{ij}\sum\sin^2\omega$. The Lennard-Jones energy is switched off by the
strongest way over one to three bonds between two atoms, and at short distances by the order that a bond between them would have. The
cutoff is in units of sigma; it is smooth from ``cutmin`` on, without which the switch goes from 2.16 to 3 sigma whatever the cutoff.
"""
from __future__ import annotations

import numpy as np

from asemd import words as read
from asemd.airebo_file import PAIRS, conjugated_values, lone_values, read_hydrocarbons
from asemd.errors import InputError
from asemd.kernels import bond_order as kernels
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
from asemd.style import register

# columns of the numbers by pair of elements that the kernel knows by their place
COLUMNS = ["rcmin", "rcmax", "rcmaxp", "Q", "alpha", "A", "BIJc1", "BIJc2", "BIJc3", "Beta1", "Beta2", "Beta3", "rho", "rcLJmin", "rcLJmax",
           "bLJmin", "bLJmax", "inner", "outer", "e1", "e2", "e3", "e4", "epsilonT", "reach"]
SWITCH = 2.16, 3.0      # where dispersion ends, in units of sigma


class AIREBO(ManyBody):
    """Numbers by pair of elements from a file of carbon and hydrogen."""

    usual, ghost_list = "3.0", True
    extra = 3                 # for compute pair: energies of bonds, dispersion and torsion
    title, morse, lone = "AIREBO", False, "airebo"
    kernel_constants, whole = kernels.NAMED, True

    def parse_settings(self, words):
        what = f"pair_style {self.name}"
        if len(words) not in (1, 3, 4):
            raise InputError(f"{what} needs cutoff or cutoff LJ_flag TORSION_flag [cutmin], got {len(words)} words")
        values = {"cutoff": read.number(words[0], f"{what}: cutoff"), "LJ_flag": 1, "TORSION_flag": 1}
        for name, word in zip(("LJ_flag", "TORSION_flag"), words[1:]):
            values[name] = read.whole(word, f"{what}: {name}")
        if len(words) == 4:
            values["cutmin"] = read.number(words[3], f"{what}: cutmin")
        if "cutmin" in values and not 0.0 < values["cutmin"] < values["cutoff"]:
            raise InputError(f"{what}: cutmin, {values['cutmin']:g}, must be positive and less than the cutoff, {values['cutoff']:g}")
        return values

    def format_settings(self, settings):
        return [repr(settings["cutoff"]), str(settings["LJ_flag"]), str(settings["TORSION_flag"]),
                *([repr(settings["cutmin"])] if "cutmin" in settings else [])]

    def read(self, file, elements, settings):
        if wrong := set(elements) - {"C", "H"}:
            raise InputError(f"{file.what}: elements must be C, H or NULL, got {min(wrong)}")
        return read_hydrocarbons(file, self.morse, self.title)

    def attraction(self, p, pair: str, unit: float) -> tuple[float, ...]:
        """Coefficients of the dispersion energy: those of r^-12 and r^-6."""
        epsilon, s6 = p[f"epsilon_{pair}"] * unit, p[f"sigma_{pair}"] ** 6
        return 4.0 * epsilon * s6 * s6, 4.0 * epsilon * s6

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        c = next(iter(filled.values()))
        data, unit = c["data"], self.unit_factor(c, units)
        p, element = data.numbers, element_of(filled, ntypes)
        switch = (settings["cutmin"], settings["cutoff"]) if "cutmin" in settings else SWITCH
        table = np.zeros((2, 2, len(COLUMNS)))
        for k, pair in enumerate(PAIRS):
            row = {name: p.get(f"{name}_{pair}", p.get(f"{name[:-1]}_{pair}{name[-1]}", 0.0)) for name in COLUMNS}
            row |= {name: unit * row[name] for name in ("A", "BIJc1", "BIJc2", "BIJc3")}
            row |= {name: value * p[f"sigma_{pair}"] for name, value in zip(("inner", "outer", "reach"), (*switch, settings["cutoff"]))}
            row |= zip(("e1", "e2", "e3", "e4"), self.attraction(p, pair, unit))
            row["epsilonT"] = unit * p["epsilonT_" + ("CCCC", "CCCH", "HCCH")[k]]
            for i, j in {(int(k == 2), int(k > 0)), (int(k > 0), int(k == 2))}:
                table[i, j] = [row[name] for name in COLUMNS]
        number = np.array([-1 if e is None else "CH".index(e) for e in element])
        rows, dispersion = np.zeros((1, ntypes + 1, ntypes + 1)), float(settings["LJ_flag"] != 0)
        for i, j in filled:
            one = table[number[i], number[j]]
            rows[0, i, j] = rows[0, j, i] = max(one[1], dispersion * one[24]) ** 2
        limits = np.array([p[name] for name in ("Nmin", "Nmax", "NCmin", "NCmax")])
        arrays = (number, table, data.carbon_ends, data.many, data.few, data.hydrogen_ends, data.hydrogen, lone_values(self.lone),
                  conjugated_values(), limits)
        return PairTables(rows, np.array([dispersion, float(settings["TORSION_flag"] != 0)]), arrays)


OPTIONS = dict(forces=kernels.bond_order_forces, shares=kernels.ROWS, rooms=13, converts=False,
               domain="atoms coincide, or have more than 24 neighbours as near as a bond")
WORDS = dict(settings="cutoff [LJ_flag] [TORSION_flag] [cutmin]", settings_example="3.0",
             units={"cutoff": "", "LJ_flag": "integer", "TORSION_flag": "integer", "cutmin": ""})
register(AIREBO("airebo", helpers=kernels.HELPERS, example="CH.airebo C", doc=__doc__,
                see="S. J. Stuart, A. B. Tutein, J. A. Harrison, J. Chem. Phys. 112, 6472 (2000)", **WORDS, **OPTIONS))
