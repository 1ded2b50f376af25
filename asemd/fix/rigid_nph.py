r"""Rigid bodies at constant enthalpy: a Nose-Hoover barostat with a chain of its own.

With the logarithms :math:`\epsilon_a` of the box lengths, f degrees of freedom of the bodies, the pressure tensor P of all atoms and
a chain :math:`\eta` with masses :math:`d^2 k_B T \tau^2, k_B T \tau^2 \dots`,

.. math:: W_a \ddot\epsilon_a = V (P_{aa} - P_0) + \frac{1}{f} \sum (M v^2 + L \cdot \omega) - W_a \dot\epsilon_a \dot\eta_1,
          \qquad W_a = (f + d) k_B T \tau_a^2

Atoms, of bodies too, keep their fractional places (those of the group of ``dilate``) while the box moves, in two halves before and after
the bodies put their atoms in place.

Source: H. Kamberaj, R.-J. Low, M. P. Neal, J. Chem. Phys. 122, 224114 (2005); LAMMPS manual, fix rigid/nph. Output: as fix rigid/nvt.
"""
from __future__ import annotations

from asemd.fix.rigid_nvt import RigidNVT


class RigidNPH(RigidNVT):
    """Rigid bodies with a barostat; see `asemd.fix.rigid_nvt.RigidNVT` for the arguments."""

    style = "rigid/nph"
    thermostats = False
    barostats = True
    brings = ("temp", "press")
