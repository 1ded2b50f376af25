"""Sums of observers over atoms, by row: those of a mask, or of numbered pieces (``at (n,)`` from 0, below 0 for none)."""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def kinetic(v, masses, out):
    """Sum of m v v into `out (6,)`: xx yy zz xy xz yz; masses of 0 for atoms that do not count."""
    a, b, c, d, e, f = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(v)):
        m, x, y, z = masses[i], v[i, 0], v[i, 1], v[i, 2]
        a += m * x * x
        b += m * y * y
        c += m * z * z
        d += m * x * y
        e += m * x * z
        f += m * y * z
    out[0], out[1], out[2], out[3], out[4], out[5] = a, b, c, d, e, f


@njit(cache=True, nogil=True)
def unwrap(x, image, cell, out):
    """Positions (n, 3) outside the box, as `image (n, 3)` says."""
    for i in range(len(x)):
        a, b, c = float(image[i, 0]), float(image[i, 1]), float(image[i, 2])
        for d in range(3):
            out[i, d] = x[i, d] + (a * cell[0, d] + b * cell[1, d] + c * cell[2, d])


@njit(cache=True, nogil=True)
def displacement(x, image, cell, drift, before, mask, out):
    """Sum of the squares of unwrapped positions less `drift (3,)` less `before (n, 3)` into `out (3,)`."""
    p, q, r = 0.0, 0.0, 0.0
    for i in range(len(x)):
        if mask[i]:
            a, b, c = float(image[i, 0]), float(image[i, 1]), float(image[i, 2])
            u = x[i, 0] + (a * cell[0, 0] + b * cell[1, 0] + c * cell[2, 0]) - drift[0] - before[i, 0]
            v = x[i, 1] + (a * cell[0, 1] + b * cell[1, 1] + c * cell[2, 1]) - drift[1] - before[i, 1]
            w = x[i, 2] + (a * cell[0, 2] + b * cell[1, 2] + c * cell[2, 2]) - drift[2] - before[i, 2]
            p += u * u
            q += v * v
            r += w * w
    out[0], out[1], out[2] = p, q, r


@njit(cache=True, nogil=True)
def product(u, v, mask, out):
    """Sum of products along x, y and z of vectors (n, 3) into `out (3,)`."""
    a, b, c = 0.0, 0.0, 0.0
    for i in range(len(u)):
        if mask[i]:
            a += u[i, 0] * v[i, 0]
            b += u[i, 1] * v[i, 1]
            c += u[i, 2] * v[i, 2]
    out[0], out[1], out[2] = a, b, c


@njit(cache=True, nogil=True)
def stress(v, masses, virials, mask, mvv2e, nktv2p, out):
    """Minus kinetic and virial part of each atom of a mask into `out (n, 6)`, xx yy zz xy xz yz, or `out (n, 9)`, then also yx zx zy;
    `mvv2e` 0: no kinetic part."""
    for i in range(len(v)):
        if mask[i]:
            m = mvv2e * masses[i] if mvv2e != 0.0 else 0.0
            x, y, z = v[i, 0], v[i, 1], v[i, 2]
            out[i, 0] = -nktv2p * (m * x * x + virials[i, 0])
            out[i, 1] = -nktv2p * (m * y * y + virials[i, 1])
            out[i, 2] = -nktv2p * (m * z * z + virials[i, 2])
            out[i, 3] = -nktv2p * (m * x * y + virials[i, 3])
            out[i, 4] = -nktv2p * (m * x * z + virials[i, 4])
            out[i, 5] = -nktv2p * (m * y * z + virials[i, 5])
            for c in range(6, out.shape[1]):
                out[i, c] = out[i, c - 3]
        else:
            for c in range(out.shape[1]):
                out[i, c] = 0.0


@njit(cache=True, nogil=True)
def flux(v, energy, more, stresses, lower, mask, out):
    """Heat flux: sums of energy times velocity and of stress times velocity into `out (6,)`; `lower` are the columns of yx, zx and zy."""
    for c in range(6):
        out[c] = 0.0
    yx, zx, zy = lower
    for i in range(len(v)):
        if mask[i]:
            x, y, z, e = v[i, 0], v[i, 1], v[i, 2], energy[i] + more[i]
            out[0] += e * x
            out[1] += e * y
            out[2] += e * z
            out[3] += stresses[i, 0] * x + stresses[i, 3] * y + stresses[i, 4] * z
            out[4] += stresses[i, yx] * x + stresses[i, 1] * y + stresses[i, 5] * z
            out[5] += stresses[i, zx] * x + stresses[i, zy] * y + stresses[i, 2] * z


@njit(cache=True, nogil=True)
def same(a, b):
    """Whether whole numbers are the same."""
    for i in range(len(a)):
        if a[i] != b[i]:
            return False
    return len(a) == len(b)


@njit(cache=True, nogil=True)
def separations(x, atoms, a, b, near, out, far):
    """Vectors from atom `b` to atom `a` of items ``atoms (m, k)`` into `out (m, 3)`, and into `far (m,)` the numbers of those that are
    longer than `near (3,)` along an axis; returns how many these are."""
    found = 0
    for i in range(len(atoms)):
        p, q = np.uint64(atoms[i, a]), np.uint64(atoms[i, b])
        u, v, w = x[p, 0] - x[q, 0], x[p, 1] - x[q, 1], x[p, 2] - x[q, 2]
        out[i, 0], out[i, 1], out[i, 2] = u, v, w
        if abs(u) > near[0] or abs(v) > near[1] or abs(w) > near[2]:
            far[found] = i
            found += 1
    return found


@njit(cache=True, nogil=True)
def within(numbers, known, highest, out):
    """Numbers of atoms that are known and from 1 to the highest one; 0 for the others."""
    for i in range(len(numbers)):
        out[i] = numbers[i] if known[i] and 1 <= numbers[i] <= highest else 0


