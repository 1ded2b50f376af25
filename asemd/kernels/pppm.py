"""Charges to a mesh, the field of the mesh back to the charges; what happens in between on the mesh of waves.

The Fourier transforms themselves are a library's; each thread calls back its part of them between two meetings
(`asemd.kspace.transforms`). Every thread spreads its charges on a mesh of its own. Rows along the third direction are longer than the mesh,
so that the weights of a charge fall on neighbouring places; what is beyond the end is folded back when the meshes of the threads are added.

`numbers (3,)`: mesh points; `green (nx, ny, nz/2 + 1, 4)`: the influence function and its products with the wave vector; `packed (nx, ny,
(nz + ORDER) * m)`: m meshes side by side; `base (cap, 3)`, `weight (cap, 3 * WIDE)`: first place and weights of each slot.
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels import pppm_ad, pppm_stagger
from asemd.kernels.callback import call_back
from asemd.kernels.ewald import is_same, slab, stretched, wire
from asemd.kernels.generate import Builder
from asemd.kernels.influence import FOUR_PI, denominator, folded, influence, make_green, opposite, sinc_power
from asemd.kernels.matrix import invert
from asemd.kernels.stencil import SUMS, WIDE, collect, deposit, weigh
from asemd.kernels.threads import barrier

ORDER = 5
ENERGY = PER_ATOM = AD = STAGGERED = False
make_green_ad = own_force = gather_ad = None


def spread(x, q, least, lo, hi, origin, inverse, numbers, density_of, pieces, wrap, base, weight, brick):
    """Charges of slots lo..hi-1 on the mesh, those above `least`; where they are and their weights stay for `gather`."""
    brick[:] = 0.0
    mesh, lines = brick.reshape(-1), wrap[1] * brick.shape[2]
    planes = wrap[0] * (brick.shape[1] * brick.shape[2])
    half = (ORDER - 1) // 2
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        for d in range(3):
            dx, dy, dz = x[0, i] - origin[0], x[1, i] - origin[1], x[2, i] - origin[2]
            s = dx * inverse[0, d] + dy * inverse[1, d] + dz * inverse[2, d]
            u = (s - math.floor(s)) * numbers[d]
            if ORDER % 2 == 1:
                k = int(u + 0.5)
                t = k - u
            else:
                k = int(u)
                t = k + 0.5 - u
            base[i, d] = wrap[d, k + 3 * numbers[d] - half]      # not negative on a mesh of one point either
            weigh(weight, i, d * WIDE, pieces, t, ORDER)
            if AD:
                for m in range(ORDER):
                    p = (ORDER - 1) * pieces[ORDER - 1, m]
                    for c in range(ORDER - 2, 0, -1):
                        p = p * t + c * pieces[c, m]
                    weight[i, (3 + d) * WIDE + m] = p
        deposit(mesh, planes, lines, base, weight, i, q[i] * density_of, 1, ORDER)


def add_bricks(first, last, brick, density):
    """The density of the planes first..last-1: the meshes of all threads, folded."""
    nz = density.shape[2]
    for i in range(first, last):
        for j in range(density.shape[1]):
            out = density[i, j]
            for k in range(nz):
                out[k] = brick[0, i, j, k]
            for t in range(1, brick.shape[0]):
                for k in range(nz):
                    out[k] += brick[t, i, j, k]
            for t in range(brick.shape[0]):
                for k in range(nz, nz + ORDER):      # what is farther is zero
                    out[k % nz] += brick[t, i, j, k]


def multiply(first, last, nz, green, scale, wave, waves):
    """Waves of the gradient of the potential, if AD of the potential, from those of the density."""
    for i in range(first, last):
        for j in range(wave.shape[1]):
            for k in range(wave.shape[2]):
                re, im = scale * wave[i, j, k].real, scale * wave[i, j, k].imag
                if AD:
                    gd = green[i, j, k, 0]
                    waves[0, i, j, k] = complex(gd * re, gd * im)
                    continue
                for d in range(3):
                    gd = green[i, j, k, 1 + d]
                    waves[d, i, j, k] = complex(-gd * im, gd * re)


def shape(n, turn, g, v):
    """What the virial of the wave n is of its energy: xx yy zz xy xz yz."""
    k0 = turn[0, 0] * n[0] + turn[0, 1] * n[1] + turn[0, 2] * n[2]
    k1 = turn[1, 0] * n[0] + turn[1, 1] * n[1] + turn[1, 2] * n[2]
    k2 = turn[2, 0] * n[0] + turn[2, 1] * n[1] + turn[2, 2] * n[2]
    kk = k0 * k0 + k1 * k1 + k2 * k2
    if kk == 0.0:
        v[:] = 0.0
        return
    w = -2.0 * (1.0 / kk + 0.25 / (g * g))
    v[0], v[1], v[2] = 1.0 + w * k0 * k0, 1.0 + w * k1 * k1, 1.0 + w * k2 * k2
    v[3], v[4], v[5] = w * k0 * k1, w * k0 * k2, w * k1 * k2


def mean_shape(n, o, numbers, turn, g, most, b, v, u):
    """`shape` of a place of the mesh in `v`: of two waves that have it the mean, weighed with their influence."""
    shape(n, turn, g, v)
    if n[0] != -o[0] or n[1] != -o[1] or n[2] != -o[2]:
        shape(o, turn, g, u)
        one, other = influence(n, numbers, turn, g, most, b), influence(o, numbers, turn, g, most, b)
        if abs(one + other) < 1e-300:       # waves so short that they have no energy
            return
        for m in range(6):
            v[m] = (one * v[m] + other * u[m]) / (one + other)


def energies(first, last, numbers, turn, g, most, b, green, scale, wave, out):
    """``out (7,)`` gains energy and virial of the waves of the planes first..last-1, without the factors of charge and volume."""
    n, o = np.empty(3, np.int64), np.empty(3, np.int64)
    v, u = np.empty(6), np.empty(6)
    nz = numbers[2]
    for i in range(first, last):
        n[0] = folded(i, numbers[0])
        o[0] = opposite(i, numbers[0])
        for j in range(numbers[1]):
            n[1] = folded(j, numbers[1])
            o[1] = opposite(j, numbers[1])
            for k in range(nz // 2 + 1):
                n[2] = folded(k, nz)
                o[2] = opposite(k, nz)
                times = 1.0 if k == 0 or 2 * k == nz else 2.0
                c = wave[i, j, k]
                e = times * scale * scale * green[i, j, k, 0] * (c.real * c.real + c.imag * c.imag)
                mean_shape(n, o, numbers, turn, g, most, b, v, u)
                out[0] += e
                for m in range(6):
                    out[1 + m] += e * v[m]


def multiply_shares(first, last, numbers, turn, g, most, b, green, scale, wave, waves):
    """Waves of the potential and of its six parts of the virial."""
    n, o = np.empty(3, np.int64), np.empty(3, np.int64)
    v, u = np.empty(6), np.empty(6)
    for i in range(first, last):
        n[0] = folded(i, numbers[0])
        o[0] = opposite(i, numbers[0])
        for j in range(numbers[1]):
            n[1] = folded(j, numbers[1])
            o[1] = opposite(j, numbers[1])
            for k in range(numbers[2] // 2 + 1):
                n[2] = folded(k, numbers[2])
                o[2] = opposite(k, numbers[2])
                mean_shape(n, o, numbers, turn, g, most, b, v, u)
                c = scale * green[i, j, k, 0] * wave[i, j, k]
                waves[0, i, j, k] = c
                for m in range(6):
                    waves[1 + m, i, j, k] = v[m] * c


def interleave(first, last, field, packed):
    """The meshes of the planes first..last-1 side by side, their rows continued beyond the end."""
    m, nz = field.shape[0], field.shape[3]
    for i in range(first, last):
        for j in range(field.shape[2]):
            for c in range(m):
                row, out = field[c, i, j], packed[i, j]
                for k in range(nz):
                    out[k * m + c] = row[k]
                for k in range(nz, nz + ORDER):
                    out[k * m + c] = row[k % nz]


def gather(f, q, least, lo, hi, scale, wrap, base, weight, packed, flat):
    """Forces on slots lo..hi-1 from the gradient of the potential; `flat` leaves out the third component."""
    mesh, lines, sums = packed.reshape(-1), wrap[1] * packed.shape[2], np.empty(3 * ORDER + SUMS, packed.dtype)
    planes = wrap[0] * (packed.shape[1] * packed.shape[2])
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        collect(mesh, planes, lines, base, weight, i, sums, 3, ORDER)
        fx, fy, fz = 0.0, 0.0, 0.0
        for n in range(ORDER):
            fx += weight[i, 2 * WIDE + n] * sums[3 * n]
            fy += weight[i, 2 * WIDE + n] * sums[3 * n + 1]
            fz += weight[i, 2 * WIDE + n] * sums[3 * n + 2]
        c = -scale * q[i]
        f[0, i] += c * fx
        f[1, i] += c * fy
        if not flat:
            f[2, i] += c * fz


def gather_shares(q, least, lo, hi, scale, wrap, base, weight, field, energy, virial):
    """Energies and virials of slots lo..hi-1 from seven meshes."""
    nz = field.shape[3]
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        w = weight[i]
        for c in range(7):
            total = 0.0
            for l in range(ORDER):
                for m in range(ORDER):
                    for n in range(ORDER):
                        total += (w[l] * w[WIDE + m] * w[2 * WIDE + n]
                                  * field[c, wrap[0, base[i, 0] + l], wrap[1, base[i, 1] + m], (base[i, 2] + n) % nz])
            if c == 0:
                energy[i] += 0.5 * scale * q[i] * total
            else:
                virial[c - 1, i] += 0.5 * scale * q[i] * total


def pppm(meeting, tid, x, f, q, lo, hi, box, origin, numbers, pieces, gfb, wrap, images, held, lengths, own, inverse, green, brick, density,
         wave, waves, field, packed, shares, share_field, base, weight, sums, constants, forward, forward_across, backward_across, backward,
         backward_shares, acc, energy, virial):
    """All of it for one thread: forces, if ENERGY also energies and virial, if PER_ATOM also the shares of the atoms.

    `constants` as in `asemd.kernels.ewald.ewald`, but 4 for a slab's correction that is left out of the energy; if STAGGERED then by how
    many spacings the mesh is shifted; `held (4, 3)`: the box that `green` is for, and its volume; `forward`, `forward_across`,
    `backward_across`, `backward`, `backward_shares`: addresses of this thread's parts of the transforms, 0 for none; after those
    across no part needs those of other threads.
    """
    g, scale, qsum, qsqsum, stretch, slabs = constants[0], constants[1], constants[2], constants[3], constants[4], constants[5]
    least = constants[6]
    nth, nx = meeting.nth, numbers[0]
    first, last = nx * tid // nth, nx * (tid + 1) // nth
    same = is_same(box, stretch, held)
    barrier(meeting)
    if not same:
        if tid == 0:
            held[3, 0] = stretched(box, stretch, held[:3], inverse)
            if AD:
                for d in range(3):
                    lengths[d] = held[d, d]
        barrier(meeting)
        if AD:
            make_green_ad(first, last, numbers, lengths, g, gfb, green)
            barrier(meeting)
            if tid == 0:
                own_force(numbers, lengths, held[3, 0], green, own)
                if STAGGERED:
                    for d in range(3):
                        own[d, 0] *= 1.0 - 4.0 * constants[7]      # half a period
        else:
            make_green(first, last, numbers, 2.0 * math.pi * inverse, g, images, gfb, green)
    volume = held[3, 0]
    points = numbers[0] * numbers[1] * numbers[2]
    corner = origin.copy()
    if STAGGERED:
        for d in range(3):
            corner[d] -= constants[7] * (held[0, d] / numbers[0] + held[1, d] / numbers[1] + held[2, d] / numbers[2])
    spread(x, q, least, lo, hi, corner, inverse, numbers, points / volume, pieces, wrap, base, weight, brick[tid])
    barrier(meeting)
    add_bricks(first, last, brick, density)
    barrier(meeting)
    if forward:
        call_back(forward)
    barrier(meeting)
    if forward_across:
        call_back(forward_across)
    barrier(meeting)
    if ENERGY:
        turn = 2.0 * math.pi * inverse
        sums[tid, :7] = 0.0
        energies(first, last, numbers, turn, g, images, gfb, green, 1.0 / points, wave, sums[tid, :7])
    if PER_ATOM:
        multiply_shares(first, last, numbers, 2.0 * math.pi * inverse, g, images, gfb, green, 1.0, wave, shares)
    multiply(first, last, numbers[2], green, 1.0, wave, waves)
    barrier(meeting)
    if backward_across:
        call_back(backward_across)
    barrier(meeting)
    if backward:
        call_back(backward)
    if PER_ATOM and backward_shares:
        call_back(backward_shares)
    barrier(meeting)
    interleave(first, last, field, packed)
    barrier(meeting)
    if AD:
        gather_ad(x, f, q, least, lo, hi, numbers, lengths, scale, own, wrap, base, weight, packed, slabs == 2.0)
    else:
        gather(f, q, least, lo, hi, scale, wrap, base, weight, packed, slabs == 2.0)
    if ENERGY and tid == 0:
        for t in range(nth):
            acc[0] += 0.5 * scale * volume * sums[t, 0]
            for m in range(6):
                acc[2 + m] += 0.5 * scale * volume * sums[t, 1 + m]
        acc[0] -= scale * (g * qsqsum / math.sqrt(math.pi) + 0.5 * math.pi * qsum * qsum / (g * g * volume))
    if PER_ATOM:
        gather_shares(q, least, lo, hi, scale, wrap, base, weight, share_field, energy, virial)
        for i in range(lo, hi):
            if abs(q[i]) > least:
                energy[i] -= scale * (g * q[i] * q[i] / math.sqrt(math.pi) + 0.5 * math.pi * q[i] * qsum / (g * g * volume))
    if slabs == 1.0 or slabs == 4.0:
        height = math.sqrt(held[2, 0] ** 2 + held[2, 1] ** 2 + held[2, 2] ** 2)
        barrier(meeting)
        without = acc[0]
        slab(meeting, tid, x, f, q, least, lo, hi, scale, qsum, height, volume, sums, acc, energy)
        if slabs == 4.0:
            acc[0] = without
    elif slabs == 3.0:
        barrier(meeting)
        wire(meeting, tid, x, f, q, least, lo, hi, scale, volume, sums, acc, energy)
    barrier(meeting)


@cache
def kernel(level: int, order: int, ad: bool, staggered: bool = False):
    """`pppm` for weights of that order, differentiated if `ad`; `level`: see `asemd.kspace.term.KSpaceTerm`."""
    b = Builder(f"particle-particle particle-mesh, order {order}")
    b.line("from asemd.kernels.threads import barrier")
    b.line("from asemd.kernels.callback import call_back")
    b.constant("ORDER", order)
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.constant("AD", ad)
    b.constant("STAGGERED", staggered)
    b.constant("FOUR_PI", 4.0 * math.pi if staggered else FOUR_PI)
    b.line("from asemd.kernels.stencil import SUMS, WIDE, collect, deposit, weigh")
    b.function(pppm_stagger.denominator if staggered else denominator, fast=True)
    for f in (sinc_power, influence, folded, opposite, make_green, spread, add_bricks, multiply, shape, mean_shape, energies,
              multiply_shares, interleave, gather, gather_shares, is_same, slab, wire, *(pppm_ad.FUNCTIONS if ad else ())):
        b.function(f, fast=True)
    b.function(invert)
    b.function(stretched)
    b.function(pppm)
    return b.build().pppm
