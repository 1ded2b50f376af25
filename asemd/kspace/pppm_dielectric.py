r"""pppm for charges of which each stands in a medium of its own, with the dielectric constant that the atom has.

$$ \vec F_i = \epsilon_i \tilde q_i \vec E(\vec x_i), \qquad \tilde q = q / \epsilon, \qquad E = \frac{1}{\langle \epsilon \rangle} E_q $$

The field is that of the scaled charges on the mesh. As in LAMMPS the energy is that of the charges themselves in a medium with the mean of
all constants. The virial is that of the forces.
T. D. Nguyen, H. Li, D. Bagchi, F. J. Solis, M. Olvera de la Cruz, Comput. Phys. Commun. 241, 80 (2019).
"""
from __future__ import annotations

import numpy as np

from asemd.kspace.dielectric import Dielectric, DielectricTerm
from asemd.kspace.pppm import PPPM, PPPMTerm


class PPPMDielectric(Dielectric, PPPM):
    """``kspace_style pppm/dielectric accuracy``."""

    style = flag = "pppm/dielectric"

    def charge_squares(self, system, q):
        return float(np.sum(q * q / system.extra["epsilon"]))

    def terms(self, engine):
        return [PPPMDielectricTerm(self)]


class PPPMDielectricTerm(DielectricTerm, PPPMTerm):
    """The mesh, for three sets of charges."""
