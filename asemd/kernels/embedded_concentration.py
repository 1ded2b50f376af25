"""Concentration-dependent embedded-atom potentials (eam/cd) over rows of neighbours.

Arrays are those of `asemd.embedded`, then a number for each type, 1 for atoms of the second element; constants too, then 1 for one site
or 2, and the coefficients of h(x), constant first.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.embedded import embedding
from asemd.kernels.manybody import add_virial, gather_near, scatter, share_pair
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False


def polynomial(x, constants):
    """h(x) and its derivative; coefficients from the eleventh constant on."""
    h, slope = 0.0, 0.0
    for k in range(constants.shape[0] - 1, 9, -1):
        slope = slope * x + h
        h = h * x + constants[k]
    return h, slope


def mixed(one_site, xi, xj, constants):
    """The factor of a pair of different elements, and its derivatives by the concentrations at both."""
    if one_site:
        hi, di = polynomial(xi, constants)
        hj, dj = polynomial(xj, constants)
        return 0.5 * (hi + hj), 0.5 * di, 0.5 * dj
    h, d = polynomial(0.5 * (xi + xj), constants)
    return h, 0.5 * d, 0.5 * d


def concentration_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types,
                         slots, grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Densities, then derivatives by concentrations, then forces of slots lo..hi-1; threads wait for each other between.

    `shared`: slope of the embedding energy, concentration of the second element, the energy's derivative by it over the density; other
    arguments as in `asemd.kernels.manybody.site_forces`.
    """
    table, offset, functions, function_of, share, second = arrays
    rdr = constants[0]
    end = int(constants[1])
    one_site = constants[9] == 1.0
    for i in range(lo, hi):
        ti = type_of[i]
        for k in range(4):
            shared[k, i] = 0.0
        if function_of[ti] < 0:
            continue
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        rho, rho_b = 0.0, 0.0
        for k in range(n):
            p = math.sqrt(near[3, k]) * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            row = offset[ti, types[k]] + m
            one = ((table[row, 0] * t + table[row, 1]) * t + table[row, 2]) * t + table[row, 3]
            rho += one
            rho_b += second[types[k]] * one
        energy, shared[0, i] = embedding(rho, functions, function_of[ti], constants)
        shared[1, i] = rho_b / rho if rho > 0.0 else 0.0
        shared[3, i] = rho
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
        if function_of[ti] < 0 or not shared[3, i] > 0.0:
            continue
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        slope = 0.0
        for k in range(n):
            if second[types[k]] != second[ti]:
                r = math.sqrt(near[3, k])
                p = r * rdr
                m = min(int(p), end)
                t = min(p - m, 1.0)
                row = offset[ti, types[k]] + m
                z = ((table[row, 4] * t + table[row, 5]) * t + table[row, 6]) * t + table[row, 7]
                h, by_i, by_j = mixed(one_site, shared[1, i], shared[1, slots[k]], constants)
                slope += z / r * by_i
        shared[2, i] = slope / shared[3, i]
    barrier(meeting)
    for i in range(lo, hi):
        ti = type_of[i]
        n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(n):
            j, tj = slots[k], types[k]
            r = math.sqrt(near[3, k])
            p = r * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            at_i = offset[ti, tj] + m
            at_j = offset[tj, ti] + m
            slope_i = ((3.0 * table[at_i, 0] * t + 2.0 * table[at_i, 1]) * t + table[at_i, 2]) * rdr
            slope_j = ((3.0 * table[at_j, 0] * t + 2.0 * table[at_j, 1]) * t + table[at_j, 2]) * rdr
            z = ((table[at_i, 4] * t + table[at_i, 5]) * t + table[at_i, 6]) * t + table[at_i, 7]
            slope_z = ((3.0 * table[at_i, 4] * t + 2.0 * table[at_i, 5]) * t + table[at_i, 6]) * rdr
            phi = z / r
            h = 1.0
            if second[ti] != second[tj]:
                h, by_i, by_j = mixed(one_site, shared[1, i], shared[1, j], constants)
            slope = h * (slope_z - phi) / r
            slope += (shared[0, i] + shared[2, i] * (second[tj] - shared[1, i])) * slope_i
            slope += (shared[0, j] + shared[2, j] * (second[ti] - shared[1, j])) * slope_j
            slope /= r
            if not abs(slope) < math.inf:
                if bad[0] == 0.0:
                    bad[0], bad[1], bad[2] = 1.0, i, phi
            grad[0, k], grad[1, k], grad[2, k] = near[0, k] * slope, near[1, k] * slope, near[2, k] * slope
            if ENERGY:
                acc[0] += h * phi
            if PER_ATOM:
                share_pair((atom_energy, atom_virial, np.int32(i), near, slots), k, h * phi, grad[0, k], grad[1, k], grad[2, k])
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)
