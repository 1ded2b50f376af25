"""Multilevel summation of the Coulomb interaction (D. J. Hardy, thesis, University of Illinois, 2006): what pair styles must know of it.

With ``kspace_modify compute no`` the pair styles coul/msm give their part of the energy; the sums over grids are not there.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.kspace import KSpace


class MSM(KSpace):
    """``kspace_style msm accuracy``."""

    style = flag = "msm"
    partner = "lj/cut/coul/msm"

    def check(self, system):
        name = f"kspace_style {self.style}"
        if system.dimension == 2:
            raise InputError(f"{name} needs three dimensions, this scene has two")
        if system.q is None:
            raise InputError(f"{name} needs atom attribute q: use atom_style charge or full")
        if self.slab is not None:
            raise InputError(f"{name} does not take kspace_modify slab: it works with any boundary")
        if self.modify["compute"]:
            raise InputError(f"{name}: sums over grids are not supported, only the part of pair styles with kspace_modify compute no; "
                             "use pppm and a pair style with coul/long")
        if self.modify["cutoff/adjust"]:
            raise InputError(f"{name} does not choose the cutoff of pair styles: add kspace_modify cutoff/adjust no")

    def first_guess(self):
        return 0.0

    def choose(self, system):
        if abs(self.qsum) > 1e-5:
            raise InputError(f"kspace_style {self.style}: charges must add up to 0, here they add up to {self.qsum:g}")
        order = self.modify["order"] or 10
        if order not in (4, 6, 8, 10):
            raise InputError(f"kspace_style {self.style}: order must be 4, 6, 8 or 10, not {order}")
        # the Taylor polynomial of 1/sqrt(u) around 1 in powers of u
        degree = order // 2
        taylor = [math.prod(-0.5 - m for m in range(k)) / math.factorial(k) for k in range(degree + 1)]
        self.smooth = [sum(taylor[k] * math.comb(k, n) * (-1.0) ** (k - n) for k in range(n, degree + 1)) for n in range(6)]

    def terms(self, engine):
        return []       # `check` lets nobody ask for the sums over grids

    @property
    def constants(self):
        return {f"smooth{n}": c / self.cutoff ** (2 * n + 1) for n, c in enumerate(self.smooth)}
