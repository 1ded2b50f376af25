"""Kernels of hydrogen bonds: triples of donor, acceptor and a hydrogen atom bonded to the donor."""
from __future__ import annotations

import math
from functools import cache

from asemd.kernels.generate import Builder

ENERGY = PER_ATOM = False
radial = None


def find_triples(i, j, code, opposite, type_of, row, kind_of, first, partner, slot_of, out):
    """Triples of a list of pairs in ``out (5, cap)``: slots of donor, acceptor and hydrogen, code, kind of bond; returns their number.

    ``kind_of (types, types, types)`` is -1 where donor, acceptor and hydrogen make no bond; the partners of row a are
    ``partner[first[a]:first[a + 1]]``. Where `out` is too small the rest is counted only.
    """
    n = 0
    for m in range(i.shape[0]):
        for turn in range(2):
            d = i[m] if turn == 0 else j[m]
            a = j[m] if turn == 0 else i[m]
            for p in range(first[row[d]], first[row[d] + 1]):
                h = slot_of[partner[p]]
                kind = kind_of[type_of[d], type_of[a], type_of[h]]
                if kind >= 0 and row[h] != row[a]:
                    if n < out.shape[1]:
                        out[0, n] = d
                        out[1, n] = a
                        out[2, n] = h
                        out[3, n] = code[m] if turn == 0 else opposite[code[m] >> 2] * 4 + (code[m] & 3)
                        out[4, n] = kind
                    n += 1
    return n


def hydrogen_bonds(x, f, triples, images, vectors, shifts, weights, params, exact, lo, hi, sums, acc, atom_energy, atom_virial, bad):
    """Triples lo..hi-1; `sums` gets the number of bonds and their energy.

    Columns of `params`: squares of the inner and outer cutoff, least angle, power of the cosine, what is added to the angle, with its
    cosine and sine, then those of `radial`. `exact` is 0 for LAMMPS's forces where they are no gradient. ``images (m, 3)`` are the
    multiples of the box vectors that bring the hydrogen to its donor.
    """
    count, total = 0.0, 0.0
    for m in range(lo, hi):
        i, j, k, code = triples[0, m], triples[1, m], triples[2, m], triples[3, m]
        p, w = params[triples[4, m]], weights[code & 3]
        rx = x[0, j] + shifts[code >> 2, 0] - x[0, i]
        ry = x[1, j] + shifts[code >> 2, 1] - x[1, i]
        rz = x[2, j] + shifts[code >> 2, 2] - x[2, i]
        r2 = rx * rx + ry * ry + rz * rz
        if r2 >= p[1]:
            continue
        dx = x[0, i] - x[0, k] - (images[m, 0] * vectors[0, 0] + images[m, 1] * vectors[1, 0] + images[m, 2] * vectors[2, 0])
        dy = x[1, i] - x[1, k] - (images[m, 0] * vectors[0, 1] + images[m, 1] * vectors[1, 1] + images[m, 2] * vectors[2, 1])
        dz = x[2, i] - x[2, k] - (images[m, 0] * vectors[0, 2] + images[m, 1] * vectors[1, 2] + images[m, 2] * vectors[2, 2])
        ax, ay, az = dx + rx, dy + ry, dz + rz
        d2 = dx * dx + dy * dy + dz * dz
        a2 = ax * ax + ay * ay + az * az
        if r2 == 0.0 or d2 == 0.0 or a2 == 0.0:
            if bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, m, math.sqrt(r2)
            continue
        over = 1.0 / math.sqrt(d2 * a2)
        # the vector across both bonds is as long as the sine of the angle: no digits are lost near a straight line
        nx, ny, nz = dy * az - dz * ay, dz * ax - dx * az, dx * ay - dy * ax
        sine = math.sqrt(nx * nx + ny * ny + nz * nz) * over
        straight = (dx * ax + dy * ay + dz * az) * over
        angle = math.atan2(sine, straight) + p[4]
        if angle <= p[2] or angle >= 2.0 * math.pi - p[2]:
            continue
        c = straight * p[5] - sine * p[6]
        e, slope = radial(r2, p)
        power, low = 1.0, 0.0
        for _ in range(int(p[3])):
            low = power
            power *= c
        slope *= power
        if r2 > p[0]:
            width = 1.0 / (p[1] - p[0]) ** 3
            s = (p[1] - r2) * (p[1] - r2) * (p[1] + 2.0 * r2 - 3.0 * p[0]) * width
            change = 6.0 * (p[1] - r2) * (p[0] - r2) * width
            slope = slope * s + e * change * (power if exact > 0.0 else 1.0)
            e *= s
        count += 1.0
        total += w * e * power
        # the distance pulls at donor and acceptor, the cosine at all three
        g, t = 2.0 * w * slope, w * e * p[3] * low
        aside = 0.0
        if p[6] != 0.0:      # the slope of the turned cosine is the quotient of the sines
            if exact > 0.0:
                t *= (sine * p[5] + straight * p[6]) / max(sine, 1e-300)
            else:
                aside = t * (straight - c)
        t *= over
        tx = (t * (ny * dz - nz * dy) + aside * dx) / d2 - g * rx
        ty = (t * (nz * dx - nx * dz) + aside * dy) / d2 - g * ry
        tz = (t * (nx * dy - ny * dx) + aside * dz) / d2 - g * rz
        ux = (t * (ay * nz - az * ny) + aside * ax) / a2 + g * rx
        uy = (t * (az * nx - ax * nz) + aside * ay) / a2 + g * ry
        uz = (t * (ax * ny - ay * nx) + aside * az) / a2 + g * rz
        f[0, i] -= tx
        f[1, i] -= ty
        f[2, i] -= tz
        f[0, j] -= ux
        f[1, j] -= uy
        f[2, j] -= uz
        f[0, k] += tx + ux
        f[1, k] += ty + uy
        f[2, k] += tz + uz
        if ENERGY:
            xx, yy, zz = -(dx * tx + ax * ux), -(dy * ty + ay * uy), -(dz * tz + az * uz)
            xy, xz, yz = -(dx * ty + ax * uy), -(dx * tz + ax * uz), -(dy * tz + ay * uz)
            acc[0] += w * e * power
            acc[2] += xx
            acc[3] += yy
            acc[4] += zz
            acc[5] += xy
            acc[6] += xz
            acc[7] += yz
            if PER_ATOM:
                third = 1.0 / 3.0
                for s in (i, j, k):
                    atom_energy[s] += third * w * e * power
                    atom_virial[0, s] += third * xx
                    atom_virial[1, s] += third * yy
                    atom_virial[2, s] += third * zz
                    atom_virial[3, s] += third * xy
                    atom_virial[4, s] += third * xz
                    atom_virial[5, s] += third * yz
    sums[0], sums[1] = count, total


@cache
def finder():
    """The compiled `find_triples`."""
    b = Builder("triples of hydrogen bonds")
    b.function(find_triples)
    return b.build().find_triples


@cache
def kernel(form, energy: bool, per_atom: bool):
    """The compiled `hydrogen_bonds` for a function ``form(r2, p)`` that gives energy and derivative by r2."""
    b = Builder("hydrogen bonds")
    b.constant("ENERGY", energy)
    b.constant("PER_ATOM", per_atom)
    b.function(form, "radial", fast=True)
    b.function(hydrogen_bonds)
    return b.build().hydrogen_bonds

