r"""Constant temperature and pressure: Nose-Hoover chains coupled to the atoms and to the box.

.. math:: \dot r_i = v_i + \dot\omega\, r_i, \qquad
          \dot v_i = \frac{F_i}{m_i} - \Bigl(\dot\omega + \frac{\operatorname{tr} \dot\omega}{N d} + \dot\eta_1\Bigr) v_i

with the box and its rates :math:`\dot\omega` as in `asemd.fix.barostat` and the chain of `asemd.fix.nvt`; a second chain thermostats the
rates. Each of the six components of the pressure may have a target of its own; lengths whose pressure is coupled change together. Atoms
are dilated with the box about a fixed point. A box that was tilted too far is flipped to an equal one when the neighbour list is built.
Conserved: kinetic plus potential energy plus the scalar of this fix,

.. math:: E_{chain} + \tfrac12 \sum_i W_i \dot\omega_i^2 + P_0 (V - V_0) + \tfrac12 \operatorname{tr}(\sigma h h^T)
          + f_W k_B T_0 \eta'_1 + k_B T_0 \sum_{k>1} \eta'_k + \tfrac12 \sum_k Q'_k \dot\eta_k'^2

with :math:`f_W` the number of controlled components. That is LAMMPS's sum; in a box that changes isotropically the force on the second
chain has :math:`f_W = 1`, as LAMMPS's has, so that there the sum wanders with :math:`\eta'_1` (not with ``pchain 0``). The vector is
LAMMPS's: chain, box, chain of the box, and their energies.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); M. E. Tuckerman et al., J. Phys. A 39, 5629 (2006);
W. Shinoda, M. Shiga, M. Mikami, Phys. Rev. B 69, 134103 (2004); LAMMPS manual, fix npt. Units: temperature, time, pressure.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.barostat import (
    barostat_chain,
    box_volume,
    dilate_box,
    drag_velocities,
    hold_box,
    kinetic_tensor,
    measure_pressure,
    push_box,
    shear_box,
    take_along,
    target_pressure,
)
from asemd.fix.nose_hoover import nose_hoover_chain
from asemd.fix.nose_hoover_box import NoseHooverBox
from asemd.fix.nve import NVE
from asemd.kernels.box import follow
from asemd.kernels.threads import barrier


def begin_box_step(th, s, p, a):
    """Both chains and the box's rates before the atoms move; returns the factor by which velocities are still to be scaled."""
    q, b, e, w, m = a
    barrier(th)                 # others may still read the factor of the last step
    if th.tid == 0:
        if q[11] > 0.0:
            barostat_chain(th, q, b, e, p[3] * p[13])
        p[12] = 1.0
        if q[28] != 0.0:
            nose_hoover_chain(th, p)
    barrier(th)
    return push_thermal_box(th, s, p, a)


def push_thermal_box(th, s, p, a):
    """The box's rates after the thermostat has acted; returns the factor by which velocities are still to be scaled."""
    q, b, e, w, m = a
    factor = p[12]
    if q[27] != 0.0:            # others may have changed velocities since the last step
        bit, mine = np.int32(np.int64(p[0])), slice(th.lo, th.hi)
        mask = s.mask[mine]
        for d in range(3):
            v = s.v[d, mine]
            for i in range(v.size):
                v[i] *= factor if mask[i] & bit != 0 else 1.0
        measure_kinetics(th, s, p, q, b, True)
        factor = 1.0
    elif th.tid == 0:
        for k in range(6):
            b[9, k] *= factor * factor
            b[10, k] *= factor * factor
    if th.tid == 0:
        measure_pressure(s, q, b, w)
        target_pressure(th, s, q, b, m)
        push_box(th, s, p, q, b, m)
    return factor


def measure_kinetics(th, s, p, q, b, begins):
    """Kinetic tensors now; that of a temperature which is the pressure's alone is measured where a step begins, as in LAMMPS."""
    terms = 3 if q[0] < 3.0 else 6
    kinetic_tensor(th, s, np.int32(np.int64(p[1])), terms, p[4], b[9])
    if q[33] != 0.0 and begins:
        kinetic_tensor(th, s, np.int32(np.int64(q[25])), terms, p[4], b[10])
    elif q[33] == 0.0 and th.tid == 0:
        b[10, :] = b[9, :]


