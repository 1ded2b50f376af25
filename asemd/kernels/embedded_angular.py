"""Angular-dependent potentials (adp) over rows of neighbours; arrays and constants are those of `asemd.embedded`."""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.embedded import embedding
from asemd.kernels.manybody import add_virial, gather_near, scatter, share_pair
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False


def angular_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                   grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Densities, dipoles and quadrupoles of slots lo..hi-1, then, when all threads have theirs, forces.

    `shared`: slope of the embedding energy, dipole, quadrupole xx yy zz xy xz yz; other arguments as in
    `asemd.kernels.manybody.site_forces`.
    """
    table, offset, functions, function_of, share = arrays
    rdr = constants[0]
    end = int(constants[1])
    for i in range(lo, hi):
        ti = type_of[i]
        for k in range(10):
            shared[k, i] = 0.0
        if function_of[ti] < 0:
            continue
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        rho, mx, my, mz, xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(n):
            p = math.sqrt(near[3, k]) * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            row = np.uint64(offset[ti, types[k]] + m)
            rho += ((table[row, 0] * t + table[row, 1]) * t + table[row, 2]) * t + table[row, 3]
            u = ((table[row, 8] * t + table[row, 9]) * t + table[row, 10]) * t + table[row, 11]
            w = ((table[row, 12] * t + table[row, 13]) * t + table[row, 14]) * t + table[row, 15]
            dx, dy, dz = near[0, k], near[1, k], near[2, k]
            mx += u * dx
            my += u * dy
            mz += u * dz
            xx += w * dx * dx
            yy += w * dy * dy
            zz += w * dz * dz
            xy += w * dx * dy
            xz += w * dx * dz
            yz += w * dy * dz
        shared[1, i], shared[2, i], shared[3, i] = mx, my, mz
        shared[4, i], shared[5, i], shared[6, i], shared[7, i], shared[8, i], shared[9, i] = xx, yy, zz, xy, xz, yz
        energy, shared[0, i] = embedding(rho, functions, function_of[ti], constants)
        trace = xx + yy + zz
        energy += 0.5 * (mx * mx + my * my + mz * mz + xx * xx + yy * yy + zz * zz) + xy * xy + xz * xz + yz * yz - trace * trace / 6.0
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
        n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        slope_of_i, m0, m1, m2 = shared[0, i], shared[1, i], shared[2, i], shared[3, i]
        q0, q1, q2, q3, q4, q5 = shared[4, i], shared[5, i], shared[6, i], shared[7, i], shared[8, i], shared[9, i]
        for k in range(n):
            j = np.uint32(slots[k])
            dx, dy, dz = near[0, k], near[1, k], near[2, k]
            r = math.sqrt(near[3, k])
            p = r * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            row = np.uint64(offset[ti, types[k]] + m)
            back = np.uint64(offset[types[k], ti] + m)
            slope_i = ((3.0 * table[row, 0] * t + 2.0 * table[row, 1]) * t + table[row, 2]) * rdr
            slope_j = ((3.0 * table[back, 0] * t + 2.0 * table[back, 1]) * t + table[back, 2]) * rdr
            z = ((table[row, 4] * t + table[row, 5]) * t + table[row, 6]) * t + table[row, 7]
            slope_z = ((3.0 * table[row, 4] * t + 2.0 * table[row, 5]) * t + table[row, 6]) * rdr
            u = ((table[row, 8] * t + table[row, 9]) * t + table[row, 10]) * t + table[row, 11]
            slope_u = ((3.0 * table[row, 8] * t + 2.0 * table[row, 9]) * t + table[row, 10]) * rdr
            w = ((table[row, 12] * t + table[row, 13]) * t + table[row, 14]) * t + table[row, 15]
            slope_w = ((3.0 * table[row, 12] * t + 2.0 * table[row, 13]) * t + table[row, 14]) * rdr
            phi = z / r
            mx, my, mz = m0 - shared[1, j], m1 - shared[2, j], m2 - shared[3, j]
            xx, yy, zz = q0 + shared[4, j], q1 + shared[5, j], q2 + shared[6, j]
            xy, xz, yz = q3 + shared[7, j], q4 + shared[8, j], q5 + shared[9, j]
            lx, ly, lz = xx * dx + xy * dy + xz * dz, xy * dx + yy * dy + yz * dz, xz * dx + yz * dy + zz * dz
            along = (slope_z - phi) / r + slope_of_i * slope_i + shared[0, j] * slope_j
            along += slope_u * (mx * dx + my * dy + mz * dz) + slope_w * (lx * dx + ly * dy + lz * dz)
            along = along / r - (xx + yy + zz) * (2.0 * w + slope_w * r) / 3.0
            grad[0, k] = along * dx + u * mx + 2.0 * w * lx
            grad[1, k] = along * dy + u * my + 2.0 * w * ly
            grad[2, k] = along * dz + u * mz + 2.0 * w * lz
            if not abs(along) < math.inf:
                if bad[0] == 0.0:
                    bad[0], bad[1], bad[2] = 1.0, i, phi
            if ENERGY:
                acc[0] += phi
            if PER_ATOM:
                share_pair((atom_energy, atom_virial, np.int32(i), near, slots), k, phi, grad[0, k], grad[1, k], grad[2, k])
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)
