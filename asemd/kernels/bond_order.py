"""The reactive bond-order potentials REBO and AIREBO over rows of neighbours: bonds, dispersion between what is not bonded, torsions.

Rows of `shared` by slot: coordinations by carbon and by hydrogen, number of bonds, how many of them count as those of this slot, element (0
carbon, 1 hydrogen), then for each bond slot, vector, length, weight, its derivative, and element; at the end the sums of
the slot's energies of bonds, dispersion and torsion. Arrays and constants are those of
`asemd.pair.airebo`, columns of numbers by pair of elements those of `asemd.airebo_file`.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels import bond_order_terms as terms
from asemd.kernels.bond_order_terms import (
    BONDS,
    FIRST,
    SUMS,
    WIDTH,
    add_energy,
    add_pair,
    add_quadruple,
    add_surroundings,
    add_triple,
    add_twist,
    add_virial_of,
    angular,
    bicubic,
    blend,
    bond_of,
    bond_order,
    dot,
    fade,
    hermite,
    is_atom,
    mixed,
    polynomial,
    pull,
    smooth,
    surroundings,
    tricubic,
    turns,
)
from asemd.kernels.manybody import gather_near
from asemd.kernels.threads import barrier

NAMED = {name: getattr(terms, name) for name in ("BONDS", "FIRST", "WIDTH", "RHO", "SUMS", "STRAIGHT")}
ROWS = SUMS + 3


def attraction(r, p):
    """Lennard-Jones energy of two atoms and its derivative."""
    i2 = 1.0 / (r * r)
    i6 = i2 * i2 * i2
    return i6 * (p[19] * i6 - p[20]), i6 * (6.0 * p[20] - 12.0 * p[19] * i6) / r


def leg(shared, pair, i, j, v):
    """Weight that a bond of atom i with the atom of slot j, `v` away, would have, its derivative, and the length.

    By distance, not by the rows: the last bond of a way counts for atoms that ``neigh_modify exclude`` takes out of the rows, too.
    """
    p = pair[int(shared[4, i]), int(shared[4, j])]
    r2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    if r2 >= p[1] * p[1]:
        return 0.0, 0.0, 0.0
    r = math.sqrt(r2)
    w, d = fade(r, p[0], p[1])
    return w, d, r


def find_path(shared, pair, i, j, v, r, path):
    """The strongest way over bonds from i to j, at most three, as the product of their weights; how many bonds it has, and which.

    path : (2,) array
        The bonds of the first and the second atom on the way; the last bond is the one that ends at j.
    """
    best, steps = 0.0, 0
    if r >= 3.0 * pair[0, 0, 1]:
        return best, steps
    best, _, length = leg(shared, pair, i, j, v)
    if length > 0.0:
        steps = 1
    for b in range(int(shared[2, i])):
        if best >= 1.0:
            break
        k, d, rk = bond_of(shared, i, b)
        wk = shared[FIRST + WIDTH * b + 5, i]
        if wk <= best or is_atom(shared, i, b, j, v[0], v[1], v[2]):
            continue
        rest = v[0] - d[0], v[1] - d[1], v[2] - d[2]
        w, _, _ = leg(shared, pair, k, j, rest)
        if wk * w > best:
            best, steps = wk * w, 2
            path[0] = b
        for c in range(int(shared[2, k])):
            w = wk * shared[FIRST + WIDTH * c + 5, k]
            if w <= best or is_atom(shared, k, c, j, rest[0], rest[1], rest[2]) or is_atom(shared, k, c, i, -d[0], -d[1], -d[2]):
                continue
            m, e, rm = bond_of(shared, k, c)
            w3, _, _ = leg(shared, pair, m, j, (rest[0] - e[0], rest[1] - e[1], rest[2] - e[2]))
            if w * w3 > best:
                best, steps = w * w3, 3
                path[0], path[1] = b, c
    return best, steps


def add_path(shared, pair, out, i, j, v, r, steps, path, weight):
    """Forces of `weight` times the product of the weights on the way from i to j."""
    if steps == 1:
        _, d, _ = leg(shared, pair, i, j, v)
        add_pair(out, i, j, v, weight * d / r)
        return
    b, c = int(path[0]), int(path[1])
    k, d, rk = bond_of(shared, i, b)
    row, next_row = FIRST + WIDTH * b, FIRST + WIDTH * c
    w1, d1 = shared[row + 5, i], shared[row + 6, i]
    back = -d[0], -d[1], -d[2]
    rest = v[0] - d[0], v[1] - d[1], v[2] - d[2]
    if steps == 2:
        w2, d2, rm = leg(shared, pair, k, j, rest)
        add_triple(out, k, i, j, back, mixed(weight * d1 * w2 / rk, back, 0.0, back), rest, mixed(weight * w1 * d2 / rm, rest, 0.0, rest))
        return
    m, e, rm = bond_of(shared, k, c)
    w2, d2 = shared[next_row + 5, k], shared[next_row + 6, k]
    f = rest[0] - e[0], rest[1] - e[1], rest[2] - e[2]
    w3, d3, rf = leg(shared, pair, m, j, f)
    add_quadruple(out, k, m, i, j, e, mixed(weight * w1 * d2 * w3 / rm, e, 0.0, e), back,
                  mixed(weight * d1 * w2 * w3 / rk, back, 0.0, back), f,
                  mixed(weight * w1 * w2 * d3 / rf, f, 0.0, f))


def bond(p, r, w, dw):
    """Repulsion and attraction of a bond of weight w, each with its derivative."""
    a = p[5] * math.exp(-p[4] * r)
    b, db = 0.0, 0.0
    for k in range(3):
        t = p[6 + k] * math.exp(-p[9 + k] * r)
        b -= w * t
        db -= (dw - p[9 + k] * w) * t
    near_ = 1.0 + p[3] / r
    return a * w * near_, a * (dw * near_ - w * p[3] / (r * r) - p[4] * w * near_), b, db


def bond_order_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                      grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Bonds of slots lo..hi-1, then, when all threads have theirs, forces; arguments as in `asemd.kernels.manybody.site_forces`."""
    element, pair, ends, many, few, ends_h, hydrogen, lone, conjugated, limits = arrays
    angles, nodes = (ends, many, few, ends_h, hydrogen), (lone, conjugated)
    for i in range(lo, hi):
        m = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        n = gather_near(i, middle[i], last[i], m, x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        ei, bonds = element[type_of[i]], 0
        shared[0, i], shared[1, i], shared[3, i], shared[4, i] = 0.0, 0.0, 0.0, ei
        for k in range(n):
            if k == m:
                shared[3, i] = bonds
            ek, r = element[types[k]], math.sqrt(near[3, k])
            if r >= pair[ei, ek, 1]:
                continue
            if bonds == BONDS:
                if bad[0] == 0.0:
                    bad[0], bad[1], bad[2] = 1.0, i, math.nan
                break
            w, dw = fade(r, pair[ei, ek, 0], pair[ei, ek, 1])
            shared[ek, i] += w
            row = FIRST + WIDTH * bonds
            shared[row, i] = slots[k]
            shared[row + 1, i], shared[row + 2, i], shared[row + 3, i] = near[0, k], near[1, k], near[2, k]
            shared[row + 4, i], shared[row + 5, i], shared[row + 6, i], shared[row + 7, i] = r, w, dw, ek
            bonds += 1
        if m >= n:
            shared[3, i] = bonds
        shared[2, i] = bonds
    barrier(meeting)
    out = (f, acc, atom_energy, atom_virial)
    for i in range(lo, hi):
        bonds, n = int(shared[3, i]), 0
        for k in range(3):
            shared[SUMS + k, i] = 0.0
        if constants[0] == 1.0:
            n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        # first the bonds, then all pairs for dispersion, so that what both do is compiled once
        for item in range(bonds + n):
            bonded = item < bonds
            b, k = min(item, BONDS - 1), max(item - bonds, 0)
            j, v, r = bond_of(shared, i, b)
            if not bonded:
                j, v, r = int(slots[k]), (near[0, k], near[1, k], near[2, k]), math.sqrt(near[3, k])
            p = pair[int(shared[4, i]), int(shared[4, j])]
            if bonded:
                w = shared[FIRST + WIDTH * b + 5, i]
                if w <= 1e-9:
                    continue
                e, d, part, slope = bond(p, r, w, shared[FIRST + WIDTH * b + 6, i])
                steps, apart, close, dclose, length, low, high = 0, 1.0, 1.0, 0.0, r, 0.0, 0.0
            else:
                if r >= min(p[18], p[24]):
                    continue
                best, steps = find_path(shared, pair, i, j, v, r, room[10])
                apart = 1.0 - best
                if apart == 0.0:
                    continue
                e, d = attraction(r, p)
                s, ds = smooth(r, p[17], p[18])
                d = d * s + e * ds
                e *= s
                close, dclose = smooth(r, p[13], p[14])
                part, slope, length, low, high = close * apart * e, 0.0, p[0], p[15], p[16]
            order = 0.0
            if close > 0.0:
                torsion = bonded and constants[1] == 1.0 and shared[4, i] + shared[4, j] == 0.0
                order = bond_order(shared, room, pair, angles, nodes, limits, out, i, j, v, length, part, low, high, torsion)
            if bonded:
                total, along = e + order * part, d + order * slope
            else:
                scale = close * order + 1.0 - close
                total, along = e * apart * scale, apart * (d * scale + e * dclose * (order - 1.0))
                if steps > 0:
                    add_path(shared, pair, out, i, j, v, r, steps, room[10], -e * scale)
            shared[SUMS if bonded else SUMS + 1, i] += total
            add_energy(out, (i, j), total)
            add_pair(out, i, j, v, along / r)
        energy = shared[SUMS, i] + shared[SUMS + 1, i] + shared[SUMS + 2, i]
        if not abs(energy) < math.inf and bad[0] == 0.0:
            bad[0], bad[1], bad[2] = 1.0, i, energy


HELPERS = (fade, smooth, polynomial, angular, hermite, bicubic, blend, tricubic, is_atom, add_virial_of, add_energy, pull, add_pair,
           add_triple, add_quadruple, dot, mixed, bond_of, add_twist, surroundings, add_surroundings, turns, bond_order, attraction,
           leg, find_path, add_path, bond)
