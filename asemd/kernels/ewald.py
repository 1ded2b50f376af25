"""The sum over waves of charges: structure factors, then forces, shared between threads by atoms.

A wave is three whole numbers n; its vector is 2 pi (inverse box) n. Waves come sorted by their first two numbers, so that the product of
the first two phases is made once for many of them. Phases of each direction are found by multiplication, as powers of the first.

Columns of `waves (m, 10)`: the weight 4 pi / V exp(-k^2 / 4 g^2) / k^2, k (3), and what the virial of a wave is of its energy (6).
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.generate import Builder
from asemd.kernels.matrix import invert
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False
BLOCK = 128      # slots whose phases are at hand at once


def error(waves, length, g, q2, natoms):
    """Estimated error of forces by so many waves along an edge of that length."""
    return 2.0 * q2 * g / length * math.sqrt(1.0 / (math.pi * waves * natoms)) * math.exp(-(math.pi * waves / (g * length)) ** 2)


def edges(vectors, length):
    """`length (3,)` of a box in LAMMPS's orientation, and its tilts xy, xz, yz."""
    a, b, c = vectors[0], vectors[1], vectors[2]
    length[0] = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    xy = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / length[0]
    xz = (a[0] * c[0] + a[1] * c[1] + a[2] * c[2]) / length[0]
    length[1] = math.sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2] - xy * xy)
    yz = (b[0] * c[0] + b[1] * c[1] + b[2] * c[2] - xy * xz) / length[1]
    length[2] = math.sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - xz * xz - yz * yz)
    return xy, xz, yz


def choose(vectors, given, g, q2, natoms, accuracy, numbers, most):
    """The waves that LAMMPS takes for that box: how many there are; they go to `numbers (m, 3)` as far as there is room.

    `given (3,)`: ``kmax/ewald``, zeros to choose; `most (2, 3)`: largest numbers along each direction, and before tilts made them larger.
    """
    length = np.empty(3)
    xy, xz, yz = edges(vectors, length)
    tilted = abs(xy) + abs(xz) + abs(yz) > 1e-12 * length[0]
    reach = 0.0
    for d in range(3):
        n = max(given[d], 1)
        while given[d] == 0 and error(n, length[d], g, q2, natoms) > accuracy:
            n += 1
        most[0, d] = most[1, d] = n
        reach = max(reach, 1.00001 * (2.0 * math.pi * n / length[d]) ** 2)
    if tilted and given[0] == 0:
        u, v, w = most[1, 0] / length[0], most[1, 1] / length[1], most[1, 2] / length[2]
        most[0, 0] = max(1, int(length[0] * u))
        most[0, 1] = max(1, int(abs(xy) * u + length[1] * v))
        most[0, 2] = max(1, int(abs(xz) * u + abs(yz) * v + length[2] * w))
    top = max(most[0, 0], most[0, 1], most[0, 2])
    turn = np.empty((3, 3))
    invert(vectors, turn)
    for a in range(3):
        for d in range(3):
            turn[a, d] *= 2.0 * math.pi
    m = 0
    for n0 in range(top + 1):
        for n1 in range(-top, top + 1):
            for n2 in range(-top, top + 1):
                axis = (n0 == 0) + (n1 == 0) + (n2 == 0)
                if axis == 3 or (n0 == 0 and (n1 < 0 or (n1 == 0 and n2 < 0))):
                    continue
                within = n0 <= most[0, 0] and abs(n1) <= most[0, 1] and abs(n2) <= most[0, 2]
                # waves along an edge have the largest of the three limits; those of tilted boxes LAMMPS counts only, see `Ewald.lines`
                if not within and (axis < 2 or tilted):
                    continue
                k0 = turn[0, 0] * n0 + turn[0, 1] * n1 + turn[0, 2] * n2
                k1 = turn[1, 0] * n0 + turn[1, 1] * n1 + turn[1, 2] * n2
                k2 = turn[2, 0] * n0 + turn[2, 1] * n1 + turn[2, 2] * n2
                if k0 * k0 + k1 * k1 + k2 * k2 <= reach:
                    if m < numbers.shape[0]:
                        numbers[m, 0], numbers[m, 1], numbers[m, 2] = n0, n1, n2
                    m += 1
    return m


