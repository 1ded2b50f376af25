"""Small rigid bodies that come and go during a run, with fix deposit and fix gcmc."""
from __future__ import annotations

import numpy as np

from asemd.errors import SimulationError
from asemd.fix import rigid_bodies as rb
from asemd.result import COMPONENTS


class AddedBodies:
    """What the styles ``rigid/.../small`` can do besides the others.

    Attributes
    ----------
    template : str
        The molecule, by the name of its template, of which bodies may be put in.
    """

    small = True
    template = ""
    came = np.zeros(0, np.int64)        # ids of atoms that came since the run began

    def prepare(self, loop) -> None:
        super().prepare(loop)
        self.came = np.zeros(0, np.int64)

    def added_dof(self, mask: np.ndarray) -> float:
        if self.kept is None or not len(self.came):
            return 0.0
        new = np.zeros(len(mask), bool)
        new[self.kept.rows[np.isin(self.members.ids, self.came)]] = True
        return self.removed_dof(mask & new)

    def take_in(self, system, atoms, molecule, matrices, aside=0.0) -> None:
        """Copies of a template whose `atoms`, with their ids, are about to join the system become bodies: each copy is one.

        `matrices` (copies, 3, 3) have turned them. `aside` (copies, 3) is how far beside its centre of mass each body is put, whereto its
        atoms follow in the next step.
        """
        atoms.mass, self.came = system.mass, np.append(self.came, atoms.id)
        number = np.repeat(np.arange(atoms.n // molecule.natoms), molecule.natoms)
        new = rb.by_number(atoms.id, number, atoms.molecule[::molecule.natoms])
        old = self.members
        bodies = rb.build(atoms, new, self.style, _given(atoms, molecule, matrices) if molecule.has_body else None)
        bodies.x[:] += aside
        self.kept = rb.joined(self.kept, bodies)
        self.members = rb.Members(np.concatenate([old.ids, new.ids]), np.concatenate([old.first, old.first[-1] + new.first[1:]]),
                                  np.concatenate([old.label, new.label]))

    def atom_arrays(self, loop):
        """Without the bodies whose atoms have left."""
        there = np.isin(self.members.ids, loop.system.id)
        if not there.all():
            count = np.add.reduceat(there.astype(np.int64), self.members.first[:-1])
            torn = np.flatnonzero((count > 0) & (count < np.diff(self.members.first)))
            if len(torn):
                lo, hi = self.members.first[torn[0]:torn[0] + 2]
                ids = " ".join(map(str, self.members.ids[lo:hi]))
                raise SimulationError(f"fix {self.id} (style {self.style}): some of the atoms {ids} of a rigid body have left")
            left = self.kept.half_virial[count == 0].sum(axis=0)      # counts, for they took part in the first half of the step
            self.kept, self.members = rb.without(self.kept, self.members, count > 0)
            self.kept.half_virial[:1] += left
        return super().atom_arrays(loop)

    def own_words(self) -> list[str]:
        return super().own_words() + (["mol", self.template] if self.template else [])


def _given(atoms, molecule, matrices) -> dict[int, np.ndarray]:
    """What the file of the molecule says of each copy, as a file of bodies would: by molecule number."""
    out, n = {}, molecule.natoms
    mass, com, inertia = molecule.body(atoms.atom_masses()[:n])
    off, places = com - molecule.x.mean(axis=0), atoms.box.unwrap(atoms.x, atoms.image)
    for k, turn in enumerate(matrices):
        tensor = turn @ inertia @ turn.T
        centre = places[k * n:(k + 1) * n].mean(axis=0) + turn @ off
        six = [tensor[i, j] for i, j in COMPONENTS]
        out[int(atoms.molecule[k * n])] = np.array([mass, *centre, *six, *atoms.v[k * n], 0.0, 0.0, 0.0, 0, 0, 0])
    return out
