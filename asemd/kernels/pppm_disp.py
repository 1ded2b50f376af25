"""Meshes of charges and of the numbers whose products are C6, with the influence function that both kinds of ``diff`` share in LAMMPS.

What the waves of a mesh and their images have is the Gaussian of the charge, or `attraction`, which is that of 1/r^6.
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels import pppm_ad
from asemd.kernels.callback import call_back
from asemd.kernels.ewald import is_same, slab, stretched
from asemd.kernels.generate import Builder
from asemd.kernels.influence import denominator, folded, opposite
from asemd.kernels.matrix import invert
from asemd.kernels.pppm import add_bricks, gather, gather_shares, interleave, multiply, spread
from asemd.kernels.pppm_ad import gather_ad, own_force, power
from asemd.kernels.threads import barrier
from asemd.kernels.whole_power import whole_power

ORDER = 5
ENERGY = PER_ATOM = AD = False


def attraction(kk, g):
    """What the wave of the field of -1/r^6 has, 1 for the longest ones."""
    u = 0.5 * math.sqrt(kk) / g
    return (1.0 - 2.0 * u * u) * math.exp(-u * u) + 2.0 * u * u * u * math.sqrt(math.pi) * math.erfc(u)


def shape(k0, k1, k2, g, attractive, v):
    """What the virial of a wave is of its energy: xx yy zz xy xz yz."""
    kk = k0 * k0 + k1 * k1 + k2 * k2
    w = 0.0
    if kk > 0.0 and attractive:
        u = 0.5 * math.sqrt(kk) / g
        value = attraction(kk, g)
        if value > 0.0:
            w = 1.5 * (math.sqrt(math.pi) * math.erfc(u) * u - math.exp(-u * u)) / (value * g * g)
    elif kk > 0.0:
        w = -2.0 * (1.0 / kk + 0.25 / (g * g))
    v[0], v[1], v[2] = 1.0 + w * k0 * k0, 1.0 + w * k1 * k1, 1.0 + w * k2 * k2
    v[3], v[4], v[5] = w * k0 * k1, w * k0 * k2, w * k1 * k2


def mean_shape(i, j, k, numbers, lengths, g, attractive, v, u):
    """`shape` of a place of the mesh in `v`: the mean of the two waves that have it."""
    n0, n1, n2 = folded(i, numbers[0]), folded(j, numbers[1]), folded(k, numbers[2])
    o0, o1, o2 = opposite(i, numbers[0]), opposite(j, numbers[1]), opposite(k, numbers[2])
    p0, p1, p2 = 2.0 * math.pi / lengths[0], 2.0 * math.pi / lengths[1], 2.0 * math.pi / lengths[2]
    shape(p0 * n0, p1 * n1, p2 * n2, g, attractive, v)
    if n0 != -o0 or n1 != -o1 or n2 != -o2:
        shape(p0 * o0, p1 * o1, p2 * o2, g, attractive, u)
        for m in range(6):
            v[m] = 0.5 * (v[m] + u[m])


def make_green_disp(first, last, numbers, lengths, g, b, attractive, green):
    """The influence function of the planes first..last-1 and, without AD, its products with the wave vector."""
    p0, p1, p2 = 2.0 * math.pi / lengths[0], 2.0 * math.pi / lengths[1], 2.0 * math.pi / lengths[2]
    for i in range(first, last):
        n0 = folded(i, numbers[0])
        for j in range(numbers[1]):
            n1 = folded(j, numbers[1])
            for k in range(numbers[2] // 2 + 1):
                n2 = folded(k, numbers[2])
                q0, q1, q2 = p0 * n0, p1 * n1, p2 * n2
                a0, a1, a2 = math.pi * n0 / numbers[0], math.pi * n1 / numbers[1], math.pi * n2 / numbers[2]
                qq = q0 * q0 + q1 * q1 + q2 * q2
                value = 0.0
                if qq != 0.0:
                    w = power(a0, 2 * ORDER) * power(a1, 2 * ORDER) * power(a2, 2 * ORDER)
                    w /= denominator(b, math.sin(a0) ** 2, math.sin(a1) ** 2, math.sin(a2) ** 2)
                    if attractive:
                        value = -math.pi * math.sqrt(math.pi) * g * g * g / 3.0 * attraction(qq, g) * w
                    else:
                        value = 4.0 * math.pi / qq * math.exp(-0.25 * qq / (g * g)) * w
                green[i, j, k, 0] = value
                if not AD:
                    green[i, j, k, 1] = 0.5 * p0 * (n0 - opposite(i, numbers[0])) * value
                    green[i, j, k, 2] = 0.5 * p1 * (n1 - opposite(j, numbers[1])) * value
                    green[i, j, k, 3] = 0.5 * p2 * (n2 - opposite(k, numbers[2])) * value


def energies_disp(first, last, numbers, lengths, g, attractive, green, scale, wave, out):
    """``out (7,)`` gains energy and virial of the waves of the planes first..last-1, times `scale`."""
    v, u = np.empty(6), np.empty(6)
    nz = numbers[2]
    for i in range(first, last):
        for j in range(numbers[1]):
            for k in range(nz // 2 + 1):
                times = 1.0 if k == 0 or 2 * k == nz else 2.0
                c = wave[i, j, k]
                e = times * scale * green[i, j, k, 0] * (c.real * c.real + c.imag * c.imag)
                mean_shape(i, j, k, numbers, lengths, g, attractive, v, u)
                out[0] += e
                for m in range(6):
                    out[1 + m] += e * v[m]


def multiply_shares_disp(first, last, numbers, lengths, g, attractive, green, wave, waves):
    """Waves of the potential and of its six parts of the virial."""
    v, u = np.empty(6), np.empty(6)
    for i in range(first, last):
        for j in range(numbers[1]):
            for k in range(numbers[2] // 2 + 1):
                mean_shape(i, j, k, numbers, lengths, g, attractive, v, u)
                c = green[i, j, k, 0] * wave[i, j, k]
                waves[0, i, j, k] = c
                for m in range(6):
                    waves[1 + m, i, j, k] = v[m] * c


def mesh_forces(meeting, tid, x, f, q, lo, hi, box, origin, types, factors, signs, numbers, pieces, gfb, wrap, held, lengths, own, inverse,
                green, brick, density, wave, waves, field, packed, shares, share_field, base, weight, values, sums, constants, forward,
                forward_across, backward_across, backward, backward_shares, acc, energy, virial):
    """All of it for one thread; arguments as in `asemd.kernels.pppm.pppm` and `asemd.kernels.ewald_disp.sums_over_waves`; without force
    along z and with a slab's correction it is 5."""
    g, scale, qsum, qsqsum, stretch, slabs = constants[0], constants[1], constants[2], constants[3], constants[4], constants[5]
    least, attractive = constants[6], factors.shape[0] > 0
    nth, nx, n = meeting.nth, numbers[0], values.shape[0]
    first, last = nx * tid // nth, nx * (tid + 1) // nth
    same = is_same(box, stretch, held)
    barrier(meeting)
    if not same:
        if tid == 0:
            held[3, 0] = stretched(box, stretch, held[:3], inverse)
            for d in range(3):
                lengths[d] = held[d, d]
        barrier(meeting)
        make_green_disp(first, last, numbers, lengths, g, gfb, attractive, green)
        barrier(meeting)
        if AD and tid == 0:
            own_force(numbers, lengths, held[3, 0], green, own)
    volume = held[3, 0]
    points = numbers[0] * numbers[1] * numbers[2]
    self_energy, all_energy = -scale * g / math.sqrt(math.pi), -0.5 * scale * math.pi / (g * g * volume)
    if attractive:
        scale, self_energy, all_energy = 1.0, g**6 / 12.0, -math.pi * math.sqrt(math.pi) * g**3 / (6.0 * volume)
    for c in range(n):
        for i in range(lo, hi):
            values[c, i] = factors[types[i], c] if attractive else q[i]
        spread(x, values[c], least, lo, hi, origin, inverse, numbers, points / volume, pieces, wrap, base, weight, brick[tid])
        barrier(meeting)
        add_bricks(first, last, brick, density[c])
        barrier(meeting)
    if forward:
        call_back(forward)
    barrier(meeting)
    if forward_across:
        call_back(forward_across)
    sums[tid, :7] = 0.0
    barrier(meeting)
    for c in range(n):
        if ENERGY:
            energies_disp(first, last, numbers, lengths, g, attractive, green, signs[c] / (points * points), wave[c], sums[tid, :7])
        if PER_ATOM:
            multiply_shares_disp(first, last, numbers, lengths, g, attractive, green, wave[c], shares)
        multiply(first, last, numbers[2], green, 1.0, wave[c], waves)
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
            gather_ad(x, f, values[c], least, lo, hi, numbers, lengths, signs[c] * scale, own, wrap, base, weight, packed, slabs == 5.0)
        else:
            gather(f, values[c], least, lo, hi, signs[c] * scale, wrap, base, weight, packed, slabs == 5.0)
        if PER_ATOM:
            gather_shares(values[c], least, lo, hi, signs[c] * scale, wrap, base, weight, share_field, energy, virial)
            at_zero = signs[c] * constants[9 + c] if attractive else qsum
            for i in range(lo, hi):
                share = all_energy * values[c, i] * at_zero
                energy[i] += signs[c] * self_energy * values[c, i] ** 2 + share
                if attractive:
                    for k in range(3):
                        virial[k, i] += share
        barrier(meeting)
    if ENERGY and tid == 0:
        for t in range(nth):
            acc[0] += 0.5 * scale * volume * sums[t, 0]
            for m in range(6):
                acc[2 + m] += 0.5 * scale * volume * sums[t, 1 + m]
        own_sum, together = (constants[8], constants[7]) if attractive else (qsqsum, qsum * qsum)
        acc[0] += self_energy * own_sum + all_energy * together
        if attractive:
            for k in range(3):
                acc[2 + k] += all_energy * together
    if (slabs == 1.0 or slabs == 5.0) and not attractive:
        height = math.sqrt(held[2, 0] ** 2 + held[2, 1] ** 2 + held[2, 2] ** 2)
        barrier(meeting)
        slab(meeting, tid, x, f, q, least, lo, hi, scale, qsum, height, volume, sums, acc, energy)
    barrier(meeting)


