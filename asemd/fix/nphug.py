r"""Hugoniostat: a liquid or solid is brought to the state behind a steady shock wave of a given pressure.

The equations are those of `asemd.fix.npt`, with a target of the temperature that changes in every step,

.. math:: T_t = T + \Delta, \qquad \Delta = \frac{\tfrac12 (P + P_0)(V_0 - V) + E_0 - E}{f k_B}

with the internal energy :math:`E`, potential and kinetic, :math:`f` degrees of freedom, and :math:`P` the pressure (all lengths are
controlled) or the component of the one length that is. In equilibrium :math:`\Delta` fluctuates about zero: the jump conditions of
Rankine and Hugoniot hold. :math:`E_0`, :math:`V_0` and :math:`P_0` are those at the start of the first run unless given; extensive ones are
of the whole system. The temperatures of ``temp`` are read but not used; masses of thermostat and box are set by the temperature at the
start of the first run, and stay.

Output: the scalar is the energy of what atoms and box are coupled to (thermo keywords ecouple, econserve). The vector has :math:`\Delta`,
the velocity of the shock :math:`u_s = \sqrt{(P - P_0) / (\rho_0 \epsilon)}` and of the particles :math:`u_p = \epsilon u_s` with
:math:`\epsilon = 1 - V / V_0`, then what the vector of fix npt has.

Source: R. Ravelo, B. L. Holian, T. C. Germann, P. S. Lomdahl, Phys. Rev. B 70, 014103 (2004); LAMMPS manual, fix nphug. Units: pressure,
time; fix_modify e0 energy, v0 volume, p0 pressure.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute.pe import PE
from asemd.errors import InputError, NotYet
from asemd.fix import hook
from asemd.fix.barostat import barostat_chain, measure_pressure
from asemd.fix.nose_hoover import nose_hoover_chain
from asemd.fix.nose_hoover_box import NoseHooverBox
from asemd.fix.npt import BOX, NPT, InnerLevel, kick_in_box, measure_kinetics, move_in_box, push_thermal_box, step_box
from asemd.kernels.threads import barrier
from asemd.words import number

V0, P0, E0, AXIS, TAIL, OTHER = range(34, 40)       # places in the numbers of the barostat; AXIS is -1 where all lengths change
FIRST_TARGET = 0.01         # temperature, before the first step
LEAST_STRAIN = 1e-10        # below it there is no shock


def aim(s, p, q, b, w):
    """The target temperature by the pressure of the present velocities and the last energies. One thread calls it."""
    measure_pressure(s, q, b, w)
    energy = q[39] + q[38] / q[32]
    for t in range(s.acc.shape[0]):
        for k in range(w.size):
            energy += s.acc[t, k, 0] + s.acc[t, k, 1]
    for c in range(3):
        energy += 0.5 * b[9, c]
    pressure = b[5, int(q[37])] if q[37] >= 0.0 else (b[5, 0] + b[5, 1] + b[5, 2]) / 3.0
    delta = (0.5 * (pressure + q[35]) * (q[34] - q[32])) / q[7] + q[36] - energy
    p[5] = p[11] + delta / (p[2] * p[3])
    p[6] = p[5]


def first_half(th, s, p, a):
    """Chains, target and the velocities of the first half of a step."""
    q, b, e, w, m = a
    barrier(th)                 # others may still read the factor of the last step
    if q[27] != 0.0:
        measure_kinetics(th, s, p, q, b, True)
    if th.tid == 0:
        if q[11] > 0.0:
            barostat_chain(th, q, b, e, p[3] * p[13])
        aim(s, p, q, b, w)
        nose_hoover_chain(th, p)
    barrier(th)
    kick_in_box(th, s, p, a, push_thermal_box(th, s, p, a))


class NPHug(NoseHooverBox):
    """Time integration towards the state behind a shock wave.

    Parameters
    ----------
    group : str
        The atoms it moves; temperature and pressure are those of all atoms.
    pressure : float
        Target of the pressure, or of the stress along the direction of the shock, in pressure units of the scene.
    damping, pressure_damping : float
        Relaxation times of temperature and pressure, in time units of the scene.
    energy, volume, reference_pressure : float, optional
        The state before the shock, of the whole system, in units of the scene; by default that at the start of the first run.
    **keywords
        The others of `asemd.fix.npt.NPT`; `components` with one of x, y and z is a shock in that direction.

    Raises
    ------
    InputError
        As `asemd.fix.npt.NPT`; target pressures that differ between start and end, or another choice of components than one length or all.

    Examples
    --------
    >>> NPHug(damping=100.0, shape="none", components={"z": (40.0, 40.0, 700.0)})
    """

    style = "nphug"
    brings = ("temp", "press", "pe")
    inner = InnerLevel
    with_energies = True
    output_needs = frozenset({"energy", "virial"})
    final_integrate = staticmethod(NPT.final_integrate)

    def __init__(self, group: str = "all", pressure: float = 0.0, damping: float = 100.0, pressure_damping: float = 1000.0,
                 energy: float | None = None, volume: float | None = None, reference_pressure: float | None = None, temperature=1.0,
                 **keywords):
        super().__init__(group, temperature, damping, pressure, pressure_damping, **keywords)
        self.deviatoric = False
        self.e0, self.v0, self.p0 = energy, volume, reference_pressure
        self.q, self.pe = np.zeros(40), PE()
        self._loop, self._density, self._counted = None, 0.0, []

    def settle(self, system) -> None:
        if not self.ready:
            what, lengths = f"fix {self.style}", [n for n in self.components if len(n) == 1]
            for name in self.single:
                if len(name) == 2:
                    raise InputError(f"{what}: {name} has no place here: use iso, aniso, tri, or one of x, y and z")
            flat = system.dimension == 2 and len(lengths) == 3 and self.couple != "xyz"
            if len(lengths) not in (1, 3) or flat or len({self.components[n][0] for n in lengths}) > 1:
                raise InputError(f"{what}: pressures need one target, along one of x, y and z or all (iso), got {' '.join(lengths)}")
            for name in lengths:
                if self.components[name][0] != self.components[name][1]:
                    start, stop, _ = self.components[name]
                    raise InputError(f"{what}: the start and the end of the target pressure must be equal, got {start:g} and {stop:g}")
        super().settle(system)

    @classmethod
    def from_lammps(cls, group, words, session):
        given = cls.read(words, session) | {"deviatoric": False}
        if "temperature" not in given:
            raise InputError(f"fix {cls.style} needs temp Tstart Tstop Tdamp, of which the last one is used")
        return cls.made(group, given, session)

    # ---- a run --------------------------------------------------------------------------------------------------------------------------
    @hook(uses=[*BOX, aim, first_half])
    def initial_integrate(th, s, p, a):
        q, b, e, w, m = a
        first_half(th, s, p, a)
        barrier(th)
        step_box(th, s, q, b, m)
        move_in_box(th, s, np.int32(np.int64(p[0])), q, b, m)

    @hook(uses=[*BOX, aim, first_half])
    def outer_initial(th, s, p, a):
        first_half(th, s, p, a)

    def parameters(self, loop) -> np.ndarray:
        self._loop = loop
        # a constraint has an energy in minimisations only
        self._counted = [f for f in loop.fixes if f.thermo_energy and f.style not in ("shake", "rattle")]
        p = super().parameters(loop)
        p[14] = 1.0
        self.q[AXIS] = -1 if self.q[6] != 1.0 else int(np.flatnonzero(self.b[3, :3])[0])
        return p

    def resize(self, loop) -> None:
        super().resize(loop)
        tail = bool(loop.interactions.tail and loop.engine.pair_terms)
        volume = abs(float(np.linalg.det(loop.system.box.cell)))
        self.q[TAIL] = loop.interactions.tail_correction(loop.system, loop.units)[0] * volume if tail else 0.0

    @property
    def all_plain(self) -> bool:
        return super().all_plain and not self._counted

    def reference(self, loop) -> float:
        return self.first_temperature(loop)

    def setup(self, loop) -> None:
        """The state before the shock, where it is not given; the target of the first half step of the box's chain is almost zero."""
        super().setup(loop)
        p, q, b, state = self.p, self.q, self.b, loop.snapshot()
        measure_pressure(loop.state, q, b, self.w)
        if self.v0 is None:
            self.v0 = float(q[32])
        if self.p0 is None:
            axis = int(q[AXIS])
            self.p0 = float(b[5, axis] if axis >= 0 else b[5, :3].sum() / 3.0)
        if self.e0 is None:
            later = loop.fixes[loop.fixes.index(self):]     # they have done nothing yet
            self.e0 = self._energy(state) - sum(f.scalar() for f in later if f.thermo_energy)
        q[V0], q[P0], q[E0] = self.v0, self.p0, self.e0
        u, mass = loop.units, float(loop.system.atom_masses()[loop.groups[self.group]].sum())
        self._density = u.nktv2p * u.mvv2e * mass / self.v0
        p[5] = p[6] = p[13] = FIRST_TARGET

    def aim_in_python(self, loop) -> None:
        """The target temperature where other fixes have potential energies, which count."""
        self.q[OTHER] = sum(f.scalar() for f in self._counted)
        aim(loop.state, self.p, self.q, self.b, self.w)

    # ---- outputs ------------------------------------------------------------------------------------------------------------------------
    def _energy(self, state) -> float:
        return self.pe.scalar(state) + 0.5 * self.temp.dof(state) * state.units.boltz * self.temp.scalar(state)

    def _pressure(self, state) -> float:
        axis = int(self.q[AXIS])
        return self.press.scalar(state) if axis < 0 else float(self.press.vector(state)[axis])

    def shock(self) -> tuple[float, float, float]:
        """Deviation from the target temperature, and velocities of shock and particles.

        Raises
        ------
        NotYet
            Before the first run, or on a step of which energies and pressure were not computed.
        """
        if self._loop is None:
            raise NotYet(f"fix {self.id} (style {self.style}): the state of the shock is not known before the first run: use run 0")
        state = self._loop.snapshot()
        if not state.fresh:
            raise NotYet(f"fix {self.id} (style {self.style}): energies and virial were not computed on step {state.step}")
        u, pressure, volume = state.units, self._pressure(state), self._volume(state.system.box.cell, state.dimension)
        delta = (0.5 * (pressure + self.p0) * (self.v0 - volume)) / u.nktv2p + self.e0 - self._energy(state)
        strain = 1.0 - volume / self.v0
        speed = math.sqrt((pressure - self.p0) / (self._density * strain)) if strain >= LEAST_STRAIN and pressure >= self.p0 else 0.0
        return delta / (self.temp.dof(state) * u.boltz), speed, speed * strain

    def elements(self) -> list[np.ndarray]:
        return [np.array(self.shock()), *super().elements()]

    @property
    def size(self) -> int:
        return 3 + super().size

    def modify_option(self, keyword, value, session):
        if keyword in ("e0", "v0", "p0"):
            setattr(self, keyword, number(value, f"fix_modify {keyword}"))
            return True
        return keyword not in ("temp", "press") and super().modify_option(keyword, value, session)

    def state(self) -> dict:
        """Those of the barostat, and the state before the shock."""
        return super().state() | {"e0": self.e0, "v0": self.v0, "p0": self.p0}

    def restore(self, state: dict) -> None:
        super().restore(state)
        self.e0, self.v0, self.p0 = state["e0"], state["v0"], state["p0"]
