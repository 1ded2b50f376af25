r"""Langevin thermostat: friction and uniform noise added to the forces; use it with fix nve.

.. math:: F_i \leftarrow F_i - \frac{m_i}{\tau_i} v_i + \sqrt{\frac{24 k_B T_0 m_i}{\tau_i \Delta t}}\, u, \quad u \in [-\tfrac12, \tfrac12)

with :math:`\tau_i` the damping time multiplied by the ratio of the atom's type (keyword ``scale``). Noise of three components per atom
and step depends on seed, step and atom only, not on threads. ``zero yes`` takes the mean of the noise away from each atom of the group.
With a temperature that takes a bias off the velocities (``fix_modify ID temp``) friction acts on what is left, and noise on the
components that are not zero. ``tally yes`` adds up the energy that friction and noise take from the atoms: the scalar of this fix
(thermo keywords ecouple, econserve).
With ``omega yes`` spheres have the same for their rotation,

.. math:: T_i \leftarrow T_i - \tfrac{10}{3} \frac{I_i}{\tau_i} \omega_i + \sqrt{\frac{80 k_B T_0 I_i}{\tau_i \Delta t}}\, u

whose factor 10/3 is that of Stokes's friction; the tally is without it. With ``angmom C`` ellipsoids have the same with the factor C (for
each component in space LAMMPS takes the moment of inertia about the axis of that number of the body, and so does this fix).

That holds for small steps. For harmonic forces of frequency :math:`\omega` the positions are too warm by the factor
:math:`1 / (1 - \omega^2 \Delta t^2 / (4 - 2 \Delta t / \tau))`, and the velocities grow without bound from
:math:`\Delta t / 2 \tau + (\omega \Delta t / 2)^2 = 1` on. With ``gjf vhalf`` or ``gjf vfull`` the steps are those of
`asemd.fix.gronbech_jensen`: positions have the right distribution at any :math:`\Delta t / \tau`. The velocities seen are then those of
half steps, right too for harmonic forces, or those at the positions, colder by :math:`(\omega \Delta t / 2)^2`. This fix comes before fix
nve then. Another way to the same end: fix baoab.

Source: T. Schneider, E. Stoll, Phys. Rev. B 17, 1302 (1978); B. Duenweg, W. Paul, Int. J. Mod. Phys. C 2, 817 (1991), for uniform noise;
LAMMPS manual, fix langevin. The noise equals LAMMPS's in distribution, the friction in every digit. Units: temperature, time.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import gronbech_jensen as gj
from asemd.fix import hook
from asemd.fix.ellipsoids import USES
from asemd.fix.formula import write
from asemd.fix.langevin_spins import check_turning, push_ellipsoids, push_spheres, spins
from asemd.fix.thermostat import Thermostat, thermal_velocities
from asemd.kernels.random import uniform
from asemd.kernels.threads import reduce_sum
from asemd.words import number, take, whole, yes_no

KEYWORDS = ("angmom", "gjf", "omega", "scale", "tally", "zero")
GJF_WORDS = {"yes": "vfull", "on": "vfull", "off": "no", "false": "no"}        # yes: the form of old versions
GJF_HOOKS = ("initial_integrate", "post_force", "end_of_step")
TYPES = 16      # ratios start here in the parameters, by atom type; type 0 has the place of a flag: velocities have a bias


def push_points(th, s, p, a):
    """Friction and noise."""
    bit, seed, step = np.int32(np.int64(p[0])), np.int64(p[1]), th.step
    tally, zero, variable, scaled, biased = p[2] != 0.0, p[3] != 0.0, p[4] != 0.0, p[10] != 0.0, p[16] != 0.0
    friction, noise = p[7], math.sqrt(p[8] / th.dt)
    done = 0.0
    if th.end != th.begin:
        done = (step - th.begin) / (th.end - th.begin)
    root = math.sqrt(p[5] + done * (p[6] - p[5]))
    mine = slice(th.lo, th.hi)
    mask, mass, row = s.mask[mine], s.mass[mine], s.row[mine]
    work = 0.0
    for d in range(3):
        total = 0.0
        if tally or variable or scaled or zero or biased:
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    ratio = p[16 + s.type[i]]
                    size = a[s.row[i], 3] if variable else root
                    v = a[s.row[i], 4 + d] if biased else s.v[d, i]
                    drag = friction * s.mass[i] / ratio * v
                    kick = noise * math.sqrt(s.mass[i] / ratio) * size * (uniform(seed, step, s.row[i], d) - 0.5)
                    if biased and v == 0.0:
                        kick = 0.0
                    s.f[d, i] += kick - drag
                    total += kick
                    if tally:
                        a[s.row[i], d] = kick - drag
        else:
            w, f = s.v[d, mine], s.f[d, mine]
            for i in range(w.size):
                kick = noise * root * math.sqrt(mass[i]) * (uniform(seed, step, row[i], d) - 0.5)
                f[i] += kick - friction * mass[i] * w[i] if mask[i] & bit != 0 else 0.0
        mean = reduce_sum(th, total) / p[9] if zero else 0.0
        if zero or tally:
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    s.f[d, i] -= mean
                    if tally:
                        a[s.row[i], d] -= mean
                        work += a[s.row[i], d] * s.v[d, i]
    if tally and step == th.begin:          # the first half step of the run
        work = reduce_sum(th, work)
        if th.tid == 0:
            p[11] = 0.5 * work * th.dt
            p[12] = work


def tally_work(th, s, p, a):
    """Energy that friction and noise of this step took."""
    bit = np.int32(np.int64(p[0]))
    work = 0.0
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            for d in range(3):
                work += a[s.row[i], d] * s.v[d, i]
    work = reduce_sum(th, work)
    if th.tid == 0:
        p[11] += work * th.dt
        p[12] = work


class Turning:
    """Hooks with ``omega yes`` or ``angmom``; `a` holds the numbers by atom, and the arrays of `asemd.fix.langevin_spins`."""

    @hook(uses=[push_points, push_spheres, push_ellipsoids, *USES])
    def post_force(th, s, p, a):
        push_points(th, s, p, a[0])
        if a[6][0] != 0.0:
            push_spheres(th, s, p, a[0], a[1], a[2])
        if a[6][1] != 0.0:
            push_ellipsoids(th, s, p, a[0], a[3], a[4], a[5], a[6][1])

    @hook(uses=[tally_work])
    def end_of_step(th, s, p, a):
        tally_work(th, s, p, a[0])


class Langevin(Thermostat):
    """Implicit solvent: friction and noise.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units of the scene; a function of the loop may return one
        number or one per atom.
    damping : float
        Relaxation time m / friction coefficient, in time units of the scene.
    seed : int
        A positive number.
    scale : dict[int, float], optional
        Atom type -> ratio that multiplies the damping time.
    tally, zero : bool
        Add up the energy; remove the mean of the noise.
    omega : bool
        Torques on spheres, too.
    angmom : float
        Torques on ellipsoids, too, times this factor; 0: none.
    gjf : str
        ``vhalf`` or ``vfull``: the discretisation of Gronbech-Jensen and Farago, with these velocities; ``no``: the plain one.

    Raises
    ------
    InputError
        A value out of its range, or at the start of a run a type that does not exist or a fix that does not go with ``gjf``.
    """

    style = "langevin"
    levels = "outermost"
    takes_bias = True

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, seed: int = 1, scale: dict[int, float] | None = None,
                 tally: bool = False, zero: bool = False, gjf: str = "no", omega: bool = False, angmom: float = 0.0):
        super().__init__(group, temperature, damping)
        if seed <= 0:
            raise InputError(f"fix langevin: seed must be a positive whole number, got {seed}")
        for kind, ratio in (scale or {}).items():
            if ratio <= 0.0:
                raise InputError(f"fix langevin: the scale ratio of type {kind} must be positive, got {ratio:g}")
        if gjf not in (*gj.VELOCITIES, "no"):
            raise InputError(f"fix langevin: gjf must be no, vhalf or vfull, got {gjf}{nearest(gjf, gj.VELOCITIES)}")
        if (omega or angmom) and gjf != "no":
            word = "omega" if omega else "angmom"
            raise InputError(f"fix langevin: {word} does not go with gjf, whose steps are for positions; leave one of the two out")
        if angmom < 0.0:
            raise InputError(f"fix langevin: the factor of angmom must not be negative, got {angmom:g}")
        self.omega, self.angmom = omega, angmom
        self.seed, self.scale, self.tally, self.zero, self.gjf = seed, dict(scale or {}), tally, zero, gjf
        self.p, self.a = np.zeros(TYPES), np.zeros((1, 4))
        if gjf != "no":
            self.levels = ""
            self.initial_integrate, self.post_force, self.end_of_step = (getattr(gj.Hooks, n) for n in GJF_HOOKS)
        elif omega or angmom:
            self.post_force, self.end_of_step = Turning.post_force, Turning.end_of_step

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) < 4:
            raise InputError(f"fix langevin needs Tstart Tstop damp seed, got {len(words)} values")
        ramp, damping = cls.read_ramp(words, session), number(words[2], "fix langevin damp")
        seed, words = whole(words[3], "fix langevin seed"), words[4:]
        scale, flags = {}, {}
        while words:
            keyword, what = words[0], f"fix langevin {words[0]}"
            if keyword not in KEYWORDS:
                raise InputError(f"fix langevin: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            values = take(words[1:], 2 if keyword == "scale" else 1, what)
            words = words[1 + len(values):]
            if keyword == "scale":
                scale[whole(values[0], what)] = number(values[1], what)
            elif keyword in ("tally", "zero"):
                flags[keyword] = yes_no(values[0], what)
            elif keyword == "gjf":
                flags["gjf"] = GJF_WORDS.get(values[0], values[0])
            elif keyword == "omega":
                flags["omega"] = yes_no(values[0], what)
            elif values[0] != "no":
                flags["angmom"] = number(values[0], what)
        return cls(group, ramp, damping, seed, scale, **flags)

    def to_lammps(self) -> list[str]:
        words = [write(self.start), repr(self.stop), repr(self.damping), str(self.seed)]
        for kind, ratio in self.scale.items():
            words += ["scale", str(kind), repr(ratio)]
        words += ["tally", "yes"] * self.tally + ["zero", "yes"] * self.zero
        return words + ["gjf", self.gjf] * (self.gjf != "no") + ["omega", "yes"] * self.omega + (
            ["angmom", repr(self.angmom)] if self.angmom else [])

    def parameters(self, loop) -> np.ndarray:
        ntypes, u = loop.system.counts["ntypes"], loop.units
        wrong = [kind for kind in self.scale if not 1 <= kind <= ntypes]
        if wrong:
            raise InputError(f"fix langevin: scale names atom type {wrong[0]}, there are types 1 to {ntypes}")
        check_turning(self, loop)
        if loop.dt == 0.0:
            raise InputError("fix langevin: noise grows without bound as time steps become short, and timestep is 0")
        ratios = [float(self.temp.bias)] + [self.scale.get(kind, 1.0) for kind in range(1, ntypes + 1)]
        constant = not callable(self.start)
        ramp = (self.start, self.stop) if constant else (0.0, 0.0)
        friction, noise = 1.0 / (self.damping * u.ftm2v), 24.0 * u.boltz / (self.damping * u.mvv2e) / u.ftm2v**2
        if self.gjf != "no":
            gj.check_order(self, loop.fixes)
            friction, noise = 1.0 / self.damping, u.boltz / u.mvv2e
        self.p = np.array([loop.group_bit(self.group), self.seed, self.tally, self.zero, not constant, *ramp, friction, noise,
                           max(np.count_nonzero(loop.groups[self.group]), 1), bool(self.scale), *self.p[11:13], loop.dt,
                           u.mvv2e, self.gjf == "vhalf", *ratios], dtype=float)
        return self.p

    def atom_arrays(self, loop):
        """Columns: added force (for the tally), square root of the target temperature (for a variable), velocity without the bias; with
        ``omega`` or ``angmom`` what turns besides."""
        if self.gjf != "no":
            if self.a.shape != (loop.system.n, gj.COLUMNS):
                self.a = np.full((loop.system.n, gj.COLUMNS), gj.NONE)
            self.a[:, 9] = 0.0
        elif self.tally or self.follows:
            self.a = np.zeros((loop.system.n, 7))
        elif self.omega or self.angmom:
            self.a = np.zeros((1, 7))
        else:
            return None
        if self.follows:
            self._follow(loop)
        return (self.a, *spins(self, loop.system.extra)) if self.omega or self.angmom else self.a

    def resize(self, loop) -> None:
        self.p[9] = max(np.count_nonzero(loop.groups[self.group]), 1)

    @property
    def follows(self) -> bool:
        """Whether the target comes from a variable, or velocities without a bias are needed: both are found in Python each step."""
        return callable(self.start) or self.temp.bias

    def _follow(self, loop) -> None:
        if callable(self.start):
            self.a[:, 3 if self.gjf == "no" else 10] = np.sqrt(self.target(loop))
        if self.temp.bias:
            self.a[:, 4:7] = thermal_velocities(loop, self.temp)

    post_force, end_of_step = hook(push_points), hook(tally_work)

    def modify_option(self, keyword, value, session):
        before, known = self.temp, super().modify_option(keyword, value, session)
        if self.gjf != "no" and self.temp.bias:
            self.temp = before
            raise InputError(f"fix_modify temp: fix langevin with gjf takes no temperature with a bias, {value} has one; use gjf no")
        return known

    def hooks(self) -> dict[str, bool]:
        vars(self).pop("pre_force", None)
        if self.follows:
            self.pre_force = self._follow
        hooks = super().hooks()
        if not self.tally and self.gjf != "vhalf":
            del hooks["end_of_step"]
        return hooks

    def scalar(self) -> float:
        """Energy given to the heat bath since the start of the run, energy units; 0 without ``tally yes``."""
        return -float(self.p[11] - 0.5 * self.p[12] * self.p[13])

    def state(self) -> dict:
        """Of ``gjf vhalf`` the velocities at the positions, which are not those that the atoms have after a run."""
        return {"velocities": self.a[:, 3:9].copy()} if self.gjf == "vhalf" and self.a.shape[1] == gj.COLUMNS else {}

    def restore(self, state: dict) -> None:
        """Velocities that are not those of the atoms any more are not used."""
        if "velocities" in state:
            self.a = np.full((len(state["velocities"]), gj.COLUMNS), gj.NONE)
            self.a[:, 3:9] = state["velocities"]
