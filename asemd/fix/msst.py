r"""Multi-scale shock technique: volume and temperature follow a shock wave of a given velocity through the system.

.. math:: \dot r_i = v_i + \frac{\dot V}{V} r_{i,s}, \qquad
          m_i \dot v_i = F_i - \frac{\dot V}{V} m_i v_{i,s} + \frac{\mu \dot V^2}{V \sum_j v_j^2} v_i, \qquad
          \frac{Q}{M} \ddot V = P_{ss} - P_0 - u^2 \frac{M}{V_0} \Bigl(1 - \frac{V}{V_0}\Bigr) - \frac{\mu \dot V}{V}

with the shock along :math:`s`, its velocity u, the mass M of all atoms and the cell mass Q: the cell, which stays orthogonal, is held to
the Rayleigh line, and its energy to the Hugoniot. At the start of every run the fraction ``tscale`` of the kinetic energy becomes motion of
the cell, :math:`\dot V < 0`, as in LAMMPS; not after a restart. :math:`E_0`, :math:`V_0` and :math:`P_0` are those at the start of the
first run, before that, unless given. Atoms outside the group are dilated with the cell, too. ``beta`` belongs to ``dftb`` and has no effect
without it.

Output: the scalar (thermo keywords ecouple, econserve) is the energy of the cell,

.. math:: \frac{Q \dot V^2}{2 M} - \tfrac12 M u^2 \Bigl(1 - \frac{V}{V_0}\Bigr)^2 - P_0 (V_0 - V)

The vector has the departures from the Hugoniot (temperature) and from the Rayleigh line (pressure), the speed of the particles
:math:`u (1 - V / V_0)`, and the position of the cell behind the front.

Source: E. J. Reed, L. E. Fried, J. D. Joannopoulos, Phys. Rev. Lett. 90, 235503 (2003); LAMMPS manual, fix msst. Units: velocity, q
mass^2/length^4, mu mass/length/time, pressure, volume, energy.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute.pe import PE
from asemd.compute.pressure import VIRIAL, Pressure, find_pressure, find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, NotYet, SimulationError, nearest
from asemd.fix import Fix, hook
from asemd.fix.barostat import box_volume, kinetic_tensor, measure_pressure, take_along
from asemd.fix.measured import take_pressure, take_temperature
from asemd.fix.nose_hoover_box import tail_virial
from asemd.kernels.box import follow
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import choice, number, take, yes_no

KEYWORDS = ("q", "mu", "p0", "v0", "e0", "tscale", "dftb", "beta")


def push_cell(th, s, p, q, b, w):
    """Half a step of the rate of the volume, from the pressure now. One thread calls it."""
    measure_pressure(s, q, b, w)
    half, volume = 0.5 * th.dt, q[32]
    line = p[7] * p[8] * p[3] * p[3] * p[6] * (p[9] - volume) / (p[9] * p[9])
    push = p[6] * (b[5, int(p[2])] - p[10] - line) / (p[4] * p[7] * p[8])
    friction = p[6] * p[5] / (p[4] * volume)
    if volume > p[9] and push > 0.0:        # a cell that expands is not blown up
        push = -push
    if friction * half > 1e-6:
        p[11] = (p[11] + push * (math.exp(friction * half) - 1.0) / friction) * math.exp(-friction * half)
    else:
        p[11] += (push - friction * p[11]) * half + 0.5 * (friction * friction * p[11] - push * friction) * half * half


def half_kick(v, force, rate, half):
    """A velocity after `half` of the time, under a force over mass and with a rate of growth."""
    if abs(half * rate) > 1e-6:
        grow = math.exp(rate * half)
        return grow * (force + rate * v - force / grow) / rate
    return v + (force + rate * v) * half + 0.5 * (rate * rate * v + force * rate) * half * half


def kick(th, s, p, volume, squares, keep):
    """Half a step of the velocities, if `keep`; returns this thread's part of the sum of their squares afterwards."""
    bit, half, mine, total = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi), 0.0
    mask, mass, inverse_mass = s.mask[mine], s.mass[mine], s.inverse_mass[mine]
    viscous = p[5] * p[11] * p[11] / (squares * volume) if p[5] != 0.0 else 0.0
    for d in range(3):
        v, f, shrink = s.v[d, mine], s.f[d, mine], 2.0 * p[11] / volume if d == int(p[2]) else 0.0
        for i in range(v.size):
            if mask[i] & bit != 0:
                new = half_kick(v[i], f[i] * inverse_mass[i], viscous / mass[i] - shrink, half)
                total += new * new
                if keep:
                    v[i] = new
    return total


