"""Pair styles of hydrogen bonds: energies of donor, acceptor and each hydrogen atom bonded to the donor (DREIDING).

A line of coefficients says which types of hydrogen atoms, which of the two types of the line is the donor, and the numbers of the bond;
lines for the same types add up. The energy is a function of the distance of donor and acceptor times a power of the cosine of the angle
donor-hydrogen-acceptor, switched off between two distances and zero for small angles. Styles with an angle of rest turn that angle by what
the angle of rest lacks to a straight line.
"""
from __future__ import annotations

import copy
import inspect
import math
from collections.abc import Callable

import numpy as np

from asemd import words as read
from asemd.errors import InputError
from asemd.pairstyle import PairStyle, PairTables
from asemd.style import register


class HydrogenBond(PairStyle):
    """A style of hydrogen bonds.

    Parameters
    ----------
    form : callable
        ``form(r2, p)`` gives energy and derivative by r2; its coefficients begin at ``p[7]``.
    names : str
        Words of the coefficients after the donor flag, of which the first is an energy.
    turned : bool
        The best angle is a setting and a coefficient, not a straight line.
    """

    many = True
    restarts = False
    elements = False
    exact = True
    extra = 2                 # numbers for compute pair: bonds, and their energy
    needs_newton = True

    def __init__(self, name: str, form: Callable, names: str, units, turned: bool = False, **options):
        super().__init__(name, [], settings="n inner outer angle" + " rest" * turned,
                         coeff=f"ktype donor {names} [n] [inner] [outer] [angle]" + " [rest]" * turned,
                         units={"n": "integer", "angle": "", "ktype": "word", "donor": "word", **units}, **options)
        self.form, self.names = form, tuple(names.split())
        self.twin = copy.copy(self)
        self.twin.exact = False

    def _checked(self, values, what: str):
        if values["n"] < 0:
            raise InputError(f"{what}: the power n of the cosine must not be negative, got {values['n']}")
        if not 0.0 <= values["inner"] < values["outer"]:
            raise InputError(f"{what}: inner cutoff {values['inner']:g} must be less than outer cutoff {values['outer']:g} and not "
                             "negative")
        if not 0.0 <= values["angle"] <= 180.0:
            raise InputError(f"{what}: angle must be 0 to 180 degrees, got {values['angle']:g}")
        if not 90.0 <= values.get("rest", 180.0) <= 180.0:
            raise InputError(f"{what}: the angle of rest must be 90 to 180 degrees, got {values['rest']:g}")
        return values

    def parse_settings(self, words):
        return self._checked(super().parse_settings(words), f"pair_style {self.name}")

    def parse_coeff(self, words, settings):
        what = f"pair_coeff {self.name}"
        if len(words) == len(self.names) + 4:
            raise InputError(f"{what}: inner and outer cutoffs come together, got only one")
        values = super().parse_coeff(words, settings)
        if values["donor"] not in ("i", "j"):
            raise InputError(f"{what}: the donor flag must be i or j, got {values['donor']!r}")
        self._checked({**settings, **values}, what)
        return {"bonds": (values,)}

    def join(self, old, new):
        return {"bonds": old.get("bonds", ()) + new["bonds"]}

    def format_coeff(self, coeff):
        return super().format_coeff(coeff["bonds"][-1])

    def lines(self, coeffs):
        return [(key, [str(t) for t in key], PairStyle.format_coeff(self, bond)) for key, c in coeffs.items() for bond in c["bonds"]]

    def reset_cutoffs(self, coeffs):
        return {}

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        pairs = set(coeffs) if only is None else only
        return {pair: {"bonds": tuple({**settings, **bond} for bond in coeffs[pair]["bonds"])} for pair in sorted(pairs) if pair in coeffs}

    def reach(self, coeff, settings):
        return max((bond["outer"] for bond in coeff["bonds"]), default=0.0)

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        cut2, kind_of = np.zeros((1, ntypes + 1, ntypes + 1)), np.full((ntypes + 1,) * 3, -1, np.int32)
        params = []
        for (i, j), c in filled.items():
            for b in c["bonds"]:
                lo, hi = read.bounds(b["ktype"], 1, ntypes, f"pair_coeff {self.name}: hydrogen type")
                donor, acceptor = (i, j) if b["donor"] == "i" else (j, i)
                kind_of[donor, acceptor, lo:hi + 1] = len(params)
                turn = math.radians(180.0 - b.get("rest", 180.0))
                params.append([b["inner"] ** 2, b["outer"] ** 2, math.radians(b["angle"]), b["n"], turn, math.cos(turn), math.sin(turn),
                               *(b[n] for n in self.names)])
                cut2[0, i, j] = cut2[0, j, i] = max(cut2[0, i, j], b["outer"] ** 2)
        table = np.array(params) if params else np.zeros((1, 7 + len(self.names)))
        return PairTables(cut2, np.zeros(0), (table, kind_of))

    def check_scene(self, interactions, system):
        if not system.molecular:
            raise InputError(f"pair style {self.name} needs an atom_style with bonds, such as full: the hydrogen atoms are those bonded "
                             "to a donor")
        for use in interactions.uses["pair"]:
            if use.style is self and not use.coeff:
                raise InputError(f"pair style {self.name}: no coefficients are set")


def hydrogen_bond(name: str, names: str, *, units, **options):
    """Register ``form(r2, p)``, which gives energy and derivative by r2, as a style of hydrogen bonds with the coefficients `names`."""
    def decorate(form):
        doc = options.pop("doc", None) or inspect.getdoc(inspect.getmodule(form)) or ""
        register(HydrogenBond(name, form, names, units, doc=doc, **options))
        return form
    return decorate
