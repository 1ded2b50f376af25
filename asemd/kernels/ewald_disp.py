"""Sums over waves of charges or of the numbers whose products are C6, all with the same waves; see `asemd.kernels.ewald`."""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.ewald import BLOCK, edges, fields, first_two, is_same, phases, shares, slab, stretched, structure, weigh
from asemd.kernels.generate import Builder
from asemd.kernels.matrix import invert
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False


def error(waves, length, g, q2, b2, density, natoms):
    """Estimated error of forces of all sums by so many waves along an edge; `density`: of squared dipoles, see `choose`."""
    u = math.pi * waves / (g * length)
    bell = math.exp(-u * u)
    return (2.0 * q2 * g / length * math.sqrt(1.0 / (math.pi * waves * natoms)) * bell
            + 4.0 * b2 * g**7 / 3.0 * math.sqrt(1.0 / (math.pi * natoms)) * bell * (u + 1.0)
            + 8.0 * math.pi * density * g * math.sqrt(2.0 * math.pi * waves**3 / (15.0 * natoms)) * bell)


def choose(vectors, g, q2, b2, m2, natoms, accuracy, numbers):
    """The waves that LAMMPS takes for that box: how many there are, and the largest number; they go to `numbers (m, 3)` as far as there
    is room. `q2`, `b2`, `m2`: squared charges, C6 of atoms with themselves, squared dipoles, all as energies."""
    length = np.empty(3)
    edges(vectors, length)
    density = m2 / (length[0] * length[1] * length[2])
    reach, top = 0.0, 1
    for d in range(3):
        n = 1
        while error(n, length[d], g, q2, b2, density, natoms) > accuracy:
            n += 1
        top = max(top, n)
        reach = max(reach, 1.00001 * (2.0 * math.pi * n / length[d]) ** 2)
    turn = np.empty((3, 3))
    invert(vectors, turn)
    for a in range(3):
        for d in range(3):
            turn[a, d] *= 2.0 * math.pi
    m = 0
    for n0 in range(top + 1):
        for n1 in range(-top, top + 1):
            for n2 in range(-top, top + 1):
                if n0 == 0 and (n1 < 0 or (n1 == 0 and n2 <= 0)):
                    continue
                k0 = turn[0, 0] * n0 + turn[0, 1] * n1 + turn[0, 2] * n2
                k1 = turn[1, 0] * n0 + turn[1, 1] * n1 + turn[1, 2] * n2
                k2 = turn[2, 0] * n0 + turn[2, 1] * n1 + turn[2, 2] * n2
                if k0 * k0 + k1 * k1 + k2 * k2 <= reach:
                    if m < numbers.shape[0]:
                        numbers[m, 0], numbers[m, 1], numbers[m, 2] = n0, n1, n2
                    m += 1
    return m, top


def weigh_dispersion(numbers, volume, g, waves):
    """Weights and virials of the attraction, for waves that `weigh` has seen."""
    front = -math.pi * math.sqrt(math.pi) / (12.0 * volume)
    for m in range(numbers.shape[0]):
        w = waves[m]
        k0, k1, k2 = w[1], w[2], w[3]
        kk = k0 * k0 + k1 * k1 + k2 * k2
        k = math.sqrt(kk)
        b = 0.5 * k / g
        bell, tail = math.exp(-b * b), math.sqrt(math.pi) * math.erfc(b)
        value = k * kk * (tail + (0.5 / (b * b) - 1.0) / b * bell)
        w[0] = front * value
        v = 3.0 * k * (tail - bell / b) / value
        w[4], w[5], w[6] = 1.0 + v * k0 * k0, 1.0 + v * k1 * k1, 1.0 + v * k2 * k2
        w[7], w[8], w[9] = v * k0 * k1, v * k0 * k2, v * k1 * k2