def weigh(numbers, vectors, g, waves):
    """Weights, vectors and virials of the waves `numbers (m, 3)` in a box; returns its volume."""
    a, b, c = vectors[0], vectors[1], vectors[2]
    bc = (b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0])
    ca = (c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0])
    ab = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    det = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2]
    front = 2.0 * math.pi / det
    for m in range(numbers.shape[0]):
        k0 = front * (numbers[m, 0] * bc[0] + numbers[m, 1] * ca[0] + numbers[m, 2] * ab[0])
        k1 = front * (numbers[m, 0] * bc[1] + numbers[m, 1] * ca[1] + numbers[m, 2] * ab[1])
        k2 = front * (numbers[m, 0] * bc[2] + numbers[m, 1] * ca[2] + numbers[m, 2] * ab[2])
        kk = k0 * k0 + k1 * k1 + k2 * k2
        w = waves[m]
        w[0] = 4.0 * math.pi / abs(det) * math.exp(-0.25 * kk / (g * g)) / kk
        w[1], w[2], w[3] = k0, k1, k2
        v = -2.0 * (1.0 / kk + 0.25 / (g * g))
        w[4], w[5], w[6] = 1.0 + v * k0 * k0, 1.0 + v * k1 * k1, 1.0 + v * k2 * k2
        w[7], w[8], w[9] = v * k0 * k1, v * k0 * k2, v * k1 * k2
    return abs(det)


def phases(x, inverse, lo, hi, most, table):
    """``table[d, n, 0 or 1, i]``: cosine and sine of n times the phase of slot i along direction d."""
    for d in range(3):
        for i in range(lo, hi):
            s = x[0, i] * inverse[0, d] + x[1, i] * inverse[1, d] + x[2, i] * inverse[2, d]
            angle = 2.0 * math.pi * (s - math.floor(s))
            table[d, 0, 0, i] = 1.0
            table[d, 0, 1, i] = 0.0
            table[d, 1, 0, i] = math.cos(angle)
            table[d, 1, 1, i] = math.sin(angle)
        for n in range(2, most[d] + 1):
            for i in range(lo, hi):
                c, s = table[d, 1, 0, i], table[d, 1, 1, i]
                table[d, n, 0, i] = table[d, n - 1, 0, i] * c - table[d, n - 1, 1, i] * s
                table[d, n, 1, i] = table[d, n - 1, 1, i] * c + table[d, n - 1, 0, i] * s


def first_two(table, n0, n1, lo, hi, re, im):
    """Cosine and sine of the phase of the first two numbers, for slots lo..hi-1; the first one is not negative."""
    sign = 1.0 if n1 >= 0 else -1.0
    m = abs(n1)
    for i in range(hi - lo):
        c0, s0 = table[0, n0, 0, lo + i], table[0, n0, 1, lo + i]
        c1, s1 = table[1, m, 0, lo + i], sign * table[1, m, 1, lo + i]
        re[i] = c0 * c1 - s0 * s1
        im[i] = s0 * c1 + c0 * s1


def structure(q, numbers, table, lo, hi, out):
    """Sums of charge times cosine and sine over slots lo..hi-1, ``out (m, 2)``."""
    re, im = np.empty(BLOCK), np.empty(BLOCK)
    out[:] = 0.0
    for b in range(lo, hi, BLOCK):
        e = min(hi, b + BLOCK)
        n0, n1 = -1, 0
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, b, e, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s, charge = table[2, abs(numbers[m, 2]), 0, b:e], table[2, abs(numbers[m, 2]), 1, b:e], q[b:e]
            sum_c, sum_s = 0.0, 0.0
            for i in range(e - b):
                sum_c += charge[i] * (re[i] * c[i] - sign * im[i] * s[i])
                sum_s += charge[i] * (im[i] * c[i] + sign * re[i] * s[i])
            out[m, 0] += sum_c
            out[m, 1] += sum_s


def fields(f, q, scale, numbers, waves, total, table, lo, hi, flat):
    """Forces on slots lo..hi-1; `flat` leaves out the third component."""
    re, im = np.empty(BLOCK), np.empty(BLOCK)
    field = np.empty((3, BLOCK))
    for b in range(lo, hi, BLOCK):
        e = min(hi, b + BLOCK)
        n0, n1 = -1, 0
        field[:] = 0.0
        fx, fy, fz = field[0], field[1], field[2]
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, b, e, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s = table[2, abs(numbers[m, 2]), 0, b:e], table[2, abs(numbers[m, 2]), 1, b:e]
            weight = 2.0 * waves[m, 0]
            sum_c, sum_s = weight * total[m, 0], weight * total[m, 1]
            k0, k1, k2 = waves[m, 1], waves[m, 2], waves[m, 3]
            for i in range(e - b):
                u = sum_c * (im[i] * c[i] + sign * re[i] * s[i]) - sum_s * (re[i] * c[i] - sign * im[i] * s[i])
                fx[i] += k0 * u
                fy[i] += k1 * u
                fz[i] += k2 * u
        for i in range(e - b):
            w = scale * q[b + i]
            f[0, b + i] += w * fx[i]
            f[1, b + i] += w * fy[i]
            if not flat:
                f[2, b + i] += w * fz[i]


