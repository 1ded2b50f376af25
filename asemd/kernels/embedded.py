"""Embedded-atom potentials over rows of neighbours: strict arithmetic, per-atom shares, small systems.

Arrays and constants are those of `asemd.embedded`.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.manybody import add_virial, gather_near, scatter, share_pair
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False


def embedding(rho, functions, first_row, constants):
    """Embedding energy at a density, and its derivative; linear beyond the largest density of the table."""
    rdrho = constants[3]
    p = (rho - constants[6]) * rdrho
    m = min(max(int(p), int(constants[5])), int(constants[4]) - 1)
    t = max(p - m, -1.0) if constants[5] > 0.0 else p - m
    beyond = t > 1.0
    t = min(t, 1.0)
    k = first_row + m
    a, b, c, d = functions[k, 0], functions[k, 1], functions[k, 2], functions[k, 3]
    slope = ((3.0 * a * t + 2.0 * b) * t + c) * rdrho
    energy = ((a * t + b) * t + c) * t + d
    if rho > constants[7]:
        energy += slope * (rho - constants[7])
    elif beyond and constants[8] == 0.0:
        slope = 0.0
    elif constants[5] > 0.0 and rho < constants[6]:
        energy += slope * (rho - constants[6])
    return energy, slope


def embedded_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                    grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Densities of slots lo..hi-1, then, when all threads have theirs, forces; arguments as in `asemd.kernels.manybody.site_forces`."""
    table, offset, functions, function_of, share = arrays
    rdr = constants[0]
    end = int(constants[1])
    for i in range(lo, hi):
        ti = type_of[i]
        shared[0, i] = 0.0
        if function_of[ti] < 0:
            continue
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        rho = 0.0
        for k in range(n):
            p = math.sqrt(near[3, k]) * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            row = offset[ti, types[k]] + m
            rho += ((table[row, 0] * t + table[row, 1]) * t + table[row, 2]) * t + table[row, 3]
        energy, slope = embedding(rho, functions, function_of[ti], constants)
        if not abs(energy) < math.inf:
            if bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, i, energy
            continue
        shared[0, i] = share[ti] * slope
        if ENERGY:
            acc[0] += share[ti] * energy
        if PER_ATOM:
            atom_energy[i] += share[ti] * energy
    barrier(meeting)
    for i in range(lo, hi):
        ti = type_of[i]
        n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(n):
            r = math.sqrt(near[3, k])
            p = r * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            at_i = offset[ti, types[k]] + m
            at_j = offset[types[k], ti] + m
            slope_i = (3.0 * table[at_i, 0] * t + 2.0 * table[at_i, 1]) * t + table[at_i, 2]
            slope_j = (3.0 * table[at_j, 0] * t + 2.0 * table[at_j, 1]) * t + table[at_j, 2]
            z = ((table[at_i, 4] * t + table[at_i, 5]) * t + table[at_i, 6]) * t + table[at_i, 7]
            slope_z = (3.0 * table[at_i, 4] * t + 2.0 * table[at_i, 5]) * t + table[at_i, 6]
            phi = z / r
            slope = ((slope_z * rdr - phi) / r + (shared[0, i] * slope_i + shared[0, slots[k]] * slope_j) * rdr) / r
            if not abs(slope) < math.inf:
                if bad[0] == 0.0:
                    bad[0], bad[1], bad[2] = 1.0, i, phi
            grad[0, k], grad[1, k], grad[2, k] = near[0, k] * slope, near[1, k] * slope, near[2, k] * slope
            if ENERGY:
                acc[0] += phi
            if PER_ATOM:
                share_pair((atom_energy, atom_virial, np.int32(i), near, slots), k, phi, grad[0, k], grad[1, k], grad[2, k])
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)
