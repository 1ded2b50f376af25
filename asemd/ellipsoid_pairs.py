"""Pair styles of ellipsoids: coefficients with relative well depths by type of atoms, and what their kernel needs of the shapes."""
from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from asemd.errors import InputError
from asemd.pair.lj_cut import lj_cut
from asemd.pairstyle import PairStyle

WELLS = (("eia", "eib", "eic"), ("eja", "ejb", "ejc"))
COEFF = "epsilon sigma eia eib eic eja ejb ejc [cut]"


class OrientedPair(PairStyle):
    """A pair style of bodies with orientations; `potential` is the function that `asemd.kernels.pair_ellipsoid` asks for."""

    listed = True
    oriented = "ellipsoid"
    exact = True
    shaped = True        # more of a body matters than its first axis

    def __init__(self, name: str, potential, **options):
        super().__init__(name, [(lj_cut, "cut")], **{**dict(see=f"LAMMPS manual, pair_style {name}"), **options})
        self.potential = potential
        self.twin = copy.copy(self)
        self.twin.exact = False


class EllipsoidPair(OrientedPair, ABC):
    """A pair style of ellipsoids. The constants of its potential are the settings and whether torques are those of the energy.

    Relative well depths are given with pairs of types, but belong to one type each: those that are not all zero, of the last line that
    speaks of the type.
    """

    def __init__(self, name: str, potential, **options):
        super().__init__(name, potential, **{**dict(coeff=COEFF, units={k: "" for well in WELLS for k in well},
                         mix={"epsilon": "sigma", "sigma": "distance"}), **options})

    def check(self, coeff, settings):
        for names in WELLS:
            given = [coeff[n] for n in names]
            if any(given) and min(given) <= 0.0:
                raise InputError(f"pair_coeff {self.name}: {' '.join(names)} must all be positive, or all 0 where another line gives them, "
                                 f"got {' '.join(f'{v:g}' for v in given)}")

    def learn(self, settings, system):
        """The diameters of each type of atoms.

        Raises
        ------
        InputError
            The atoms have none, or those of one type have several.
        """
        if "shape" not in system.extra:
            raise InputError(f"pair style {self.name} needs ellipsoids: use atom_style ellipsoid, or hybrid with it")
        shape, shapes = system.extra["shape"], np.zeros((system.counts["ntypes"] + 1, 3))
        shapes[system.type] = shape
        other = (shapes[system.type] != shape).any(axis=1)
        if other.any():
            row = int(np.argmax(other))
            raise InputError(f"pair style {self.name}: atoms of one type must have one shape; those of type {system.type[row]} have "
                             "several, such as atom {}".format(system.id[row]))
        settings["shapes"] = tuple(map(tuple, shapes.tolist()))

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        out, wells = super().filled(coeffs, settings, ntypes, rule, only), {}
        for pair, c in coeffs.items():
            for t, names in zip(pair, WELLS):
                if any(c[n] for n in names):
                    wells[t] = [c[n] for n in names]
        for pair, c in out.items():
            for t, names in zip(pair, WELLS):
                if t not in wells:
                    raise InputError(f"pair style {self.name}: relative well depths of atom type {t} are not set: give eia eib eic in "
                                     f"pair_coeff {t} {t}")
                c |= dict(zip(names, wells[t]))
        return out

    @staticmethod
    def shapes(settings: Mapping, ntypes: int) -> np.ndarray:
        """(ntypes + 1, 3) diameters of each type; points before `learn`."""
        return np.array(settings.get("shapes", ((0.0, 0.0, 0.0),) * (ntypes + 1)))

    @abstractmethod
    def bodies(self, settings: Mapping, wells: Mapping[int, list[float]], ntypes: int) -> np.ndarray:
        """(ntypes + 1, 9) what the kernel takes of each type: squared semi-axes, tensor of well depths, semi-axes."""

    @abstractmethod
    def form(self, i: int, j: int, bodies: np.ndarray, settings: Mapping) -> float:
        """What a pair of types is: 0 for two spheres, others are for `potential`."""

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, shift)
        wells = {t: [c[n] for n in names] for pair, c in filled.items() for t, names in zip(pair, WELLS)}
        bodies, form = self.bodies(settings, wells, ntypes), np.zeros((1, ntypes + 1, ntypes + 1))
        for i, j in filled:
            form[0, i, j], form[0, j, i] = self.form(i, j, bodies, settings), self.form(j, i, bodies, settings)
        return replace(tables, rows=np.concatenate([tables.rows, form]), arrays=(bodies,),
                       constants=np.array([*(float(settings[p.name]) for p in self.settings), float(self.exact)]))