def quality(numbers, lengths, g, attractive):
    """The sum over the mesh that the square of the error of forces is proportional to."""
    total, pi3 = 0.0, math.pi**3
    p0, p1, p2 = 2.0 * math.pi / lengths[0], 2.0 * math.pi / lengths[1], 2.0 * math.pi / lengths[2]
    w = np.empty((3, 5))
    for i in range(numbers[0]):
        n0 = folded(i, numbers[0])
        for j in range(numbers[1]):
            n1 = folded(j, numbers[1])
            for k in range(numbers[2]):
                n2 = folded(k, numbers[2])
                if n0 == 0 and n1 == 0 and n2 == 0:
                    continue
                for m in range(-2, 3):
                    w[0, m + 2] = power(math.pi * (n0 + m * numbers[0]) / numbers[0], 2 * ORDER)
                    w[1, m + 2] = power(math.pi * (n1 + m * numbers[1]) / numbers[1], 2 * ORDER)
                    w[2, m + 2] = power(math.pi * (n2 + m * numbers[2]) / numbers[2], 2 * ORDER)
                kk = (p0 * n0) ** 2 + (p1 * n1) ** 2 + (p2 * n2) ** 2
                s1, s2, s3, s4 = 0.0, 0.0, 0.0, 0.0
                for m0 in range(-2, 3):
                    q0 = p0 * (n0 + m0 * numbers[0])
                    for m1 in range(-2, 3):
                        q1 = p1 * (n1 + m1 * numbers[1])
                        for m2 in range(-2, 3):
                            q2 = p2 * (n2 + m2 * numbers[2])
                            qq = q0 * q0 + q1 * q1 + q2 * q2
                            u = w[0, m0 + 2] * w[1, m1 + 2] * w[2, m2 + 2]
                            dot = qq if AD else p0 * n0 * q0 + p1 * n1 * q1 + p2 * n2 * q2
                            if attractive:
                                term = attraction(qq, g) * g * g * g
                                s1 += term * term * pi3 / 9.0 * qq
                                s2 -= u * term * math.pi * math.sqrt(math.pi) / 3.0 * dot
                            else:
                                term = math.exp(-0.25 * qq / (g * g)) * 4.0 * math.pi
                                s1 += term * term / qq
                                s2 += u * term / qq * dot
                            s3 += u
                            s4 += u * qq
                total += s1 - s2 * s2 / (s3 * (s4 if AD else s3 * kk))
    return total


