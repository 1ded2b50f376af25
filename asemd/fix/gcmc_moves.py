"""The moves of `asemd.fix.gcmc`: which atoms, where to, and whether it is accepted."""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import SimulationError
from asemd.fix.reservoir import Reservoir
from asemd.kernels.trial import ACCEPTABLE

TRANSLATION, INSERTION, DELETION, ROTATION = 0, 2, 4, 6     # where their attempts are counted; successes follow


def boltzmann(exponent: float) -> float:
    return math.exp(exponent) if exponent < 700.0 else math.inf


class Moves(Reservoir):
    """One series of attempts on copies of the atoms of a loop; `carry_over` makes them real."""

    def __init__(self, fix, loop):
        super().__init__(fix, loop)
        self._gas = None
        self.size = 1 if fix.molecule is None else fix.molecule.natoms
        # with energies of the whole system LAMMPS draws the number that decides from the stream of all processes
        self.decides = fix.random if fix.full_energy else fix.other
        self.count = fix.counts
        self.born: dict[int, np.ndarray] = {}
        self.closed = self.energies.closed
        self.angle = math.radians(fix.max_angle)
        self.last_stays = fix.as_lammps and fix.holder is not None and fix.holder[0] == "rigid"
        self.one_type = fix.as_lammps and not fix.full_energy and fix.molecule is None     # that of inserted atoms, whatever an atom is

    # ---- choosing
    @property
    def gas(self) -> np.ndarray:
        """Indices of the gas atoms, of those in the region if there is one."""
        if self._gas is None:
            a, fix, region = self.atoms, self.fix, self.fix.region
            self._gas = np.flatnonzero(a.gas[:a.n])
            if region is not None and len(self._gas):
                x = a.centres(fix.gas_mass)[a.molecule[self._gas]] if fix.by_molecule else a.x[self._gas]
                inside = region.inside(x)
                if fix.by_molecule and fix.as_lammps:       # which does not look at the newest molecule
                    inside &= a.molecule[self._gas] != a.molecule[:a.n].max()
                self._gas = self._gas[inside]
        return self._gas

    def pick(self) -> int:
        return int(self.gas[int(len(self.gas) * self.fix.random.uniform())])

    def changed(self) -> None:
        """Places or numbers of atoms are others."""
        self._gas = None

    def series(self) -> None:
        """All attempts of one time: compiled where single atoms move in a periodic box along the axes, or in a block of it."""
        fix, anywhere = self.fix, self.fix.region is None or self.fix.region.style == "block"
        plain = fix.molecule is None and not fix.by_molecule and anywhere and not (self.tail.on or self.rest.on or self.closed)
        alone = self.energies.own_terms or (self.energies.exact and self.energies.narrow)
        if plain and self.energies.aligned and not alone:
            self.compiled()
        else:
            for _ in range(fix.exchanges + fix.moves):
                self.attempt()

    def compiled(self) -> None:
        fix, a = self.fix, self.atoms
        a.room(fix.exchanges + fix.moves)
        streams = (fix.random, fix.other)
        states = np.array([r.state for r in streams], np.int64)
        saved = np.array([math.nan if r.saved is None else r.saved for r in streams])
        limits = np.array([fix.moves, fix.exchanges, fix.kind, fix.least, fix.most, 0 if fix.full_energy else 1, self.one_type,
                           fix.full_energy, fix.region is not None], np.int64)
        p = np.array([fix.displace, fix.beta, fix.activity * self.volume, fix.speed, self.charges[0], self.kept_charge,
                      self.system.mass[fix.kind]])
        gone = np.zeros(1, np.int64)
        self.energies.numbers[1] = -1.0
        a.n = int(self.energies.module.atom_moves(states, saved, limits, p, self.count, a.n, gone, a.x, a.image, a.type, a.q, a.molecule,
                                                  a.row, a.gas, a.moved, a.v, a.id, a.mass, self.box.origin, self.energies.edges,
                                                  np.array([self.low, self.high]), self.energies.numbers, *self.energies.box))
        a.removed |= bool(gone[0])
        for r, state, value in zip(streams, states, saved):
            r.state, r.saved = int(state), None if math.isnan(value) else float(value)

    def attempt(self) -> None:
        """One attempt."""
        fix, random = self.fix, self.fix.random
        cycles = fix.exchanges + fix.moves
        if int(random.uniform() * cycles) + 1 <= fix.moves:
            which = random.uniform()
            if which < fix.chances[0]:
                self.translate_atom()
            elif which < fix.chances[0] + fix.chances[1]:
                self.translate_molecule()
            else:
                self.rotate_molecule()
        elif random.uniform() < 0.5:
            (self.delete_atom if fix.molecule is None else self.delete_molecule)()
        else:
            (self.insert_atom if fix.molecule is None else self.insert_molecule)()

    def moved(self, before: float, after: float, random, rows, at) -> bool:
        """Whether a move of atoms to positions `at` is accepted."""
        after += self.tail.of_move() + self.rest.of_move(rows, self.wrapped(at))
        return self.decided(after < ACCEPTABLE and random.uniform() < boltzmann(self.fix.beta * (before - after)))

    def decided(self, good: bool) -> bool:
        """Whether an attempt was accepted; told to what goes with the whole system."""
        self.tail.decided(good)
        self.rest.decided(good)
        return good

    # ---- atoms
    def atom_energy(self, i: int, x) -> float:
        a, fix, molecule = self.atoms, self.fix, int(self.atoms.molecule[i])
        if fix.as_lammps and not fix.full_energy and fix.molecule is not None:      # type 0 there, which has no energy: overlaps count
            return self.with_others(x, np.zeros(1, np.int64), a.q[i:i + 1], i)
        if fix.by_molecule and molecule > 0 and self.energies.exact:        # bonds change, and special pairs
            rows = a.members(molecule)
            at = self.unwrapped(rows)
            at[rows == i] = x + a.image[i] @ self.box.cell
            return self.with_others(x, a.type[i:i + 1], a.q[i:i + 1], molecule=molecule) + self.alone(self._part(rows, at))
        return self.with_others(x, self.types if self.one_type else a.type[i:i + 1], a.q[i:i + 1], i)

    def translate_atom(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[TRANSLATION] += 1
        if not len(self.gas):
            return
        i = self.pick()
        before = self.atom_energy(i, a.x[i:i + 1])
        at = self.displaced(a.x[i], fix.other)
        if self.moved(before, self.atom_energy(i, at[None]), self.decides, [i], at[None]):
            a.place([i], at[None], a.image[i:i + 1])
            self.own.pop(int(a.molecule[i]), None)
            self.changed()
            self.count[TRANSLATION + 1] += 1

    def displaced(self, x, random) -> np.ndarray:
        """A place at most `displace` from x, in the region if there is one."""
        fix = self.fix
        while True:
            at = x + fix.displace * np.array(self.ball(random))
            if fix.region is None or fix.region.inside(at[None])[0]:
                self.check_inside(at[None])
                return at

    def check_inside(self, x) -> None:
        """Moves may not end beyond a face that is not periodic."""
        if self.closed and self.box.beyond(x).any():
            raise SimulationError(f"{self.fix.what}: step {self.loop.step}: a move put an atom beyond a face that is not periodic")

    def delete_atom(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[DELETION] += 1
        n = len(self.gas)
        if not n or n <= fix.least:
            return
        i = self.pick()
        energy = self.atom_energy(i, a.x[i:i + 1])
        energy += self.alone_atom(int(a.type[i]), float(a.q[i])) + self.tail.of_deletion(a.type[i:i + 1]) + self.rest.of_deletion([i])
        if self.decided(self.decides.uniform() < n * boltzmann(fix.beta * energy) / (fix.activity * self.volume)):
            a.delete(i)
            self.changed()
            self.count[DELETION + 1] += 1

    def insert_atom(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[INSERTION] += 1
        n = len(self.gas)
        if n >= fix.most:
            return
        at = self.point()
        if at is None:
            return
        at = self.wrapped(at[None])
        if fix.full_energy:
            v = [fix.other.gaussian() * fix.speed for _ in range(3)]
        energy = self.with_others(at, self.types, self.charges)
        energy += self.alone_atom(fix.kind, float(self.charges[0])) + self.tail.of_insertion(self.types)
        energy += self.rest.of_insertion(at) if energy < ACCEPTABLE else 0.0
        chance = fix.activity * self.volume / (n + 1)
        if self.decided(energy < ACCEPTABLE and self.decides.uniform() < chance * boltzmann(-fix.beta * energy)):
            if not fix.full_energy:
                v = [fix.other.gaussian() * fix.speed for _ in range(3)]
            a.add(x=at[0], type=fix.kind, q=self.kept_charge, v=v, id=int(a.id[:a.n].max(initial=0)) + 1, mass=self.system.mass[fix.kind])
            self.changed()
            self.count[INSERTION + 1] += 1

    # ---- molecules
    def molecule_energy(self, rows, x, molecule: int) -> float:
        return self.with_others(x, self.atoms.type[rows], self.atoms.q[rows], molecule=molecule)

    def unwrapped(self, rows) -> np.ndarray:
        return self.atoms.x[rows] + self.atoms.image[rows] @ self.box.cell

    def centre(self, rows) -> np.ndarray:
        """Centre of mass of a molecule as if it had the mass of the template."""
        return (self.atoms.mass[rows, None] * self.unwrapped(rows)).sum(axis=0) / self.fix.gas_mass

    def translate_molecule(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[TRANSLATION] += 1
        if not len(self.gas):
            return
        molecule = int(a.molecule[self.pick()])
        rows = a.members(molecule)
        before = self.molecule_energy(rows, a.x[rows], molecule)
        shift = fix.displace * np.array(self.ball(fix.random))
        if fix.region is not None:
            centre = self.centre(rows)
            while not fix.region.inside((centre + shift)[None])[0]:
                shift = fix.displace * np.array(self.ball(fix.random))
        at = a.x[rows] + shift
        self.check_inside(at)
        if self.moved(before, self.molecule_energy(rows, at, molecule), fix.random, rows, at):
            a.place(rows, at, a.image[rows])
            self.changed()
            self.count[TRANSLATION + 1] += 1

    def rotate_molecule(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[ROTATION] += 1
        if not len(self.gas):
            return
        molecule = int(a.molecule[self.pick()])
        rows = a.members(molecule)
        before = self.molecule_energy(rows, a.x[rows], molecule)
        centre = self.centre(rows)
        matrix = self.orientation(self.angle)
        at = (self.unwrapped(rows) - centre) @ matrix.T + centre
        after = self.molecule_energy(rows, self.wrapped(at), molecule)
        if fix.full_energy and self.energies.narrow:
            before, after = before + self.alone(self._part(rows)), after + self.alone(self._part(rows, at))
        if self.moved(before, after, fix.random, rows, at):
            a.place(rows, at, np.zeros(at.shape, np.int32))
            self.changed()
            self.count[ROTATION + 1] += 1

    def delete_molecule(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[DELETION] += 1
        n = len(self.gas)
        if not n or n <= fix.least or (n == self.size and self.last_stays):
            return
        molecule = int(a.molecule[self.pick()])
        rows = a.members(molecule)
        energy = self.molecule_energy(rows, a.x[rows], molecule)
        if fix.full_energy:
            energy += self.alone(self._part(rows), None if self.energies.narrow else molecule) - fix.intra_energy
            energy += self.tail.of_deletion(a.type[rows]) + self.rest.of_deletion(rows)
        if self.decided(fix.random.uniform() < n * boltzmann(fix.beta * energy) / (fix.activity * self.volume * self.size)):
            while len(rows):        # the last atom, maybe one of them, takes the place of the first
                a.delete(int(rows[0]))
                rows = a.members(molecule)
            self.own.pop(molecule, None)
            self.changed()
            self.count[DELETION + 1] += 1

    def insert_molecule(self) -> None:
        fix, a = self.fix, self.atoms
        self.count[INSERTION] += 1
        n = len(self.gas)
        if n >= fix.most:
            return
        centre = self.point()
        if centre is None:
            return
        at, matrix = self.molecule_at(centre)
        if fix.full_energy:
            v = [fix.random.gaussian() * fix.speed for _ in range(3)]
        inside = self.wrapped(at)
        self.check_inside(inside)
        energy = self.with_others(inside, self.types, self.charges)
        if fix.full_energy:
            energy += self.template_energy(at) - fix.intra_energy + self.tail.of_insertion(self.types)
            energy += self.rest.of_insertion(inside, matrix) if energy < ACCEPTABLE else 0.0
        chance = fix.activity * self.volume * self.size / (n + self.size)
        if self.decided(energy < ACCEPTABLE and fix.random.uniform() < chance * boltzmann(-fix.beta * energy)):
            if not fix.full_energy:
                v = [fix.random.gaussian() * fix.speed for _ in range(3)]
            number, last = int(a.molecule[:a.n].max(initial=0)) + 1, int(a.id[:a.n].max(initial=0))
            if fix.full_energy and not (self.energies.narrow or fix.whole):
                self.own[number] = self.own["template"]
            rows = [a.add(x=x, type=t, q=q, v=v, id=last + 1 + k, molecule=number, mass=m)
                    for k, (x, t, q, m) in enumerate(zip(at, self.types, self.charges, self._masses()))]
            a.place(rows, at, np.zeros(at.shape, np.int32))
            self.born[number] = matrix
            self.changed()
            self.count[INSERTION + 1] += 1

    def _masses(self) -> np.ndarray:
        m = self.fix.molecule
        return m.rmass if m.rmass is not None else self.system.mass[self.types]

    def _part(self, rows, at=None):
        """A molecule that is in the system or was inserted, by itself."""
        a, fix = self.atoms, self.fix
        if (a.row[rows] < 0).any():
            one = fix.molecule.copies(self.unwrapped(rows)[None], self.system, 0, [np.eye(3)])
            one.mass = self.system.mass
        else:
            chosen = np.zeros(self.system.n, bool)
            chosen[a.row[rows]] = True
            one = self.system.select(chosen)
            order = np.argsort(a.row[rows])
            one.x[:], one.image[:] = a.x[rows][order], a.image[rows][order]
            at = None if at is None else at[order]
        if at is not None:
            one.x[:], one.image[:] = at, 0
            self.box.wrap(one.x, one.image)
        return one

    # ---- the end
    def newcomers(self, new, x=None):
        """New atoms as a system, in the order of their ids, so molecule by molecule; at positions x (n, 3) of all copies."""
        a, fix = self.atoms, self.fix
        new = new[np.argsort(a.id[new])]
        if fix.molecule is None:
            atoms = self.new_atoms(a.type[new], a.q[new], a.x[new].copy())
        else:
            numbers = a.molecule[new[::self.size]]
            places = self.unwrapped(new).reshape(len(numbers), self.size, 3)
            atoms = fix.molecule.copies(places, self.system, 0, [self.born[int(k)] for k in numbers])
            atoms.mass, atoms.molecule[:] = self.system.mass, a.molecule[new]
        atoms.id[:], atoms.x[:], atoms.image[:], atoms.v[:] = a.id[new], (a.x if x is None else x)[new], a.image[new], a.v[new]
        return atoms

    def make(self, new):
        """New atoms as a system, as fixes that hold molecules want them."""
        atoms, fix = self.newcomers(new), self.fix
        if fix.holds is not None:
            off = fix.molecule.x.mean(axis=0) if fix.as_lammps else np.zeros(3)     # LAMMPS puts bodies beside their atoms by this much
            turns = [self.born[int(k)] for k in atoms.molecule[::self.size]]
            fix.holds.take_in(self.system, atoms, fix.molecule, turns, np.array([-turn @ off for turn in turns]))
        return atoms

    def members(self, atoms) -> dict[str, np.ndarray]:
        everybody = np.ones(atoms.n, bool)
        out = dict.fromkeys((self.fix.group, *self.fix.groups), everybody)
        for kind, name in self.fix.type_groups:
            out[name] = out.get(name, False) | (atoms.type == kind)
        return out

    def carry_over(self) -> None:
        """The loop's system becomes what the moves made of it."""
        self.atoms.carry_over(self.make, self.members)
