r"""pppm with the mean of two meshes half a spacing apart: for the same accuracy both are coarser, up to half as many points.

The influence function is the best one for both meshes together. U. Neelov, C. Holm, J. Chem. Phys. 132, 234103 (2010); D. S. Cerutti,
R. E. Duke, T. A. Darden, T. P. Lybrand, J. Chem. Theory Comput. 5, 2322 (2009).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.kernels import pppm, pppm_stagger
from asemd.kspace.pppm import PPPM, PPPMTerm, aliases


def alternating(order: int) -> np.ndarray:
    """Coefficients of the sum over images of the squared transform of the weights with alternate signs, in even powers of the cosine,
    without a factor of it: derivatives of the cosecant."""
    p = np.polynomial.Polynomial([1.0])
    c = np.polynomial.Polynomial([0.0, 1.0])
    for n in range(2 * order - 1):      # the n-th derivative is p(cos) / sin^(n+1)
        p = -p.deriv() * (1.0 - c * c) - (n + 1.0) * c * p
    out = np.zeros(order)
    odd = -p.coef[1::2] / math.factorial(2 * order - 1)
    out[:len(odd)] = odd
    return out


def weights(order: int) -> np.ndarray:
    """Coefficients for `asemd.kernels.pppm_stagger.denominator`."""
    return np.concatenate([aliases(order), alternating(order)])


class PPPMStagger(PPPM):
    """``kspace_style pppm/stagger accuracy``."""

    style = "pppm/stagger"
    groups = False
    largest_shift = 0.5

    def check(self, system):
        super().check(system)
        if self._tilted(system):
            raise InputError(f"kspace_style {self.style} needs a box that is not triclinic")

    def fine_enough(self):
        return self.fine_enough_ad()

    @property
    def mesh_error(self):
        quality = pppm_stagger.quality_of(self.order, self.ad)(np.array(self.mesh), self.prd, self.g_ewald, weights(self.order))
        return math.sqrt(max(quality, 0.0) / self.n) * self.q2 / self.volume

    def lines(self):
        return ["PPPMStagger initialization ...", *super().lines()[1:]]

    def terms(self, engine):
        return [StaggeredTerm(self, shift) for shift in (0.0, 0.5)]


class StaggeredTerm(PPPMTerm):
    """One of the two meshes, with half of the energy."""

    def __init__(self, solver, shift: float):
        super().__init__(solver)
        self.constants = np.append(self.constants, shift)
        self.set_factor(solver.factor)

    def make_kernel(self, level):
        if level == 2 and not self.shares.size:
            self._make_shares()
        return pppm.kernel(level, self.order, self.solver.ad, True)

    def set_factor(self, factor):
        super().set_factor(0.5 * factor)

    def prepare(self, engine):
        super().prepare(engine)
        self.aliases = weights(self.order)