def shares(q, scale, numbers, waves, total, table, lo, hi, energy, virial):
    """Energies and virials of slots lo..hi-1."""
    re, im = np.empty(1), np.empty(1)
    for i in range(lo, hi):
        n0, n1 = -1, 0
        for m in range(numbers.shape[0]):
            if numbers[m, 0] != n0 or numbers[m, 1] != n1:
                n0, n1 = numbers[m, 0], numbers[m, 1]
                first_two(table, n0, n1, i, i + 1, re, im)
            sign = 1.0 if numbers[m, 2] >= 0 else -1.0
            c, s = table[2, abs(numbers[m, 2]), 0, i], sign * table[2, abs(numbers[m, 2]), 1, i]
            e = scale * q[i] * waves[m, 0] * (total[m, 0] * (re[0] * c - im[0] * s) + total[m, 1] * (im[0] * c + re[0] * s))
            energy[i] += e
            for k in range(6):
                virial[k, i] += e * waves[m, 4 + k]


def slab(meeting, tid, x, f, q, least, lo, hi, scale, qsum, height, volume, sums, acc, energy):
    """Take the interaction of the periodic images of a charged or polar slab off (Yeh, Berkowitz, J. Chem. Phys. 111, 3155 (1999);
    Ballenegger, Arnold, Cerda, J. Chem. Phys. 131, 094107 (2009)); `sums (nth, 2)` is room for all threads."""
    dipole, second = 0.0, 0.0
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        dipole += q[i] * x[2, i]
        second += q[i] * x[2, i] * x[2, i]
    sums[tid, 0], sums[tid, 1] = dipole, second
    barrier(meeting)
    dipole, second = 0.0, 0.0
    for t in range(sums.shape[0]):
        dipole += sums[t, 0]
        second += sums[t, 1]
    front = scale * 2.0 * math.pi / volume
    if ENERGY and tid == 0:
        acc[0] += front * (dipole * dipole - qsum * second - qsum * qsum * height * height / 12.0)
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        f[2, i] -= 2.0 * front * q[i] * (dipole - qsum * x[2, i])
    if PER_ATOM:
        for i in range(lo, hi):
            if abs(q[i]) <= least:
                continue
            energy[i] += front * q[i] * (x[2, i] * dipole - 0.5 * (second + qsum * x[2, i] * x[2, i]) - qsum * height * height / 12.0)


def wire(meeting, tid, x, f, q, least, lo, hi, scale, volume, sums, acc, energy):
    """Take the interaction of the periodic images of a polar wire along z off (Brodka, Sliwinski, J. Chem. Phys. 120, 5518 (2004));
    `sums (nth, 2)` is room for all threads."""
    along_x, along_y = 0.0, 0.0
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        along_x += q[i] * x[0, i]
        along_y += q[i] * x[1, i]
    sums[tid, 0], sums[tid, 1] = along_x, along_y
    barrier(meeting)
    along_x, along_y = 0.0, 0.0
    for t in range(sums.shape[0]):
        along_x += sums[t, 0]
        along_y += sums[t, 1]
    front = scale * math.pi / volume
    if ENERGY and tid == 0:
        acc[0] += front * (along_x * along_x + along_y * along_y)
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        f[0, i] -= 2.0 * front * q[i] * along_x
        f[1, i] -= 2.0 * front * q[i] * along_y
        if PER_ATOM:
            energy[i] += front * q[i] * (x[0, i] * along_x + x[1, i] * along_y)


def is_same(vectors, stretch, held):
    """Whether `held` is that box as `stretched` makes it."""
    for a in range(3):
        for d in range(3):
            if held[a, d] != vectors[a, d] * (max(stretch, 1.0) if a == 2 else max(-stretch, 1.0)):
                return False
    return True


