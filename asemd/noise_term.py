"""The term of pair styles with friction and noise, whose forces depend on velocities and on the time step."""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.dielectric_term import DielectricPairTerm
from asemd.errors import InputError
from asemd.kernels import marsaglia, pair_noise, pair_sums
from asemd.kernels.generate import Builder
from asemd.marsaglia import Marsaglia
from asemd.oriented_term import TERMS
from asemd.term import PairListTerm


@cache
def kernel(energy: bool, per_atom: bool, across: bool):
    """The kernel of `asemd.kernels.pair_noise`."""
    b = Builder("pairs with friction and noise")
    for name, value in dict(ENERGY=energy, PER_ATOM=per_atom, ACROSS=across).items():
        b.constant(name, value)
    pair_sums.use(b, "eight", "add", "halve")
    for f in (marsaglia.uniform, marsaglia.gaussian, pair_noise.noisy_forces):
        b.function(f)
    return b.build().noisy_forces


class NoiseTerm(PairListTerm):
    """All pairs of the list, each with random numbers of its own."""

    def __init__(self, owner):
        super().__init__(owner.style, owner.tables, owner.style.parts, "all", owner=owner)
        self.streams = None

    def kernel(self, energy, per_atom):
        return kernel(energy, per_atom, self.style.across)

    def rebuild(self, engine):
        super().rebuild(engine)
        loop, settings = getattr(engine, "loop", None), self.owner.use.settings
        if loop is None:
            raise InputError(f"pair style {self.style.name} has friction and noise, which take a run (asemd.MolecularDynamics or the "
                             "command run): energies and forces of positions alone it does not have")
        if np.ndim(self.owner.use.factor) > 0:
            raise InputError(f"pair style {self.style.name} cannot have a factor for each atom")
        if loop.dt == 0.0:
            raise InputError(f"pair style {self.style.name}: noise grows without bound as time steps become short, and timestep is 0")
        if self.streams is None:
            if len(settings.get("streams", ((),))[0]) < engine.threads:       # they go on from run to run; what they are and what they were
                settings["streams"] = np.array([[stream(settings["seed"] + k) for k in range(engine.threads)]] * 2)
            (self.streams, self.before), self.control = settings["streams"], np.zeros((engine.threads, 6))
        ends = [2.0 * engine.units.boltz * settings[name] for name in self.style.temperatures]
        self.control[:, 3:5] = ends[0], ends[-1]
        self.look(engine)
        self.scale(engine)
        deform = next((f for f in loop.fixes if getattr(f, "remap", "") == "v"), None)
        self.group = 0 if deform is None else loop.group_bit(deform.group)
        self.rates = np.zeros(9) if deform is None else deform.p
        self.images = np.rint(self.shifts @ np.linalg.inv(engine.vectors))

    def look(self, engine):
        """Where the run is."""
        loop = engine.loop
        self.control[:, :3] = loop.dt, loop.step - loop.begin, loop.end - loop.begin

    def rewind(self):
        """The next evaluation has the random numbers of the last one."""
        self.streams[:] = self.before

    def scale(self, engine):
        """The factor stands apart: noise has the root of the weights of special pairs, but all of the factor."""
        super().scale(engine)
        self.control[:, 5] = factor = float(self.owner.use.factor)
        self.lj /= factor or 1.0

    def arguments(self, engine, tid, shares=False):
        s, m, nth = engine.state, len(self.i), engine.threads
        random = self.streams[tid], self.before[tid]
        if shares:      # the same random numbers once more
            self.look(engine)
            random = self.before[tid].copy(), np.empty_like(self.before[tid])
        return (s.x, engine.buffers[tid], s.v, s.type, s.mask, self.i, self.j, self.code, self.shifts, self.images, self.rates, self.group,
                self.lj, m * tid // nth, m * (tid + 1) // nth, self.tables.rows, *random, self.control[tid], engine.acc[tid, self.index],
                engine.atom_energy[tid], engine.atom_virial[tid])


def stream(seed: int) -> np.ndarray:
    """A stream of random numbers as the kernel keeps it."""
    return np.array(Marsaglia(seed).stream())


def list_term(term) -> PairListTerm:
    """The term of a pair style over all pairs of a plain list."""
    if term.style.oriented:
        return TERMS[term.style.oriented](term)
    if term.style.dielectric:
        return DielectricPairTerm(term)
    return NoiseTerm(term) if term.style.stirred else PairListTerm(term.style, term.tables, term.style.parts, "all", owner=term)
