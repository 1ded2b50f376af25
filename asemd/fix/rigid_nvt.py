r"""Rigid bodies at constant temperature: two Nose-Hoover chains, one for translation and one for rotation.

.. math:: \dot v = \frac{F}{M} - v\,\dot\eta_1, \qquad \dot P = \frac{\partial P}{\partial t}\Big|_{\text{free}} - P\,\dot\xi_1, \qquad
          Q_1 \ddot\eta_1 = \sum M v^2 - f_t k_B T_0 - Q_1\dot\eta_1\dot\eta_2

and the same for :math:`\xi` with the rotational energy and its degrees of freedom. Masses: :math:`Q_1 = f k_B T_0 \tau^2`, :math:`Q_k = k_B
T_0 \tau^2`. Rotations as in `asemd.fix.rigid_nve`; the chains take Suzuki-Yoshida sub-steps of order 3 or 5. Under ``run_style respa``
chains and box move with the innermost level; the pressure pushes the box on the outermost one.

Source: H. Kamberaj, R.-J. Low, M. P. Neal, J. Chem. Phys. 122, 224114 (2005); LAMMPS manual, fix rigid/nvt. Output: the array of fix rigid;
the scalar is, as in LAMMPS, the energy of the chains (and of the barostat) plus the temperature of the bodies, or for the ``/small`` styles
plus the energy of rotation and twice that of translation.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute.pressure import Pressure
from asemd.compute.temp import Temp
from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.measured import take_pressure, take_temperature
from asemd.fix.rigid_nve import MOVE, RigidNVE
from asemd.kernels.box import follow
from asemd.kernels.rigid_bath import (
    body_barostat_step,
    body_couple_pressure,
    body_inward,
    body_outward,
    body_push_box,
    body_ramp,
    body_scale_box,
    body_sinh_ratio,
    body_slowing,
    body_strain,
    body_thermostat_step,
)
from asemd.kernels.threads import barrier, reduce_sum

CHAINS = 80         # first number of the chains in ``p``
COUPLE = ("none", "xyz", "xy", "yz", "xz")
CUBE, FOURTH = 2.0 ** (1.0 / 3.0), 4.0 ** (1.0 / 3.0)
WEIGHTS = {3: (1.0 / (2.0 - CUBE), 1.0 - 2.0 / (2.0 - CUBE), 1.0 / (2.0 - CUBE)),
           5: (1.0 / (4.0 - FOURTH), 1.0 / (4.0 - FOURTH), 1.0 - 4.0 / (4.0 - FOURTH), 1.0 / (4.0 - FOURTH), 1.0 / (4.0 - FOURTH))}
ALL = [*MOVE, follow, body_sinh_ratio, body_slowing, body_ramp, body_inward, body_outward, body_thermostat_step,
       body_barostat_step, body_couple_pressure, body_strain, body_push_box, body_scale_box]


class RigidNVT(RigidNVE):
    """Rigid bodies with a thermostat.

    Parameters
    ----------
    temperature : float or (float, float)
        Target, or target at the start and at the end of a run, temperature units.
    damping : float
        Relaxation time, time units.
    chain, loops, order : int
        Length of the chains, sub-steps, and order (3 or 5) of the splitting.
    pressure : dict
        Of the styles with a barostat: direction x, y or z -> (pressure at start, at stop, relaxation time), pressure and time units.
    couple : str
        Which directions change together: none, xyz, xy, yz, xz.
    pressure_chain : int
        Length of the barostat's chain.
    dilate : str
        Group of the atoms whose positions follow the box.
    group, bodies, force, torque, infile, reinit
        See `asemd.fix.rigid.Rigid`.
    """

    style = "rigid/nvt"
    thermostats = True
    ecouple = True

    def __init__(self, group="all", bodies="single", temperature=None, damping: float = 100.0, pressure=None, couple: str = "none",
                 chain: int = 10, loops: int = 1, order: int = 3, pressure_chain: int = 10, dilate: str = "all", **options):
        super().__init__(group, bodies, **options)
        what, self.damping = f"fix {self.style}", damping
        if self.thermostats:
            if temperature is None:
                raise InputError(f"{what} needs temp Tstart Tstop Tdamp")
            self.start, self.stop = temperature if isinstance(temperature, tuple) else (temperature, temperature)
            if min(self.start, self.stop) <= 0.0 or not damping > 0.0:
                raise InputError(f"{what}: target temperatures and Tdamp must be above 0, got {self.start:g} {self.stop:g} {damping:g}")
        else:
            self.start = self.stop = 0.0
        if min(chain, loops, pressure_chain) < 1 or order not in WEIGHTS:
            raise InputError(f"{what}: tparam needs a chain of at least 1, at least 1 iteration and order 3 or 5, got {chain} {loops} "
                             f"{order}, pchain {pressure_chain}")
        self.chain, self.loops, self.order, self.pressure_chain = chain, loops, order, pressure_chain
        self.pressure, self.couple, self.dilate = dict(pressure or {}), couple, dilate
        if self.barostats:
            self._check_pressure(what)
            self.box_moves, self.virial_every = "size", 1
        self.temp = Temp()
        self.press = Pressure("all", self.temp, ())
        self.p = np.zeros(CHAINS + 8 * chain + 4 * pressure_chain)

    def _check_pressure(self, what: str) -> None:
        if not self.pressure:
            raise InputError(f"{what} needs iso, aniso, x, y or z with Pstart Pstop Pdamp")
        for axis, (_, _, damping) in self.pressure.items():
            if not damping > 0.0:
                raise InputError(f"{what} {axis}: Pdamp must be positive, got {damping:g}")
        if self.couple not in COUPLE:
            raise InputError(f"{what} couple: expected one of {' '.join(COUPLE)}, got {self.couple!r}")
        axes = "" if self.couple == "none" else self.couple
        given = {self.pressure.get(axis) for axis in axes if axis in self.pressure or axis != "z" or axes != "xyz"}
        if None in given or len(given) > 1:
            raise InputError(f"{what} couple {self.couple}: {' and '.join(axes)} must have the same Pstart Pstop Pdamp")

    def own_words(self) -> list[str]:
        words = ["temp", repr(self.start), repr(self.stop), repr(self.damping)] if self.thermostats else []
        if self.thermostats:
            words += ["tparam", str(self.chain), str(self.loops), str(self.order)]
        for axis, values in self.pressure.items():
            words += [axis, *(repr(float(v)) for v in values)]
        if self.pressure:
            words += ["couple", self.couple, "pchain", str(self.pressure_chain)] + (["dilate", self.dilate] if self.dilate != "all" else [])
        return words

    def modify_option(self, keyword, value, session):
        if self.barostats and keyword in ("temp", "press"):
            found = session.scene.computes.get(value)
            if keyword == "temp" and type(found) is Temp:
                take_temperature(self, found, session)
                return True
            if keyword == "press" and type(found) is Pressure and type(found.temperature) is Temp and found.terms == self.press.terms:
                take_pressure(self, value, session)
                return True
            wanted = "temp" if keyword == "temp" else "pressure"
            raise InputError(f"fix_modify {keyword}: fix {self.style} takes a compute of style {wanted} with all terms, {value} is "
                             f"{'not defined' if found is None else f'of style {found.style}'}")
        return super().modify_option(keyword, value, session)

    def prepare(self, loop) -> None:
        box = loop.system.box
        if self.barostats and (box.triclinic or not box.is_lammps_frame or box.cell[~np.eye(3, dtype=bool)].any()):
            raise InputError(f"fix {self.style}: the box must have its edges along x, y and z")
        for axis in self.pressure:
            if not box.periodic["xyz".index(axis)]:
                raise InputError(f"fix {self.style}: direction {axis} is not periodic, its pressure cannot be controlled")
            if axis == "z" and loop.system.dimension == 2:
                raise InputError(f"fix {self.style}: there is no pressure in z in two dimensions")
        super().prepare(loop)

    def _as_lammps(self, loop) -> bool:
        return False        # its chains, too, would take several times their steps

    def parameters(self, loop) -> np.ndarray:
        p, b, u, d = super().parameters(loop), self.kept, loop.units, loop.system.dimension
        nf_t = d * len(b.mass)
        nf_r = np.count_nonzero(b.moments) if d == 3 else np.count_nonzero(b.moments[:, 2])
        p[16:24] = self.thermostats, self.barostats, self.start, self.stop, 1.0 / self.damping, self.chain, self.loops, self.order
        p[24:27] = nf_t, nf_r, u.boltz
        couple = "none" if self.couple == "xyz" and d == 2 and "z" in self.pressure else self.couple
        p[31:34] = COUPLE.index(couple), couple == "xyz" or (d == 2 and couple == "xy"), max(len(self.pressure), 1)
        for k, axis in enumerate("xyz"):
            if axis in self.pressure:
                start, stop, damping = self.pressure[axis]
                p[34 + k], p[37 + k], p[40 + k], p[43 + k] = 1.0, start, stop, 1.0 / damping
        p[55:58] = p[43:46].max(), self.pressure_chain, u.nktv2p
        p[59:61] = loop.group_bit(self.dilate), loop.group_bit(self.press.temperature.group)
        p[66:66 + self.order] = WEIGHTS[self.order]
        return p

    def setup(self, loop) -> None:
        """Targets, masses of the chains, and the first push of the barostat."""
        super().setup(loop)
        p, b, n = self.p, self.kept, self.chain
        done = (loop.step - loop.begin) / (loop.end - loop.begin) if loop.end != loop.begin else 0.0
        p[27] = self.start + done * (self.stop - self.start)
        p[28], p[29] = (b.mass * (b.v**2).sum(axis=1)).sum(), (b.momentum * b.omega).sum()
        if self.barostats:
            loop._collect()
            self._first_push(loop, done)
        if self.thermostats:
            kt = p[26] * p[27]
            for at, dof in ((CHAINS, p[24]), (CHAINS + 4 * n, p[25])):
                rate, mass = p[at + n:at + 2 * n], p[at + 3 * n:at + 4 * n]
                mass[:] = kt * self.damping**2
                mass[0] *= dof
                p[at + 2 * n + 1:at + 3 * n] = (mass[:-1] * rate[:-1] ** 2 - kt) / mass[1:]

    def _first_push(self, loop, done: float) -> None:
        p, snapshot, d = self.p, loop.snapshot(), loop.system.dimension
        if not self.thermostats:
            p[27] = self.temp.scalar(snapshot) or (1.0 if loop.system.units == "lj" else 300.0)
        kt, n = p[26] * p[27], self.pressure_chain
        with np.errstate(divide="ignore"):
            p[52:55] = np.where(p[34:37] != 0.0, (p[24] + p[25] + d) * kt / p[43:46] ** 2, 0.0)
        h = loop.state.box.vectors
        volume = float(np.prod(np.diag(h)[:d]))
        p[46:49] = math.log(volume) / d
        tail = loop.result.virial_of.get("tail")
        p[58] = 0.0 if tail is None else tail[0] * volume
        at = CHAINS + 8 * self.chain
        rate, mass = p[at + n:at + 2 * n], p[at + 3 * n:at + 4 * n]
        mass[:] = kt / p[55] ** 2
        mass[0] *= d * d
        p[at + 2 * n + 1:at + 3 * n] = (mass[:-1] * rate[:-1] ** 2 - kt) / mass[1:]
        measured = self.press.vector(snapshot)[:3].copy()
        body_couple_pressure(p, measured)
        p[61:64] = p[34:37] * (p[37:40] + done * (p[40:43] - p[37:40]))
        p[64] = p[61:64].sum() / p[33]
        body_strain(p, measured, volume, 0.5 * loop.dt)

    @hook(uses=ALL)
    def initial_integrate(th, s, p, b):
        barrier(th)
        half, quarter, count = 0.5 * th.dt * p[10], 0.5 * th.dt, b.mass.shape[0]
        slow, move, n = np.empty(4), np.empty(3), int(p[21])
        body_slowing(p, quarter, slow)
        for d in range(3):
            y = quarter * p[49 + d]
            move[d] = th.dt * math.exp(y) * body_sinh_ratio(y) if p[17] != 0.0 else th.dt
        lo, hi = count * th.tid // th.nth, count * (th.tid + 1) // th.nth
        twice_t, twice_r = 0.0, 0.0
        for k in range(lo, hi):
            if p[2] != 0.0:
                follow_box(s, b, k)
            if p[3] == 2.0:
                gather_forces(s, p, b, k, 0.0)
            for d in range(3):
                b.v[k, d] = (b.v[k, d] + half / b.mass[k] * b.force[k, d] * b.moves[k, d]) * slow[d]
                twice_t += b.mass[k] * b.v[k, d] * b.v[k, d]
                b.x[k, d] += move[d] * b.v[k, d]
                b.torque[k, d] *= b.moves[k, 3 + d]
            kick_conjugate(b.p[k], b.q[k], b.axes[k], b.torque[k], 2.0 * half)
            for d in range(4):
                b.p[k, d] *= slow[3]
            turn_symplectic(b.p[k], b.q[k], b.moments[k], th.dt)
            turn_axes(b.q[k], b.axes[k])
            momentum_of(b.p[k], b.q[k], b.axes[k], b.momentum[k])
            angular_velocity(b.momentum[k], b.axes[k], b.moments[k], b.omega[k])
            for d in range(3):
                twice_r += b.momentum[k, d] * b.omega[k, d]
        twice_t, twice_r = reduce_sum(th, twice_t), reduce_sum(th, twice_r)
        if th.tid == 0:
            p[28], p[29] = twice_t, twice_r
            if p[16] != 0.0:
                p[27] = body_ramp(th, p[18], p[19])
                body_thermostat_step(th, p, 80, p[24], twice_t * p[12])
                if p[25] > 0.0:
                    body_thermostat_step(th, p, 80 + 4 * n, p[25], twice_r * p[12])
        barrier(th)
        if p[17] != 0.0:
            body_scale_box(th, s, p, quarter)
        for k in range(lo, hi):
            if p[17] != 0.0:
                follow_box(s, b, k)
            place_moved(th, s, p, b, k)
        barrier(th)
        if p[17] != 0.0:
            body_scale_box(th, s, p, quarter)
            if th.tid == 0:
                body_barostat_step(th, p)
            barrier(th)

    @hook(uses=ALL)
    def final_integrate(th, s, p, b):
        barrier(th)
        quarter, count, sums, slow = 0.5 * th.dt, b.mass.shape[0], np.empty(6), np.ones(4)
        share, twice_t, twice_r = 0.5, 0.0, 0.0
        if p[3] < 2.0:
            body_slowing(p, quarter, slow)
        else:               # of several levels the innermost one has the baths
            share = 1.0
        for k in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
            if p[3] != 1.0:
                if p[2] != 0.0:
                    follow_box(s, b, k)
                gather_forces(s, p, b, k, 1.0)
            kick_body(p, b, k, 0.5 * th.dt * p[10], slow)
            for d in range(3):
                twice_t += b.mass[k] * b.v[k, d] * b.v[k, d]
                twice_r += b.momentum[k, d] * b.omega[k, d]
            place_atoms(s, b, k, 0.5 * th.dt * p[1], share, False, sums)
            if p[1] != 0.0:
                for c in range(6):
                    s.virial[th.tid, c] += sums[c]
        barrier(th)
        if p[17] != 0.0:
            twice_t, twice_r = reduce_sum(th, twice_t), reduce_sum(th, twice_r)
            bit, mine = np.int32(np.int64(p[60])), slice(th.lo, th.hi)
            mask, mass, kinetic = s.mask[mine], s.mass[mine], np.empty(3)
            for d in range(3):
                v, total = s.v[d, mine], 0.0
                for i in range(v.size):
                    total += mass[i] * v[i] * v[i] if mask[i] & bit != 0 else 0.0
                kinetic[d] = p[12] * reduce_sum(th, total)
            if th.tid == 0:
                p[28], p[29] = twice_t, twice_r
                body_push_box(th, s, p, kinetic, quarter)
            barrier(th)

    @hook(uses=ALL)
    def inner_final(th, s, p, b):
        slow = np.empty(4)
        body_slowing(p, 0.5 * th.dt, slow)
        kick_level(th, s, p, b, 0.0, 0.5, slow)

    def _bodies_energy(self) -> float:
        """The part of the scalar that LAMMPS adds to the energy of the chains."""
        if self.small:
            translation, rotation = (e.sum() for e in self.bodies_energies())
            return float(2.0 * translation + rotation)
        return RigidNVE.scalar(self)

    def scalar(self) -> float:
        """Energy of the chains and the barostat, energy units, plus what LAMMPS adds."""
        p, kt, total = self.p, self.p[26] * self.p[27], self._bodies_energy()
        n = self.chain
        if self.thermostats:
            for at, dof in ((CHAINS, p[24]), (CHAINS + 4 * n, p[25])):
                eta, rate, mass = p[at:at + n], p[at + n:at + 2 * n], p[at + 3 * n:at + 4 * n]
                total += kt * (dof * eta[0] + eta[1:].sum()) + 0.5 * (mass * rate**2).sum()
        if self.barostats:
            h, d, m, at = self._loop.state.box.vectors, int(p[11]), self.pressure_chain, CHAINS + 8 * n
            eta, rate, mass = p[at:at + m], p[at + m:at + 2 * m], p[at + 3 * m:at + 4 * m]
            total += 0.5 / p[33] * (p[52:55] * p[49:52] ** 2).sum() + p[61:64].sum() / 3.0 * np.prod(np.diag(h)[:d]) / p[57]
            total += kt * eta.sum() + 0.5 * (mass * rate**2).sum()
        return float(total)

    def state(self) -> dict:
        """Positions and rates of the chains and the strain rates of the box."""
        return {"chain": self.chain, "pressure_chain": self.pressure_chain, "numbers": self.p[CHAINS:].copy(),
                "strain": self.p[46:52].copy()}

    def restore(self, state: dict) -> None:
        """Of chains of another length nothing is taken."""
        if (state["chain"], state["pressure_chain"]) == (self.chain, self.pressure_chain):
            self.p[CHAINS:], self.p[46:52] = state["numbers"], state["strain"]