def resize_cell(th, s, p, q, b, change, old, new):
    """The length along the shock follows the volume, and positions and velocities of the atoms with it."""
    if th.tid == 0:
        axis, o, v = int(p[2]), s.box.origin, s.box.vectors
        grow = new / old
        for d in range(3):
            b[11, d], change[d, d] = o[d], grow if d == axis else 1.0
        middle = o[axis] + 0.5 * v[axis, axis]
        o[axis] = middle + (o[axis] - middle) * grow
        v[axis, axis] *= grow
        for d in range(3):
            b[12, d] = o[d]
        follow(s.box)
    barrier(th)
    take_along(th, s, np.int32(1), b[11], change, b[12], False)
    v, grow = s.v[int(p[2]), th.lo:th.hi], new / old
    for i in range(v.size):
        v[i] *= grow


USES = [kinetic_tensor, box_volume, measure_pressure, take_along, follow, push_cell, half_kick, kick, resize_cell]


class MSST(Fix):
    """Time integration of a cell that a shock wave runs over.

    Parameters
    ----------
    group : str
        The atoms it moves; meant for all. Temperature and pressure are those of all atoms.
    direction : str
        x, y or z.
    velocity : float
        Of the shock, in velocity units of the scene.
    cell_mass : float
        The mass-like parameter of the cell, mass^2/distance^4.
    viscosity : float
        Artificial viscosity, mass/distance/time.
    energy, volume, pressure : float, optional
        The state before the shock, of the whole system; by default that at the start of the first run.
    scale : float
        Fraction of the kinetic energy that becomes motion of the cell at the start of a run.

    Raises
    ------
    InputError
        A value out of its range; a box that is triclinic or not periodic.

    Examples
    --------
    >>> MSST(direction="z", velocity=0.1, cell_mass=25.0, viscosity=0.9)
    """

    style = "msst"
    brings = ("temp", "press", "pe")
    integrates = True
    ecouple = True
    box_moves = "size"
    virial_every = 1
    output_needs = frozenset({"energy", "virial"})
    size = 4

    def __init__(self, group: str = "all", direction: str = "x", velocity: float = 1.0, cell_mass: float = 10.0, viscosity: float = 0.0,
                 energy: float | None = None, volume: float | None = None, pressure: float | None = None, scale: float = 0.01,
                 beta: float | None = None):
        super().__init__(group)
        what = f"fix {self.style}"
        self.axis = "xyz".index(choice(direction, "xyz", f"{what} direction"))
        for name, value in (("the shock velocity", velocity), ("q", cell_mass), ("v0", 1.0 if volume is None else volume)):
            if not value > 0.0:
                raise InputError(f"{what}: {name} must be positive, got {value:g}")
        if viscosity < 0.0:
            raise InputError(f"{what}: mu must not be negative, got {viscosity:g}")
        if not 0.0 <= scale <= 1.0 or not 0.0 <= (beta or 0.0) <= 1.0:
            raise InputError(f"{what}: tscale and beta must be between 0 and 1")
        self.velocity, self.cell_mass, self.viscosity, self.scale, self.beta = velocity, cell_mass, viscosity, scale, beta
        self.e0, self.v0, self.p0 = energy, volume, pressure
        self.given = {"e0": energy, "v0": volume, "p0": pressure}
        self.restarted = False
        self.temp = Temp("all")
        self.press = Pressure("all", self.temp, ())
        self.pe = PE()
        self.p, self.q, self.b, self.w, self.change = np.zeros(15), np.zeros(34), np.zeros((13, 6)), np.zeros(1), np.eye(3)
        self._loop = None

    @classmethod
    def from_lammps(cls, group, words, session):
        what, given = f"fix {cls.style}", {}
        direction, velocity = take(words, 2, f"{what} direction shockvel")[:2]
        names = {"q": "cell_mass", "mu": "viscosity", "p0": "pressure", "v0": "volume", "e0": "energy", "tscale": "scale", "beta": "beta"}
        words = words[2:]
        while words:
            keyword = words[0]
            if keyword not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            value = take(words[1:], 1, f"{what} {keyword}")[0]
            words = words[2:]
            if keyword in names:
                given[names[keyword]] = number(value, f"{what} {keyword}")
            elif yes_no(value, f"{what} dftb"):
                raise InputError(f"{what} dftb yes is not supported: it needs the electronic entropy of DFTB+; leave dftb out")
        new = cls(group, direction, number(velocity, f"{what} shockvel"), **given)
        if session.scene.system is not None:
            new.check_box(session.scene.system)
        for line in new.told():
            session.print(line)
        return new

    def told(self) -> list[str]:
        """What the log says of it."""
        lines = ["MSST parameters:", f"  Shock in {'xyz'[self.axis]} direction",
                 f"  Cell mass-like parameter qmass (units of mass^2/length^4) = {self.cell_mass:.8g}",
                 f"  Shock velocity = {self.velocity:.8g}", f"  Artificial viscosity (units of mass/length/time) = {self.viscosity:.8g}"]
        for what, value in (("pressure", self.given["p0"]), ("volume", self.given["v0"]), ("energy", self.given["e0"])):
            lines.append(f"  Initial {what} " + ("calculated on first step" if value is None else f"specified to be {value:.8g}"))
        return lines

    def to_lammps(self) -> list[str]:
        words = ["xyz"[self.axis], repr(self.velocity), "q", repr(self.cell_mass), "mu", repr(self.viscosity), "tscale", repr(self.scale)]
        for name, value in {**self.given, "beta": self.beta}.items():
            words += [name, repr(value)] if value is not None else []
        return words

    def check_box(self, system) -> None:
        """Refuse a box that cannot be shocked.

        Raises
        ------
        InputError
            It is triclinic, or not periodic in all directions.
        """
        what, box = f"fix {self.style}", system.box
        if box.triclinic or not box.is_lammps_frame:
            raise InputError(f"{what}: the box must be orthogonal, with its edges along x, y and z")
        if not box.periodic.all():
            raise InputError(f"{what}: the box must be periodic in all directions")

    # ---- a run --------------------------------------------------------------------------------------------------------------------------
    def parameters(self, loop) -> np.ndarray:
        self.check_box(loop.system)
        self._loop = loop
        p, q, u, measured = self.p.copy(), self.q, loop.units, self.press.temperature or self.temp
        p[:9] = (loop.group_bit(self.group), loop.group_bit(measured.group), self.axis, self.velocity, self.cell_mass, self.viscosity,
                 float(loop.system.atom_masses().sum()), u.nktv2p, u.mvv2e)
        p[14] = measured is not self.temp
        q[:] = 0.0
        q[0], q[7], q[26] = 2.0, u.nktv2p, loop.system.dimension
        q[23], q[24] = "fix" in self.press.terms, "ke" in self.press.terms
        self.p = p
        self.resize(loop)
        return p

    def resize(self, loop) -> None:
        self.q[22] = tail_virial(loop, self.press)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Not by atom: numbers as in `asemd.fix.barostat`, and by what the lengths change."""
        self.w = np.array([float(t.category in self.press.terms or t.category not in VIRIAL) for t in loop.engine.terms])
        return self.q, self.b, self.w, self.change

    def setup(self, loop) -> None:
        """The state before the shock, where it is not given; then kinetic energy becomes motion of the cell."""
        p, q, b, state = self.p, self.q, self.b, loop.snapshot()
        b[10] = (self.press.temperature or self.temp).vector(state)
        measure_pressure(loop.state, q, b, self.w)
        if self.v0 is None:
            self.v0 = float(q[32])
            loop.say(f"Fix MSST v0 = {self.v0:.8g}")
        if self.p0 is None:
            self.p0 = float(b[5, self.axis])
            loop.say(f"Fix MSST p0 = {self.p0:.8g}")
        if self.e0 is None:
            later = loop.fixes[loop.fixes.index(self):]     # they have done nothing yet
            self.e0 = self._energy(state) - sum(f.scalar() for f in later if f.thermo_energy)
            loop.say(f"Fix MSST e0 = {self.e0:.8g}")
        p[9], p[10], p[13] = self.v0, self.p0, 0.0
        kinetic, scale = float(self.temp.vector(state)[:3].sum()), 0.0 if self.restarted else self.scale
        if kinetic > 0.0 and scale > 0.0:
            p[11] = -math.sqrt(scale * p[6] / p[4] * kinetic / p[8])
            loop.say(f"Fix MSST initial strain rate of {p[11] / self.v0:.8g} established by reducing temperature by factor of {scale:.8g}")
            loop.system.v[loop.groups[self.group]] *= math.sqrt(1.0 - scale)
            loop.sync_in()

    @hook(uses=USES)
    def initial_integrate(th, s, p, a):
        q, b, w, change = a
        bit, mine = np.int32(np.int64(p[0])), slice(th.lo, th.hi)
        kinetic_tensor(th, s, np.int32(np.int64(p[1])), 3, p[8], b[10])
        if th.tid == 0:
            push_cell(th, s, p, q, b, w)
        squares, mask = 0.0, s.mask[mine]
        for d in range(3):
            v = s.v[d, mine]
            for i in range(v.size):
                squares += v[i] * v[i] if mask[i] & bit != 0 else 0.0
        squares = reduce_sum(th, squares)
        volume = q[32]
        squares = reduce_sum(th, kick(th, s, p, volume, squares, False))
        if th.tid == 0:
            p[12] = squares
        kick(th, s, p, volume, squares, True)
        barrier(th)
        half = volume + 0.5 * th.dt * p[11]
        resize_cell(th, s, p, q, b, change, volume, half)
        for d in range(3):
            x, v = s.x[d, mine], s.v[d, mine]
            for i in range(x.size):
                x[i] += th.dt * v[i] if mask[i] & bit != 0 else 0.0
        barrier(th)
        resize_cell(th, s, p, q, b, change, half, half + 0.5 * th.dt * p[11])

    @hook(uses=USES)
    def final_integrate(th, s, p, a):
        q, b, w, change = a
        volume = box_volume(s, q)
        kick(th, s, p, volume, p[12], True)
        if p[14] == 0.0:        # a temperature that is the pressure's alone is measured where a step begins, as in LAMMPS
            kinetic_tensor(th, s, np.int32(np.int64(p[1])), 3, p[8], b[10])
        if th.tid == 0:
            push_cell(th, s, p, q, b, w)
            p[13] -= p[3] * q[32] / p[9] * th.dt
        barrier(th)

    def broken_constraint(self, loop) -> str:
        if not self.p[11] == self.p[11] or self.q[29] == 2.0:
            return "the pressure is not a number: the run has come apart"
        return "the cell has no volume left: q is too small, or the shock too fast" if self.q[32] <= 0.0 else ""

    def finish(self, loop) -> None:
        broken = self.broken_constraint(loop)
        if broken:
            raise SimulationError(f"fix {self.id} (style {self.style}): {broken}")

    # ---- outputs ------------------------------------------------------------------------------------------------------------------------
    def _energy(self, state) -> float:
        return self.pe.scalar(state) + 0.5 * self.temp.dof(state) * state.units.boltz * self.temp.scalar(state)

    def _compression(self) -> tuple[float, float]:
        """Volume, and 1 - V / V0."""
        if self._loop is None:
            raise NotYet(f"fix {self.id} (style {self.style}): the state of the shock is not known before the first run: use run 0")
        volume = float(np.prod(np.diag(self._loop.state.box.vectors)))
        return volume, 1.0 - volume / self.v0

    def extensive_at(self, index) -> bool:
        """Whether ``thermo_modify norm yes`` divides an output by the number of atoms: the energy, not the elements of the vector."""
        return not index

    def scalar(self) -> float:
        """Energy of the cell, energy units."""
        p, (volume, strain) = self.p, self._compression()
        flow = 0.5 * p[6] * p[3] ** 2 * strain**2
        return float((p[4] * p[11] ** 2 / (2.0 * p[6]) - flow) * p[8] - p[10] * (self.v0 - volume) / p[7])

    def vector(self, i: int) -> float:
        """Element `i`, from 1, see above."""
        p, (volume, strain) = self.p, self._compression()
        if i == 3:
            return float(p[3] * strain)
        if i == 4:
            return float(p[13])
        if not 1 <= i <= 4:
            raise InputError(f"fix {self.id} (style {self.style}): the vector has 4 elements")
        state = self._loop.snapshot()
        if not state.fresh:
            raise NotYet(f"fix {self.id} (style {self.style}): energies and virial were not computed on step {state.step}")
        pressure = float(self.press.vector(state)[self.axis])
        if i == 2:
            return pressure - p[10] - p[6] * p[3] ** 2 * p[8] * strain * p[7] / self.v0
        excess = 0.5 * (pressure + p[10]) * (self.v0 - volume) / p[7] + self.e0 - self._energy(state)
        return excess / (self.temp.dof(state) * state.units.boltz)

    def modify_option(self, keyword, value, session):
        if keyword in ("temp", "press"):
            what = f"fix_modify {keyword}"
            found = (find_temperature if keyword == "temp" else find_pressure)(value, session, what)
            plain = found if keyword == "temp" else found.temperature or self.temp
            if type(plain) is not Temp:
                raise InputError(f"{what}: fix {self.style} takes a compute of style temp only, {plain.id} has style {plain.style}")
            if keyword == "press":
                take_pressure(self, value, session)
            else:       # a pressure of the script's own keeps its temperature
                take_temperature(self, found, session, self.press.maker == self.id)
            return True
        return super().modify_option(keyword, value, session)

    def own_computes(self) -> dict:
        return {f"{self.id}MSST_{name}": getattr(self, name) for name in self.brings}

    def state(self) -> dict:
        """The rate of the volume and the state before the shock."""
        return {"omega": float(self.p[11]), "e0": self.e0, "v0": self.v0, "p0": self.p0}

    def restore(self, state: dict) -> None:
        self.p[11], self.e0, self.v0, self.p0 = state["omega"], state["e0"], state["v0"], state["p0"]
        self.restarted = True
