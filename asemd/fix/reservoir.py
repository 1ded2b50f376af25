"""What fixes share that insert atoms or molecules of an ideal gas: where they come from, places and orientations for them, checks."""
from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence

import numpy as np

from asemd.engine import Engine, Settings
from asemd.errors import InputError, nearest
from asemd.fix.trial_atoms import Energies, TrialAtoms
from asemd.fix.trial_waves import Waves
from asemd.fix.trial_whole import Whole, needs_whole
from asemd.kernels import own_energy
from asemd.molecule import rotation, turned
from asemd.words import bounds, take, whole

SAMPLES = 10_000_000        # points that estimate the volume of a region
FAR = 1e4           # boxes: positions nearer are folded one box after the other
TRIES = 1000                # points of a region's box until one is in the region


def read(words: Sequence[str], values: Mapping[str, int], what: str) -> dict[str, list]:
    """Keywords and their values; those that may come several times as lists ``groups`` and ``grouptypes``."""
    given: dict[str, list] = {}
    words = list(words)
    while words:
        key = words[0]
        if key not in values:
            raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, values)}")
        found = take(words[1:], values[key], f"{what} {key}")
        if key in ("group", "grouptype"):
            given.setdefault(f"{key}s", []).append(found)
        else:
            given[key] = found
        words = words[1 + values[key]:]
    return given


def find_molecule(words, scene, what: str):
    """The template that the keyword ``mol`` names, or None."""
    if words is None:
        return None
    if words[0] not in scene.molecules:
        raise InputError(f"{what} mol: there is no molecule {words[0]}{nearest(words[0], scene.molecules)}")
    molecule = scene.molecules[words[0]][0]
    molecule.check(scene.system, f"{what} mol")
    if molecule.q is not None and scene.system.q is None:
        raise InputError(f"{what} mol: the molecule has charges, the atoms have none; use atom_style full")
    return molecule


def find_region(words, scene, what: str):
    """The region that the keyword ``region`` names, or None; it must be in the box."""
    if words is None:
        return None
    region, box = scene.region(words[0], what), scene.system.box
    if region.extent() is None:
        raise InputError(f"{what}: the region must have an end, be of side in and not move")
    low, high = region.extent()
    corners = box.origin + np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell
    for a, axis in enumerate("xyz"):
        if low[a] < corners[:, a].min() or high[a] > corners[:, a].max():
            raise InputError(f"{what}: the region extends along {axis} from {low[a]:g} to {high[a]:g}, beyond the box")
    return region


def gas_type(word: str, scene, molecule, what: str) -> int:
    """The type of the atoms that are inserted; 0 for a molecule."""
    if molecule is not None:
        if whole(word, f"{what} type") != 0:
            raise InputError(f"{what} mol: the atom type must be 0 with molecules, got {word}")
        return 0
    return bounds(word, 1, scene.system.counts["ntypes"], f"{what} type", scene.system.labels["atom"])[0]


