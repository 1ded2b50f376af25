r"""An indenter pushes atoms: a sphere, a cylinder, a plane or a cone, with a stiffness that grows with the depth.

.. math:: F = K d^2, \qquad E = \tfrac13 K d^3

at a depth d below the surface; ``side in`` makes it a container. Position and size may be variables, in which case it moves.

Source: LAMMPS manual, fix indent. Units: ``K`` in force/distance^2. Arguments: ``sphere x y z R``, ``cylinder dim c1 c2 R``, ``plane dim
pos side``, ``cone dim c1 c2 Rlo Rhi lo hi``; side in or out; units box or lattice. Output: a scalar, the energy; a vector of 3, the force
on the indenter. A cone pushes along its normals; LAMMPS pushes from its centre and tells minus the energy.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.fix.formula import read
from asemd.kernels.image import closest_general
from asemd.kernels.threads import reduce_sum
from asemd.words import choice, number, take

# kind -> names of its numbers
KINDS = {"sphere": ("x", "y", "z", "R"), "cylinder": ("c1", "c2", "R"), "plane": ("pos",),
         "cone": ("c1", "c2", "Rlo", "Rhi", "lo", "hi")}


def below_cone(r, h, rlo, rhi, lo, hi):
    """Depth below the surface of a truncated cone, negative outside, and the outward direction there, along r and h."""
    length = math.sqrt((hi - lo) ** 2 + (rhi - rlo) ** 2)
    nr, nh = (hi - lo) / length, (rlo - rhi) / length
    across = (rlo - r) * nr + (lo - h) * nh            # from the point to the slanted side
    if lo <= h <= hi and across >= 0.0:
        depth = across
        if h - lo < depth:
            depth, nr, nh = h - lo, 0.0, -1.0
        if hi - h < depth:
            depth, nr, nh = hi - h, 0.0, 1.0
        return depth, nr, nh
    along = min(max(((r - rlo) * (rhi - rlo) + (h - lo) * (hi - lo)) / (length * length), 0.0), 1.0)
    br, bh = rlo + along * (rhi - rlo), lo + along * (hi - lo)
    best = (r - br) ** 2 + (h - bh) ** 2
    if h < lo:
        cr = min(r, rlo)
        d = (r - cr) ** 2 + (h - lo) ** 2
        if d < best:
            best, br, bh = d, cr, lo
    if h > hi:
        cr = min(r, rhi)
        d = (r - cr) ** 2 + (h - hi) ** 2
        if d < best:
            best, br, bh = d, cr, hi
    d = math.sqrt(best)
    if d > 0.0:
        nr, nh = (r - br) / d, (h - bh) / d
    return -d, nr, nh


class Indent(Forcing):
    """An indenter.

    Parameters
    ----------
    group : str
        The atoms it pushes.
    k : float
        Stiffness, force/distance^2 units of the scene.
    kind : str
        ``sphere``, ``cylinder``, ``plane`` or ``cone``.
    geometry : sequence of float or callable
        Centre and radius; two coordinates of the axis and the radius; the position; two coordinates, two radii and where they are. In
        distance units; functions of the loop return numbers.
    dim : str
        Axis of cylinder and cone, normal of the plane.
    side : str
        ``out`` or ``in``; for a plane ``lo`` (atoms below it are pushed up) or ``hi``.

    Raises
    ------
    InputError
        An unknown kind or side, a wrong number of arguments, a negative radius.
    """

    style = "indent"
    told, size, first = 4, 3, 4
    modifies = ("energy",)
    conservative = True

    def __init__(self, group: str = "all", k: float = 1.0, kind: str = "sphere", geometry=(0.0, 0.0, 0.0, 1.0), dim: str = "z",
                 side: str = "out"):
        super().__init__(group, geometry)
        if kind not in KINDS:
            raise InputError(f"fix indent: expected one of {' '.join(KINDS)}, got {kind!r}{nearest(kind, KINDS)}")
        if len(geometry) != len(KINDS[kind]):
            raise InputError(f"fix indent {kind} needs {' '.join(KINDS[kind])}, got {len(geometry)} values")
        choice(dim, ("x", "y", "z"), f"fix indent {kind}")
        choice(side, ("lo", "hi") if kind == "plane" else ("in", "out"), f"fix indent {kind} side")
        given = dict(zip(KINDS[kind], geometry))
        if any(not callable(v) and v < 0.0 for n, v in given.items() if n[0] == "R"):
            raise InputError(f"fix indent {kind}: a radius must not be negative")
        if kind == "cone" and not any(map(callable, geometry)) and not given["hi"] > given["lo"]:
            raise InputError("fix indent cone: hi must be above lo")
        self.k, self.kind, self.dim, self.side, self.words = k, kind, dim, side, []

    @classmethod
    def from_lammps(cls, group, words, session):
        k, rest, options = number(take(words, 1, "fix indent")[0], "fix indent K"), list(words[1:]), {}
        shape, lattice = None, True
        while rest:
            key, what = rest[0], f"fix indent {rest[0]}"
            if key in KINDS:
                count = len(KINDS[key]) + (key != "sphere") + (key == "plane")
                if shape:
                    raise InputError(f"{what}: there is a {shape[0]} already, one fix has one indenter")
                shape = key, take(rest[1:], count, what)
            elif key in ("side", "units"):
                count, value = 1, take(rest[1:], 1, what)[0]
                if key == "side":
                    options["side"] = choice(value, ("in", "out"), what)
                else:
                    lattice = choice(value, ("lattice", "box"), what) == "lattice"
            else:
                raise InputError(f"fix indent: unknown keyword {key!r}{nearest(key, (*KINDS, 'side', 'units'))}")
            rest = rest[1 + count:]
        if shape is None:
            raise InputError(f"fix indent needs one of {' '.join(KINDS)}")
        kind, given = shape
        if kind != "sphere":
            options["dim"], given = choice(given[0], ("x", "y", "z"), f"fix indent {kind}"), given[1:]
        if kind == "plane":
            options["side"], given = choice(given[-1], ("lo", "hi"), "fix indent plane side"), given[:-1]
        spacings = session.scene.lattice.spacings if lattice and session.scene.lattice is not None else np.ones(3)
        axes, geometry = cls.axes(kind, options.get("dim", "z")), []
        for word, name, axis in zip(given, KINDS[kind], axes):
            value, scale = read(word, f"fix indent {kind} {name}", session), float(spacings[axis])
            geometry.append(value if callable(value) else value * scale)      # variables are distances
        fix = cls(group, k, kind, geometry, **options)
        fix.words = list(words)
        return fix

    @staticmethod
    def axes(kind: str, dim: str) -> list[int]:
        """The direction whose lattice spacing is the unit of each number; radii go by x."""
        d = "xyz".index(dim)
        others = [k for k in range(3) if k != d]
        return {"sphere": [0, 1, 2, 0], "cylinder": [*others, 0], "plane": [d], "cone": [*others, 0, 0, d, d]}[kind]

    def to_lammps(self) -> list[str]:
        if self.words:
            return list(self.words)
        dim, end = [self.dim] * (self.kind != "sphere"), [self.side] if self.kind == "plane" else ["side", self.side]
        return [repr(self.k), self.kind, *dim, *self.value_words(), *end, "units", "box"]

    def numbers(self, loop) -> list[float]:
        return [0.0] * (6 - len(self.values)) + [list(KINDS).index(self.kind), -1.0 if self.side in ("in", "lo") else 1.0, self.k,
                                                 "xyz".index(self.dim)]

    @hook(uses=[closest_general, below_cone])
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        kind, side, k, dim = p[13], p[14], p[15], int(p[16])
        one, two = (1 if dim == 0 else 0), (1 if dim == 2 else 2)
        energy = 0.0
        total, d = np.zeros(3), np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit == 0:
                continue
            if kind == 2.0:
                depth = -side * (p[7] - s.x[dim, i])
                if depth > 0.0:
                    push = -side * k * depth * depth
                    s.f[dim, i] += push
                    total[dim] -= push
                    energy += k / 3.0 * depth * depth * depth
                continue
            d[0] = d[1] = d[2] = 0.0
            if kind == 0.0:
                for c in range(3):
                    d[c] = s.x[c, i] - p[7 + c]
                radius = p[10]
            else:
                d[one], d[two] = s.x[one, i] - p[7], s.x[two, i] - p[8]
                radius = p[9]
            d[0], d[1], d[2] = closest_general(d[0], d[1], d[2], s.box.cell)
            r = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
            lift = 0.0
            if kind == 3.0:
                depth, along, lift = below_cone(r, s.x[dim, i], p[9], p[10], p[11], p[12])
                depth *= side
            else:
                depth, along = side * (radius - r), 1.0
            if depth > 0.0:
                size = side * k * depth * depth
                out = size * along / r if r > 0.0 else 0.0
                for c in range(3):
                    push = out * d[c] + (size * lift if c == dim else 0.0)
                    s.f[c, i] += push
                    total[c] -= push
                energy += k / 3.0 * depth * depth * depth
        energy = reduce_sum(th, energy)
        if th.tid == 0:
            p[3] = energy
        for c in range(3):
            part = reduce_sum(th, total[c])
            if th.tid == 0:
                p[4 + c] = part

    def scalar(self) -> float:
        """Energy of atoms and indenter, energy units."""
        return float(self.p[3])
