"""What the bond-order potentials REBO and AIREBO are made of: switches, splines, sums over the neighbours of a bond, forces on atoms.

Forces come from derivatives by vectors between atoms: ``out`` is (f, acc, energies, virials), an energy that changes by g with the vector
from a to b is a force -g on b and g on a, and virials of single atoms are shared as LAMMPS does, by the atoms of a term.
"""
from __future__ import annotations

import math

ENERGY = PER_ATOM = False
BONDS = 24             # places for bonds of an atom
FIRST, WIDTH = 5, 8    # rows of a bond in `shared`: see `asemd.kernels.bond_order`
RHO = 12
STRAIGHT = 1e-13       # of the cosine from that of a straight angle: dihedrals have faded there, to less than forces are rounded to
SUMS = FIRST + WIDTH * BONDS


def fade(x, low, high):
    """Half a cosine from 1 at `low` to 0 at `high`, and its derivative."""
    t = (x - low) / (high - low)
    if t <= 0.0:
        return 1.0, 0.0
    if t >= 1.0:
        return 0.0, 0.0
    return 0.5 * (1.0 + math.cos(math.pi * t)), -0.5 * math.pi * math.sin(math.pi * t) / (high - low)


def smooth(x, low, high):
    """A cubic from 1 at `low` to 0 at `high`, and its derivative."""
    t = (x - low) / (high - low)
    if t <= 0.0:
        return 1.0, 0.0
    if t >= 1.0:
        return 0.0, 0.0
    return 1.0 - t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t) / (high - low)


def polynomial(x, ends, table):
    """Value and derivative of a polynomial of fifth degree in pieces."""
    x = min(max(x, ends[0]), ends[table.shape[0]])
    k = 0
    while k < table.shape[0] - 1 and x >= ends[k + 1]:
        k += 1
    value, slope = table[k, 5], 0.0
    for m in range(4, -1, -1):
        slope = slope * x + value
        value = value * x + table[k, m]
    return value, slope


def angular(x, n, element, tables, low, high):
    """The angular function G of the cosine x and the coordination n, and its derivatives by both."""
    ends, many, few, ends_h, hydrogen = tables
    if element == 1:
        g, slope = polynomial(x, ends_h, hydrogen)
        return g, slope, 0.0
    s, ds = fade(n, low, high)
    g, slope = polynomial(x, ends, many)
    if s == 0.0:
        return g, slope, 0.0
    other, d = polynomial(x, ends, few)
    return g + s * (other - g), slope + s * (d - slope), ds * (other - g)


def hermite(t):
    """Cubics that are 1 or have slope 1 at one end, and their derivatives: values at 0 and 1, slopes at 0 and 1."""
    u = 1.0 - t
    return ((1.0 + 2.0 * t) * u * u, t * t * (3.0 - 2.0 * t), t * u * u, -t * t * u), \
        (-6.0 * t * u, 6.0 * t * u, u * (1.0 - 3.0 * t), t * (3.0 * t - 2.0))


def bicubic(table, x, y):
    """Value and derivatives between values (n, n) with slopes of zero."""
    last = table.shape[0] - 1
    x, y = min(x, last + 0.0), min(y, last + 0.0)
    a, b = min(int(x), last - 1), min(int(y), last - 1)
    p, dp = hermite(x - a)
    q, dq = hermite(y - b)
    value, dx, dy = 0.0, 0.0, 0.0
    for i in range(2):
        for j in range(2):
            f = table[a + i, b + j]
            value += f * p[i] * q[j]
            dx += f * dp[i] * q[j]
            dy += f * p[i] * dq[j]
    return value, dx, dy


def blend(n, p, q, r, ps, qs, rs):
    """Value and slopes `n` with their weights along three axes."""
    return n[0] * p * q * r + n[1] * ps * q * r + n[2] * p * qs * r + n[3] * p * q * rs


