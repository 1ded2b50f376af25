"""Embedded-ion potentials (eim) over rows of neighbours: charges, then potentials, then forces."""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.manybody import add_virial, gather_near, scatter, share_pair
from asemd.kernels.threads import barrier

ENERGY = PER_ATOM = False


def interval(table, row, at, t):
    """Value and slope by t of the cubic whose coefficients begin in column `at`."""
    a, b, c, d = table[row, at], table[row, at + 1], table[row, at + 2], table[row, at + 3]
    return ((a * t + b) * t + c) * t + d, (3.0 * a * t + 2.0 * b) * t + c


def ion_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots, grad,
               room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Charges of slots lo..hi-1 (``shared[0]``), potentials (``shared[1]``), forces; arguments as in `asemd.kernels.manybody.site_forces`.

    Columns of the table: eta that an atom of the second type makes at one of the first, psi, phi; `offset` is the first row of two types.
    """
    table, offset = arrays
    rdr = constants[0]
    end = int(constants[1])
    for i in range(lo, hi):
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        charge = 0.0
        for k in range(n):
            p = math.sqrt(near[3, k]) * rdr
            m = min(int(p), end)
            eta, slope = interval(table, offset[type_of[i], types[k]] + m, 0, min(p - m, 1.0))
            charge += eta
        shared[0, i] = charge
    barrier(meeting)
    for i in range(lo, hi):
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        potential = 0.0
        for k in range(n):
            p = math.sqrt(near[3, k]) * rdr
            m = min(int(p), end)
            psi, slope = interval(table, offset[type_of[i], types[k]] + m, 4, min(p - m, 1.0))
            potential += shared[0, slots[k]] * psi
        shared[1, i] = potential
        energy = 0.5 * shared[0, i] * potential
        if ENERGY:
            acc[0] += energy
        if PER_ATOM:
            atom_energy[i] += energy
    barrier(meeting)
    for i in range(lo, hi):
        n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(n):
            r = math.sqrt(near[3, k])
            p = r * rdr
            m = min(int(p), end)
            t = min(p - m, 1.0)
            row = offset[type_of[i], types[k]] + m
            eta, eta_i = interval(table, row, 0, t)
            eta, eta_j = interval(table, offset[types[k], type_of[i]] + m, 0, t)
            psi, psi_slope = interval(table, row, 4, t)
            phi, phi_slope = interval(table, row, 8, t)
            j = slots[k]
            slope = (phi_slope + shared[1, i] * eta_i + shared[1, j] * eta_j + shared[0, i] * shared[0, j] * psi_slope) * rdr / r
            if not abs(slope) < math.inf and bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, i, phi
            grad[0, k], grad[1, k], grad[2, k] = near[0, k] * slope, near[1, k] * slope, near[2, k] * slope
            if ENERGY:
                acc[0] += phi
            if PER_ATOM:
                share_pair((atom_energy, atom_virial, np.int32(i), near, slots), k, phi, grad[0, k], grad[1, k], grad[2, k])
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)