def step_box(th, s, q, b, m):
    """Both halves of the box's step; atoms are taken along by what is left in ``b`` and ``m``."""
    if th.tid == 0:
        dilate_box(th, s, q, b, m, 0)
        dilate_box(th, s, q, b, m, 1)
        follow(s.box)
    barrier(th)


def kick_group(th, s, bit, factor):
    """Half a step of the forces."""
    half, mine = 0.5 * th.dt, slice(th.lo, th.hi)
    mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
    for d in range(3):
        v, f = s.v[d, mine], s.f[d, mine]
        for i in range(v.size):
            if mask[i] & bit != 0:
                v[i] = v[i] * factor + half * inverse_mass[i] * f[i]


def move_in_box(th, s, bit, q, b, m):
    """The positions, and half of the dilation before and after."""
    dilated, shear, mine = np.int32(np.int64(q[21])), q[31] != 0.0, slice(th.lo, th.hi)
    mask = s.mask[mine]
    if shear:
        take_along(th, s, dilated, b[11], m[2], b[12], True)
    for d in range(3):
        x, v = s.x[d, mine], s.v[d, mine]
        if shear:
            for i in range(x.size):
                x[i] += th.dt * v[i] if mask[i] & bit != 0 else 0.0
            continue
        before, first, between, second, after = b[11, d], m[2, d, d], b[12, d], m[3, d, d], b[13, d]
        for i in range(x.size):        # empty slots, in no group, stay: lists are built when a slot has moved far enough
            y = between + first * (x[i] - before) if mask[i] & dilated != 0 else x[i]
            y += th.dt * v[i] if mask[i] & bit != 0 else 0.0
            x[i] = after + second * (y - between) if mask[i] & dilated != 0 else y
    if shear:
        take_along(th, s, dilated, b[12], m[3], b[13], True)


def drag_and_kick(th, s, bit, q, b, factor):
    """The thermostat's factor, the friction by the box, and half a step of the forces, where the box is not sheared."""
    half, mine = 0.5 * th.dt, slice(th.lo, th.hi)
    mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
    for d in range(3):
        v, f = s.v[d, mine], s.f[d, mine]
        scale = factor * b[14, d] * b[14, d]
        for i in range(v.size):
            if mask[i] & bit != 0:
                v[i] = v[i] * scale + half * inverse_mass[i] * f[i]


def kick_in_box(th, s, p, a, factor):
    """The velocities, after the box's rates: the thermostat's factor, the friction by the box, half a step of the forces."""
    q, b, bit = a[0], a[1], np.int32(np.int64(p[0]))
    barrier(th)
    if q[0] == 3.0:
        mine = slice(th.lo, th.hi)
        mask = s.mask[mine]
        for d in range(3):
            v = s.v[d, mine]
            for i in range(v.size):
                v[i] *= factor if mask[i] & bit != 0 else 1.0
        drag_velocities(th, s, bit, b, True)
        kick_group(th, s, bit, 1.0)
    else:
        drag_and_kick(th, s, bit, q, b, factor)


BOX = [follow, kinetic_tensor, box_volume, hold_box, measure_pressure, target_pressure, push_box, barostat_chain, shear_box, dilate_box,
       take_along, drag_velocities, nose_hoover_chain, measure_kinetics, begin_box_step, push_thermal_box, step_box, kick_group,
       move_in_box, drag_and_kick, kick_in_box]


def start_box_step(th, s, p, a):
    """Velocities of the first half of a step."""
    kick_in_box(th, s, p, a, begin_box_step(th, s, p, a))


class InnerLevel:
    """What moves atoms and box on the innermost level of several."""

    final_integrate = staticmethod(NVE.final_integrate)

    @hook(uses=BOX)
    def initial_integrate(th, s, p, a):
        q, b, e, w, m = a
        bit = np.int32(np.int64(p[0]))
        kick_group(th, s, bit, 1.0)
        barrier(th)
        step_box(th, s, q, b, m)
        move_in_box(th, s, bit, q, b, m)