def tricubic(table, x, y, z):
    """Value and derivatives between values and slopes along the axes (5, 5, 10, 4)."""
    x, y, z = min(x, 4.0), min(y, 4.0), min(z, 9.0)
    a, b, c = min(int(x), 3), min(int(y), 3), min(int(z), 8)
    p, dp = hermite(x - a)
    q, dq = hermite(y - b)
    r, dr = hermite(z - c)
    value, dx, dy, dz = 0.0, 0.0, 0.0, 0.0
    for i in range(2):
        for j in range(2):
            for k in range(2):
                n = table[a + i, b + j, c + k]
                value += blend(n, p[i], q[j], r[k], p[i + 2], q[j + 2], r[k + 2])
                dx += blend(n, dp[i], q[j], r[k], dp[i + 2], q[j + 2], r[k + 2])
                dy += blend(n, p[i], dq[j], r[k], p[i + 2], dq[j + 2], r[k + 2])
                dz += blend(n, p[i], q[j], dr[k], p[i + 2], q[j + 2], dr[k + 2])
    return value, dx, dy, dz


def is_atom(shared, i, b, j, dx, dy, dz):
    """Whether bond `b` of slot i leads to slot j at that vector, and not to another image of it."""
    row = FIRST + WIDTH * b
    if int(shared[row, i]) != j:
        return False
    ex, ey, ez = shared[row + 1, i] - dx, shared[row + 2, i] - dy, shared[row + 3, i] - dz
    return ex * ex + ey * ey + ez * ez < 1e-6


def add_virial_of(out, atoms, xx, yy, zz, xy, xz, yz):
    """A virial, also in equal parts to some atoms."""
    acc, virials = out[1], out[3]
    acc[2] -= xx
    acc[3] -= yy
    acc[4] -= zz
    acc[5] -= xy
    acc[6] -= xz
    acc[7] -= yz
    if PER_ATOM:
        part = 1.0 / len(atoms)
        for a in atoms:
            virials[0, a] -= part * xx
            virials[1, a] -= part * yy
            virials[2, a] -= part * zz
            virials[3, a] -= part * xy
            virials[4, a] -= part * xz
            virials[5, a] -= part * yz


def add_energy(out, atoms, e):
    """An energy, also in equal parts to some atoms."""
    if ENERGY:
        out[1][0] += e
    if PER_ATOM:
        for a in atoms:
            out[2][a] += e / len(atoms)


def pull(f, i, j, g):
    """Forces of an energy with derivative `g` by the vector from i to j."""
    f[0, i] += g[0]
    f[1, i] += g[1]
    f[2, i] += g[2]
    f[0, j] -= g[0]
    f[1, j] -= g[1]
    f[2, j] -= g[2]


def add_pair(out, i, j, v, d):
    """A derivative `d` by the square of the distance, halved: the energy changes by d v with the vector v from i to j."""
    g = (d * v[0], d * v[1], d * v[2])
    pull(out[0], i, j, g)
    if ENERGY:
        add_virial_of(out, (i, j), v[0] * g[0], v[1] * g[1], v[2] * g[2], v[0] * g[1], v[0] * g[2], v[1] * g[2])


def add_triple(out, i, j, k, a, ga, b, gb):
    """Derivatives by the vectors a from i to j and b from i to k."""
    pull(out[0], i, j, ga)
    pull(out[0], i, k, gb)
    if ENERGY:
        add_virial_of(out, (i, j, k), a[0] * ga[0] + b[0] * gb[0], a[1] * ga[1] + b[1] * gb[1], a[2] * ga[2] + b[2] * gb[2],
                      a[0] * ga[1] + b[0] * gb[1], a[0] * ga[2] + b[0] * gb[2], a[1] * ga[2] + b[1] * gb[2])


