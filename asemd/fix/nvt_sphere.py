r"""Constant temperature for spheres that turn: a Nose-Hoover chain for positions and angular velocities.

.. math:: \dot\omega = \frac{T}{I} - \omega\,\dot\eta_1, \qquad
          Q_1 \ddot\eta_1 = \sum_i m_i v_i^2 + \sum_i I_i \omega_i^2 - f k_B T_0 - Q_1 \dot\eta_1 \dot\eta_2

with the other equations of `asemd.fix.nvt`. The temperature is that of translation and rotation (compute temp/sphere) unless
``fix_modify ID temp`` names another. ``disc`` and ``update dipole`` as in `asemd.fix.nve_sphere`.

Source: G. J. Martyna, M. L. Klein, M. Tuckerman, J. Chem. Phys. 97, 2635 (1992); LAMMPS manual, fix nvt/sphere. Units: temperature, time.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp_sphere import TempSphere
from asemd.fix import hook
from asemd.fix.nose_hoover import nose_hoover_chain
from asemd.fix.npt import kick_group
from asemd.fix.nve_sphere import NVESphere
from asemd.fix.nvt import NVT
from asemd.fix.sphere_bath import SphereBath
from asemd.fix.spheres import TURNS, kick_spins, move_spheres, scale_spins, spins_tensor, turn_along
from asemd.kernels.threads import barrier


class NVTSphere(SphereBath, NVT):
    """Time integration of spheres at constant temperature.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a radius.
    temperature, damping, chain, loops, drag
        As those of `asemd.fix.nvt.NVT`.
    dipole : str
        ``dipole`` or ``dipole/dlm``: dipoles turn along; empty: they stay.
    disc : bool
        Discs in two dimensions: another moment of inertia.

    Raises
    ------
    InputError
        As `asemd.fix.nvt.NVT`; an unknown way of turning dipoles.

    Examples
    --------
    >>> NVTSphere(temperature=1.0, damping=0.5, dipole="dipole")
    """

    style = "nvt/sphere"
    inner = NVESphere

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, chain: int = 3, loops: int = 1, drag: float = 0.0,
                 dipole: str = "", disc: bool = False):
        super().__init__(group, temperature, damping, chain, loops, drag)
        self.set_turning(dipole, disc)
        self.temp = TempSphere(group)

    @hook(uses=[*TURNS, nose_hoover_chain, kick_group, move_spheres])
    def initial_integrate(th, s, p, a):
        barrier(th)             # others may still read the factor of the last step
        if th.tid == 0:
            nose_hoover_chain(th, p)
        barrier(th)
        bit, factor, omega = np.int32(np.int64(p[0])), p[12], a[0]
        kick_group(th, s, bit, factor)
        kick_spins(th, s, bit, factor, omega, a[1], a[3])
        move_spheres(th, s, bit)
        turn_along(th, s, bit, omega, a[1], a[2], a[3])

    @hook(uses=[*TURNS, nose_hoover_chain, kick_group])
    def outer_initial(th, s, p, a):
        barrier(th)             # others may still read the factor of the last step
        if th.tid == 0:
            nose_hoover_chain(th, p)
        barrier(th)
        bit, factor = np.int32(np.int64(p[0])), p[12]
        kick_group(th, s, bit, factor)
        kick_spins(th, s, bit, factor, a[0], a[1], a[3])

    @hook(uses=[*TURNS, nose_hoover_chain, kick_group, scale_spins, spins_tensor])
    def final_integrate(th, s, p, a):
        bit, seen, twice = np.int32(np.int64(p[0])), np.int32(np.int64(p[1])), np.zeros(3)
        omega, radius, mu, o = a
        kick_group(th, s, bit, 1.0)
        kick_spins(th, s, bit, 1.0, omega, radius, o)
        spins_tensor(th, s, seen, 3, p[4], omega, radius, mu, o[3], o[4], twice)
        if th.tid == 0:
            p[11] = (twice[0] + twice[1] + twice[2]) / (p[2] * p[3]) if p[2] > 0.0 else 0.0
            nose_hoover_chain(th, p)
        barrier(th)
        scale_spins(th, s, bit, p[12], omega)
