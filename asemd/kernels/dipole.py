"""Angles between the dipole of an atom and the vector to a second one, for `asemd.kernels.block`.

`arrays` ends with the rows of the slots (cap,), the dipoles by row (n, 3) and the torques by slot (3, cap), which are added to.
a = x2 - x1, gamma = atan2(|a x mu|, a . mu). The third atom of the angle is not used. As in LAMMPS there is no virial.
"""
from __future__ import annotations

import math

from asemd.kernels.algebra import between, cross, dot, member, number, push, put, store, times, triple
from asemd.kernels.vector_math import vector_atan2

V1 = F1 = GAMMA = D = SHAPE = NORMAL = 0
closest = None


def gather(x, items, first, n, b):
    for k in range(n):
        store(b, V1, k, between(x, member(items, first + k, 1), member(items, first + k, 0)))


def geometry(b, n, sides):
    for k in range(n):
        closest(b, V1, k, sides)         # the rest is for `recall`, which knows the dipoles


def recall(b, n, first, lo, hi, items, types, arrays, level):
    """The angles."""
    row, mu = arrays[-3], arrays[-2]
    for k in range(n):
        i = row[member(items, first + k, 0)]
        a, m = triple(b, V1, k), (mu[i, 0], mu[i, 1], mu[i, 2])
        aa, mm, normal = dot(a, a), dot(m, m), cross(a, m)
        store(b, NORMAL, k, normal)
        put(b, GAMMA, k, vector_atan2(math.sqrt(dot(normal, normal)), dot(a, m)))
        put(b, SHAPE, k, aa if aa < mm else mm)      # 0: at one place, or no dipole


def part(b, n, first, items, types, arrays, x, level):
    """The torques; they take the place of the normals."""
    for k in range(n):
        slope, normal = number(b, D, k), triple(b, NORMAL, k)
        size = math.sqrt(dot(normal, normal))
        w = -slope / size if size > 0.0 and math.isfinite(slope) else 0.0      # a dipole along the vector is not turned
        turn = times(w, normal)
        store(b, NORMAL, k, turn)
        push(arrays[-1], member(items, first + k, 0), turn)


def gradient(b, n):
    for k in range(n):
        a = triple(b, V1, k)
        f = cross(a, triple(b, NORMAL, k))
        aa = dot(a, a)
        store(b, F1, k, (f[0] / aa, f[1] / aa, f[2] / aa))


def scatter(out, items, first, n, b):
    for k in range(n):
        f = triple(b, F1, k)
        push(out, member(items, first + k, 0), times(-1.0, f))
        push(out, member(items, first + k, 1), f)
