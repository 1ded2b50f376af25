r"""Constant temperature in a box that fix deform changes: Nose-Hoover chain and the SLLOD equations of motion.

.. math:: \dot r = v, \qquad \dot v' = \frac{F}{m} - v' \cdot \nabla u - v'\,\dot\eta, \qquad v' = v - u(r)

with the flow :math:`u(r) = \dot h\, h^{-1} (r - r_0) + \dot r_0` of the box. The thermostat acts on :math:`v'`, whose temperature
(compute temp/deform) it measures. With ``psllod yes`` the term of the gradient takes :math:`v` in place of :math:`v'`. The box must be
deformed with ``remap v``. The chain has one link unless ``tchain`` says otherwise.

``fix_modify temp`` takes other temperatures with a bias (temp/profile, temp/partial ...): :math:`v'` is then what they leave of the
velocities, while the term of the gradient stays that of the box.

Each of the M sub-steps of ``tloop M`` takes its part of the term of the gradient. LAMMPS takes the whole term in each, M times the flow's
gradient: ``-compat lammps`` does so too.

Source: D. J. Evans, G. P. Morriss, Phys. Rev. A 30, 1528 (1984); M. E. Tuckerman, C. J. Mundy, S. Balasubramanian, M. L. Klein,
J. Chem. Phys. 106, 5615 (1997); P. J. Daivis, B. D. Todd, J. Chem. Phys. 124, 194103 (2006) for psllod; LAMMPS manual, fix nvt/sllod.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp_deform import TempDeform
from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.nose_hoover import HEADER, nose_hoover_chain
from asemd.fix.nvt import NVT
from asemd.fix.thermostat import thermal_velocities
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import take, yes_no


def gradient(box, rates, m):
    """The gradient of the flow, ``m (6,)``: xx yy zz yx zx zy, so that ``u = (x - origin) @ m + rate of the origin``."""
    v = box.vectors
    ax, by, cz = 1.0 / v[0, 0], 1.0 / v[1, 1], 1.0 / v[2, 2]
    bx = -v[1, 0] / (v[0, 0] * v[1, 1])
    cx = (v[2, 1] * v[1, 0] - v[1, 1] * v[2, 0]) / (v[0, 0] * v[1, 1] * v[2, 2])
    cy = -v[2, 1] / (v[1, 1] * v[2, 2])
    m[0], m[1], m[2] = ax * rates[3], by * rates[4], cz * rates[5]
    m[3] = bx * rates[3] + by * rates[8]
    m[4] = cx * rates[3] + cy * rates[8] + cz * rates[7]
    m[5] = cy * rates[4] + cz * rates[6]


def thermal_temperature(th, s, p, rates):
    """The temperature of what the velocities of the group with bit ``p[1]`` have beyond the flow."""
    m = np.empty(6)
    gradient(s.box, rates, m)
    bit, mine, o = np.int32(np.int64(p[1])), slice(th.lo, th.hi), s.box.origin
    mask, mass = s.mask[mine], s.mass[mine]
    x, y, z, vx, vy, vz = s.x[0, mine], s.x[1, mine], s.x[2, mine], s.v[0, mine], s.v[1, mine], s.v[2, mine]
    twice = 0.0
    for i in range(mask.size):
        if mask[i] & bit != 0:
            dx, dy, dz = x[i] - o[0], y[i] - o[1], z[i] - o[2]
            a = vx[i] - (m[0] * dx + m[3] * dy + m[4] * dz + rates[9])
            b = vy[i] - (m[1] * dy + m[5] * dz + rates[10])
            c = vz[i] - (m[2] * dz + rates[11])
            twice += mass[i] * (a * a + b * b + c * c)
    twice = reduce_sum(th, twice)
    return p[4] * twice / (p[2] * p[3]) if p[2] > 0.0 else 0.0


def thermostat(th, s, p, rates, peculiar, share):
    """Half a step of the chain on the thermal velocities, and in each of its sub-steps `share` of the term of the gradient."""
    m = np.empty(6)
    gradient(s.box, rates, m)
    barrier(th)                 # others may still read the factor of the last step
    if th.tid == 0:
        nose_hoover_chain(th, p)
    barrier(th)
    bit, half, mine, o = np.int32(np.int64(p[0])), 0.5 * th.dt * share, slice(th.lo, th.hi), s.box.origin
    mask, x, y, z, vx, vy, vz = s.mask[mine], s.x[0, mine], s.x[1, mine], s.x[2, mine], s.v[0, mine], s.v[1, mine], s.v[2, mine]
    for factor in p[17 + 4 * int(p[9]):]:
        for i in range(mask.size):
            if mask[i] & bit != 0:
                dx, dy, dz = x[i] - o[0], y[i] - o[1], z[i] - o[2]
                u = m[0] * dx + m[3] * dy + m[4] * dz + rates[9]
                v = m[1] * dy + m[5] * dz + rates[10]
                w = m[2] * dz + rates[11]
                a, b, c = vx[i] - u, vy[i] - v, vz[i] - w
                p_x, p_y, p_z = (vx[i], vy[i], vz[i]) if peculiar != 0.0 else (a, b, c)
                vx[i] = a * factor - half * (m[0] * p_x + m[3] * p_y + m[4] * p_z) + u
                vy[i] = b * factor - half * (m[1] * p_y + m[5] * p_z) + v
                vz[i] = c * factor - half * m[2] * p_z + w


class NVTSllod(NVT):
    """Constant temperature in a flow.

    Parameters
    ----------
    group : str
        The atoms it moves.
    temperature : float or (float, float)
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time, in time units of the scene.
    chain : int
        Length of the chain.
    loops : int
        Sub-steps of the chain.
    drag : float
        Damps oscillations of the chain.
    psllod : bool
        The equations of motion p-SLLOD.

    Raises
    ------
    InputError
        As `NVT`; at the start of a run, when no fix deform with ``remap v`` is there.
    """

    style = "nvt/sllod"
    kinds = tuple(kind for kind in NVT.kinds if kind not in ("temp", "temp/sphere", "temp/asphere"))     # those with a bias
    size = 12

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, chain: int = 1, drag: float = 0.0,
                 psllod: bool = False, loops: int = 1):
        super().__init__(group, temperature, damping, chain, loops, drag)
        self.temp, self.psllod = TempDeform(group), psllod
        self.p = np.append(self.p, np.ones(loops))      # the factors of the sub-steps

    @classmethod
    def from_lammps(cls, group, words, session):
        words, psllod = list(words), False
        while "psllod" in words:
            at = words.index("psllod")
            psllod = yes_no(take(words[at + 1:], 1, "fix nvt/sllod psllod")[0], "fix nvt/sllod psllod")
            del words[at:at + 2]
        plain = NVT.from_lammps(group, words, session)
        return cls(group, (plain.start, plain.stop), plain.damping, plain.chain if "tchain" in words else 1, plain.drag, psllod,
                   plain.loops)

    @property
    def all_plain(self) -> bool:
        return self.temp.style == "temp/deform"

    def to_lammps(self) -> list[str]:
        return [*super().to_lammps(), "psllod", "yes" if self.psllod else "no"]

    def atom_arrays(self, loop):
        """The numbers of fix deform, among which are the rates of the box."""
        deform = next((f for f in loop.fixes if f.style == "deform"), None)
        if deform is None:
            raise InputError(f"fix {self.id} (style {self.style}) needs a fix deform")
        if deform.remap != "v":
            raise InputError(f"fix {self.id} (style {self.style}) needs a fix deform with remap v, it has remap {deform.remap}")
        self._arrays = deform.p, np.array([float(self.psllod), 1.0 if loop.interactions.compat == "lammps" else 1.0 / self.loops])
        return self._arrays

    def vector(self, i: int) -> float:
        """Positions and velocities of the chain, its potential and its kinetic energies; 12 values, the last ones 0 for a short chain."""
        n, p = self.chain, self.p
        if not 1 <= i <= max(12, 4 * n):
            raise InputError(f"fix {self.id} (style {self.style}): the vector has {max(12, 4 * n)} elements, there is no element {i}")
        eta, rate, mass = p[HEADER:HEADER + n], p[HEADER + n:HEADER + 2 * n], p[HEADER + 3 * n + 1:HEADER + 4 * n + 1]
        weight = np.where(np.arange(n) == 0, p[2], 1.0)
        values = np.concatenate([eta, rate, p[3] * p[13] * weight * eta, 0.5 * mass * rate * rate])
        return float(values[i - 1]) if i <= 4 * n else 0.0

    def scale_thermal(self, loop) -> None:
        """The sub-steps of `thermostat` with another bias than the flow of the box."""
        rates, (peculiar, share) = self._arrays
        m, mine = np.empty(6), loop.groups[self.group]
        gradient(loop.state.box, rates, m)
        flow = np.array([[m[0], 0.0, 0.0], [m[3], m[1], 0.0], [m[4], m[5], m[2]]])
        for factor in self.p[HEADER + 4 * self.chain + 1:]:
            thermal, v = thermal_velocities(loop, self.temp), loop.system.v
            pulled = (v if peculiar else thermal) @ flow
            v[mine] += ((factor - 1.0) * thermal - 0.5 * loop.dt * share * pulled)[mine]
            loop.sync_in()

    @hook(uses=[nose_hoover_chain, gradient, thermostat])
    def initial_integrate(th, s, p, a):
        thermostat(th, s, p, a[0], a[1][0], a[1][1])
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            x, v, f = s.x[d, mine], s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]
                    x[i] += th.dt * v[i]

    @hook(uses=[nose_hoover_chain, gradient, thermostat])
    def outer_initial(th, s, p, a):
        thermostat(th, s, p, a[0], a[1][0], a[1][1])
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            v, f = s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]

    @hook(uses=[nose_hoover_chain, gradient, thermal_temperature, thermostat])
    def final_integrate(th, s, p, a):
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            v, f = s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]
        now = thermal_temperature(th, s, p, a[0])
        if th.tid == 0:
            p[11] = now
        thermostat(th, s, p, a[0], a[1][0], a[1][1])
