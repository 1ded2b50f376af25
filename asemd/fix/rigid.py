r"""Groups of atoms move as rigid bodies: constant energy, by Richardson iteration.

Forces on the atoms of a body add up to a force F on its centre of mass and a torque N about it. With the mass M, the angular momentum L and
the angular velocity :math:`\omega = I^{-1} L`:

.. math:: M \dot v = F, \qquad \dot L = N, \qquad \dot q = \tfrac12 \omega q

by half steps of v and L before and after the forces. Between them the orientation q takes a whole step and two half steps at constant L,
which are extrapolated, :math:`q = 2 q_{\text{half}} - q_{\text{whole}}`, and normalised. The atoms then get the places and velocities that
the body gives them; what that does to them counts as virial. A body has six degrees of freedom (five if its atoms are on a line, three in
two dimensions). Interactions within bodies do no work; ``neigh_modify exclude`` saves their computation. Spheres and ellipsoids bring
their own moments of inertia, angular momenta and torques, and turn with the body; so do dipoles.

Source: LAMMPS manual, fix rigid. Output: the temperature of the bodies, and 15 numbers for each body, f_ID[i][j]: centre of mass, its
velocity, force, torque, image flags. ``fix rigid/small`` is the same without that array.
"""
from __future__ import annotations

import time
from typing import ClassVar

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook, rigid_file
from asemd.fix import rigid_bodies as rb
from asemd.fix.rigid_outputs import BodyOutputs
from asemd.fix.rigid_words import bodies_from_words, options_from_words, words_of
from asemd.kernels.rigid import (
    angular_velocity,
    body_turned,
    follow_box,
    gather_forces,
    kick_body,
    kick_conjugate,
    kick_level,
    langevin_bath,
    momentum_of,
    place_atoms,
    place_moved,
    turn_axes,
    turn_richardson,
    turn_solid,
)
from asemd.kernels.threads import barrier
from asemd.result import COMPONENTS
from asemd.words import bounds, yes_no

HEADER = 16     # numbers of every fix of this family before its own
ORDER = "rigid bodies must be defined before the fix that changes the box"
LEVEL = [turn_axes, angular_velocity, kick_conjugate, momentum_of, follow_box, gather_forces, kick_body, kick_level, place_atoms,
         place_moved, turn_solid, langevin_bath]
MOVE = [*LEVEL, body_turned, turn_richardson]


