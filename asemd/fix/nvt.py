r"""Constant temperature: a Nose-Hoover chain coupled to velocity Verlet.

.. math:: \dot v = \frac{F}{m} - v\,\dot\eta_1, \qquad
          Q_1 \ddot\eta_1 = \sum_i m_i v_i^2 - f k_B T_0 - Q_1 \dot\eta_1 \dot\eta_2, \qquad
          Q_k \ddot\eta_k = Q_{k-1} \dot\eta_{k-1}^2 - k_B T_0 - Q_k \dot\eta_k \dot\eta_{k+1}

with :math:`Q_1 = f k_B T_0 \tau^2` and :math:`Q_k = k_B T_0 \tau^2`, f degrees of freedom and the damping time :math:`\tau`. A half step of
the chain comes before and after the Verlet step; it scales all velocities of the group by :math:`e^{-\dot\eta_1 \Delta t / 2}`. Conserved:
kinetic plus potential energy plus

.. math:: f k_B T_0 \eta_1 + k_B T_0 \sum_{k>1} \eta_k + \tfrac12 \sum_k Q_k \dot\eta_k^2

which is the scalar of this fix (thermo keywords ecouple, econserve). With ``tloop M`` the chain takes M sub-steps; ``drag D`` multiplies
its velocities by :math:`1 - D \Delta t / (\tau M)`. The chain goes on from one run to the next.

Source: G. J. Martyna, M. L. Klein, M. Tuckerman, J. Chem. Phys. 97, 2635 (1992); M. E. Tuckerman et al., J. Phys. A 39, 5629 (2006);
LAMMPS manual, fix nvt. Units: temperature, time.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.nose_hoover import NoseHoover, nose_hoover_chain
from asemd.fix.nve import NVE
from asemd.kernels.threads import barrier, reduce_sum


class NVT(NoseHoover):
    """Time integration at constant temperature.

    Parameters
    ----------
    group : str
        The atoms it moves.
    temperature : float or (float, float)
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time, in time units of the scene; about 100 timesteps is usual.
    chain : int
        Length of the chain.
    loops : int
        Sub-steps of the chain.
    drag : float
        Damps oscillations of the chain; 0 is the true ensemble.

    Raises
    ------
    InputError
        A temperature or damping time that is not positive, a chain or loop count below 1, a negative drag.

    Examples
    --------
    >>> NVT(temperature=(300.0, 350.0), damping=100.0)
    """

    style = "nvt"
    inner = NVE

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, chain: int = 3, loops: int = 1, drag: float = 0.0):
        super().__init__(group, temperature, damping, chain, loops, drag)

    @classmethod
    def from_lammps(cls, group, words, session):
        given = cls.read(words, session)
        if given["components"]:
            keyword = given.get("shape") or given["single"][0]
            raise InputError(f"fix {cls.style}: {keyword} controls the pressure, which fix {cls.style} does not; use fix npt")
        if "temperature" not in given:
            raise InputError(f"fix {cls.style} needs temp Tstart Tstop Tdamp")
        return cls(group, **{k: given[k] for k in ("temperature", "damping", "chain", "loops", "drag", "dipole", "disc") if k in given})

    @hook(uses=[nose_hoover_chain])
    def initial_integrate(th, s, p, a):
        barrier(th)             # others may still read the factor of the last step
        if th.tid == 0:
            nose_hoover_chain(th, p)
        barrier(th)
        bit, factor, half, mine = np.int32(np.int64(p[0])), p[12], 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            x, v, f = s.x[d, mine], s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] = v[i] * factor + half * inverse_mass[i] * f[i]
                    x[i] += th.dt * v[i]

    @hook(uses=[nose_hoover_chain])
    def outer_initial(th, s, p, a):
        barrier(th)             # others may still read the factor of the last step
        if th.tid == 0:
            nose_hoover_chain(th, p)
        barrier(th)
        bit, factor, half, mine = np.int32(np.int64(p[0])), p[12], 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            v, f = s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] = v[i] * factor + half * inverse_mass[i] * f[i]

    @hook(uses=[nose_hoover_chain])
    def final_integrate(th, s, p, a):
        bit, seen, half, mine = np.int32(np.int64(p[0])), np.int32(np.int64(p[1])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, mass, inverse_mass = s.mask[mine], s.mass[mine], s.inverse_mass[mine]
        twice = 0.0
        for d in range(3):
            v, f = s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                v[i] += half * inverse_mass[i] * f[i] if mask[i] & bit != 0 else 0.0
                twice += mass[i] * v[i] * v[i] if mask[i] & seen != 0 else 0.0
        twice = reduce_sum(th, twice)
        if th.tid == 0:
            p[11] = p[4] * twice / (p[2] * p[3]) if p[2] > 0.0 else 0.0
            nose_hoover_chain(th, p)
        barrier(th)
        factor = p[12]
        for d in range(3):
            v = s.v[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] *= factor
