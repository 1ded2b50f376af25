r"""Restraints of distances, angles and torsions between given atoms, bonded or not.

.. math:: E_{bond} = K (r - r_0)^2, \quad E_{lbound} = K (r - r_0)^2 \;\text{for}\; r < r_0, \quad
          E_{angle} = K (\theta - \theta_0)^2, \quad
          E_{dihedral} = K [1 + \cos(n \phi - \phi_0)]

K, and the distance of bond and lbound, ramp from start to stop over the run (``run start/stop``).

Source: LAMMPS manual, fix restrain. Units: ``K`` in energy/distance^2, energy for angles; distances, degrees. Output: a scalar, the energy;
a vector of 3: that of bond, of lbound, and 0, as in LAMMPS.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.kernels.image import closest_general
from asemd.kernels.threads import barrier
from asemd.words import number, take, whole

KINDS = {"bond": 2, "lbound": 2, "angle": 3, "dihedral": 4}
FIRST, SIZE = 7, 12


def away(s, i, j):
    """The closest image of the vector from slot j to slot i."""
    return closest_general(s.x[0, i] - s.x[0, j], s.x[1, i] - s.x[1, j], s.x[2, i] - s.x[2, j], s.box.cell)


def push(s, i, x, y, z):
    s.f[0, i] += x
    s.f[1, i] += y
    s.f[2, i] += z


def restrain_bond(s, p, at, done, lower):
    """Energy of a distance; forces."""
    i, j = s.slot[int(p[at + 1])], s.slot[int(p[at + 2])]
    k, rest = p[at + 5] + done * (p[at + 6] - p[at + 5]), p[at + 7] + done * (p[at + 8] - p[at + 7])
    x, y, z = away(s, i, j)
    r = math.sqrt(x * x + y * y + z * z)
    dr = r - rest
    if lower and dr > 0.0:
        return 0.0
    w = -2.0 * k * dr / r if r > 0.0 else 0.0
    push(s, i, w * x, w * y, w * z)
    push(s, j, -w * x, -w * y, -w * z)
    return k * dr * dr


def restrain_angle(s, p, at, done):
    """Energy of an angle; forces."""
    i, j, k = s.slot[int(p[at + 1])], s.slot[int(p[at + 2])], s.slot[int(p[at + 3])]
    strength = p[at + 5] + done * (p[at + 6] - p[at + 5])
    ax, ay, az = away(s, i, j)
    bx, by, bz = away(s, k, j)
    a2, b2 = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
    ab = math.sqrt(a2 * b2)
    c = (ax * bx + ay * by + az * bz) / ab
    c = min(max(c, -1.0), 1.0)
    sine = max(math.sqrt(1.0 - c * c), 0.001)
    d = math.acos(c) - p[at + 7]
    w = -2.0 * strength * d / sine
    fx, fy, fz = w * (c * ax / a2 - bx / ab), w * (c * ay / a2 - by / ab), w * (c * az / a2 - bz / ab)
    gx, gy, gz = w * (c * bx / b2 - ax / ab), w * (c * by / b2 - ay / ab), w * (c * bz / b2 - az / ab)
    push(s, i, fx, fy, fz)
    push(s, k, gx, gy, gz)
    push(s, j, -fx - gx, -fy - gy, -fz - gz)
    return strength * d * d


def restrain_dihedral(s, p, at, done):
    """Energy of a torsion; forces."""
    i, j, k, m = s.slot[int(p[at + 1])], s.slot[int(p[at + 2])], s.slot[int(p[at + 3])], s.slot[int(p[at + 4])]
    strength = p[at + 5] + done * (p[at + 6] - p[at + 5])
    n = p[at + 9]
    ax, ay, az = away(s, i, j)
    gx, gy, gz = away(s, j, k)
    hx, hy, hz = away(s, m, k)
    ux, uy, uz = ay * gz - az * gy, az * gx - ax * gz, ax * gy - ay * gx
    vx, vy, vz = hy * gz - hz * gy, hz * gx - hx * gz, hx * gy - hy * gx
    u2, v2, g2 = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, gx * gx + gy * gy + gz * gz
    g = math.sqrt(g2)
    if not (u2 > 0.0 and v2 > 0.0):     # atoms on a line have no torsion
        return 0.0
    wx, wy, wz = vy * uz - vz * uy, vz * ux - vx * uz, vx * uy - vy * ux
    phi = math.atan2((wx * gx + wy * gy + wz * gz) / g, ux * vx + uy * vy + uz * vz)
    slope = -strength * n * math.sin(n * phi - p[at + 7])
    fg, hg = (ax * gx + ay * gy + az * gz) / g2, (hx * gx + hy * gy + hz * gz) / g2
    fi, fm = slope * g / u2, -slope * g / v2
    push(s, i, fi * ux, fi * uy, fi * uz)
    push(s, m, fm * vx, fm * vy, fm * vz)
    tx, ty, tz = -fg * fi * ux - hg * fm * vx, -fg * fi * uy - hg * fm * vy, -fg * fi * uz - hg * fm * vz
    push(s, j, tx - fi * ux, ty - fi * uy, tz - fi * uz)
    push(s, k, -tx - fm * vx, -ty - fm * vy, -tz - fm * vz)
    return strength * (1.0 + math.cos(n * phi - p[at + 7]))


class Restrain(Forcing):
    """Restraints.

    Parameters
    ----------
    group : str
        Without meaning; the atoms are named by their ids.
    restraints : sequence of tuple
        ``(kind, ids, Kstart, Kstop, value, stop or multiplicity)``: kind is ``bond``, ``lbound``, ``angle`` or ``dihedral``; ids those of
        its atoms; the value a distance, or an angle in degrees, in units of the scene; last the distance at the end of the run, the
        multiplicity of a torsion, or None.

    Raises
    ------
    InputError
        An unknown kind, a wrong number of ids; at the start of a run, an atom that is not there.
    """

    style = "restrain"
    told, size, first = 4, 3, 4
    modifies = ("energy",)
    conservative = True

    def __init__(self, group: str = "all", restraints=()):
        super().__init__(group)
        self.restraints = [tuple(r) for r in restraints]
        if not self.restraints:
            raise InputError(f"fix restrain needs one of {' '.join(KINDS)} with its arguments")
        for kind, ids, *_ in self.restraints:
            if kind not in KINDS:
                raise InputError(f"fix restrain: unknown keyword {kind!r}{nearest(kind, KINDS)}")
            if len(ids) != KINDS[kind]:
                raise InputError(f"fix restrain {kind} needs {KINDS[kind]} atoms, got {len(ids)}")

    @classmethod
    def from_lammps(cls, group, words, session):
        restraints = []
        while words:
            kind, what = words[0], f"fix restrain {words[0]}"
            if kind not in KINDS:
                raise InputError(f"fix restrain: unknown keyword {kind!r}{nearest(kind, KINDS)}")
            count = KINDS[kind]
            given = take(words[1:], count + 3, what)
            ids, (k0, k1, value) = [whole(w, f"{what} atom") for w in given[:count]], [number(w, what) for w in given[count:]]
            words, last = words[count + 4:], None
            if count == 2 and words and words[0] not in KINDS:
                last, words = number(words[0], f"{what} r0stop"), words[1:]
            elif kind == "dihedral" and words[:1] == ["mult"]:
                last, words = whole(take(words[1:], 1, f"{what} mult")[0], f"{what} mult"), words[2:]
                if last < 0:
                    raise InputError(f"{what} mult must not be negative, got {last}")
            restraints.append((kind, ids, k0, k1, value, last))
        return cls(group, restraints)

    def to_lammps(self) -> list[str]:
        words = []
        for kind, ids, k0, k1, value, last in self.restraints:
            words += [kind, *map(str, ids), repr(k0), repr(k1), repr(value)]
            if last is not None:
                words += ["mult", str(last)] if kind == "dihedral" else [repr(last)]
        return words

    def numbers(self, loop) -> list[float]:
        out = []
        rows = dict(zip(loop.system.id.tolist(), range(loop.system.n)))
        for kind, ids, k0, k1, value, last in self.restraints:
            for id in ids:
                if id not in rows:
                    raise InputError(f"Restrain atom {id} missing: fix restrain {kind} names atoms by their ids")
            block = np.zeros(SIZE)
            block[0] = list(KINDS).index(kind)
            block[1:1 + len(ids)] = [rows[id] for id in ids]
            block[5:7] = k0, k1
            block[7:9] = value, value if last is None else last
            if kind == "angle":
                block[7] = math.radians(value)
            elif kind == "dihedral":
                block[7], block[9] = math.radians(value), 1.0 if last is None else last
            out += block.tolist()
        return out

    def has_potential(self) -> bool:
        """Strengths and distances that change during a run are no function of positions."""
        return all(k0 == k1 and (kind == "dihedral" or last in (None, value)) for kind, _, k0, k1, value, last in self.restraints)

    def resize(self, loop) -> None:
        self.p[FIRST:] = self.numbers(loop)

    @hook(uses=[closest_general, away, push, restrain_bond, restrain_angle, restrain_dihedral])
    def post_force(th, s, p, a):
        done = 0.0
        if th.end != th.begin:
            done = (th.step - th.begin) / (th.end - th.begin)
        barrier(th)
        if th.tid == 0:
            bonds, bounds, others = 0.0, 0.0, 0.0
            for m in range((p.size - 7) // 12):
                at = 7 + 12 * m
                if p[at] == 0.0:
                    bonds += restrain_bond(s, p, at, done, False)
                elif p[at] == 1.0:
                    bounds += restrain_bond(s, p, at, done, True)
                elif p[at] == 2.0:
                    others += restrain_angle(s, p, at, done)
                else:
                    others += restrain_dihedral(s, p, at, done)
            p[3], p[4], p[5] = bonds + bounds + others, bonds, bounds
        barrier(th)

    def scalar(self) -> float:
        """Energy of the restraints, energy units."""
        return float(self.p[3])