def stretched(vectors, stretch, out, inverse):
    """The box with its third vector times `stretch`, or if that is negative with the others times minus that; its inverse and volume."""
    for a in range(3):
        for d in range(3):
            out[a, d] = vectors[a, d] * (max(stretch, 1.0) if a == 2 else max(-stretch, 1.0))
    return abs(invert(out, inverse))


def renew(box, stretch, given, g, strength, natoms, accuracy, room, most, waves, held, inverse, top):
    """The waves of a box that is not the one that they are for: `room`, `most`, `waves`, `held`, `inverse`; at most `top` along an edge."""
    stretched(box, stretch, held[:3], inverse)
    found = choose(held[:3], given, g, strength, natoms, accuracy, room, most)
    held[3, 1] = min(room.shape[0], found)
    held[3, 2] = found > room.shape[0]
    held[3, 0] = weigh(room[:int(held[3, 1])], held[:3], g, waves)
    largest = max(most[0, 0], most[0, 1], most[0, 2])
    for d in range(3):
        most[0, d] = min(top, largest)


def ewald(meeting, tid, x, f, q, lo, hi, box, origin, room, given, most, all_waves, held, inverse, table, all_sums, sums, constants, acc,
          energy, virial):
    """All of it for one thread: forces, if ENERGY also energies and virial, if PER_ATOM also the shares of the atoms.

    `constants`: g_ewald, energy scale, sum of charges, sum of their squares, what `stretched` takes, 1 for a slab's correction, 2 for no
    force along z or 3 for a wire's correction, the charge up to which atoms are passed over, then of the choice of waves: charges squared
    as energy times length, atoms, accuracy; `held (4, 3)`: the box that the waves are for, its volume, how many waves there are, and
    whether there is no room for more.
    """
    g, scale, qsum, qsqsum, stretch, slabs = constants[0], constants[1], constants[2], constants[3], constants[4], constants[5]
    if tid == 0 and not is_same(box, stretch, held):
        renew(box, stretch, given, g, constants[7], constants[8], constants[9], room, most, all_waves, held, inverse, table.shape[1] - 1)
    barrier(meeting)
    numbers, waves, sfac = room[:int(held[3, 1])], all_waves[:int(held[3, 1])], all_sums[:, :int(held[3, 1])]
    volume = held[3, 0]
    phases(x, inverse, lo, hi, most[0], table)
    structure(q, numbers, table, lo, hi, sfac[tid])
    barrier(meeting)
    total = sfac[0].copy()
    for t in range(1, sfac.shape[0]):
        total += sfac[t]
    fields(f, q, scale, numbers, waves, total, table, lo, hi, slabs == 2.0)
    if ENERGY and tid == 0:
        for m in range(numbers.shape[0]):
            e = scale * waves[m, 0] * (total[m, 0] ** 2 + total[m, 1] ** 2)
            acc[0] += e
            for k in range(6):
                acc[2 + k] += e * waves[m, 4 + k]
        acc[0] -= scale * (g * qsqsum / math.sqrt(math.pi) + 0.5 * math.pi * qsum * qsum / (g * g * volume))
    if PER_ATOM:
        shares(q, scale, numbers, waves, total, table, lo, hi, energy, virial)
        for i in range(lo, hi):
            energy[i] -= scale * (g * q[i] * q[i] / math.sqrt(math.pi) + 0.5 * math.pi * q[i] * qsum / (g * g * volume))
    if slabs == 1.0:
        height = math.sqrt(held[2, 0] ** 2 + held[2, 1] ** 2 + held[2, 2] ** 2)
        slab(meeting, tid, x, f, q, constants[6], lo, hi, scale, qsum, height, volume, sums, acc, energy)
    elif slabs == 3.0:
        wire(meeting, tid, x, f, q, constants[6], lo, hi, scale, volume, sums, acc, energy)
    barrier(meeting)


@cache
def chooser():
    """`choose`, compiled."""
    b = Builder("waves of an Ewald sum")
    b.function(invert)
    for f in (error, edges, choose):
        b.function(f, fast=True)
    return b.build().choose


@cache
def kernel(level: int):
    """`ewald` with that level."""
    b = Builder("Ewald summation")
    b.line("from asemd.kernels.threads import barrier")
    b.constant("BLOCK", BLOCK)
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.function(invert)
    for f in (error, edges, choose, weigh, phases, first_two, structure, fields, shares, is_same, slab, wire):
        b.function(f, fast=True)
    b.function(stretched)
    b.function(renew)
    b.function(ewald)
    return b.build().ewald
