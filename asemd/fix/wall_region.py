r"""The surface of a region is a wall that acts on atoms at a distance r along its normal.

.. math:: E = U(r) - U(r_c) \;\; \text{for} \;\; r < r_c

with U of fix wall/lj93, wall/lj126, wall/lj1043, wall/harmonic or wall/morse, or that of colloids of radius R, with D = r - R,

.. math:: U = \epsilon \left[ \frac{\sigma^6}{7560} \left( \frac{6R - D}{D^7} + \frac{D + 8R}{(D + 2R)^7} \right)
          - \frac{1}{6} \left( \frac{2R (D + R)}{D (D + 2R)} + \ln \frac{D}{D + 2R} \right) \right]

Inside a region each face within reach acts, outside of it only the nearest point. Edges of unions and intersections that jut into the
region are no part of the wall: near them atoms may come to feel it all at once, as in LAMMPS.

Source: LAMMPS manual, fix wall/region. Arguments: region, style, its coefficients (epsilon sigma, morse: D0 alpha r0), cutoff. Output: a
scalar, the energy; a vector of 3, the force on the wall.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.fix.forcing import Forcing
from asemd.fix.wall import HARMONIC, LJ93, LJ126, LJ1043, wall_energy
from asemd.words import choice, exactly, number, take

KINDS = {"lj93": LJ93, "lj126": LJ126, "lj1043": LJ1043, "harmonic": HARMONIC, "morse": -1, "colloid": -2}
NAMES = {kind: ("D0", "alpha", "r0") if kind == "morse" else ("epsilon", "sigma") for kind in KINDS}


def morse(r, depth, alpha, rest):
    """Energy and slope."""
    w = np.exp(-alpha * (r - rest))
    return depth * w * (w - 2.0), 2.0 * depth * alpha * w * (1.0 - w)


def colloid(r, radius, epsilon, sigma):
    """Energy and slope."""
    near, far = r - radius, r + radius
    s = sigma**6 / 7560.0
    u = s * ((7.0 * radius - r) / near**7 + (r + 7.0 * radius) / far**7) - (2.0 * radius * r / (near * far) + np.log(near / far)) / 6.0
    slope = s * (-1.0 / near**7 - 7.0 * (7.0 * radius - r) / near**8 + 1.0 / far**7 - 7.0 * (r + 7.0 * radius) / far**8) \
        - (-2.0 * radius * (r * r + radius**2) / (near * far)**2 + 2.0 * radius / (near * far)) / 6.0
    return epsilon * u, epsilon * slope


class WallRegion(Forcing):
    """A wall around or within a region.

    Parameters
    ----------
    group : str
        The atoms that feel it; all of them must be in the region.
    region : Region
        Its surface is the wall.
    kind : str
        lj93, lj126, lj1043, harmonic, morse or colloid.
    coefficients : sequence of float
        epsilon and sigma, or for morse D0, alpha and r0, in units of the scene.
    cutoff : float
        Distance from the surface beyond which the wall does not act.

    Raises
    ------
    InputError
        An unknown kind, a wrong number of coefficients, a cutoff that is not positive; at the start of a run: colloids without radius, a
        region whose surface is not supported.
    """

    style = "wall/region"
    told, size, first = 4, 3, 4
    modifies = ("energy", "virial")

    def __init__(self, group: str = "all", region=None, kind: str = "harmonic", coefficients=(1.0, 1.0), cutoff: float = 1.0):
        super().__init__(group)
        choice(kind, KINDS, "fix wall/region")
        if region is None:
            raise InputError("fix wall/region needs a region")
        if len(coefficients) != len(NAMES[kind]):
            raise InputError(f"fix wall/region {kind} needs {' '.join(NAMES[kind])}, got {len(coefficients)} values")
        if not cutoff > 0.0:
            raise InputError(f"fix wall/region: the cutoff must be above 0, got {cutoff:g}")
        self.wall, self.wall_id, self.kind = region, getattr(region, "id", ""), kind
        self.coefficients, self.cutoff = tuple(coefficients), cutoff

    @classmethod
    def from_lammps(cls, group, words, session):
        name, kind = take(words, 2, "fix wall/region (region-ID style)")[:2]
        region = session.scene.region(name, "fix wall/region")
        choice(kind, KINDS, "fix wall/region")
        names = (*NAMES[kind], "cutoff")
        values = [number(w, f"fix wall/region {kind} {n}")
                  for w, n in zip(exactly(words[2:], len(names), f"fix wall/region {kind} ({' '.join(names)})"), names, strict=True)]
        fix = cls(group, region, kind, values[:-1], values[-1])
        fix.wall_id = name
        return fix

    def to_lammps(self) -> list[str]:
        return [self.wall_id, self.kind, *(repr(float(v)) for v in (*self.coefficients, self.cutoff))]

    def parameters(self, loop) -> np.ndarray:
        if self.kind == "colloid" and "radius" not in loop.system.extra:
            raise InputError("Fix wall/region colloid requires atom attribute radius: use an atom style such as sphere")
        self.wall.surface(np.zeros((0, 3)), self.cutoff)
        return super().parameters(loop)

    def energy_of(self, r, radius):
        """Energy, less that at the cutoff, and slope at distances from the wall."""
        if self.kind == "morse":
            u, slope = morse(r, *self.coefficients)
            return u - morse(self.cutoff, *self.coefficients)[0], slope
        if self.kind == "colloid":
            u, slope = colloid(r, radius, *self.coefficients)
            return u - colloid(self.cutoff, radius, *self.coefficients)[0], slope
        block = np.array([0.0, 0.0, 0.0, self.cutoff, 0.0, KINDS[self.kind], *self.coefficients])
        u, slope = wall_energy(r, block, 0, block)
        return u - wall_energy(self.cutoff, block, 0, block)[0], slope

    def post_force(self, loop) -> None:
        """Add the forces of the wall."""
        loop.sync_out()
        rows, system = np.flatnonzero(loop.groups[self.group]), loop.system
        x = system.x[rows]
        self.wall.see(loop)
        index, d = self.wall.surface(x, self.cutoff)
        radius = system.extra["radius"][rows[index]] if self.kind == "colloid" else np.zeros(len(index))
        r = np.sqrt((d * d).sum(axis=1))
        ok = r > radius
        lost = np.concatenate([rows[~self.wall.inside(x)], rows[index[~ok]]])
        if len(lost):
            raise SimulationError(f"fix {self.id} (style {self.style}): atom {system.id[lost[0]]} is on the surface of region "
                                  f"{self.wall_id} or outside of it")
        energies, slope = self.energy_of(r, radius)
        f = (-slope / r)[:, None] * d
        slots = loop.engine.slot_of[rows[index]]
        for c in range(3):
            np.add.at(loop.state.f[c], slots, f[:, c])      # an atom may be near several faces
        self.p[3], self.p[4:7] = energies.sum(), -f.sum(axis=0)
        if self.thermo_virial:
            loop.state.virial[0] += [(f[:, i] * d[:, j]).sum() for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]

    def scalar(self) -> float:
        """Energy of atoms and wall, energy units."""
        return float(self.p[3])
