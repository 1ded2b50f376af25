r"""Hold bonds and angles at their rest values: SHAKE. Fast vibrations of light atoms are gone, so timesteps can be longer.

.. math:: F_i \leftarrow F_i + \sum_k \pm\lambda_k r_k, \qquad |r_k(t + \Delta t)| = d_k

Clusters of 2, 3 or 4 atoms are held: a central atom bonded to 1, 2 or 3 others, or bonded to 2 others with the angle between them. The
bonds of the given types ``b``, of atoms of types ``t`` or masses ``m`` (within 0.1) are held if both atoms are in the group, angles of the
types ``a`` if both their bonds are. They are turned off as bonds and angles: their energy does not count. The forces along the old bond
vectors are iterated until none changes the positions by more than the tolerance (`asemd.fix.constraint_solver`); the method, the number of
iterations and the stopping rule are LAMMPS's, so trajectories agree at any tolerance. At the start of a run positions are moved onto the
constraints. Put this fix after those that change forces. Under ``run_style respa`` each level has such forces, for the next step of the
innermost one.

Each distance takes a degree of freedom from the temperature; the forces count in the virial (``fix_modify virial no``: not). During
minimisation a distance is held by a spring, :math:`E = K (r - d)^2` with K of the keyword ``kbond`` (default :math:`10^9 k_B`); this energy
is the scalar of the fix and counts in the potential energy.

``settle yes`` solves clusters with an angle, equal bonds and ends of equal mass (water) at once, to the last digits: SETTLE, at any
tolerance. That keyword is an extension: LAMMPS does not know it.

Source: J.-P. Ryckaert, G. Ciccotti, H. J. C. Berendsen, J. Comput. Phys. 23, 327 (1977); LAMMPS manual, fix shake.
Output: a scalar, the energy of the springs.
"""
from __future__ import annotations

import time

import numpy as np

from asemd.errors import InputError, SimulationError, nearest
from asemd.fix import Fix, hook
from asemd.fix import constraint_clusters as cc
from asemd.fix.constraint_levels import PART, OnLevels
from asemd.fix.constraint_solver import POSITIONS, add_virials, hold_positions
from asemd.words import number, take, whole, yes_no

LISTS = {"b": "bonds", "a": "angles", "t": "atoms", "m": "masses"}
KEYWORDS = (*LISTS, "kbond", "mol", "settle")
BROKEN = 0.1        # relative error of a distance that no sound run has
BELOW, SINGULAR = 6, 7     # places in p: counts of determinants below 0; at 0