def region_volume(region, random, what: str) -> float:
    """Volume of a region by random points, as LAMMPS estimates it."""
    if region.extent() is None:
        raise InputError(f"{what}: the region must have an end, be of side in and not move")
    low, high = region.extent()
    inside = 0
    if region.style == "block":     # every point is in it
        random.skip(3 * SAMPLES)
        inside = SAMPLES
    else:
        for _ in range(100):
            inside += int(np.count_nonzero(region.inside(low + random.uniform(3 * SAMPLES // 100).reshape(-1, 3) * (high - low))))
    return float(np.prod(high - low)) * inside / SAMPLES


def check_scene(fix, loop) -> float:
    """Mass of the gas particle; decides whether energies of the whole system are needed.

    Raises
    ------
    InputError
        Two dimensions, no masses by type, atoms without molecule, what the energies cannot include.
    """
    what, system = fix.what, loop.system
    if system.dimension == 2:
        raise InputError(f"{what} cannot be used in two dimensions")
    if np.isnan(system.mass[1:]).all():
        raise InputError(f"{what} needs masses by type")
    gas, molecule = loop.groups[fix.group], fix.molecule
    if fix.by_molecule:
        if not system.molecular:
            raise InputError(f"{what}: molecules need an atom style with molecule numbers, such as full")
        if (system.molecule[gas] == 0).any():
            single = system.id[gas & (system.molecule == 0)][0]
            raise InputError(f"{what}: atoms of group {fix.group} have no molecule, such as atom {single}")
    if fix.what == "fix gcmc" and molecule is None and (system.molecule[system.type == fix.kind] != 0).any():
        raise InputError(f"{what} cannot exchange individual atoms belonging to a molecule: atoms of type {fix.kind} do")
    if not fix.by_molecule and (system.molecule[gas] != 0).any():
        loop.warn(f"{what} takes single atoms, but atoms of group {fix.group} belong to molecules")
    inter = loop.interactions
    uses = inter.uses["pair"]
    fix.whole = needs_whole(fix, loop)
    if not fix.full_energy and (not uses or fix.whole or loop.engine.solver is not None or inter.hybrid["pair"]
                                or any(inter.modified(u, "tail") for u in uses)):
        fix.full_energy = True
        loop.warn(f"{what} takes energies of the whole system (full_energy), since there is a kspace_style, or the pair style is a "
                  "hybrid, has a tail, is none or no sum over pairs of atoms")
    if fix.full_energy:
        _check_full(fix, loop, gas)
    if molecule is None:
        mass = float(system.mass[fix.kind])
    else:
        mass = molecule.mass if molecule.mass is not None else float(masses_of(molecule, system).sum())
    if not mass > 0.0:
        raise InputError(f"{what}: the mass of the gas must be positive, got {mass:g}")
    return mass


def _check_full(fix, loop, gas) -> None:
    """What the energy of the whole system may not include."""
    for f in loop.fixes:
        if f.thermo_energy and f is not fix and f.style not in ("shake", "rattle"):     # whose energy is that of a minimisation
            raise InputError(f"{fix.what} full_energy: the energy of fix {f.id} cannot be included; say fix_modify {f.id} energy no")
    for kind, *masks in loop.settings.exclude:
        if (kind == "molecule/inter" or (kind == "group" and any((m & gas).any() for m in masks))
                or (kind == "molecule/intra" and not fix.by_molecule)):
            raise InputError(f"{fix.what} full_energy: neigh_modify exclude {kind} that concerns the gas is not supported; exclude types")


def masses_of(molecule, system) -> np.ndarray:
    """(n,) masses of the atoms of a template."""
    return molecule.rmass if molecule.rmass is not None else system.mass[np.asarray(molecule.type)]


class Reservoir:
    """Draws places and orientations, and knows the energies of particles.

    Parameters
    ----------
    fix : Fix
        With ``random``, ``region``, ``molecule``, ``kind``, ``charge``, ``full_energy``, ``overlap``, ``group``, ``storage``.
    loop : asemd.loop.Loop
    """

    def __init__(self, fix, loop):
        self.fix, self.loop, self.system, self.box = fix, loop, loop.system, loop.system.box
        self.energies = Energies.of_loop(loop, fix.full_energy or not fix.as_lammps, fix.overlap, fix.what, not fix.whole)
        self.energies.see(self.box)
        known = self.energies
        self.edges = known.edges if known.aligned and not known.closed else None
        self.atoms = TrialAtoms(loop, fix.storage, fix.group, self.wrap)
        self.volume = fix.volume if fix.region is not None else known.volume
        self.low, self.high = fix.region.extent() if fix.region is not None else (self.box.origin, self.box.origin + known.edges)
        self.tilted = fix.region is None and known.tilted
        self.own: dict[int, float] = {}        # energies of molecules by themselves
        self.tail = Tail(self, fix)
        m = fix.molecule
        if m is None:
            self.types, self.charges = np.array([fix.kind]), np.array([fix.charge or 0.0])
            self.kept_charge = 0.0 if fix.as_lammps and not fix.full_energy else self.charges[0]
        else:
            weights = masses_of(m, self.system)
            com = m.com if m.com is not None else (weights[:, None] * m.x).sum(axis=0) / weights.sum()
            self.template, self.types = m.x - com, np.asarray(m.type, np.int64)
            self.charges = np.zeros(m.natoms) if m.q is None else np.asarray(m.q, float)
        self.rest = Whole(self) if fix.whole else Waves(self)      # of the energy: what is no sum over pairs

    def three(self) -> list[float]:
        uniform = self.fix.random.uniform
        return [uniform(), uniform(), uniform()]

    def point(self) -> np.ndarray | None:
        """A random place of the region or the box; None if the region was not met."""
        fix = self.fix
        if fix.region is None:
            if self.tilted:
                return self.box.origin + np.array(self.three()) @ self.box.cell
            return np.array([a + u * (b - a) for u, a, b in zip(self.three(), self.low, self.high)])
        for _ in range(TRIES + 1):
            x = np.array([a + u * (b - a) for u, a, b in zip(self.three(), self.low, self.high)])
            if fix.region.inside(x[None])[0]:
                return x
        return None

    def ball(self, random) -> list[float]:
        """A random point of the unit sphere."""
        while True:
            r = [2.0 * random.uniform() - 1.0 for _ in range(3)]
            if r[0] * r[0] + r[1] * r[1] + r[2] * r[2] <= 1.0:
                return r

    def orientation(self, largest: float) -> np.ndarray:
        """A rotation by up to `largest` radians about a random axis."""
        r = self.ball(self.fix.random)
        theta = self.fix.random.uniform() * largest
        scale = 1.0 / math.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
        return rotation([c * scale for c in r], theta)

    def molecule_at(self, centre) -> tuple[np.ndarray, np.ndarray]:
        """The template in a random orientation: positions (m, 3) and the rotation."""
        matrix = self.orientation(2.0 * math.pi)
        return turned(matrix, self.template) + centre, matrix

    def wrap(self, x: np.ndarray, image: np.ndarray) -> None:
        """Positions come into the box, in place."""
        if self.edges is not None and np.abs(x).max(initial=0.0) < FAR * self.edges.min():
            self.energies.module.fold_each(x, image, self.box.origin, self.edges)
        else:
            self.box.wrap(x, image)

    def wrapped(self, x) -> np.ndarray:
        x = np.array(x, float)
        self.wrap(x, np.zeros(x.shape, np.int32))
        return x

    def with_others(self, at, types, charges, skip=-1, molecule=-1) -> float:
        """Energy of a particle with all others."""
        return self.energies.of(self.atoms, at, types, charges, skip, molecule)

    def insertion_energy(self, place) -> float:
        """Energy that the particle would have at a place, in a random orientation."""
        fix = self.fix
        if fix.molecule is None:
            at = self.wrapped(place[None])
            energy = self.with_others(at, self.types, self.charges) + self.rest.of_insertion(at)
            return energy + self.alone_atom(fix.kind, float(self.charges[0])) + self.tail.of_insertion(self.types)
        at, matrix = self.molecule_at(place)
        inside = self.wrapped(at)
        energy = self.with_others(inside, self.types, self.charges) + self.rest.of_insertion(inside, matrix)
        if fix.full_energy:
            energy += self.template_energy(at) - fix.intra_energy + self.tail.of_insertion(self.types)
        return energy

    # ---- what only energies of the whole system have
    def new_atoms(self, types, charges, x):
        """Single atoms as a system."""
        from asemd.atom_style import fresh
        from asemd.system import System
        system, own = self.system, fresh(self.system.atom_style, len(types))
        if own["q"] is not None:
            own["q"] = np.array(charges, float)
        return System(box=self.box, x=x, type=types, id=np.arange(1, len(types) + 1), units=system.units, dimension=3, mass=system.mass,
                      counts=dict(system.counts), **own)

    def particle(self, at, matrix=None):
        """What is inserted, as a system, at positions (m, 3) in the box, turned by a matrix."""
        if self.fix.molecule is None:
            return self.new_atoms(self.types, self.charges, np.array(at))
        one = self.fix.molecule.copies(np.array(at)[None], self.system, 0, [np.eye(3) if matrix is None else matrix])
        one.mass = self.system.mass
        return one

    def alone_atom(self, kind: int, charge: float) -> float:
        """Energy of an atom with its own images, and of its charge by itself, as far as they count."""
        if not self.energies.exact or self.fix.whole:
            return 0.0
        if not self.energies.narrow:
            return sum(float(t.factor[0] * own_energy.alone(charge, t.numbers[kind])) for t in self.energies.own_terms)
        return self.alone(self.new_atoms(np.array([kind]), np.array([charge]), self.box.origin[None].copy()), ("atom", kind, charge))

    def template_energy(self, at) -> float:
        """Energy of the template by itself, at positions (m, 3)."""
        if self.energies.narrow or "template" not in self.own:
            one = self.fix.molecule.copies(at[None], self.system, 0, [np.eye(3)])
            one.mass = self.system.mass
            self.own.pop("template", None)
            return self.alone(one, "template")
        return self.own["template"]

    def alone(self, atoms, key=None) -> float:
        """Energy of some atoms by themselves, bonds and images included; remembered by `key`. None that `rest` has."""
        if self.fix.whole:
            return 0.0
        if key is not None and key in self.own:
            return self.own[key]
        s = self.loop.settings
        rules = [rule for rule in s.exclude if rule[0] == "type"]
        if any(rule[0] == "molecule/intra" for rule in s.exclude):
            rules.append(("molecule/intra", np.ones(atoms.n, bool)))
        solver = copy.copy(self.loop.engine.solver)     # pairs are as it has them; what it adds, `rest` knows
        if solver is not None:
            solver.modify = {**solver.modify, "compute": 0}
        engine = Engine(atoms, self.loop.interactions, Settings(skin=s.skin, exclude=rules), solver=solver)
        energy = engine.compute().energy
        value = sum(e for name, e in energy.items() if name != "etail")
        if key is not None:
            self.own[key] = value
        return value


class Tail:
    """What the tail correction of the pair style changes in a series of attempts.

    Parameters
    ----------
    reservoir : Reservoir
    fix : Fix
        With ``held_tail``, the correction as LAMMPS holds it at present (None: as the atoms are), which finds it anew for each exchange
        that is tried but not after a deletion; used with ``as_lammps``.
    """

    def __init__(self, reservoir: Reservoir, fix):
        self.atoms, n, volume = reservoir.atoms, reservoir.system.counts["ntypes"], reservoir.energies.volume
        self.matrix = np.zeros((n + 1, n + 1))
        for term in reservoir.loop.interactions.pair_terms(n, reservoir.loop.units) if fix.full_energy else ():
            if term.has_tail and term.style.tail is not None:
                for (i, j), c in term.filled.items():
                    cut = term.style.cutoffs(c, term.use.settings)[0]
                    if cut > 0.0:
                        self.matrix[i, j] += term.style.tail(c, cut)[0] / volume
                        self.matrix[j, i] = self.matrix[i, j]
        self.on = bool(self.matrix.any())
        self.late = fix.as_lammps
        held = fix.held_tail if fix.as_lammps else None
        self.accepted = self.trial = self.held = self.with_atoms() if held is None else held

    def with_atoms(self, more=(), less=()) -> float:
        """The correction with some types more and less."""
        if not self.on:
            return 0.0
        count = np.zeros(len(self.matrix))
        for types, sign in ((self.atoms.type[:self.atoms.n], 1.0), (more, 1.0), (less, -1.0)):
            count += sign * np.bincount(types, minlength=len(count))
        return float(count @ self.matrix @ count)

    def _differ(self, trial: float, refused: float) -> float:
        self.trial, self.held = trial, refused
        return trial - self.accepted

    def of_move(self) -> float:
        """Change of the correction by a move."""
        return self._differ(self.held, self.held) if self.on else 0.0

    def of_insertion(self, types) -> float:
        return self._differ(self.with_atoms(more=types), self.with_atoms()) if self.on else 0.0

    def of_deletion(self, types) -> float:
        """What a deletion gains: the negative change."""
        if not self.on:
            return 0.0
        now = self.with_atoms()
        return -self._differ(now if self.late else self.with_atoms(less=types), now)

    def decided(self, good: bool) -> None:
        """The attempt was accepted or not."""
        if good:
            self.accepted = self.held = self.trial


__all__ = ["Reservoir", "Tail", "check_scene", "find_molecule", "find_region", "gas_type", "masses_of", "read", "region_volume"]