@cache
def quality_of(order: int, ad: bool):
    """`quality` for weights of that order."""
    b = Builder(f"error of meshes of dispersion, order {order}")
    b.constant("ORDER", order)
    b.constant("AD", ad)
    for f in (folded, whole_power, power, attraction, quality):
        b.function(f, fast=True)
    return b.build().quality


@cache
def kernel(level: int, order: int, ad: bool):
    """`mesh_forces` for weights of that order, differentiated if `ad`; `level`: see `asemd.kspace.term.KSpaceTerm`."""
    b = Builder(f"meshes of charges and dispersion, order {order}")
    b.line("from asemd.kernels.threads import barrier")
    b.line("from asemd.kernels.callback import call_back")
    b.constant("ORDER", order)
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.constant("AD", ad)
    b.line("from asemd.kernels.stencil import SUMS, WIDE, collect, deposit, weigh")
    for f in (denominator, folded, opposite, whole_power, power, attraction, shape, mean_shape, make_green_disp, energies_disp,
              multiply_shares_disp, spread, add_bricks, multiply, interleave, gather, gather_shares, is_same, slab,
              *((pppm_ad.overlaps, own_force, gather_ad) if ad else ())):
        b.function(f, fast=True)
    b.function(invert)
    b.function(stretched)
    b.function(mesh_forces)
    return b.build().mesh_forces