def sums_over_waves(meeting, tid, x, f, q, lo, hi, box, origin, types, factors, signs, room, most, all_waves, held, inverse, table, values,
                    every_sum, sums, constants, choice, acc, energy, virial):
    """All of it for one thread, of charges or, where `factors (ntypes + 1, n)` has rows, of these numbers; `signs (n,)` of
    their products.

    `constants` as in `asemd.kernels.ewald.ewald`, then the sums of C6 of all pairs and of atoms with themselves, and those of each of the
    numbers; `choice (5,)`: what `choose` takes after the splitting parameter; `held (4, 3)` as in `asemd.kernels.ewald.ewald`.
    """
    g, scale, qsum, qsqsum, stretch, slabs = constants[0], constants[1], constants[2], constants[3], constants[4], constants[5]
    attraction = factors.shape[0] > 0
    if tid == 0 and not is_same(box, stretch, held):
        stretched(box, stretch, held[:3], inverse)
        found, top = choose(held[:3], g, choice[0], choice[1], choice[2], choice[3], choice[4], room)
        held[3, 2] = found > room.shape[0]
        found = min(found, room.shape[0])
        held[3, 1] = found
        most[:] = min(top, table.shape[1] - 1)
        held[3, 0] = weigh(room[:found], held[:3], g, all_waves)
        if attraction:
            weigh_dispersion(room[:found], held[3, 0], g, all_waves)
    barrier(meeting)
    volume, n, m = held[3, 0], values.shape[0], int(held[3, 1])
    numbers, waves, all_sums = room[:m], all_waves[:m], every_sum[:, :, :m]
    self_energy, all_energy = -scale * g / math.sqrt(math.pi), -0.5 * scale * math.pi / (g * g * volume)
    all_pressure = -all_energy        # LAMMPS's sign for charges that do not add up to 0
    if attraction:
        scale, self_energy, all_energy = 1.0, g**6 / 12.0, -math.pi * math.sqrt(math.pi) * g**3 / (6.0 * volume)
        all_pressure = all_energy
    for c in range(n):
        for i in range(lo, hi):
            values[c, i] = factors[types[i], c] if attraction else q[i]
    phases(x, inverse, lo, hi, most, table)
    for c in range(n):
        structure(values[c], numbers, table, lo, hi, all_sums[tid, c])
    barrier(meeting)
    total = all_sums[0].copy()
    for t in range(1, all_sums.shape[0]):
        total += all_sums[t]
    for c in range(n):
        fields(f, values[c], signs[c] * scale, numbers, waves, total[c], table, lo, hi, slabs == 2.0)
    if ENERGY and tid == 0:
        for m in range(numbers.shape[0]):
            e = 0.0
            for c in range(n):
                e += signs[c] * scale * waves[m, 0] * (total[c, m, 0] ** 2 + total[c, m, 1] ** 2)
            acc[0] += e
            for k in range(6):
                acc[2 + k] += e * waves[m, 4 + k]
        own, together = (constants[8], constants[7]) if attraction else (qsqsum, qsum * qsum)
        acc[0] += self_energy * own + all_energy * together
        for k in range(3):
            acc[2 + k] += all_pressure * together
    if PER_ATOM:
        for c in range(n):
            shares(values[c], signs[c] * scale, numbers, waves, total[c], table, lo, hi, energy, virial)
            at_zero = signs[c] * constants[9 + c] if attraction else qsum
            for i in range(lo, hi):
                share = all_energy * values[c, i] * at_zero
                energy[i] += signs[c] * self_energy * values[c, i] ** 2 + share
                for k in range(3):
                    virial[k, i] += share * all_pressure / all_energy
    if slabs == 1.0 and not attraction:
        height = math.sqrt(held[2, 0] ** 2 + held[2, 1] ** 2 + held[2, 2] ** 2)
        slab(meeting, tid, x, f, q, constants[6], lo, hi, scale, qsum, height, volume, sums, acc, energy)
    barrier(meeting)


@cache
def chooser():
    """`choose`, compiled."""
    b = Builder("waves of an Ewald sum with dispersion")
    b.function(invert)
    for f in (error, edges, choose):
        b.function(f, fast=True)
    return b.build().choose


@cache
def kernel(level: int):
    """`sums_over_waves` with that level, see `asemd.kspace.term.KSpaceTerm`."""
    b = Builder("Ewald summation of charges and dispersion")
    b.line("from asemd.kernels.threads import barrier")
    b.constant("BLOCK", BLOCK)
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.function(invert)
    for f in (error, edges, choose, weigh, weigh_dispersion, phases, first_two, structure, fields, shares, is_same, slab):
        b.function(f, fast=True)
    b.function(stretched)
    b.function(sums_over_waves)
    return b.build().sums_over_waves
