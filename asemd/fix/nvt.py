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

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.nve import NVE
from asemd.fix.thermostat import Thermostat
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import number, take, whole

HEADER = 14     # numbers before the chain: eta (n), its velocity (n + 1), acceleration (n), mass (n)
PRESSURE = ("iso", "aniso", "tri", "x", "y", "z", "xy", "yz", "xz", "couple", "ptemp")
BAROSTAT_ONLY = {"mtk": 1, "pchain": 1, "ploop": 1, "nreset": 1, "flip": 1, "dilate": 1, "fixedpoint": 3}     # no effect here
KEYWORDS = ("temp", "tchain", "tloop", "drag", *BAROSTAT_ONLY)


def nose_hoover_chain(th, p):
    """Half a timestep of the chain; afterwards ``p[12]`` is the factor of the velocities and ``p[11]`` the temperature they then have."""
    dof, boltz, n, loops = p[2], p[3], int(p[9]), int(p[10])
    done = 0.0
    if th.end != th.begin:
        done = (th.step - th.begin) / (th.end - th.begin)
    target = p[5] + done * (p[6] - p[5])
    kt = boltz * target
    eta, rate, push, mass = p[14:14 + n], p[14 + n:15 + 2 * n], p[15 + 2 * n:15 + 3 * n], p[15 + 3 * n:15 + 4 * n]
    for k in range(n):
        mass[k] = kt / (p[7] * p[7])
    mass[0] *= dof
    half, quarter, eighth = 0.5 * th.dt / loops, 0.25 * th.dt / loops, 0.125 * th.dt / loops
    drag = 1.0 - th.dt * p[7] * p[8] / loops
    push[0] = boltz * dof * (p[11] - target) / mass[0] if dof > 0.0 else 0.0
    factor = 1.0
    for _ in range(loops):
        for k in range(n - 1, -1, -1):
            slow = math.exp(-eighth * rate[k + 1])
            rate[k] = (rate[k] * slow + push[k] * quarter) * drag * slow
        scale = math.exp(-half * rate[0])
        factor *= scale
        p[11] *= scale * scale
        push[0] = boltz * dof * (p[11] - target) / mass[0] if dof > 0.0 else 0.0
        for k in range(n):
            eta[k] += half * rate[k]
        for k in range(n):
            slow = math.exp(-eighth * rate[k + 1])
            if k > 0:
                push[k] = (mass[k - 1] * rate[k - 1] * rate[k - 1] - kt) / mass[k]
                rate[k] *= slow
                rate[k] = (rate[k] + push[k] * quarter) * slow
            else:
                rate[k] *= slow
                rate[k] = (rate[k] + push[k] * quarter) * slow
    p[12], p[13] = factor, target


class NVT(Thermostat):
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
    integrates = True
    levels = "every"
    inner = NVE

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, chain: int = 3, loops: int = 1, drag: float = 0.0):
        super().__init__(group, temperature, damping)
        if callable(self.start) or min(self.start, self.stop) <= 0.0:
            raise InputError("fix nvt: target temperatures must be numbers above 0")
        if chain < 1 or loops < 1:
            raise InputError(f"fix nvt: tchain and tloop must be at least 1, got {chain} and {loops}")
        if drag < 0.0:
            raise InputError(f"fix nvt: drag must not be negative, got {drag:g}")
        self.chain, self.loops, self.drag = chain, loops, drag
        self.p = np.zeros(HEADER + 4 * chain + 1)

    @classmethod
    def from_lammps(cls, group, words, session):
        arguments = {}
        while words:
            keyword, words = words[0], words[1:]
            if keyword in PRESSURE:
                raise InputError(f"fix nvt: {keyword} controls the pressure, which fix nvt does not; use fix npt")
            if keyword not in KEYWORDS:
                raise InputError(f"fix nvt: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            what = f"fix nvt {keyword}"
            values = take(words, 3 if keyword == "temp" else BAROSTAT_ONLY.get(keyword, 1), what)
            words = words[len(values):]
            if keyword == "temp":
                start, stop, arguments["damping"] = (number(w, what) for w in values)
                arguments["temperature"] = start, stop
            elif keyword == "drag":
                arguments["drag"] = number(values[0], what)
            elif keyword in ("tchain", "tloop"):
                arguments[{"tchain": "chain", "tloop": "loops"}[keyword]] = whole(values[0], what)
        if "temperature" not in arguments:
            raise InputError("fix nvt needs temp Tstart Tstop Tdamp")
        return cls(group, **arguments)

    def to_lammps(self) -> list[str]:
        words = ["temp", repr(self.start), repr(self.stop), repr(self.damping), "tchain", str(self.chain), "tloop", str(self.loops)]
        return words + (["drag", repr(self.drag)] if self.drag else [])

    def parameters(self, loop) -> np.ndarray:
        self.p = self.p.copy()
        self.p[:11] = (loop.group_bit(self.group), loop.group_bit(self.temp.group), self.temp.dof(loop), loop.units.boltz, loop.units.mvv2e,
                       self.start, self.stop, 1.0 / self.damping, self.drag, self.chain, self.loops)
        return self.p

    def setup(self, loop) -> None:
        """The chain's masses and accelerations for the temperature at the start of the run."""
        n, p = self.chain, self.p
        target = self.target(loop)
        p[11:14] = self.temp.scalar(loop.snapshot()), 1.0, target
        rate, push, mass = p[HEADER + n:HEADER + 2 * n], p[HEADER + 2 * n + 1:HEADER + 3 * n + 1], p[HEADER + 3 * n + 1:]
        mass[:] = p[3] * target * self.damping**2
        mass[0] *= p[2]
        if n > 1:
            push[1:] = (mass[:-1] * rate[:-1] ** 2 - p[3] * target) / mass[1:]

    @hook(uses=[nose_hoover_chain])
    def initial_integrate(th, s, p, a):
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

    def scalar(self) -> float:
        """Energy of the chain, energy units."""
        n, p = self.chain, self.p
        eta, rate, mass = p[HEADER:HEADER + n], p[HEADER + n:HEADER + 2 * n], p[HEADER + 3 * n + 1:]
        return float(p[3] * p[13] * (p[2] * eta[0] + eta[1:].sum()) + 0.5 * (mass * rate * rate).sum())

    def state(self) -> dict:
        """Positions and velocities of the chain."""
        return {"eta": self.p[HEADER:HEADER + self.chain].copy(), "eta_dot": self.p[HEADER + self.chain:HEADER + 2 * self.chain].copy()}

    def restore(self, state: dict) -> None:
        """Of a chain of another length nothing is taken."""
        if len(state["eta"]) == self.chain:
            self.p[HEADER:HEADER + self.chain] = state["eta"]
            self.p[HEADER + self.chain:HEADER + 2 * self.chain] = state["eta_dot"]