def add_quadruple(out, i, j, k, m, a, ga, b, gb, c, gc):
    """Derivatives by the vectors a from i to j, b from i to k and c from j to m."""
    pull(out[0], i, j, ga)
    pull(out[0], i, k, gb)
    pull(out[0], j, m, gc)
    if ENERGY:
        add_virial_of(out, (i, j, k, m), a[0] * ga[0] + b[0] * gb[0] + c[0] * gc[0], a[1] * ga[1] + b[1] * gb[1] + c[1] * gc[1],
                      a[2] * ga[2] + b[2] * gb[2] + c[2] * gc[2], a[0] * ga[1] + b[0] * gb[1] + c[0] * gc[1],
                      a[0] * ga[2] + b[0] * gb[2] + c[0] * gc[2], a[1] * ga[2] + b[1] * gb[2] + c[1] * gc[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def mixed(s, a, t, b):
    """s a + t b"""
    return s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]


def bond_of(shared, i, b):
    """Slot, vector and length of a bond."""
    row = FIRST + WIDTH * b
    return int(shared[row, i]), (shared[row + 1, i], shared[row + 2, i], shared[row + 3, i]), shared[row + 4, i]


def add_twist(out, i, j, k, m, a, ra, b, rb, c, rc, by_turn, by_b, by_c, along_a, along_b, along_c):
    """Derivatives of an energy by the cosine of the dihedral k-i-j-m, by the cosines of a with b and c, by the three lengths."""
    u, v, w = mixed(1.0 / ra, a, 0.0, a), mixed(1.0 / rb, b, 0.0, b), mixed(1.0 / rc, c, 0.0, c)
    x, y, q = dot(u, v), dot(u, w), dot(v, w)
    sx, sy = 1.0 - x * x, 1.0 - y * y
    inverse = 1.0 / math.sqrt(sx * sy)
    turn = (q - x * y) * inverse
    dq = by_turn * inverse
    dx = by_b + by_turn * (turn * x / sx - y * inverse)
    dy = by_c + by_turn * (turn * y / sy - x * inverse)
    gb = mixed(dx / rb, u, along_b - (dx * x + dq * q) / rb, v)
    gb = mixed(1.0, gb, dq / rb, w)
    gc = mixed(dy / rc, u, along_c - (dy * y + dq * q) / rc, w)
    gc = mixed(1.0, gc, dq / rc, v)
    ga = mixed(dx / ra, v, along_a - (dx * x + dy * y) / ra, u)
    ga = mixed(1.0, ga, dy / ra, w)
    add_quadruple(out, i, j, k, m, a, ga, b, gb, c, gc)


def surroundings(shared, room, base, pair, angles, limits, a, p, v, length):
    """What the other neighbours of atom a say about its bond v to atom p, of that length: coordinations by carbon and hydrogen, the sum
    of angular terms and its derivative by the coordination, the sum of conjugation.

    Rows `base`... of `room` keep for each bond its cosine (2 for the bond to p), the derivative by it, that by its weight, and how much its
    atom is conjugated, with the derivative by the coordination there.
    """
    ea, ep, n = int(shared[4, a]), int(shared[4, p]), int(shared[2, a])
    carbons, hydrogens = 0.0, 0.0
    for b in range(n):
        row = FIRST + WIDTH * b
        partner = is_atom(shared, a, b, p, v[0], v[1], v[2])
        room[base, b] = 2.0 if partner else 0.0
        if not partner:
            carbons += shared[row + 5, a] if shared[row + 7, a] == 0.0 else 0.0
            hydrogens += shared[row + 5, a] if shared[row + 7, a] == 1.0 else 0.0
    total, slope, conjugated = 0.0, 0.0, 0.0
    rv = math.sqrt(dot(v, v))
    for b in range(n):
        if room[base, b] == 2.0:
            continue
        k, d, r = bond_of(shared, a, b)
        w, ek = shared[FIRST + WIDTH * b + 5, a], int(shared[4, k])
        x = min(max(dot(v, d) / (rv * r), -1.0), 1.0)
        e = math.exp(4.0 * ((pair[1, ek, RHO] - r) - (pair[1, ep, RHO] - length))) if ea == 1 else 1.0
        g, dx, dn = angular(x, carbons + hydrogens, ea, angles, limits[2], limits[3])
        total += w * g * e
        slope += w * dn * e
        room[base, b] = x
        room[base + 1, b] = w * dx * e
        room[base + 2, b] = g * e
        room[base + 3, b], room[base + 4, b] = 0.0, 0.0
        if ek == 0:
            room[base + 3, b], room[base + 4, b] = fade(shared[0, k] + shared[1, k] - w, limits[0], limits[1])
            conjugated += w * room[base + 3, b]
    return carbons, hydrogens, total, slope, conjugated


def add_surroundings(shared, room, base, out, a, p, v, stretches, h, slope, by_carbon, by_hydrogen, by_number, by_conjugation):
    """Forces on the atoms around a and p of an energy with derivative `h` by the sum of angular terms and those other derivatives;
    `stretches`: the length of the bond is that of its vector."""
    rv = math.sqrt(dot(v, v))
    u = mixed(1.0 / rv, v, 0.0, v)
    for b in range(int(shared[2, a])):
        x = room[base, b]
        if x == 2.0:
            continue
        row = FIRST + WIDTH * b
        k, d, r = bond_of(shared, a, b)
        w, dw = shared[row + 5, a], shared[row + 6, a]
        unit = mixed(1.0 / r, d, 0.0, d)
        t = h * room[base + 1, b]
        along = h * (room[base + 2, b] + slope) + (by_carbon if shared[row + 7, a] == 0.0 else by_hydrogen)
        longer = 4.0 * h * w * room[base + 2, b] if shared[4, a] == 1.0 else 0.0
        add_triple(out, a, p, k, v, mixed(t / rv, unit, (longer if stretches else 0.0) - t * x / rv, u),
                   d, mixed(t / r, u, along * dw - longer - t * x / r, unit))
        s = (by_number + by_conjugation * room[base + 3, b]) * dw
        if s != 0.0:
            add_pair(out, a, k, d, s / r)
        s = by_conjugation * w * room[base + 4, b]
        if s != 0.0:
            for c in range(int(shared[2, k])):
                if not is_atom(shared, k, c, a, -d[0], -d[1], -d[2]):
                    m, e, re = bond_of(shared, k, c)
                    add_pair(out, k, m, e, s * shared[FIRST + WIDTH * c + 6, k] / re)


def turns(shared, pair, out, i, j, v, r, stage, weight):
    """Sum over the dihedrals around the bond v from i to j of their squared sines (`stage` 0); forces of `weight` times this sum (1);
    torsion energies with their forces (2). The ends of a dihedral fade with the distance, and where one of its angles is straight.
    """
    u, total = mixed(1.0 / r, v, 0.0, v), 0.0
    ei, ej = int(shared[4, i]), int(shared[4, j])
    torsion = stage == 2
    end = 1 if torsion else 2
    w23, dw23 = fade(r, pair[ei, ej, 0], pair[ei, ej, 1])
    if not torsion:
        w23, dw23 = 1.0, 0.0
    for b in range(int(shared[2, i])):
        k, d, rk = bond_of(shared, i, b)
        x = min(max(dot(u, d) / rk, -1.0), 1.0)
        if 1.0 + x < STRAIGHT or 1.0 - x * x <= 1e-18 or is_atom(shared, i, b, j, v[0], v[1], v[2]):
            continue
        ek = int(shared[4, k])
        w21, dw21 = fade(rk, pair[ei, ek, 0], pair[ei, ek, end])
        s21, ds21 = smooth(x, -1.0, -0.995)
        for c in range(int(shared[2, j])):
            m, e, rm = bond_of(shared, j, c)
            y = min(max(dot(u, e) / rm, -1.0), 1.0)
            back = is_atom(shared, j, c, i, -v[0], -v[1], -v[2]) or is_atom(shared, j, c, k, d[0] - v[0], d[1] - v[1], d[2] - v[2])
            if 1.0 - y < STRAIGHT or 1.0 - y * y <= 1e-18 or back:
                continue
            em = int(shared[4, m])
            w34, dw34 = fade(rm, pair[ej, em, 0], pair[ej, em, end])
            s34, ds34 = smooth(-y, -1.0, -0.995)
            turn = (dot(d, e) / (rk * rm) - x * y) / math.sqrt((1.0 - x * x) * (1.0 - y * y))
            g, dg = 1.0 - turn * turn, -2.0 * turn
            if torsion:
                half = 0.5 * (1.0 + turn)
                g = pair[ek, em, 23] * (256.0 / 405.0 * half**5 - 0.1)
                dg = pair[ek, em, 23] * (128.0 / 81.0) * half**4
            faded, open_ = weight * w23 * w21 * w34, (1.0 - s21) * (1.0 - s34)
            total += g * faded * open_
            if torsion:
                add_energy(out, (i, j, k, m), g * faded * open_)
            if stage > 0:
                lone = g * weight * open_
                add_twist(out, i, j, k, m, v, r, d, rk, e, rm, dg * faded * open_, -g * faded * ds21 * (1.0 - s34),
                          g * faded * (1.0 - s21) * ds34, lone * dw23 * w21 * w34, lone * w23 * dw21 * w34, lone * w23 * w21 * dw34)
    if torsion:
        shared[SUMS + 2, i] += total
    return total


def bond_order(shared, room, pair, angles, nodes, limits, out, i, j, v, length, weight, low, high, torsion):
    """Order of the bond v from i to j as if it had that length, and the forces of `weight` times it on the surroundings, those of torsion
    energies too if asked for. With low < high the value is one that goes from 1 at bond order `low` to 0 at `high` instead."""
    ei, ej, r = int(shared[4, i]), int(shared[4, j]), math.sqrt(dot(v, v))
    lone, conjugated = nodes
    # of each side: coordinations, derivative of the angular sum by the coordination, conjugation, order, derivatives of P
    for side in range(2):
        a, p, s = (i, j, 1.0) if side == 0 else (j, i, -1.0)
        carbons, hydrogens, total, slope, u = surroundings(shared, room, 5 * side, pair, angles, limits, a, p, mixed(s, v, 0.0, v), length)
        value, by_carbon, by_hydrogen = bicubic(lone[int(shared[4, p])], carbons, hydrogens)
        on = 1.0 if shared[4, a] == 0.0 else 0.0
        mine = room[11 + side]
        mine[0], mine[1], mine[2] = carbons + hydrogens, slope, u
        mine[3], mine[4], mine[5] = 1.0 / math.sqrt(1.0 + total + on * value), on * by_carbon, on * by_hydrogen
    one, other = room[11], room[12]
    order, dni, dnj, dnu, twist, tni, tnj, tnu = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for kind in range(2 if ei + ej == 0 else 1):
        t = tricubic(conjugated[ei + ej if kind == 0 else 3], one[0], other[0], 1.0 + one[2] * one[2] + other[2] * other[2])
        if kind == 0:
            order, dni, dnj, dnu = t
        elif abs(t[0]) > 1e-9:
            twist, tni, tnj, tnu = t
    order += 0.5 * (one[3] + other[3])
    value, turned = 0.0, 0.0
    for stage in range(3):
        if stage == 1:
            order += twist * turned
            value, slope = order, 1.0
            if low < high:
                value, slope = smooth(order, low, high)
            weight *= slope
        if (stage == 0 and twist != 0.0) or (stage == 1 and weight * twist != 0.0) or (stage == 2 and torsion):
            t_sum = turns(shared, pair, out, i, j, v, r, stage, weight * twist if stage == 1 else 1.0)
            turned = t_sum if stage == 0 else turned
    if weight != 0.0:
        for side in range(2):
            a, p, s = (i, j, 1.0) if side == 0 else (j, i, -1.0)
            mine = room[11 + side]
            h = -0.25 * weight * mine[3] * mine[3] * mine[3]
            by_number = dni + tni * turned if side == 0 else dnj + tnj * turned
            add_surroundings(shared, room, 5 * side, out, a, p, mixed(s, v, 0.0, v), low == high, h, mine[1], h * mine[4], h * mine[5],
                             weight * by_number, 2.0 * weight * (dnu + tnu * turned) * mine[2])
    return value
