r"""Constant temperature and pressure for spheres that turn: Nose-Hoover chains coupled to atoms, their rotation, and the box.

The equations are those of `asemd.fix.npt`; angular velocities feel the torques and the chain of the atoms, not the box,

.. math:: \dot\omega_i = \frac{T_i}{I_i} - \omega_i\,\dot\eta_1

and the energy of rotation counts in temperature and pressure as in compute temp/sphere. ``disc`` and ``update dipole`` as in
`asemd.fix.nve_sphere`.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); LAMMPS manual, fix npt/sphere. Units: temperature, time,
pressure.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.pressure import Pressure
from asemd.compute.temp_sphere import TempSphere
from asemd.fix import hook
from asemd.fix.barostat import barostat_chain, drag_velocities, measure_pressure, push_box, target_pressure
from asemd.fix.nose_hoover import nose_hoover_chain
from asemd.fix.npt import BOX, NPT, kick_group, move_in_box, step_box
from asemd.fix.sphere_bath import SphereBath
from asemd.fix.spheres import TURNS, kick_spins, scale_spins, spins_tensor, turn_along
from asemd.kernels.threads import barrier


def measure_spins(th, s, p, q, b, omega, radius, mu, o, begins):
    """Kinetic tensors now; that of a temperature which is the pressure's alone is measured where a step begins, as in LAMMPS. For a box
    that changes isotropically the mean of the diagonal counts, with the rotation about an axis out of the plane."""
    terms, dimension = 3 if q[0] < 3.0 else 6, int(q[26])
    for k in range(2):
        if k == 0 or (q[33] != 0.0 and begins):
            out, bit = b[9 + k], np.int32(np.int64(p[1] if k == 0 else q[25]))
            spins_tensor(th, s, bit, terms, p[4], omega, radius, mu, o[3 + 2 * k], o[4 + 2 * k], out)
            if q[0] == 1.0 and th.tid == 0:
                mean = (out[0] + out[1] + out[2]) / dimension
                out[0], out[1], out[2] = mean, mean, mean if dimension == 3 else 0.0
    if q[33] == 0.0 and th.tid == 0:
        b[10, :] = b[9, :]


SPHERES = [*BOX, *TURNS, scale_spins, spins_tensor, measure_spins]


def start_spins(th, s, p, a):
    """Velocities and angular velocities of the first half of a step."""
    q, b, e, w, m, omega, radius, mu, o = a
    bit = np.int32(np.int64(p[0]))
    barrier(th)                 # others may still read the factor of the last step
    if th.tid == 0:
        if q[11] > 0.0:
            barostat_chain(th, q, b, e, p[3] * p[13])
        p[12] = 1.0
        if q[28] != 0.0:
            nose_hoover_chain(th, p)
    barrier(th)
    scale_spins(th, s, bit, p[12], omega)
    measure_spins(th, s, p, q, b, omega, radius, mu, o, True)
    if th.tid == 0:
        measure_pressure(s, q, b, w)
        target_pressure(th, s, q, b, m)
        push_box(th, s, p, q, b, m)
    barrier(th)
    drag_velocities(th, s, bit, b, q[0] == 3.0)
    kick_group(th, s, bit, 1.0)
    kick_spins(th, s, bit, 1.0, omega, radius, o)


class InnerSpheres:
    """What moves spheres and box on the inner levels of several."""

    @hook(uses=SPHERES)
    def initial_integrate(th, s, p, a):
        q, b, e, w, m, omega, radius, mu, o = a
        bit = np.int32(np.int64(p[0]))
        kick_group(th, s, bit, 1.0)
        kick_spins(th, s, bit, 1.0, omega, radius, o)
        barrier(th)
        step_box(th, s, q, b, m)
        move_in_box(th, s, bit, q, b, m)
        turn_along(th, s, bit, omega, radius, mu, o)

    @hook(uses=SPHERES)
    def final_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        kick_group(th, s, bit, 1.0)
        kick_spins(th, s, bit, 1.0, a[5], a[6], a[8])


class NPTSphere(SphereBath, NPT):
    """Time integration of spheres at constant temperature and pressure.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a radius. Temperature and pressure are those of all atoms.
    temperature : float or (float, float)
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time of the temperature, in time units of the scene.
    pressure, pressure_damping
        As those of `asemd.fix.npt.NPT`.
    dipole : str
        ``dipole`` or ``dipole/dlm``: dipoles turn along; empty: they stay.
    disc : bool
        Discs in two dimensions: another moment of inertia.
    **keywords
        The others of `asemd.fix.npt.NPT`.

    Raises
    ------
    InputError
        As `asemd.fix.npt.NPT`; an unknown way of turning dipoles.

    Examples
    --------
    >>> NPTSphere(temperature=1.0, damping=0.5, pressure=1.0, pressure_damping=5.0, dipole="dipole/dlm")
    """

    style = "npt/sphere"
    inner = InnerSpheres

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, pressure=0.0, pressure_damping: float = 1000.0,
                 dipole: str = "", disc: bool = False, **keywords):
        super().__init__(group, temperature, damping, pressure, pressure_damping, **keywords)
        self.set_turning(dipole, disc)
        self.temp = TempSphere("all")
        self.press = Pressure("all", self.temp, ())

    @hook(uses=[*SPHERES, start_spins])
    def initial_integrate(th, s, p, a):
        q, b, e, w, m, omega, radius, mu, o = a
        bit = np.int32(np.int64(p[0]))
        start_spins(th, s, p, a)
        barrier(th)
        step_box(th, s, q, b, m)
        move_in_box(th, s, bit, q, b, m)
        turn_along(th, s, bit, omega, radius, mu, o)

    @hook(uses=[*SPHERES, start_spins])
    def outer_initial(th, s, p, a):
        start_spins(th, s, p, a)

    @hook(uses=SPHERES)
    def final_integrate(th, s, p, a):
        q, b, e, w, m, omega, radius, mu, o = a
        bit = np.int32(np.int64(p[0]))
        kick_group(th, s, bit, 1.0)
        kick_spins(th, s, bit, 1.0, omega, radius, o)
        drag_velocities(th, s, bit, b, q[0] == 3.0)
        measure_spins(th, s, p, q, b, omega, radius, mu, o, False)
        if th.tid == 0:
            p[11] = (b[9, 0] + b[9, 1] + b[9, 2]) / (p[2] * p[3]) if p[2] > 0.0 else 0.0
            measure_pressure(s, q, b, w)
            push_box(th, s, p, q, b, m)
            p[12] = 1.0
            if q[28] != 0.0:
                nose_hoover_chain(th, p)
            if q[11] > 0.0:
                barostat_chain(th, q, b, e, p[3] * p[13])
        barrier(th)
        if q[28] != 0.0:
            scale_spins(th, s, bit, p[12], omega)