class NPT(NoseHooverBox):
    """Time integration at constant temperature and pressure.

    Parameters
    ----------
    group : str
        The atoms it moves; temperature and pressure are those of all atoms.
    temperature : float or (float, float)
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time of the temperature, in time units of the scene; about 100 timesteps is usual.
    pressure : float or (float, float)
        Target, or target at the start and at the end of a run, in pressure units of the scene.
    pressure_damping : float
        Relaxation time of the pressure, in time units of the scene; about 1000 timesteps is usual.
    shape : str
        ``iso``: all lengths change together; ``aniso``: each by itself; ``tri``: tilts too; ``none``: only `components`.
    components : mapping, optional
        Of x y z yz xz xy -> (start, stop, damping) in place of what `shape` says.
    couple : str
        ``none xyz xy yz xz``: lengths that change together, with the mean of their pressures.
    chain, loops, pressure_chain, pressure_loops : int
        Length of the chains (`pressure_chain` may be 0) and their sub-steps.
    drag : float
        Damps oscillations; 0 is the true ensemble.
    mtk : bool
        With the terms of Martyna, Tobias and Klein.
    nreset : int
        The box from which strain is counted is renewed every so many steps; 0: never.
    flip : bool
        A box that was tilted far becomes an equal one that is not.
    dilate : str
        The group of atoms that are taken along by the box.
    fixed_point : (3,) array, optional
        The point that stays where it is, distance units; by default the centre of the box.
    scalexy, scaleyz, scalexz : bool, optional
        Whether tilts are scaled with the lengths; by default those that are not zero and not controlled are.
    ptemp : float, optional
        Sets the masses of the box where there is no thermostat; by default the temperature at the start.

    Raises
    ------
    InputError
        A value out of its range; a direction that is not periodic, or a box that is not triclinic but would have to be; coupled lengths
        with different targets.

    Examples
    --------
    >>> NPT(temperature=300.0, damping=100.0, pressure=1.0, pressure_damping=1000.0)
    >>> NPT(shape="none", components={"z": (0.0, 0.0, 1000.0)})
    """

    style = "npt"
    inner = InnerLevel

    @hook(uses=[*BOX, start_box_step])
    def initial_integrate(th, s, p, a):
        q, b, e, w, m = a
        start_box_step(th, s, p, a)
        barrier(th)
        step_box(th, s, q, b, m)
        move_in_box(th, s, np.int32(np.int64(p[0])), q, b, m)

    @hook(uses=[*BOX, start_box_step])
    def outer_initial(th, s, p, a):
        start_box_step(th, s, p, a)

    @hook(uses=BOX)
    def final_integrate(th, s, p, a):
        q, b, e, w, m = a
        bit, mine = np.int32(np.int64(p[0])), slice(th.lo, th.hi)
        kick_group(th, s, bit, 1.0)
        drag_velocities(th, s, bit, b, q[0] == 3.0)
        measure_kinetics(th, s, p, q, b, False)
        if th.tid == 0:
            p[11] = (b[9, 0] + b[9, 1] + b[9, 2]) / (p[2] * p[3]) if p[2] > 0.0 else 0.0
            measure_pressure(s, q, b, w)
            push_box(th, s, p, q, b, m)
            p[12] = 1.0
            if q[28] != 0.0:
                nose_hoover_chain(th, p)
            if q[11] > 0.0:
                barostat_chain(th, q, b, e, p[3] * p[13])
            for k in range(6):
                b[9, k] *= p[12] * p[12]
                b[10, k] *= p[12] * p[12]
        barrier(th)
        factor = p[12]
        if q[28] != 0.0:
            mask = s.mask[mine]
            for d in range(3):
                v = s.v[d, mine]
                for i in range(v.size):
                    if mask[i] & bit != 0:
                        v[i] *= factor

    @classmethod
    def from_lammps(cls, group, words, session):
        given = cls.read(words, session)
        if "temperature" not in given:
            raise InputError(f"fix {cls.style} needs temp Tstart Tstop Tdamp")
        return cls.made(group, given, session)