class Shake(OnLevels, Fix):
    """Constraints on bonds and angles.

    Parameters
    ----------
    group : str
        The atoms whose bonds are held, if both are in it.
    tolerance : float
        The iteration stops when no multiplier changes by more than this (in mass units; positions change by it times bond length over
        mass).
    iterations : int
        At most so many.
    every : int
        Steps between statistics of bond lengths and angles; 0: none.
    bonds, angles, atoms : sequence of int
        Types of bonds, angles and atoms whose bonds (and angles) are held.
    masses : sequence of float
        Masses of atoms whose bonds are held, mass units.
    spring : float, optional
        Energy over distance squared, for minimisations; by default 10^9 times the Boltzmann constant.
    settle : bool
        Solve rigid triangles in one go, without iterations.

    Raises
    ------
    InputError
        Nothing to hold, negative numbers. In a run: bonds that form no small clusters, a style without a rest length, two such fixes.

    Examples
    --------
    >>> Shake(bonds=[1], angles=[1], tolerance=1e-5, settle=True)
    """

    style = "shake"
    verb = "SHAKE"
    minimizes = True
    thermo_energy = thermo_virial = True
    first_part = 0.5        # of dt^2, for which the forces of the set-up act
    part = 1.0              # those of all other steps

    def __init__(self, group: str = "all", tolerance: float = 1e-4, iterations: int = 20, every: int = 0, bonds=(), angles=(), atoms=(),
                 masses=(), spring: float | None = None, settle: bool = False):
        super().__init__(group)
        if not (len(bonds) or len(atoms) or len(masses) or len(angles)):
            raise InputError(f"fix {self.style}: name bonds (b), angles (a), atom types (t) or masses (m) to be held")
        if spring is not None and spring < 0.0:
            raise InputError(f"fix {self.style}: kbond must not be negative, got {spring:g}")
        if any(m == 0.0 for m in masses):
            raise InputError(f"fix {self.style}: a mass (m) must not be 0")
        self.chosen = cc.Chosen(tuple(bonds), tuple(angles), tuple(atoms), tuple(float(m) for m in masses))
        self.tolerance, self.iterations, self.output, self.spring, self.settle = float(tolerance), iterations, max(every, 0), spring, settle
        self.every, self.template = max(every, 1), ""
        self.lasting = False        # of a script: the clusters are those there were when the fix was made
        self.clusters = self.ids = cc.Clusters(np.zeros((0, 4), int), np.zeros(0, int), np.zeros((0, 3), int))
        self.distances = np.zeros((0, 3))
        self.came = np.zeros(0, np.int64)       # ids of atoms that came since the run began
        self._energy, self._told, self.p = 0.0, -1, np.zeros(9)

    # ---- text ---------------------------------------------------------------------------------------------------------------------------
    @classmethod
    def from_lammps(cls, group, words, session):
        what, began = f"fix {cls.style}", time.perf_counter()
        if len(words) < 5:
            raise InputError(f"{what} needs tol iter N and what is held (b, a, t or m with values), got {' '.join(words) or 'nothing'}")
        system = session.scene.system
        if not system.molecular:
            raise InputError(f"{what}: atom_style {system.atom_style} has no bonds")
        options = {"tolerance": number(words[0], f"{what} tol"), "iterations": whole(words[1], f"{what} iter"),
                   "every": whole(words[2], f"{what} N")}
        lists, words, mode, template = {name: [] for name in LISTS.values()}, words[3:], "", ""
        while words and words[0] not in ("mol", "kbond", "settle"):
            word, words = words[0], words[1:]
            if word in LISTS:
                mode = word
            elif not mode:
                raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
            elif mode == "m":
                lists["masses"].append(number(word, f"{what} m"))
            else:
                kind, count = {"b": ("bond", "nbondtypes"), "a": ("angle", "nangletypes"), "t": ("atom", "ntypes")}[mode]
                value = next((t for t, label in system.labels[kind].items() if label == word), None) or whole(word, f"{what} {mode}")
                if not 1 <= value <= system.counts[count]:
                    raise InputError(f"{what}: there is no {kind} type {value} ({mode}); there are {system.counts[count]}")
                lists[LISTS[mode]].append(value)
        while words:
            if words[0] not in ("mol", "kbond", "settle"):
                raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], KEYWORDS)}"
                                 + (f"; {' '.join(LISTS)} come before kbond and mol" if words[0] in LISTS else ""))
            value = take(words[1:], 1, f"{what} {words[0]}")[0]
            if words[0] == "kbond":
                options["spring"] = number(value, f"{what} kbond")
            elif words[0] == "settle":
                options["settle"] = yes_no(value, f"{what} settle")
            else:
                if value not in session.scene.molecules:
                    raise InputError(f"{what} mol: there is no molecule {value}{nearest(value, session.scene.molecules)}")
                if any(key not in one.shake for one in session.scene.molecules[value] for key in ("flag", "atoms", "types")):
                    raise InputError(f"{what} mol: molecule {value} must have shake info: sections Shake Flags, Shake Atoms and Shake Bond "
                                     "Types")
                template = value
            words = words[2:]
        fix = cls(group, **options, **lists)
        fix.template = template
        session.print(f"Finding {cls.verb} clusters ...")
        found = cc.find(system, session.scene.groups.mask(group), fix.chosen, what)
        fix.clusters, fix.ids, fix.lasting = found, cc.by_id(found, system), True
        cc.switch(system, found, False)
        for kind, name in ((cc.PAIR, "# of size 2 clusters"), (cc.TWO, "# of size 3 clusters"), (cc.THREE, "# of size 4 clusters"),
                           (cc.ANGLE, "# of frozen angles")):
            session.print(f"{found.count(kind):8d} = {name}")
        session.print(f"  find clusters CPU = {time.perf_counter() - began:.3f} seconds")
        return fix

    def to_lammps(self) -> list[str]:
        words = [repr(self.tolerance), str(self.iterations), str(self.output)]
        for mode, name in LISTS.items():
            values = [repr(v) if mode == "m" else str(v) for v in getattr(self.chosen, name)]
            words += [mode, *values] if values else []
        words += ["mol", self.template] if self.template else []
        words += ["kbond", repr(float(self.spring))] if self.spring is not None else []
        return words + (["settle", "yes"] if self.settle else [])

    # ---- what is held -------------------------------------------------------------------------------------------------------------------
    def join(self, loop) -> None:
        what, system = f"fix {self.style}", loop.system
        if sum(f.style == self.style for f in loop.fixes) > 1:
            raise InputError(f"{what}: there can be only one, list all bonds and angles there")
        if self.lasting:
            self.clusters = self._rows(system)
        else:
            self.clusters = cc.find(system, loop.groups[self.group], self.chosen, what)
            self.ids = cc.by_id(self.clusters, system)
        cc.switch(system, self.clusters, False)         # of a script they are off already, unless the system is another one
        self.distances = cc.lengths(self.clusters, loop.interactions, what)
        if self.settle:
            self._mark_rigid(system)
        self._arrays(system)

    def _arrays(self, system) -> None:
        c, self._listed = self.clusters, system.id
        self.a = (np.ascontiguousarray(c.atoms, np.int32), c.kind.astype(np.int32), self.distances, np.zeros((len(c.kind), 6)))

    def _rows(self, system) -> cc.Clusters:
        """The clusters of `ids` by row; those of which no atom is there any more are forgotten."""
        stay = np.isin(self.ids.atoms, system.id).any(axis=1)
        if not stay.all():
            self.ids = cc.Clusters(self.ids.atoms[stay], self.ids.kind[stay], self.ids.types[stay])
        order = np.argsort(system.id)
        ids = self.ids.atoms
        at = order[np.minimum(np.searchsorted(system.id, ids, sorter=order), system.n - 1)] if system.n else np.zeros_like(ids)
        missing = (ids >= 0) & (system.id[at] != ids) if system.n else ids >= 0
        if missing.any():
            torn = np.flatnonzero(missing.any(axis=1))[0]
            raise InputError(f"fix {self.style}: atoms {' '.join(str(i) for i in ids[torn] if i >= 0)} are held together, but not all of "
                             "them are there any more: give the fix again")
        return cc.Clusters(np.where(ids >= 0, at, -1), self.ids.kind.copy(), self.ids.types)

    def held_pairs(self, system) -> np.ndarray:
        """(k, 2) rows of the atoms whose distances are held, for a fix of a script."""
        return self._rows(system).pairs()[2]

    def _mark_rigid(self, system) -> None:
        c, d, mass = self.clusters, self.distances, system.atom_masses()
        angled = c.kind == cc.ANGLE
        same = (d[:, 0] == d[:, 1]) & (mass[c.atoms[:, 1]] == mass[c.atoms[:, 2]])
        c.kind[angled & same] = cc.RIGID

    def detach(self, system) -> None:
        cc.switch(system, self._rows(system), True)

    def removed_dof(self, mask: np.ndarray) -> float:
        """A degree of freedom for each distance of the clusters whose central atom is in `mask`."""
        centre = self.clusters.atoms[:, 0]
        there = centre < len(mask)
        return float(cc.HELD[self.clusters.kind[there]][mask[centre[there]]].sum())

    def added_dof(self, mask: np.ndarray) -> float:
        rows = self.clusters.atoms[np.isin(self.ids.atoms, self.came)]
        new = np.zeros(len(mask), bool)
        new[rows[(rows >= 0) & (rows < len(mask))]] = True
        return self.removed_dof(mask & new)

    # ---- a run --------------------------------------------------------------------------------------------------------------------------
    def parameters(self, loop) -> np.ndarray:
        vars(self).pop("post_force", None)
        if self.minimizing:
            self.post_force = self._springs
        self.p = np.array([loop.group_bit(self.group), self.part, self.tolerance, self.iterations, 1.0 / loop.units.ftm2v,
                           loop.engine.ortho,  0.0, 0.0, self.thermo_virial], dtype=float)
        return self.p

    def atom_arrays(self, loop):
        """Clusters by row, their kinds, distances, and virials."""
        if loop.system.id is not self._listed:        # some have left or joined
            self.clusters = self._rows(loop.system)
            self.distances = cc.lengths(self.clusters, loop.interactions, f"fix {self.style}")
            if self.settle:
                self._mark_rigid(loop.system)
            self._arrays(loop.system)
        return self.a

    def take_in(self, system, atoms, molecule, matrices, aside=0.0) -> None:
        """Hold copies of a template whose `atoms`, with their ids, are about to join the system."""
        self.came = np.append(self.came, atoms.id)
        new = cc.of_template(molecule, atoms.id.reshape(-1, molecule.natoms))
        self.ids = cc.Clusters(*(np.concatenate([getattr(c, name) for c in (self.ids, new)]) for name in ("atoms", "kind", "types")))

    def hooks(self) -> dict[str, bool]:
        hooks = super().hooks()
        if self.minimizing:
            return {"post_force": False}
        if not self.output:
            del hooks["end_of_step"]
        return hooks

    def setup(self, loop) -> None:
        """Positions that fit the constraints; the forces of the first half step follow."""
        self._energy, self._told, self.came = 0.0, loop.step, np.zeros(0, np.int64)
        if self.minimizing:
            loop.warn(f"Using fix {self.style} with minimization.\n  Substituting constraints with harmonic restraint forces using "
                      f"kbond={self._spring(loop):.8g}")
            return
        if loop.dt == 0.0:
            raise InputError(f"fix {self.style}: with timestep 0 no force keeps the distances; choose another step, or unfix it")
        if any(f.style == "nve/limit" for f in loop.fixes):
            loop.warn("Should not use fix nve/limit with fix shake or fix rattle")
        if self.output:
            self._tell(loop, loop.step)
        self.starting, s = True, loop.state
        alone = s._replace(v=np.zeros_like(s.v), f=np.zeros_like(s.f), virial=np.zeros_like(s.virial))
        self.p[PART] = self.first_part
        loop._call(loop.fixes.index(self), "post_force", alone)
        s.x[:] += 0.5 * loop.dt**2 * s.inverse_mass * alone.f
        loop.sync_out()
        self._prepare_velocities(loop, alone)
        self.p[PART] = self.first_part

    def _prepare_velocities(self, loop, alone) -> None:
        """What velocities need at the start of a run: nothing, their part along the bonds dies in the first step."""

    @hook(uses=[*POSITIONS])
    def post_force(th, s, p, a):
        hold_positions(th, s, p, a, th.dt, p[1] * th.dt * th.dt)
        add_virials(th, s, p, a, 1.0)
        if th.tid == 0:
            p[1] = 1.0

    def hold_again(self, loop) -> None:
        """Another fix changed positions or velocities at the end of a step: forces that make the next step keep the distances."""
        if self.minimizing:
            return
        if loop.in_levels:
            self._hold_again_on_levels(loop)
            return
        s, kept = loop.state, self.a[3].copy()
        self.p[PART] = 0.5
        loop._call(loop.fixes.index(self), "post_force", s._replace(virial=np.zeros_like(s.virial)))
        self.p[PART], self.a[3][:] = self.part, kept        # virials stay those of the step

    def end_of_step(self, loop) -> None:
        self._tell(loop, loop.step)

    def finish(self, loop) -> None:
        if self.p[BELOW]:
            loop.warn(f"Shake determinant < 0.0: {self.p[BELOW]:g} times the two atoms of a cluster could not be brought to their distance")
        if self.p[SINGULAR]:
            raise SimulationError(f"fix {self.style}: {self._singular(loop)}")

    # ---- minimisation -------------------------------------------------------------------------------------------------------------------
    def _spring(self, loop) -> float:
        return 1e9 * loop.units.boltz if self.spring is None else self.spring

    def _springs(self, loop) -> None:
        """Springs in place of constraints."""
        s, step = loop.state, loop.step + 1
        if self.output and step % self.output == 0 and step != self._told and self._told >= 0:
            self._tell(loop, step)
        d, length, target, i, j = self._distances(loop)
        k = self._spring(loop)
        pull = (-2.0 * k * (length - target) / length)[:, None] * d
        for c in range(3):
            np.add.at(s.f[c], i, pull[:, c])
            np.add.at(s.f[c], j, -pull[:, c])
        self._energy = float((k * (length - target) ** 2).sum())
        if self.thermo_virial:
            s.virial[0] += np.stack([pull[:, x] * d[:, y] for x, y in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]).sum(axis=1)

    def _distances(self, loop) -> tuple[np.ndarray, ...]:
        """All distances: vectors (k, 3), lengths, what they should be, slots of both atoms."""
        of, which, ends = self.clusters.pairs()
        s = loop.state
        i, j = s.slot[ends].T
        d = loop.system.box.minimum_image((s.x[:, i] - s.x[:, j]).T)[0]
        return d, np.sqrt(np.einsum("ij,ij->i", d, d)), self.distances[of, which], i, j

    # ---- what others see ----------------------------------------------------------------------------------------------------------------
    def scalar(self) -> float:
        """Energy of the springs of a minimisation, energy units."""
        return self._energy

    def virials(self, state) -> np.ndarray:
        """(n, 6) each atom's virial, xx yy zz xy xz yz, energy units: equal shares of that of its cluster."""
        out = np.zeros((state.system.n, 6))
        c = self.clusters
        for k in range(4):
            there = cc.SIZE[c.kind] > k
            np.add.at(out, c.atoms[there, k], (self.a[3] / cc.SIZE[c.kind][:, None])[there])
        return out

    def modify_option(self, keyword, value, session):
        if keyword in ("energy", "virial"):
            setattr(self, f"thermo_{keyword}", yes_no(value, f"fix_modify {keyword}"))
            return True
        return super().modify_option(keyword, value, session)

    def constraint_error(self, loop) -> float:
        """The largest relative error of a distance now."""
        _, length, target, *_ = self._distances(loop)
        return float(np.abs(length / target - 1.0).max(initial=0.0))

    def broken_constraint(self, loop) -> str:
        if self.p[SINGULAR]:
            return self._singular(loop)
        _, length, target, i, j = self._distances(loop)
        error = np.abs(length / target - 1.0)
        if not error.max(initial=0.0) > BROKEN:
            return ""
        k = int(np.argmax(error))
        a, b = loop.system.id[loop.state.row[[i[k], j[k]]]]
        return f"atoms {a} and {b} should be {target[k]:.6g} apart, but are {length[k]:.6g}: the timestep is too long or iterations too few"

    def _singular(self, loop) -> str:
        atoms = self.clusters.atoms[int(self.p[SINGULAR]) - 1]
        ids = " ".join(str(loop.system.id[r]) for r in atoms if r >= 0)
        return f"Shake determinant = 0.0: the constraints of atoms {ids} cannot be kept"

    def _tell(self, loop, step: int) -> None:
        """Mean and spread of each bond type and angle type that is held."""
        self._told = step
        of, which, _ = self.clusters.pairs()
        _, length, *_ = self._distances(loop)
        c = self.clusters
        end = np.isin(c.kind[of], (cc.ANGLE, cc.RIGID)) & (which == 2)
        types, lines = c.types[of, which], [f"{self.verb} stats (type/ave/delta/count) on step {step}"]
        for t in np.unique(types[~end]):
            lines.append(_row("Bond:", 4, t, length[~end & (types == t)]))
        a, b = (np.zeros(len(c.kind)) for _ in range(2))
        for k, side in ((0, a), (1, b)):
            side[of[which == k]] = length[which == k]
        base, at = length[end], of[end]
        theta = np.degrees(np.arccos((a[at] ** 2 + b[at] ** 2 - base**2) / (2.0 * a[at] * b[at])))
        for t in np.unique(types[end]):
            lines.append(_row("Angle:", 3, t, theta[types[end] == t]))
        for line in lines:
            loop.say(line)


def _row(name: str, width: int, type_: int, values: np.ndarray) -> str:
    return f"{name}{type_:{width}d}   {values.mean():<9.6g} {values.max() - values.min():<11.6g} {len(values):8d}"
