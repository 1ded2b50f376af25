"""Modified embedded-atom method over rows of neighbours: screened densities, embedding energies, forces.

Arrays are those of `asemd.pair.meam`. Rows of `shared` by slot are first the densities, sums over neighbours, then the derivatives of the
embedding energy by them:

- 0: the density of order 0; 1..3: that times t1 t2 t3 of the neighbour, 4..6: times their squares
- from 7 and, in meam/ms, from 30 on: moments of order 1 (x y z), 2 (xx yy zz xy xz yz, trace), 3 (xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz,
  x y z of the trace)
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.manybody import add_virial, gather_near, scatter, share_triple
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False
SECOND = False      # there is a second set of densities
MOMENTS = 23        # rows of a set of moments
# columns of the table by atom type
RE, RHO0, BETA, BETA_M, WEIGHT, WEIGHT_M, T, DEPTH, IBAR, BACKGROUND, Z, SHAPE, IN_FORCES = 0, 1, 2, 6, 9, 12, 15, 18, 19, 20, 21, 22, 25


def smooth(x):
    """Cutoff function, 0 up to x = 0 and 1 from 1 on, and its derivative."""
    if x >= 1.0:
        return 1.0, 0.0
    if x <= 0.0:
        return 0.0, 0.0
    a = (1.0 - x) * (1.0 - x) * (1.0 - x)
    b = 1.0 - a * (1.0 - x)
    return b * b, 8.0 * b * a


def screening(j, n, ti, near, types, bounds, widest, room, slopes):
    """How much of the pair with neighbour j the others leave of it, and how many of them matter; these come to `room`: which, derivative
    of the logarithm by the squared distances from i and from j."""
    ir2 = 1.0 / near[3, j]
    tj = types[j]
    limit = widest[ti, tj] * near[3, j]
    product, count = 1.0, 0
    for k in range(n):
        if near[3, k] > limit or k == j:
            continue
        dx = near[0, k] - near[0, j]
        dy = near[1, k] - near[1, j]
        dz = near[2, k] - near[2, j]
        x = near[3, k] * ir2
        y = (dx * dx + dy * dy + dz * dz) * ir2
        d = x - y
        a = 1.0 - d * d
        if a <= 0.0:
            continue
        c = (2.0 * (x + y) + a - 2.0) / a
        low, high = bounds[ti, tj, types[k], 0], bounds[ti, tj, types[k], 1]
        if c >= high:
            continue
        if c <= low:
            return 0.0, 0
        s, ds = smooth((c - low) / (high - low))
        product *= s
        if slopes:
            w = ds * ir2 / (s * (high - low))
            u = 2.0 / a
            v = u * u * (x + y - 1.0) * d
            room[0, count] = k
            room[1, count] = w * (u + v)
            room[2, count] = w * (u - v)
            count += 1
    return product, count


def decays(atom, r, at):
    """Densities of order 0 to 3 that an atom of this type makes at a distance; weights of order 1 to 3 are in the columns from `at` on."""
    a = r / atom[RE] - 1.0
    return (atom[RHO0] * math.exp(-atom[BETA] * a), atom[at] * math.exp(-atom[BETA + 1] * a),
            atom[at + 1] * math.exp(-atom[BETA + 2] * a), atom[at + 2] * math.exp(-atom[BETA + 3] * a))


def second_decays(atom, r):
    """The densities of the second set, order 1 to 3."""
    a = r / atom[RE] - 1.0
    return (atom[WEIGHT_M] * math.exp(-atom[BETA_M] * a), atom[WEIGHT_M + 1] * math.exp(-atom[BETA_M + 1] * a),
            atom[WEIGHT_M + 2] * math.exp(-atom[BETA_M + 2] * a))


def add_moments(shared, i, at, x, y, z, p, q, w):
    """Add a neighbour in the direction x y z with densities p q w of order 1 to 3."""
    shared[at, i] += p * x
    shared[at + 1, i] += p * y
    shared[at + 2, i] += p * z
    shared[at + 3, i] += q * x * x
    shared[at + 4, i] += q * y * y
    shared[at + 5, i] += q * z * z
    shared[at + 6, i] += q * x * y
    shared[at + 7, i] += q * x * z
    shared[at + 8, i] += q * y * z
    shared[at + 9, i] += q
    shared[at + 10, i] += w * x * x * x
    shared[at + 11, i] += w * x * x * y
    shared[at + 12, i] += w * x * x * z
    shared[at + 13, i] += w * x * y * y
    shared[at + 14, i] += w * x * y * z
    shared[at + 15, i] += w * x * z * z
    shared[at + 16, i] += w * y * y * y
    shared[at + 17, i] += w * y * y * z
    shared[at + 18, i] += w * y * z * z
    shared[at + 19, i] += w * z * z * z
    shared[at + 20, i] += w * x
    shared[at + 21, i] += w * y
    shared[at + 22, i] += w * z


def squares(shared, i, at):
    """Squared densities of order 1 to 3."""
    p, q, w = 0.0, -shared[at + 9, i] * shared[at + 9, i] / 3.0, 0.0
    for k in range(3):
        p += shared[at + k, i] * shared[at + k, i]
        q += shared[at + 3 + k, i] * shared[at + 3 + k, i] + 2.0 * shared[at + 6 + k, i] * shared[at + 6 + k, i]
        w -= 0.6 * shared[at + 20 + k, i] * shared[at + 20 + k, i]
    for k in range(10):
        times = 6.0 if k == 4 else 1.0 if k == 0 or k == 6 or k == 9 else 3.0
        w += times * shared[at + 10 + k, i] * shared[at + 10 + k, i]
    return p, q, w


def to_slopes(shared, i, at, p, q, w):
    """Put derivatives by the moments in their places; p q w: those by the squares."""
    for k in range(3):
        shared[at + k, i] *= 2.0 * p
        shared[at + 3 + k, i] *= 2.0 * q
        shared[at + 6 + k, i] *= 4.0 * q
        shared[at + 20 + k, i] *= -1.2 * w
    shared[at + 9, i] *= -2.0 / 3.0 * q
    for k in range(10):
        shared[at + 10 + k, i] *= (12.0 if k == 4 else 2.0 if k == 0 or k == 6 or k == 9 else 6.0) * w


def contracted(shared, i, at, x, y, z, p, q, w):
    """Derivatives of the embedding energy by the three densities of a neighbour in the direction x y z, and the gradient by x, y and z of
    their sum weighted with p q w."""
    first = shared[at, i] * x + shared[at + 1, i] * y + shared[at + 2, i] * z
    ax = 2.0 * shared[at + 3, i] * x + shared[at + 6, i] * y + shared[at + 7, i] * z
    ay = 2.0 * shared[at + 4, i] * y + shared[at + 6, i] * x + shared[at + 8, i] * z
    az = 2.0 * shared[at + 5, i] * z + shared[at + 7, i] * x + shared[at + 8, i] * y
    second = 0.5 * (ax * x + ay * y + az * z) + shared[at + 9, i]
    xx, xy, xz, yy, yz, zz = x * x, x * y, x * z, y * y, y * z, z * z
    bx = 3.0 * shared[at + 10, i] * xx + 2.0 * (shared[at + 11, i] * xy + shared[at + 12, i] * xz) + shared[at + 13, i] * yy \
        + shared[at + 14, i] * yz + shared[at + 15, i] * zz
    by = shared[at + 11, i] * xx + 2.0 * (shared[at + 13, i] * xy + shared[at + 17, i] * yz) + shared[at + 14, i] * xz \
        + 3.0 * shared[at + 16, i] * yy + shared[at + 18, i] * zz
    bz = shared[at + 12, i] * xx + shared[at + 14, i] * xy + 2.0 * (shared[at + 15, i] * xz + shared[at + 18, i] * yz) \
        + shared[at + 17, i] * yy + 3.0 * shared[at + 19, i] * zz
    traced = shared[at + 20, i] * x + shared[at + 21, i] * y + shared[at + 22, i] * z
    third = (bx * x + by * y + bz * z) / 3.0 + traced
    return (first, second, third, p * shared[at, i] + q * ax + w * (bx + shared[at + 20, i]),
            p * shared[at + 1, i] + q * ay + w * (by + shared[at + 21, i]), p * shared[at + 2, i] + q * az + w * (bz + shared[at + 22, i]))


def correction(gamma, ibar, factor):
    """G(gamma) and its derivative."""
    if ibar == 1.0:
        g = math.exp(0.5 * gamma)
        return g, 0.5 * g
    if ibar == 3.0:
        g = 2.0 / (1.0 + math.exp(-gamma))
        return g, 0.5 * g * (2.0 - g)
    if ibar == -5.0:
        g = math.sqrt(abs(1.0 + gamma))
        d = 0.5 / g if g > 0.0 else 0.0
        return (g, d) if 1.0 + gamma >= 0.0 else (-g, d)
    point = -factor / (factor + 1.0)
    if gamma < point:
        g = math.sqrt(math.pow(point / gamma, factor) / (factor + 1.0))
        return g, -0.5 * factor * g / gamma
    g = math.sqrt(1.0 + gamma)
    return g, 0.5 / g


def embed(rho, depth, linear):
    """Embedding energy of a reduced density, and its derivative."""
    if rho > 0.0:
        return depth * rho * math.log(rho), depth * (1.0 + math.log(rho))
    return (-depth * rho, -depth) if linear == 1.0 else (0.0, 0.0)


def embedding(i, shared, atom, constants):
    """Embedding energy of slot i, and its derivatives in place of the densities."""
    alloy, mixed, linear, factor = constants[4], constants[5], constants[6], constants[7]
    rho0 = shared[0, i]
    p, q, w = squares(shared, i, 7)
    total = 0.0
    if SECOND:
        a, b, c = squares(shared, i, 7 + MOMENTS)
        total = -a - b - c
    square = (p, q, w)
    means = (0.0, 0.0, 0.0)
    if rho0 > 0.0 or alloy == 2.0:
        for k in range(3):
            t = atom[T + k]
            if SECOND:      # LAMMPS's sums, no means
                t = shared[1 + k, i] if alloy != 2.0 else 0.0
            elif alloy == 0.0:
                t = shared[1 + k, i] / rho0
            elif alloy == 1.0:
                t = shared[1 + k, i] / shared[4 + k, i] if shared[4 + k, i] != 0.0 else 0.0
            means = (means[1], means[2], t)
    ts = (1.0, 1.0, 1.0) if SECOND else means      # or they are in the weights of the densities
    total += ts[0] * square[0] + ts[1] * square[1] + ts[2] * square[2]
    weight = 1.0 / (rho0 * rho0) if rho0 > 0.0 else 0.0
    gamma = total * weight
    g, dg = correction(gamma, atom[IBAR], factor)
    background, by_t = atom[BACKGROUND], 0.0
    if mixed == 1.0 and atom[IBAR] > 0.0:
        z2 = 1.0 / (atom[Z] * atom[Z])
        mean = (means[0] * atom[SHAPE] + means[1] * atom[SHAPE + 1] + means[2] * atom[SHAPE + 2]) * z2
        gbar, dgbar = correction(mean, atom[IBAR], factor)
        background *= gbar
        by_t = -dgbar / gbar * z2
    rho = rho0 * g / background
    energy, slope = embed(rho, atom[DEPTH], linear)
    by_gamma = slope * rho0 * dg / background
    by_rho0 = slope * g / background - (2.0 * by_gamma * gamma / rho0 if rho0 > 0.0 else 0.0)
    for k in range(3):
        t = means[k]
        d = (0.0 if SECOND else by_gamma * square[k] * weight) + slope * rho * by_t * atom[SHAPE + k]
        count, shared[1 + k, i] = shared[4 + k, i], 0.0
        shared[4 + k, i] = 0.0
        if alloy == 2.0 or rho0 <= 0.0 or (SECOND and constants[8] == 1.0):
            continue
        if SECOND:
            shared[1 + k, i] = d
        elif alloy == 0.0:
            shared[1 + k, i] = d / rho0
            by_rho0 -= d * t / rho0
        elif count != 0.0:
            shared[1 + k, i] = d / count
            shared[4 + k, i] = -d * t / count
    shared[0, i] = by_rho0
    weight *= by_gamma
    to_slopes(shared, i, 7, weight * ts[0], weight * ts[1], weight * ts[2])
    if SECOND:
        to_slopes(shared, i, 7 + MOMENTS, -weight, -weight, -weight)
    return energy


def neighbour(i, shared, atom, r, x, y, z):
    """What the embedding energy of slot i has of a neighbour of this type in the direction x y z: sum of the densities times derivatives,
    its derivative by the distance, its gradient by x y z."""
    p0, p1, p2, p3 = decays(atom, r, IN_FORCES)
    d0 = shared[0, i]
    for k in range(3):
        t = atom[T + k]
        d0 += t * (shared[1 + k, i] + t * shared[4 + k, i])
    d1, d2, d3, gx, gy, gz = contracted(shared, i, 7, x, y, z, p1, p2, p3)
    value = p0 * d0 + p1 * d1 + p2 * d2 + p3 * d3
    slope = -(atom[BETA] * p0 * d0 + atom[BETA + 1] * p1 * d1 + atom[BETA + 2] * p2 * d2 + atom[BETA + 3] * p3 * d3) / atom[RE]
    if SECOND:
        p1, p2, p3 = second_decays(atom, r)
        d1, d2, d3, ax, ay, az = contracted(shared, i, 7 + MOMENTS, x, y, z, p1, p2, p3)
        value += p1 * d1 + p2 * d2 + p3 * d3
        slope -= (atom[BETA_M] * p1 * d1 + atom[BETA_M + 1] * p2 * d2 + atom[BETA_M + 2] * p3 * d3) / atom[RE]
        gx += ax
        gy += ay
        gz += az
    return value, slope, gx, gy, gz


def share_symmetric(shares, j, e, gx, gy, gz):
    """As `share_pair`, with the mean of the virial and its transpose."""
    energies, virials, i, near, slots = shares
    dx, dy, dz = near[0, j], near[1, j], near[2, j]
    for s in (i, slots[j]):
        energies[s] += 0.5 * e
        virials[0, s] -= 0.5 * dx * gx
        virials[1, s] -= 0.5 * dy * gy
        virials[2, s] -= 0.5 * dz * gz
        virials[3, s] -= 0.25 * (dx * gy + dy * gx)
        virials[4, s] -= 0.25 * (dx * gz + dz * gx)
        virials[5, s] -= 0.25 * (dy * gz + dz * gy)


def meam_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots, grad,
                room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Densities of slots lo..hi-1, then, when all threads have theirs, forces; arguments as in `asemd.kernels.manybody.site_forces`."""
    atoms, bounds, widest, phi_table, offset, scale = arrays
    rc, per_width, rdr, end = constants[0], constants[1], constants[2], int(constants[3])
    rc2 = rc * rc
    rows = 7 + MOMENTS * (2 if SECOND else 1)
    for i in range(lo, hi):
        ti = type_of[i]
        for k in range(rows):
            shared[k, i] = 0.0
        if atoms[ti, RE] == 0.0 or last[i] == first[i]:
            continue
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for j in range(n):
            if near[3, j] > rc2:
                continue
            s, count = screening(j, n, ti, near, types, bounds, widest, room, False)
            if s == 0.0:
                continue
            r = math.sqrt(near[3, j])
            fc, slope = smooth((rc - r) * per_width)
            s *= fc
            atom = atoms[types[j]]
            ux, uy, uz = near[0, j] / r, near[1, j] / r, near[2, j] / r
            p0, p1, p2, p3 = decays(atom, r, WEIGHT)
            shared[0, i] += s * p0
            for k in range(3):
                shared[1 + k, i] += s * p0 * atom[T + k]
                shared[4 + k, i] += s * p0 * atom[T + k] * atom[T + k]
            add_moments(shared, i, 7, ux, uy, uz, s * p1, s * p2, s * p3)
            if SECOND:
                p1, p2, p3 = second_decays(atom, r)
                add_moments(shared, i, 7 + MOMENTS, ux, uy, uz, s * p1, s * p2, s * p3)
        energy = scale[ti, ti] * embedding(i, shared, atoms[ti], constants)
        if not abs(energy) < math.inf:
            if bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, i, energy
            continue
        if ENERGY:
            acc[0] += energy
        if PER_ATOM:
            atom_energy[i] += energy
    barrier(meeting)
    for i in range(lo, hi):
        ti = type_of[i]
        m = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        n = gather_near(i, middle[i], last[i], m, x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(n):
            grad[0, k], grad[1, k], grad[2, k] = 0.0, 0.0, 0.0
        for j in range(m):
            if near[3, j] > rc2:
                continue
            s, count = screening(j, n, ti, near, types, bounds, widest, room, True)
            if s == 0.0:
                continue
            tj = types[j]
            r = math.sqrt(near[3, j])
            ir = 1.0 / r
            ux, uy, uz = near[0, j] * ir, near[1, j] * ir, near[2, j] * ir
            fc, dfc = smooth((rc - r) * per_width)
            p = r * rdr
            k = min(int(p), end)
            t = min(p - k, 1.0)
            k += offset[ti, tj]
            a, b, c = phi_table[k, 0], phi_table[k, 1], phi_table[k, 2]
            own = scale[ti, tj]
            phi = own * (((a * t + b) * t + c) * t + phi_table[k, 3])
            slope = own * ((3.0 * a * t + 2.0 * b) * t + c) * rdr
            scale_i, scale_j = (own, own) if constants[8] == 1.0 else (scale[ti, ti], scale[tj, tj])
            value, d, gx, gy, gz = neighbour(i, shared, atoms[tj], r, ux, uy, uz)
            total, slope, gx, gy, gz = phi + scale_i * value, slope + scale_i * d, scale_i * gx, scale_i * gy, scale_i * gz
            value, d, hx, hy, hz = neighbour(slots[j], shared, atoms[ti], r, -ux, -uy, -uz)
            total, slope, gx, gy, gz = total + scale_j * value, slope + scale_j * d, gx - scale_j * hx, gy - scale_j * hy, gz - scale_j * hz
            along = s * (fc * slope - dfc * per_width * total) - s * fc * ir * (gx * ux + gy * uy + gz * uz)
            w = s * fc * total
            if not abs(along) < math.inf and bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, i, phi
            for k in range(count):      # by the distance of the pair itself
                along -= 2.0 * w * ir * (room[1, k] * near[3, int(room[0, k])] + room[2, k] * far2(near, j, int(room[0, k])))
            gx, gy, gz = along * ux + s * fc * ir * gx, along * uy + s * fc * ir * gy, along * uz + s * fc * ir * gz
            grad[0, j] += gx
            grad[1, j] += gy
            grad[2, j] += gz
            if ENERGY:
                acc[0] += s * fc * phi
            if PER_ATOM:
                share_symmetric((atom_energy, atom_virial, np.int32(i), near, slots), j, s * fc * phi, gx, gy, gz)
            for c in range(count):
                k = int(room[0, c])
                a, b = 2.0 * w * room[1, c], 2.0 * w * room[2, c]
                hx, hy, hz = b * (near[0, k] - near[0, j]), b * (near[1, k] - near[1, j]), b * (near[2, k] - near[2, j])
                kx, ky, kz = a * near[0, k] + hx, a * near[1, k] + hy, a * near[2, k] + hz
                grad[0, j] -= hx
                grad[1, j] -= hy
                grad[2, j] -= hz
                grad[0, k] += kx
                grad[1, k] += ky
                grad[2, k] += kz
                if PER_ATOM:
                    share_triple((atom_energy, atom_virial, np.int32(i), near, slots), j, k, 0.0, -hx, -hy, -hz, kx, ky, kz)
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)


def far2(near, j, k):
    """Squared distance of two neighbours."""
    dx, dy, dz = near[0, k] - near[0, j], near[1, k] - near[1, j], near[2, k] - near[2, j]
    return dx * dx + dy * dy + dz * dz


HELPERS = (smooth, screening, decays, second_decays, add_moments, squares, to_slopes, contracted, correction, embed, embedding, neighbour,
           share_symmetric, far2)
COLUMNS = {"RE": RE, "RHO0": RHO0, "BETA": BETA, "BETA_M": BETA_M, "WEIGHT": WEIGHT, "WEIGHT_M": WEIGHT_M, "T": T, "DEPTH": DEPTH,
           "IBAR": IBAR, "BACKGROUND": BACKGROUND, "Z": Z, "SHAPE": SHAPE, "IN_FORCES": IN_FORCES, "MOMENTS": MOMENTS}
