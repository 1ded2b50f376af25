"""Multilevel summation: charges on the finest grid and forces from its potential; what lies between is `asemd.kspace.msm`.

Charges have weights of `ORDER` points along each direction, nodal polynomials of the place between two points (`pieces (ORDER, ORDER)`,
powers and points). Rows of `wrap` give the place in the grid of a point, counted from the first one that a charge can reach.
`base (cap, 3)`, `weight (cap, 6 * WIDE)`: first point, weights and their slopes of each slot.
"""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.kernels.callback import call_back
from asemd.kernels.ewald import stretched
from asemd.kernels.generate import Builder
from asemd.kernels.matrix import invert
from asemd.kernels.threads import barrier

ORDER = 10
WIDE = 10
ENERGY = PER_ATOM = False


def weights(x, i, origin, inverse, numbers, periodic, pieces, base, weight):
    """Place and weights of slot i."""
    for d in range(3):
        dx, dy, dz = x[0, i] - origin[0], x[1, i] - origin[1], x[2, i] - origin[2]
        s = dx * inverse[0, d] + dy * inverse[1, d] + dz * inverse[2, d]
        u = (s - np.floor(s) if periodic[d] else s) * numbers[d]
        k = min(max(int(np.floor(u)), 0), numbers[d] - 1)
        t = u - k
        base[i, d] = k
        for m in range(ORDER):
            p, slope = pieces[ORDER - 1, m], 0.0
            for c in range(ORDER - 2, -1, -1):
                slope = slope * t + p
                p = p * t + pieces[c, m]
            weight[i, d * WIDE + m] = p
            weight[i, (3 + d) * WIDE + m] = slope * numbers[d]


def spread(x, q, least, lo, hi, origin, inverse, numbers, periodic, pieces, wrap, base, weight, brick):
    """Charges of slots lo..hi-1 on the grid, those above `least`."""
    brick[:] = 0.0
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        weights(x, i, origin, inverse, numbers, periodic, pieces, base, weight)
        w = weight[i]
        for k in range(ORDER):
            for m in range(ORDER):
                row, front = brick[wrap[0, base[i, 0] + k], wrap[1, base[i, 1] + m]], q[i] * w[k] * w[WIDE + m]
                for n in range(ORDER):
                    row[wrap[2, base[i, 2] + n]] += front * w[2 * WIDE + n]


def gather(f, q, least, lo, hi, scale, inverse, wrap, base, weight, field):
    """Forces on slots lo..hi-1 from the potential, whose slope is that of the weights."""
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        w = weight[i]
        a, b, c = 0.0, 0.0, 0.0
        for k in range(ORDER):
            for m in range(ORDER):
                row = field[wrap[0, base[i, 0] + k], wrap[1, base[i, 1] + m]]
                value, slope = 0.0, 0.0
                for n in range(ORDER):
                    e = row[wrap[2, base[i, 2] + n]]
                    value += w[2 * WIDE + n] * e
                    slope += w[5 * WIDE + n] * e
                a += w[3 * WIDE + k] * w[WIDE + m] * value
                b += w[k] * w[4 * WIDE + m] * value
                c += w[k] * w[WIDE + m] * slope
        for d in range(3):
            f[d, i] -= scale * q[i] * (inverse[d, 0] * a + inverse[d, 1] * b + inverse[d, 2] * c)


def gather_shares(q, least, lo, hi, scale, own, wrap, base, weight, fields, energy, virial):
    """Energies and virials of slots lo..hi-1 from seven grids; `own`: the potential of a charge by itself."""
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        w = weight[i]
        for c in range(7):
            total = 0.0
            for k in range(ORDER):
                for m in range(ORDER):
                    row, front = fields[c, wrap[0, base[i, 0] + k], wrap[1, base[i, 1] + m]], w[k] * w[WIDE + m]
                    for n in range(ORDER):
                        total += front * w[2 * WIDE + n] * row[wrap[2, base[i, 2] + n]]
            if c == 0:
                energy[i] += 0.5 * scale * q[i] * (total - own * q[i])
            else:
                virial[c - 1, i] += 0.5 * scale * q[i] * total


def msm(meeting, tid, x, f, q, lo, hi, box, origin, numbers, periodic, pieces, wrap, held, inverse, brick, density, field, share_fields,
        base, weight, results, constants, forces_only, energies_too, shares_too, acc, energy, virial):
    """All of it for one thread: forces, if ENERGY also energies and virial, if PER_ATOM also the shares of the atoms.

    `constants` as in `asemd.kernels.ewald.ewald` but the first one, the potential of a charge by itself; `held (3, 3)`: the box;
    `forces_only` and so on: addresses of the sums over grids, from `density` to the potential in `field`, to
    energy and virial in `results (7,)` and to the potentials of the shares of both in `share_fields (7, ...)`.
    """
    own, scale, qsqsum, least = constants[0], constants[1], constants[3], constants[6]
    first, last = density.shape[0] * tid // meeting.nth, density.shape[0] * (tid + 1) // meeting.nth
    if tid == 0:
        stretched(box, 1.0, held, inverse)
    barrier(meeting)
    spread(x, q, least, lo, hi, origin, inverse, numbers, periodic, pieces, wrap, base, weight, brick[tid])
    barrier(meeting)
    for i in range(first, last):
        density[i] = brick[0, i]
        for t in range(1, brick.shape[0]):
            density[i] += brick[t, i]
    barrier(meeting)
    if tid == 0:
        call_back(shares_too if PER_ATOM else energies_too if ENERGY else forces_only)
    barrier(meeting)
    gather(f, q, least, lo, hi, scale, inverse, wrap, base, weight, field)
    if ENERGY and tid == 0:
        acc[0] += 0.5 * scale * (results[0] - own * qsqsum)
        for m in range(6):
            acc[2 + m] += 0.5 * scale * results[1 + m]
    if PER_ATOM:
        gather_shares(q, least, lo, hi, scale, own, wrap, base, weight, share_fields, energy, virial)
    barrier(meeting)


@cache
def kernel(level: int, order: int):
    """`msm` for weights of that order; `level`: see `asemd.kspace.term.KSpaceTerm`."""
    b = Builder(f"multilevel summation, order {order}")
    b.line("from asemd.kernels.threads import barrier")
    b.line("from asemd.kernels.callback import call_back")
    for name, value in dict(ORDER=order, WIDE=WIDE, ENERGY=level > 0, PER_ATOM=level > 1).items():
        b.constant(name, value)
    for f in (weights, spread, gather, gather_shares):
        b.function(f, fast=True)
    b.function(invert)
    b.function(stretched)
    b.function(msm)
    return b.build().msm
