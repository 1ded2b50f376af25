"""Terms of pair styles of atoms with an orientation, which feel torques: over plain lists of pairs."""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.errors import InputError
from asemd.kernels import pair_dipole, pair_ellipsoid, pair_sums
from asemd.kernels.generate import Builder
from asemd.kernels.pair import paste_one
from asemd.kernels.rigid import turn_axes
from asemd.kernels.whole_power import whole_power
from asemd.term import PairListTerm


@cache
def dipole_kernel(style, energy: bool, per_atom: bool):
    """The kernel of `asemd.kernels.pair_dipole` for a style."""
    b = Builder(f"pair {style.name}: charges with dipoles")
    *others, second = style.parts
    last, scale = sum(2 + len(part.rows) for part in others), second.rows.index("scale") if "scale" in second.rows else -1
    b.line("real = np.float64")
    paste_one(b, style, others)
    for key, value in dict(ENERGY=energy, PER_ATOM=per_atom, FIRST=last, SCALE=last + 2 + scale, SCALED=scale >= 0).items():
        b.constant(key, value)
    b.function(style.radial, "radial")
    pair_sums.use(b, "eight", "add", "halve")
    b.function(pair_dipole.dipole_forces)
    return b.build().dipole_forces


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

    def kernel(self, energy, per_atom):
        return dipole_kernel(self.style, energy, per_atom)

    def arguments(self, engine, tid):
        s, m, nth = engine.state, len(self.i), engine.threads
        return (s.x, engine.buffers[tid], s.q, engine.system.extra["mu"], s.row, engine.buffers[tid, 3:], s.type, self.i, self.j, self.code,
                self.shifts, self.lj, self.coul, m * tid // nth, m * (tid + 1) // nth, self.tables.rows, self.tables.constants,
                self.tables.arrays, engine.qqr2e, engine.acc[tid, self.index], engine.atom_energy[tid], engine.atom_virial[tid],
                engine.bad[tid, self.index])


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
