"""The sum over waves of charges with point dipoles, shared between threads by atoms; waves as in `asemd.kernels.ewald_disp`.

With rho(k) = sum of (q_i + i p_i . k) exp(i k . x_i) the energy of a wave is its weight times |rho|^2. A factor of fix adapt acts on what
charges do to each other, as in LAMMPS, so that their part of rho is held too.
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.ewald import BLOCK, edges, first_two, is_same, phases, stretched, weigh
from asemd.kernels.ewald_disp import choose, error
from asemd.kernels.generate import Builder
from asemd.kernels.matrix import invert
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False


def take(mu, row, lo, hi, p):
    """Dipoles of slots lo..hi-1 as ``p (3, BLOCK)``."""
    for i in range(lo, hi):
        for d in range(3):
            p[d, i - lo] = mu[row[i], d] if row[i] >= 0 else 0.0


def both(q, mu, row, numbers, waves, table, lo, hi, out):
    """rho of the waves over slots lo..hi-1, and the part of charges, ``out (m, 4)``."""
    re, im, p = np.empty(BLOCK), np.empty(BLOCK), np.empty((3, BLOCK))
    out[:] = 0.0
    for b in range(lo, hi, BLOCK):
        e = min(hi, b + BLOCK)
        take(mu, row, b, e, p)
        n0, n1 = -1, 0
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, b, e, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s, charge = table[2, abs(numbers[m, 2]), 0, b:e], table[2, abs(numbers[m, 2]), 1, b:e], q[b:e]
            k0, k1, k2 = waves[m, 1], waves[m, 2], waves[m, 3]
            real, imaginary, charged, imaginary_charged = 0.0, 0.0, 0.0, 0.0
            for i in range(e - b):
                u = re[i] * c[i] - sign * im[i] * s[i]
                w = im[i] * c[i] + sign * re[i] * s[i]
                pk = p[0, i] * k0 + p[1, i] * k1 + p[2, i] * k2
                charged += charge[i] * u
                imaginary_charged += charge[i] * w
                real -= pk * w
                imaginary += pk * u
            out[m, 0] += charged + real
            out[m, 1] += imaginary_charged + imaginary
            out[m, 2] += charged
            out[m, 3] += imaginary_charged


def act(f, q, mu, row, torque, scale, unit, g, qsum, all_energy, numbers, waves, total, table, lo, hi, flat, acc, energy, virial):
    """Forces and torques on slots lo..hi-1; if ENERGY what their dipoles add to the virial, if PER_ATOM their energies and virials too;
    `scale`: of charges with each other, `unit`: of all else; `flat` leaves out the third component of forces."""
    re, im = np.empty(BLOCK), np.empty(BLOCK)
    field, force, p = np.empty((3, BLOCK)), np.empty((3, BLOCK)), np.empty((3, BLOCK))
    root = math.sqrt(math.pi)
    for b in range(lo, hi, BLOCK):
        e = min(hi, b + BLOCK)
        take(mu, row, b, e, p)
        n0, n1 = -1, 0
        field[:], force[:] = 0.0, 0.0
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, b, e, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s = table[2, abs(numbers[m, 2]), 0, b:e], table[2, abs(numbers[m, 2]), 1, b:e]
            k0, k1, k2 = waves[m, 1], waves[m, 2], waves[m, 3]
            weight, more = 2.0 * unit * waves[m, 0], 2.0 * (scale - unit) * waves[m, 0]
            real, imaginary = weight * total[m, 0], weight * total[m, 1]
            real_more, imaginary_more = more * total[m, 2], more * total[m, 3]
            for i in range(e - b):
                u = re[i] * c[i] - sign * im[i] * s[i]
                w = im[i] * c[i] + sign * re[i] * s[i]
                pk = p[0, i] * k0 + p[1, i] * k1 + p[2, i] * k2
                along = imaginary * u - real * w
                across = real * u + imaginary * w
                push = pk * across - q[b + i] * (along + imaginary_more * u - real_more * w)
                field[0, i] -= k0 * along
                field[1, i] -= k1 * along
                field[2, i] -= k2 * along
                force[0, i] += k0 * push
                force[1, i] += k1 * push
                force[2, i] += k2 * push
                if PER_ATOM:
                    share = 0.5 * (q[b + i] * (across + real_more * u + imaginary_more * w) + pk * along)
                    energy[b + i] += share
                    for d in range(6):
                        virial[d, b + i] += share * waves[m, 4 + d]
        for i in range(e - b):
            f[0, b + i] += force[0, i]
            f[1, b + i] += force[1, i]
            if not flat:
                f[2, b + i] += force[2, i]
            torque[0, b + i] += p[1, i] * field[2, i] - p[2, i] * field[1, i]
            torque[1, b + i] += p[2, i] * field[0, i] - p[0, i] * field[2, i]
            torque[2, b + i] += p[0, i] * field[1, i] - p[1, i] * field[0, i]
            if ENERGY:      # dipoles do not turn with the box
                for d in range(3):
                    acc[2 + d] -= p[d, i] * field[d, i]
                acc[5] -= p[0, i] * field[1, i]
                acc[6] -= p[0, i] * field[2, i]
                acc[7] -= p[1, i] * field[2, i]
            if PER_ATOM:
                share = all_energy * qsum * q[b + i]
                square = p[0, i] ** 2 + p[1, i] ** 2 + p[2, i] ** 2
                energy[b + i] -= g / root * (scale * q[b + i] ** 2 + unit * 2.0 * g * g / 3.0 * square) - share
                for d in range(3):
                    virial[d, b + i] -= p[d, i] * field[d, i] + share
                virial[3, b + i] -= p[0, i] * field[1, i]
                virial[4, b + i] -= p[0, i] * field[2, i]
                virial[5, b + i] -= p[1, i] * field[2, i]


def take_slab_off(meeting, tid, x, f, q, mu, row, torque, lo, hi, scale, qsum, height, volume, sums, acc, energy):
    """Take the interaction of the periodic images of a charged or polar slab off, see `asemd.kernels.ewald.slab`."""
    dipole, second = 0.0, 0.0
    for i in range(lo, hi):
        dipole += q[i] * x[2, i] + (mu[row[i], 2] if row[i] >= 0 else 0.0)
        second += q[i] * x[2, i] * x[2, i]
    sums[tid, 0], sums[tid, 1] = dipole, second
    barrier(meeting)
    dipole, second = 0.0, 0.0
    for t in range(sums.shape[0]):
        dipole += sums[t, 0]
        second += sums[t, 1]
    front = scale * 2.0 * math.pi / volume
    rest = qsum * height * height / 12.0
    if ENERGY and tid == 0:
        acc[0] += front * (dipole * dipole - qsum * second - qsum * rest)
    for i in range(lo, hi):
        f[2, i] -= 2.0 * front * q[i] * (dipole - qsum * x[2, i])
        own = 0.0
        if row[i] >= 0:
            own = mu[row[i], 2]
            torque[0, i] -= 2.0 * front * dipole * mu[row[i], 1]
            torque[1, i] += 2.0 * front * dipole * mu[row[i], 0]
        if PER_ATOM:
            energy[i] += front * (dipole * own + q[i] * (x[2, i] * dipole - 0.5 * (second + qsum * x[2, i] * x[2, i]) - rest))


def charges_and_dipoles(meeting, tid, x, f, q, lo, hi, box, origin, mu, row, torque, room, most, all_waves, held, inverse, table, every_sum,
                        sums, constants, choice, acc, energy, virial):
    """All of it for one thread: forces, if ENERGY also energies and virial, if PER_ATOM also the shares of the atoms.

    `constants` as in `asemd.kernels.ewald.ewald`, then the sum of squared dipoles and the factor without fix adapt;
    `choice`, `held` as in `asemd.kernels.ewald_disp`.
    """
    g, scale, qsum, qsqsum, stretch, slabs = constants[0], constants[1], constants[2], constants[3], constants[4], constants[5]
    squares, unit = constants[7], constants[8]
    if tid == 0 and not is_same(box, stretch, held):
        stretched(box, stretch, held[:3], inverse)
        found, top = choose(held[:3], g, choice[0], choice[1], choice[2], choice[3], choice[4], room)
        held[3, 2] = found > room.shape[0]
        found = min(found, room.shape[0])
        held[3, 1] = found
        most[:] = min(top, table.shape[1] - 1)
        held[3, 0] = weigh(room[:found], held[:3], g, all_waves)
    barrier(meeting)
    volume, m = held[3, 0], int(held[3, 1])
    numbers, waves, all_sums = room[:m], all_waves[:m], every_sum[:, :m]
    all_energy = -0.5 * scale * math.pi / (g * g * volume)
    phases(x, inverse, lo, hi, most, table)
    both(q, mu, row, numbers, waves, table, lo, hi, all_sums[tid])
    barrier(meeting)
    total = all_sums[0].copy()
    for t in range(1, all_sums.shape[0]):
        total += all_sums[t]
    act(f, q, mu, row, torque, scale, unit, g, qsum, all_energy, numbers, waves, total, table, lo, hi, slabs == 2.0, acc, energy, virial)
    if ENERGY and tid == 0:
        for k in range(m):
            e = waves[k, 0] * (unit * (total[k, 0] ** 2 + total[k, 1] ** 2) + (scale - unit) * (total[k, 2] ** 2 + total[k, 3] ** 2))
            acc[0] += e
            for d in range(6):
                acc[2 + d] += e * waves[k, 4 + d]
        acc[0] -= g / math.sqrt(math.pi) * (scale * qsqsum + unit * 2.0 * g * g / 3.0 * squares) - all_energy * qsum * qsum
        for d in range(3):
            acc[2 + d] -= all_energy * qsum * qsum        # LAMMPS's sign for charges that do not add up to 0
    if slabs == 1.0:
        height = math.sqrt(held[2, 0] ** 2 + held[2, 1] ** 2 + held[2, 2] ** 2)
        take_slab_off(meeting, tid, x, f, q, mu, row, torque, lo, hi, scale, qsum, height, volume, sums, acc, energy)
    barrier(meeting)


@cache
def kernel(level: int):
    """`charges_and_dipoles` with that level, see `asemd.kspace.term.KSpaceTerm`."""
    b = Builder("Ewald summation of charges with dipoles")
    b.line("from asemd.kernels.threads import barrier")
    b.constant("BLOCK", BLOCK)
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.function(invert)
    for f in (error, edges, choose, weigh, phases, first_two, is_same, take, both, act, take_slab_off):
        b.function(f, fast=True)
    b.function(stretched)
    b.function(charges_and_dipoles)
    return b.build().charges_and_dipoles