class Rigid(BodyOutputs):
    """Rigid bodies.

    Parameters
    ----------
    group : str
        The atoms that are in bodies.
    bodies : str or sequence of str or sequence of int
        ``single``: one body of all atoms; ``molecule``: one of each molecule; names of groups: one of each; a number for each atom of the
        system: one of each number.
    force, torque : sequence of (str or int, (bool, bool, bool))
        Components of the force on the centre of mass, and of the torque, that act, for bodies by number (``3``, ``1*5``, ``*``).
    langevin : (float, float, float, int), optional
        A heat bath: temperature at the start and at the end of a run, relaxation time, seed; temperature and time units.
    infile : str, optional
        File with mass, centre, inertia, velocity and angular momentum of bodies, see `asemd.fix.rigid_file`. Such a file, with ``.rigid``
        after its name, is then written beside each restart file.
    reinit : bool, optional
        Take the bodies from their atoms, or the file, anew at each run; by default unless there is a file.
    gravity : str, optional
        Id of a fix gravity whose field acts on the centres of mass.

    Raises
    ------
    InputError
        Bodies of one atom, atoms in two bodies, values out of their range.

    Examples
    --------
    >>> Rigid(group="water", bodies="molecule")
    """

    style = "rigid"
    integrates = True
    levels = "outermost"
    thermo_virial = True
    symplectic: ClassVar[bool] = False
    small: ClassVar[bool] = False
    thermostats: ClassVar[bool] = False
    barostats: ClassVar[bool] = False

    def __init__(self, group: str = "all", bodies="single", force=(), torque=(), langevin=None, infile: str | None = None,
                 reinit: bool | None = None, gravity: str | None = None):
        super().__init__(group)
        self.kind = bodies
        self.force, self.torque = list(force), list(torque)
        self.langevin, self.infile, self.gravity = langevin, infile, gravity
        self.reinit = infile is None if reinit is None else reinit
        if langevin is not None:
            start, stop, damping, seed = langevin
            if min(start, stop) < 0.0:
                raise InputError(f"fix {self.style} langevin: temperatures must not be negative, got {start:g} and {stop:g}")
            if not damping > 0.0:
                raise InputError(f"fix {self.style} langevin: the damping time must be positive, got {damping:g}")
            if seed <= 0:
                raise InputError(f"fix {self.style} langevin: the seed must be a positive whole number, got {seed}")
        self.early = False
        self.members: rb.Members | None = None
        self.kept: rb.Bodies | None = None       # the bodies, from the first run on
        self.p = np.zeros(HEADER)
        self.kind_words: list[str] = []
        self.warned: set[bytes] = set()
        self._warn = None
        self._loop = None

    # ---- words of scripts
    @classmethod
    def from_lammps(cls, group, words, session):
        kind, mode, rest = bodies_from_words(cls, words, session)
        options = options_from_words(cls, rest, session)
        template = options.pop("mol", "")
        fix = cls(group, kind, **options)
        if template:
            fix.template = template
        fix.kind_words, fix._warn = mode, session.warn
        session.scene.sync_groups()
        if cls.small:
            session.print(f"Fix {cls.style} setup ...")
        began = time.perf_counter()
        system = session.scene.system
        fix.define(system, {name: session.scene.groups.mask(name, f"fix {cls.style}") for name in (group, *fix.group_names)})
        if cls.small:
            session.print(f"  create bodies CPU = {time.perf_counter() - began:.3f} seconds")
        session.print(f"  {fix.members.count} rigid bodies with {len(fix.members.ids)} atoms")
        if cls.small:
            away = rb.farthest(system, fix.members) if fix.members.count else 0.0
            session.print(f"  {away:.8} = max distance from body owner to body atom")
        return fix

    def to_lammps(self) -> list[str]:
        return words_of(self)

    def own_words(self) -> list[str]:
        """Words of keywords that only some styles have."""
        return []

    @property
    def group_names(self) -> list[str]:
        return [] if isinstance(self.kind, str) or (len(self.kind) and not isinstance(self.kind[0], str)) else list(self.kind)

    def modify_option(self, keyword, value, session):
        if keyword == "virial":
            self.thermo_virial = yes_no(value, "fix_modify virial")
            return True
        if keyword == "bodyforces":
            if value not in ("early", "late"):
                raise InputError(f"fix_modify bodyforces: expected early or late, got {value!r}")
            self.early = value == "early"
            return True
        return super().modify_option(keyword, value, session)

    # ---- the bodies
    def define(self, system, masks) -> None:
        """Say which atoms are in which body; `masks` has the groups' (n,) bool by name."""
        mask = masks[self.group]
        if self.group_names:
            self.members = rb.by_groups(system.id, [masks[name] & mask for name in self.group_names], self.style)
        else:
            if isinstance(self.kind, str) and self.kind == "single":
                number = np.ones(system.n, np.int64)
            elif isinstance(self.kind, str):
                number = system.molecule
            else:
                number = np.asarray(self.kind, np.int64)
                if len(number) != system.n:
                    raise InputError(f"fix {self.style}: bodies by number needs one for each of {system.n} atoms, got {len(number)}")
                number = number - number[mask].min(initial=0) + 1
            self.members = rb.by_number(system.id[mask], number[mask])
        if self.members.count == 0 and not getattr(self, "template", ""):
            raise InputError(f"fix {self.style}: no rigid bodies defined, group {self.group} has no atoms")
        size = np.diff(self.members.first)
        if size.min(initial=2) < 2:
            k = int(np.argmin(size))
            raise InputError(f"fix {self.style}: rigid body {k + 1} has {size[k]} atom{'s' * (int(size[k]) != 1)}, it needs two or more")
        for keyword, settings in (("force", self.force), ("torque", self.torque)):
            for which, _ in settings:
                bounds(str(which), 1, self.members.count, f"fix {self.style} {keyword}")

    def prepare(self, loop) -> None:
        """The bodies as they are at the start of a run."""
        again, self._loop = loop is self._loop, loop        # in the midst of a run
        self._warn = self._warn or loop.warn
        if self.members is None:
            self.define(loop.system, loop.groups)
        self._check_order(loop)
        self.warned.clear()
        if self.kept is not None and (not self.reinit or (again and self.infile)):
            rb.follow(self.kept, loop.system.box.origin, loop.system.box.cell)
            self._wrap(loop)
            return
        bath = self.kept.bath if self.kept is not None else None
        self.kept = self._made(loop.system)
        if bath is not None:        # the last force of the bath begins the next run, too
            self.kept.bath[:] = bath
        for column, settings in ((0, self.force), (3, self.torque)):
            for which, flags in settings:
                lo, hi = bounds(str(which), 1, self.members.count, f"fix {self.style}")
                self.kept.moves[lo - 1:hi, column:column + 3] = flags
        if loop.system.dimension == 2:
            self.kept.moves[:, 2:5] = 0.0
            if any(fix.style == "enforce2d" for fix in loop.fixes):     # spheres may turn about another axis before the run
                self.kept.v[:, 2] = self.kept.momentum[:, :2] = 0.0

    def _made(self, system) -> rb.Bodies:
        """The bodies by their atoms and the file."""
        file = rigid_file.read(self.infile, self.style, self.members.label) if self.infile else None
        return rb.build(system, self.members, self.style, file)

    def write_beside(self, path: str, system, step: int) -> None:
        """The file of bodies beside a restart file, of a fix that has read one."""
        if self.infile and self.members is not None:
            bodies = self._made(system) if self.kept is None else self.bodies
            rigid_file.write(f"{path}.rigid", bodies, self.members, f"rigid bodies of fix {self.id} (style {self.style}) on step {step}")

    def goes_on(self, words: list[str], numbers) -> bool:
        """With another file too, if it has the same bodies; a file with other ones counts."""
        if not self.infile:
            return super().goes_on(words, numbers)
        mine = [str(w) for w in self.to_lammps()]
        if "infile" in words:
            words = [*words]
            words[words.index("infile") + 1] = self.infile
        return mine == words and len(numbers) == len(self.kept) and rigid_file.same(self.kept, rb.Bodies(*numbers))

    def _check_order(self, loop) -> None:
        at = loop.fixes.index(self)
        for fix in loop.fixes[:at]:
            if fix.box_moves and not isinstance(fix, Rigid):
                raise InputError(f"fix {self.id} (style {self.style}): {ORDER} {fix.id} (style {fix.style})")
        if not self.small and sum(isinstance(f, Rigid) and not f.small for f in loop.fixes) > 1:
            loop.warn("More than one fix rigid")
        if self.early and self._on_levels(loop):
            raise InputError(f"fix {self.id} (style {self.style}): fix_modify bodyforces early does not work with run_style respa")
        if self.early:
            for fix in loop.fixes[at + 1:]:
                if "post_force" in fix.hooks() and not isinstance(fix, Rigid):
                    loop.warn(f"Fix {fix.id} with style {fix.style} alters forces after fix {self.id}, which has summed them")

    def _on_levels(self, loop) -> bool:
        return loop.in_levels and loop.levels.n > 1

    def _as_lammps(self, loop) -> bool:
        """Whether the first half step of the innermost level takes the forces of another one, as in LAMMPS."""
        return loop.interactions.compat == "lammps"

    def parameters(self, loop) -> np.ndarray:
        u, p = loop.units, self.p
        start, stop, damping, seed = self.langevin or (0.0, 0.0, 1.0, 0)
        forces = 2 + self._as_lammps(loop) if self._on_levels(loop) else int(self.early)
        p[:13] = (self.symplectic, self.thermo_virial, bool(loop.engine.box_moves), forces, 0.0, seed, start, stop,
                  1.0 / (damping * u.ftm2v), 24.0 * u.boltz / (damping * u.mvv2e) / u.ftm2v**2, u.ftm2v, loop.system.dimension, u.mvv2e)
        p[13:16] = self._field(loop) if self.gravity else 0.0
        return p

    def _field(self, loop) -> np.ndarray:
        """(3,) acceleration by the fix gravity that was named."""
        found = [fix for fix in loop.fixes if fix.id == self.gravity and fix.style == "gravity"]
        if not found:
            raise InputError(f"fix {self.id} (style {self.style}) gravity: there is no fix gravity with ID {self.gravity}")
        if any(callable(value) for value in found[0].values):
            raise InputError(f"fix {self.id} (style {self.style}) gravity: the field of fix {self.gravity} changes with a variable, "
                             "which bodies cannot follow; let fix gravity act on their atoms")
        return found[0].values[0] * found[0].direction(list(found[0].values[1:]), loop.system.dimension)

    def atom_arrays(self, loop) -> rb.Bodies:
        b = self.kept
        rows = loop.system.index_of(self.members.ids)       # they change when other atoms leave
        b.rows[:] = rows
        _, spin, mu = rb.spheres(loop.system, rows)
        _, momenta, turned = rb.ellipsoids(loop.system, rows)
        self.kept = b._replace(spin=spin, mu=mu, momenta=momenta, turned=turned)
        return self.kept

    def setup(self, loop) -> None:
        """Forces and torques on the bodies, and the atoms' velocities, with twice the second half of a step's virial."""
        b, s, system = self.kept, loop.state, loop.system
        loop.sync_out()
        body = np.repeat(np.arange(len(b.mass)), np.diff(b.first))
        r, f = rb.unwrapped(system, b, body), system.f[b.rows]
        b.half_virial[:] = 0.0
        b.force[:] = np.add.reduceat(f, b.first[:-1], axis=0) + b.bath[:, :3] + b.mass[:, None] * self.p[13:16]
        b.torque[:] = np.add.reduceat(np.cross(r - b.x[body], f), b.first[:-1], axis=0) + b.bath[:, 3:]
        if (finite := rb.finite(b)).any():
            b.torque[:] += np.add.reduceat(finite[:, None] * system.extra["torque"][b.rows], b.first[:-1], axis=0)
        v = rb.velocities(b, body)
        push = (system.atom_masses()[b.rows] / (0.5 * loop.dt * self.p[10]))[:, None] * (v - system.v[b.rows]) - f
        for c, (i, j) in enumerate(COMPONENTS):
            b.virial[:, c] = r[:, i] * push[:, j]
        if self.thermo_virial:
            s.virial[0] += b.virial.sum(axis=0)
        system.v[b.rows] = v
        loop.sync_in()
        self.p[4] = 1.0

    def stop(self, system, rotation: bool) -> None:
        """Bodies of a system at rest between runs stop to move, or to turn."""
        if self.members is None:
            raise InputError(f"fix {self.id} (style {self.style}): its bodies are not known before the first run")
        b = self.kept if self.kept is not None and not self.reinit else rb.build(system, self.members, self.style)
        (b.momentum if rotation else b.v)[:] = 0.0
        body = np.repeat(np.arange(len(b.mass)), np.diff(b.first))
        system.v[b.rows] = rb.velocities(b, body)

    def post_neighbor(self, loop) -> None:
        """The box of the system is the one of the list."""
        rb.follow(self.kept, loop.system.box.origin, loop.system.box.cell)
        self._wrap(loop)

    def _wrap(self, loop) -> None:
        """Centres of mass back into the box, at list builds as the atoms."""
        b, image = self.kept, np.zeros((len(self.kept.mass), 3), np.int32)
        loop.system.box.wrap(b.x, image)
        b.image[:] += image

    # ---- the motion
    @hook(uses=MOVE)
    def initial_integrate(th, s, p, b):
        barrier(th)
        half, count = 0.5 * th.dt * p[10], b.mass.shape[0]
        whole, middle = np.empty(4), np.empty(4)
        for k in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
            if p[2] != 0.0:
                follow_box(s, b, k)
            if p[3] == 2.0:
                gather_forces(s, p, b, k, 0.0)
            for d in range(3):
                b.v[k, d] += half / b.mass[k] * b.force[k, d] * b.moves[k, d]
                b.x[k, d] += th.dt * b.v[k, d]
                b.momentum[k, d] += half * b.torque[k, d] * b.moves[k, 3 + d]
            angular_velocity(b.momentum[k], b.axes[k], b.moments[k], b.omega[k])
            turn_richardson(b.q[k], b.momentum[k], b.omega[k], b.moments[k], b.axes[k], 0.5 * th.dt, whole, middle)
            place_moved(th, s, p, b, k)
        barrier(th)

    @hook(uses=MOVE)
    def post_force(th, s, p, b):
        count = b.mass.shape[0]
        barrier(th)
        if p[4] != 0.0:         # the forces of the set-up
            barrier(th)
            p[4] = 0.0
        else:
            for k in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
                for c in range(6):
                    s.virial[th.tid, c] += p[1] * b.half_virial[k, c]
                if p[3] == 1.0:
                    if p[2] != 0.0:
                        follow_box(s, b, k)
                    langevin_bath(th, p, b, k)
                    gather_forces(s, p, b, k, 1.0)
        barrier(th)

    @hook(uses=MOVE)
    def final_integrate(th, s, p, b):
        barrier(th)
        count, sums, slow = b.mass.shape[0], np.empty(6), np.ones(4)
        share = 1.0 if p[3] == 2.0 else 0.5
        for k in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
            if p[3] != 1.0:
                if p[2] != 0.0:
                    follow_box(s, b, k)
                langevin_bath(th, p, b, k)
                gather_forces(s, p, b, k, 1.0)
            kick_body(p, b, k, 0.5 * th.dt * p[10], slow)
            place_atoms(s, b, k, 0.5 * th.dt * p[1], share, False, sums)
            if p[1] != 0.0:
                for c in range(6):
                    s.virial[th.tid, c] += sums[c]
        barrier(th)

    # ---- under run_style respa, on several levels
    @hook(uses=MOVE)
    def inner_final(th, s, p, b):
        kick_level(th, s, p, b, p[3] - 2.0, 0.5, np.ones(4))

    @hook(uses=MOVE)
    def middle(th, s, p, b):
        kick_level(th, s, p, b, p[3] - 2.0, 1.0 if p[3] == 2.0 else 0.5, np.ones(4))

    @hook(uses=MOVE)
    def outer_initial(th, s, p, b):
        kick_level(th, s, p, b, 1.0, 1.0, np.ones(4))