@njit(cache=True, nogil=True)
def count(at, out):
    """How many atoms each piece has."""
    for i in range(len(at)):
        if at[i] >= 0:
            out[at[i]] += 1.0


@njit(cache=True, nogil=True)
def total(at, values, out):
    """Sum of `values (n,)` of each piece."""
    for i in range(len(at)):
        if at[i] >= 0:
            out[at[i]] += values[i]


@njit(cache=True, nogil=True)
def totals(at, values, out):
    """Sum of `values (n, k)` of each piece into `out (pieces, k)`."""
    for i in range(len(at)):
        if at[i] >= 0:
            for c in range(values.shape[1]):
                out[at[i], c] += values[i, c]


@njit(cache=True, nogil=True)
def weighted(at, masses, values, out):
    """Sum of mass times `values (n, 3)` of each piece into `out (pieces, 3)`."""
    for i in range(len(at)):
        if at[i] >= 0:
            for c in range(3):
                out[at[i], c] += masses[i] * values[i, c]


@njit(cache=True, nogil=True)
def centres(index, masses, types, x, image, cell, mass, out):
    """Mass and centre of mass, of unwrapped positions, of each piece into `mass (pieces,)` and `out (pieces, 3)`, 0 without atoms.

    `index (n,)`: the piece from 1 on, 0 for none; `masses`: of atoms, or of `types (n,)` if there are any.
    """
    for i in range(len(x)):
        k = np.int64(index[i]) - 1
        if k >= 0:
            a, b, c = float(image[i, 0]), float(image[i, 1]), float(image[i, 2])
            m = masses[types[i]] if len(types) else masses[i]
            mass[k] += m
            for d in range(3):
                out[k, d] += m * (x[i, d] + (a * cell[0, d] + b * cell[1, d] + c * cell[2, d]))
    for k in range(len(mass)):
        for d in range(3):
            out[k, d] = out[k, d] / mass[k] if mass[k] > 0.0 else 0.0


@njit(cache=True, nogil=True)
def heat(at, masses, v, out):
    """Sum of m v^2 of each piece."""
    for i in range(len(at)):
        if at[i] >= 0:
            out[at[i]] += masses[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])


@njit(cache=True, nogil=True)
def moments(index, masses, types, x, image, cell, centres, out):
    """Sum of m d d of each piece, d from its centre, into `out (pieces, 3, 3)`; arguments as for `centres`."""
    for i in range(len(x)):
        k = np.int64(index[i]) - 1
        if k >= 0:
            m = masses[types[i]] if len(types) else masses[i]
            p, q, r = float(image[i, 0]), float(image[i, 1]), float(image[i, 2])
            a = x[i, 0] + (p * cell[0, 0] + q * cell[1, 0] + r * cell[2, 0]) - centres[k, 0]
            b = x[i, 1] + (p * cell[0, 1] + q * cell[1, 1] + r * cell[2, 1]) - centres[k, 1]
            c = x[i, 2] + (p * cell[0, 2] + q * cell[1, 2] + r * cell[2, 2]) - centres[k, 2]
            out[k, 0, 0] += m * a * a
            out[k, 1, 1] += m * b * b
            out[k, 2, 2] += m * c * c
            out[k, 0, 1] += m * a * b
            out[k, 0, 2] += m * a * c
            out[k, 1, 2] += m * b * c
    for k in range(len(out)):
        out[k, 1, 0], out[k, 2, 0], out[k, 2, 1] = out[k, 0, 1], out[k, 0, 2], out[k, 1, 2]


@njit(cache=True, nogil=True)
def grid(x, origin, edges, reduced, periodic, low, high, axes, first, delta, counts, keep, at, known):
    """Bins of atoms: layers along `axes`, the last one fastest; the k-th axis has layers ``delta[k]`` thick from ``first[k]`` on.

    `reduced`: places are those in a box along the axes, from 0 to 1. Along periodic directions atoms are within `low` and `high`.
    ``keep (k, 2)``: atoms below the first and above the last layer belong to it.
    """
    for i in range(len(at)):
        number, inside = 0, True
        for k in range(len(axes)):
            d = axes[k]
            if reduced:
                u = (x[i, d] - origin[d]) / edges[d]
            else:
                u = x[i, d]
            if periodic[d]:
                if u < low[d]:
                    u += high[d] - low[d]
                if u >= high[d]:
                    u -= high[d] - low[d]
            layer = int(math.floor((u - first[k]) / delta[k]))
            if layer < 0:
                inside = inside and keep[k, 0]
                layer = 0
            elif layer >= counts[k]:
                inside = inside and keep[k, 1]
                layer = max(counts[k] - 1, 0)
            number = number * counts[k] + layer
        at[i], known[i] = number, inside


@njit(cache=True, nogil=True)
def histogram(values, weights, lo, hi, inverse, bins, beyond, counts, stats):
    """Count values (n,) in bins: `stats` are weights counted, weights left out, smallest and largest value.

    `beyond`: what becomes of values outside: 0 left out, 1 the first or last bin, 2 bins of their own before and behind; `bins` are those
    between.
    """
    for i in range(len(values)):
        x, w = values[i], weights[i] if len(weights) else 1.0
        stats[2] = min(stats[2], x)
        stats[3] = max(stats[3], x)
        low, high = x < lo, x > hi
        if (low or high) and beyond == 0:
            stats[1] += w
            continue
        if low:
            k = 0
        elif high:
            k = len(counts) - 1
        else:
            k = min(max(int((x - lo) * inverse), 0), bins - 1) + (beyond == 2)
        stats[0] += w
        counts[np.uint64(k)] += w
