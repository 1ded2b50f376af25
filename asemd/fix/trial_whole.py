"""Energies of trials where they are no sums over pairs of atoms: all of the energy is found anew for each, as LAMMPS does it with
full_energy."""
from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from asemd.engine import Engine
from asemd.fix.trial_waves import felt
from asemd.kspace.term import KSpaceTerm


def needs_whole(fix, loop) -> bool:
    """Whether the energy of an atom is more than a sum over its pairs: potentials of many bodies, of orientations, of charges on sites or
    in a dielectric, and solvers of such charges."""
    e = loop.engine
    special = any(t.sites is not None or t.style.oriented or t.style.dielectric or t.molecules == "same" for t in e.pair_terms)
    return bool(e.many_terms) or special or (
        felt(fix, loop) and not all(t.of_places for t in e.terms if isinstance(t, KSpaceTerm)))


class Whole:
    """The energy of all atoms, without the tail correction.

    Parameters
    ----------
    reservoir : asemd.fix.reservoir.Reservoir
    """

    on = True

    def __init__(self, reservoir):
        self.reservoir, self.atoms = reservoir, reservoir.atoms
        self.accepted = self.trial = self.energy(np.arange(self.atoms.n))

    def energy(self, rows, x=None, more=None) -> float:
        """That of the copies `rows`, at positions x (n, 3) of all copies, and of `more` atoms, energy units."""
        r, a, loop = self.reservoir, self.atoms, self.reservoir.loop
        x = a.x if x is None else x
        old, new = rows[a.row[rows] >= 0], rows[a.row[rows] < 0]
        system = r.system.select(a.row[old])
        system.x[:], system.image[:] = x[old], a.image[old]
        for others in ([r.newcomers(new, x)] if len(new) else []) + ([more] if more is not None else []):
            others.id[:] = system.id.max(initial=0) + 1 + np.arange(others.n)
            system = system.append(others, keep_ids=True)
        count = system.n - len(old)
        exclude = [(kind, *(m if kind == "type" else np.append(m[a.row[old]], np.full(count, kind == "molecule/intra")) for m in masks))
                   for kind, *masks in loop.settings.exclude]
        engine = Engine(system, loop.interactions, replace(loop.settings, exclude=exclude), solver=copy.copy(loop.engine.solver))
        return sum(e for name, e in engine.compute().energy.items() if name != "etail")

    def _change(self, *arguments) -> float:
        self.trial = self.energy(*arguments)
        return self.trial - self.accepted

    def of_move(self, rows, at) -> float:
        """Change if atoms go to positions (m, 3) in the box, energy units."""
        x = self.atoms.x.copy()
        x[rows] = at
        return self._change(np.arange(self.atoms.n), x)

    def of_insertion(self, at, matrix=None) -> float:
        """Change with one more particle, at positions (m, 3), turned by `matrix`."""
        more = self.reservoir.particle(at, matrix)
        more.molecule[more.molecule > 0] += int(self.atoms.molecule[:self.atoms.n].max(initial=0))
        return self._change(np.arange(self.atoms.n), None, more)

    def of_deletion(self, rows) -> float:
        """What a deletion gains: the negative change."""
        left = np.ones(self.atoms.n, bool)
        left[list(rows)] = False
        return -self._change(np.flatnonzero(left))

    def decided(self, good: bool) -> None:
        """The attempt was accepted or not."""
        if good:
            self.accepted = self.trial


__all__ = ["Whole", "needs_whole"]
