"""Terms of pair styles of atoms with an orientation, which feel torques: over plain lists of pairs."""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.errors import InputError
from asemd.kernels import pair_dipole, pair_ellipsoid, pair_reach, pair_sums
from asemd.kernels.generate import Builder
from asemd.kernels.pair import list_kernel, paste_pairs
from asemd.kernels.rigid import turn_axes
from asemd.kernels.state import aligned
from asemd.kernels.whole_power import whole_power
from asemd.term import PairListTerm


@cache
def dipole_kernel(style, energy: bool, per_atom: bool):
    """The kernel of `asemd.kernels.pair_dipole` for a style."""
    b = Builder(f"pair {style.name}: charges with dipoles")
    *others, second = style.parts
    last, scale = plain_rows(style), second.rows.index("scale") if "scale" in second.rows else -1
    b.line("real = np.float64")
    b.line("place = np.uint64")
    room = pair_dipole.ROOM
    for key, value in dict(ENERGY=energy, PER_ATOM=per_atom, FIRST=last, SCALE=last + 2 + scale, SCALED=scale >= 0, ROOM=room, ROW=room,
                           AT_ONCE=pair_dipole.AT_ONCE).items():
        b.constant(key, value)
    b.use(list_kernel(style, tuple(others), wanted=True)[1], "pair_energy_one")
    paste_pairs(b, others)
    b.function(style.radial, "radial", vector=True, inline=True)
    cuts = [f"rows[{sum(2 + len(part.rows) for part in style.parts[:k])}, ti, tj]" for k in range(len(style.parts))]
    b.text(f"def furthest(rows, ti, tj):\n    return max({', '.join(cuts)})")
    pair_sums.use(b, "eight", "add", "halve")
    for f in (pair_reach.in_reach, pair_dipole.dipoles_at_once, pair_dipole.dipole_forces):
        b.function(f)
    return b.build().dipole_forces


def plain_rows(style) -> int:
    """How many rows of coefficients there are before those of the charges."""
    return sum(2 + len(part.rows) for part in style.parts[:-1])


class OrientedTerm(PairListTerm):
    """All pairs of the list; forces and torques.

    Raises
    ------
    InputError
        The style has a factor for each atom.
    """

    def __init__(self, owner):
        super().__init__(owner.style, owner.tables, owner.style.parts, "all", owner=owner)
        if np.ndim(owner.use.factor) > 0:
            raise InputError(f"pair style {self.style.name} cannot have a factor for each atom")


class DipolePairTerm(OrientedTerm):
    """Charges with point dipoles, which fixes may turn: kernels read them where they are, by row."""

    room = ()

    def kernel(self, energy, per_atom):
        return dipole_kernel(self.style, energy, per_atom)

    def rebuild(self, engine):
        super().rebuild(engine)
        if len(self.room) != engine.threads:
            self.room = aligned((engine.threads, (pair_dipole.COLUMNS + plain_rows(self.style)) * pair_dipole.ROOM))
            self.who = np.zeros((engine.threads, 3, pair_dipole.ROOM), np.int32)

    def arguments(self, engine, tid):
        s, m, nth = engine.state, len(self.i), engine.threads
        return (s.x, engine.buffers[tid], s.q, engine.system.extra["mu"], s.row, engine.buffers[tid, 3:], s.type, self.i, self.j, self.code,
                self.shifts, self.lj, self.coul, m * tid // nth, m * (tid + 1) // nth, self.tables.rows, self.tables.constants,
                self.tables.arrays, engine.qqr2e, engine.acc[tid, self.index], engine.atom_energy[tid], engine.atom_virial[tid],
                engine.bad[tid, self.index], self.room[tid], self.who[tid])


@cache
def ellipsoid_kernel(style, energy: bool, per_atom: bool):
    """The kernel of `asemd.kernels.pair_ellipsoid` for a style."""
    b = Builder(f"pair {style.name}: ellipsoids")
    name = b.function(style.parts[0].function)
    b.text(f"def plain(r2, rows, ti, tj):\n    e, d = {name}(r2, rows[2, ti, tj], rows[3, ti, tj])\n"
           "    return e - rows[1, ti, tj], -2.0 * d")
    for key, value in dict(ENERGY=energy, PER_ATOM=per_atom, FORM=4, SHAPED=style.shaped).items():
        b.constant(key, value)
    pair_sums.use(b, "eight", "add", "halve")
    for f in (turn_axes, pair_ellipsoid.lay, pair_ellipsoid.stand, pair_ellipsoid.times, pair_ellipsoid.inverse, pair_ellipsoid.skew,
              pair_ellipsoid.trace, whole_power):
        b.function(f)
    b.function(style.potential, "potential")
    b.function(pair_ellipsoid.ellipsoid_forces)
    return b.build().ellipsoid_forces


class EllipsoidPairTerm(OrientedTerm):
    """Ellipsoids, whose orientations integrators turn: kernels read them where they are, by row."""

    def kernel(self, energy, per_atom):
        return ellipsoid_kernel(self.style, energy, per_atom)

    def arguments(self, engine, tid):
        s, m, nth = engine.state, len(self.i), engine.threads
        return (s.x, engine.buffers[tid], engine.system.extra["quaternions"], s.row, engine.buffers[tid, 3:], s.type, self.i, self.j,
                self.code, self.shifts, self.lj, m * tid // nth, m * (tid + 1) // nth, self.tables.rows, self.tables.constants,
                *self.tables.arrays, engine.acc[tid, self.index], engine.atom_energy[tid], engine.atom_virial[tid],
                engine.bad[tid, self.index])


TERMS = {"dipole": DipolePairTerm, "ellipsoid": EllipsoidPairTerm}      # by `asemd.pairstyle.PairStyle.oriented`
