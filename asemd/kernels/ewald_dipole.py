"""The sum over waves of point dipoles, shared between threads by atoms; waves and phases are those of `asemd.kernels.ewald`.

With P(k) = sum of p_i exp(i k . x_i) the energy of a wave is its weight times |k . P|^2.
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.ewald import choose, edges, first_two, is_same, phases, renew, stretched, weigh
from asemd.kernels.generate import Builder
from asemd.kernels.matrix import invert
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False
BLOCK = 128      # slots whose phases are at hand at once


def error(waves, length, g, density, natoms):
    """Estimated error of forces by so many waves along an edge of that length; `density`: squared dipoles as energy, see `choose`."""
    return (8.0 * math.pi * density * g * math.sqrt(2.0 * math.pi * waves**3 / (15.0 * natoms))
            * math.exp(-(math.pi * waves / (g * length)) ** 2))


def size(vectors):
    """Volume of a box."""
    a, b, c = vectors[0], vectors[1], vectors[2]
    return abs(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]))


def polarisation(mu, row, numbers, table, lo, hi, out):
    """Sums of dipoles times cosine and sine over slots lo..hi-1, ``out (m, 6)``."""
    re, im = np.empty(BLOCK), np.empty(BLOCK)
    p = np.empty((3, BLOCK))
    out[:] = 0.0
    for b in range(lo, hi, BLOCK):
        e = min(hi, b + BLOCK)
        for i in range(b, e):
            for d in range(3):
                p[d, i - b] = mu[row[i], d] if row[i] >= 0 else 0.0
        n0, n1 = -1, 0
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, b, e, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s = table[2, abs(numbers[m, 2]), 0, b:e], table[2, abs(numbers[m, 2]), 1, b:e]
            s0, s1, s2, s3, s4, s5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for i in range(e - b):
                u = re[i] * c[i] - sign * im[i] * s[i]
                w = im[i] * c[i] + sign * re[i] * s[i]
                s0 += p[0, i] * u
                s1 += p[1, i] * u
                s2 += p[2, i] * u
                s3 += p[0, i] * w
                s4 += p[1, i] * w
                s5 += p[2, i] * w
            out[m, 0] += s0
            out[m, 1] += s1
            out[m, 2] += s2
            out[m, 3] += s3
            out[m, 4] += s4
            out[m, 5] += s5


def dipole_fields(f, mu, row, torque, scale, g, numbers, waves, total, table, lo, hi, flat, energy, virial):
    """Forces and torques on slots lo..hi-1, if PER_ATOM their energies and virials too; `flat` leaves out the third component of forces."""
    re, im = np.empty(BLOCK), np.empty(BLOCK)
    field, force, p = np.empty((3, BLOCK)), np.empty((3, BLOCK)), np.empty((3, BLOCK))
    for b in range(lo, hi, BLOCK):
        e = min(hi, b + BLOCK)
        for i in range(b, e):
            for d in range(3):
                p[d, i - b] = mu[row[i], d] if row[i] >= 0 else 0.0
        n0, n1 = -1, 0
        field[:], force[:] = 0.0, 0.0
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, b, e, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s = table[2, abs(numbers[m, 2]), 0, b:e], table[2, abs(numbers[m, 2]), 1, b:e]
            k0, k1, k2 = waves[m, 1], waves[m, 2], waves[m, 3]
            weight = 2.0 * scale * waves[m, 0]
            sum_c = weight * (k0 * total[m, 0] + k1 * total[m, 1] + k2 * total[m, 2])
            sum_s = weight * (k0 * total[m, 3] + k1 * total[m, 4] + k2 * total[m, 5])
            for i in range(e - b):
                u = re[i] * c[i] - sign * im[i] * s[i]
                w = im[i] * c[i] + sign * re[i] * s[i]
                along = u * sum_c + w * sum_s
                across = (w * sum_c - u * sum_s) * (k0 * p[0, i] + k1 * p[1, i] + k2 * p[2, i])
                field[0, i] -= k0 * along
                field[1, i] -= k1 * along
                field[2, i] -= k2 * along
                force[0, i] += k0 * across
                force[1, i] += k1 * across
                force[2, i] += k2 * across
            if PER_ATOM:
                for i in range(e - b):
                    along = (re[i] * c[i] - sign * im[i] * s[i]) * sum_c + (im[i] * c[i] + sign * re[i] * s[i]) * sum_s
                    share = 0.5 * along * (k0 * p[0, i] + k1 * p[1, i] + k2 * p[2, i])
                    energy[b + i] += share
                    for k in range(6):
                        virial[k, b + i] += share * waves[m, 4 + k]
                    virial[0, b + i] += along * k0 * p[0, i]
                    virial[1, b + i] += along * k1 * p[1, i]
                    virial[2, b + i] += along * k2 * p[2, i]
                    virial[3, b + i] += along * k1 * p[0, i]
                    virial[4, b + i] += along * k2 * p[0, i]
                    virial[5, b + i] += along * k2 * p[1, i]
        for i in range(e - b):
            f[0, b + i] += force[0, i]
            f[1, b + i] += force[1, i]
            if not flat:
                f[2, b + i] += force[2, i]
            torque[0, b + i] += p[1, i] * field[2, i] - p[2, i] * field[1, i]
            torque[1, b + i] += p[2, i] * field[0, i] - p[0, i] * field[2, i]
            torque[2, b + i] += p[0, i] * field[1, i] - p[1, i] * field[0, i]
            if PER_ATOM:
                energy[b + i] -= scale * 2.0 * g**3 / (3.0 * math.sqrt(math.pi)) * (p[0, i] ** 2 + p[1, i] ** 2 + p[2, i] ** 2)


def dipole_slab(meeting, tid, mu, row, torque, lo, hi, scale, volume, sums, acc, energy):
    """Take the interaction of the periodic images of a polar slab off (Yeh, Berkowitz, J. Chem. Phys. 111, 3155 (1999))."""
    dipole = 0.0
    for i in range(lo, hi):
        if row[i] >= 0:
            dipole += mu[row[i], 2]
    sums[tid, 0] = dipole
    barrier(meeting)
    dipole = 0.0
    for t in range(sums.shape[0]):
        dipole += sums[t, 0]
    front = scale * 2.0 * math.pi / volume
    if ENERGY and tid == 0:
        acc[0] += front * dipole * dipole
    field = -2.0 * front * dipole
    for i in range(lo, hi):
        if row[i] >= 0:
            torque[0, i] += mu[row[i], 1] * field
            torque[1, i] -= mu[row[i], 0] * field
            if PER_ATOM:
                energy[i] += front * dipole * mu[row[i], 2]


def ewald_dipole(meeting, tid, x, f, q, lo, hi, box, origin, mu, row, torque, room, given, most, all_waves, held, inverse, table,
                 all_sums, sums, constants, acc, energy, virial):
    """All of it for one thread: forces, if ENERGY also energies and virial, if PER_ATOM also the shares of the atoms.

    `constants`: g_ewald, energy scale, 0, sum of squared dipoles, stretch of the third vector, 1 for a slab's correction or 2 for no force
    along z, then of the choice of waves: dipoles squared as energy times volume, atoms, accuracy; `held (4, 3)`: the box that the waves are
    for, its volume, and how many waves there are; `torque (3, cap)`.
    """
    g, scale, squares, stretch, slabs = constants[0], constants[1], constants[3], constants[4], constants[5]
    if tid == 0 and not is_same(box, stretch, held):
        density = constants[7] / (stretch * size(box))
        renew(box, stretch, given, g, density, constants[8], constants[9], room, most, all_waves, held, inverse, table.shape[1] - 1)
    barrier(meeting)
    numbers, waves, sfac = room[:int(held[3, 1])], all_waves[:int(held[3, 1])], all_sums[:, :int(held[3, 1])]
    phases(x, inverse, lo, hi, most[0], table)
    polarisation(mu, row, numbers, table, lo, hi, sfac[tid])
    barrier(meeting)
    total = sfac[0].copy()
    for t in range(1, sfac.shape[0]):
        total += sfac[t]
    dipole_fields(f, mu, row, torque, scale, g, numbers, waves, total, table, lo, hi, slabs == 2.0, energy, virial)
    if ENERGY and tid == 0:
        for m in range(numbers.shape[0]):
            k0, k1, k2 = waves[m, 1], waves[m, 2], waves[m, 3]
            sum_c = k0 * total[m, 0] + k1 * total[m, 1] + k2 * total[m, 2]
            sum_s = k0 * total[m, 3] + k1 * total[m, 4] + k2 * total[m, 5]
            weight = scale * waves[m, 0]
            e = weight * (sum_c * sum_c + sum_s * sum_s)
            acc[0] += e
            for k in range(6):
                acc[2 + k] += e * waves[m, 4 + k]
            a0 = 2.0 * weight * (sum_c * total[m, 0] + sum_s * total[m, 3])
            a1 = 2.0 * weight * (sum_c * total[m, 1] + sum_s * total[m, 4])
            a2 = 2.0 * weight * (sum_c * total[m, 2] + sum_s * total[m, 5])
            acc[2] += a0 * k0
            acc[3] += a1 * k1
            acc[4] += a2 * k2
            acc[5] += a0 * k1
            acc[6] += a0 * k2
            acc[7] += a1 * k2
        acc[0] -= scale * 2.0 * g**3 / (3.0 * math.sqrt(math.pi)) * squares
    if slabs == 1.0:
        dipole_slab(meeting, tid, mu, row, torque, lo, hi, scale, held[3, 0], sums, acc, energy)
    barrier(meeting)


@cache
def chooser():
    """`choose` with the estimate for dipoles, compiled."""
    b = Builder("waves of an Ewald sum of dipoles")
    b.function(invert)
    for f in (error, edges, choose):
        b.function(f, fast=True)
    return b.build().choose


@cache
def kernel(level: int):
    """`ewald_dipole` with that level."""
    b = Builder("Ewald summation of dipoles")
    b.line("from asemd.kernels.threads import barrier")
    b.constant("BLOCK", BLOCK)
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.function(invert)
    for f in (error, size, edges, choose, weigh, phases, first_two, polarisation, dipole_fields, is_same, dipole_slab):
        b.function(f, fast=True)
    b.function(stretched)
    b.function(renew)
    b.function(ewald_dipole)
    return b.build().ewald_dipole
