"""Order parameters of single atoms from the vectors to their neighbours.

`start (n+1,)`, `vector (m, 3)` and `square (m,)` are those of `asemd.kernels.surroundings.surroundings`; `atoms` the rows to be done.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def nearest(square, low, high, count):
    """Places low..high-1 of the `count` shortest vectors, sorted by length; all of them for count 0."""
    order = np.argsort(square[low:high])
    return (order[:count] if count > 0 else order) + low


@njit(cache=True, nogil=True)
def hexagonal(atoms, start, vector, square, degree, count, out):
    """Mean of exp(i degree theta) over the `count` nearest neighbours (0: all): real and imaginary part.

    Directions are those from the neighbours to the atom.
    """
    for i in atoms:
        low, high = start[i], start[i + 1]
        if high - low < count or high == low:
            continue
        chosen = nearest(square, low, high, count)
        for p in chosen:
            theta = math.atan2(-vector[p, 1], -vector[p, 0])
            out[i, 0] += math.cos(degree * theta)
            out[i, 1] += math.sin(degree * theta)
        out[i, 0] /= len(chosen)
        out[i, 1] /= len(chosen)


@njit(cache=True, nogil=True)
def harmonics(atoms, start, vector, square, degrees, count, out, enough):
    """Means of the spherical harmonics of the `count` nearest neighbours (0: all): `out (n, degrees, 2 lmax + 1)` complex, from m = -l on.

    `enough (n,)`: whether an atom has that many neighbours. Directions are those from the neighbours to the atom.
    """
    top = 0
    for l in degrees:
        top = max(top, l)
    legendre = np.zeros((top + 1, top + 1))
    for i in atoms:
        low, high = start[i], start[i + 1]
        if high - low < count or high == low:
            continue
        enough[i] = True
        chosen = nearest(square, low, high, count)
        for p in chosen:
            r = math.sqrt(square[p])
            z = -vector[p, 2] / r
            flat = math.hypot(vector[p, 0], vector[p, 1])
            turn = complex(1.0, 0.0)
            if flat > 1e-12 * r:        # the opposite direction and the phase (-1)^m cancel
                turn = complex(vector[p, 0] / flat, vector[p, 1] / flat)
            s = math.sqrt(max((1.0 - z) * (1.0 + z), 0.0))
            legendre[0, 0] = math.sqrt(0.25 / math.pi)      # normalised associated Legendre functions
            for m in range(1, top + 1):
                legendre[m, m] = s * math.sqrt((2.0 * m + 1.0) / (2.0 * m)) * legendre[m - 1, m - 1]
            for m in range(top):
                legendre[m + 1, m] = z * math.sqrt(2.0 * m + 3.0) * legendre[m, m]
            for m in range(top + 1):
                for l in range(m + 2, top + 1):
                    a = math.sqrt((4.0 * l * l - 1.0) / (l * l - m * m))
                    b = math.sqrt(((l - 1.0) ** 2 - m * m) / (4.0 * (l - 1.0) ** 2 - 1.0))
                    legendre[l, m] = a * (z * legendre[l - 1, m] - b * legendre[l - 2, m])
            power = complex(1.0, 0.0)
            for m in range(top + 1):
                for k in range(len(degrees)):
                    l = degrees[k]
                    if m <= l:
                        y = legendre[l, m] * power
                        out[i, k, l + m] += y
                        if m > 0:
                            sign = 1.0 if m % 2 == 0 else -1.0
                            out[i, k, l - m] += sign * complex(y.real, -y.imag)
                power *= turn
        for k in range(len(degrees)):
            for m in range(2 * degrees[k] + 1):
                out[i, k, m] /= len(chosen)


@njit(cache=True, nogil=True)
def third_order(atoms, q, l, symbols, out):
    """Sum over m1 + m2 + m3 = 0 of a 3j symbol ``symbols (2l+1, 2l+1)`` and three of the harmonics `q (n, 2l+1)`."""
    for i in atoms:
        total = 0.0
        for a in range(2 * l + 1):
            for b in range(max(0, l - a), min(2 * l, 3 * l - a) + 1):
                total += symbols[a, b] * (q[i, a] * q[i, b] * q[i, 3 * l - a - b]).real
        out[i] = total


@njit(cache=True, nogil=True)
def centrosymmetry(atoms, start, vector, square, count, out, axes):
    """Sum of the count/2 smallest |r_j + r_k|^2 over pairs of the `count` nearest neighbours.

    `axes (n, 3, 3)`, if it is not empty: along the two pairs with the smallest sums, and their cross product.
    """
    pairs = count * (count - 1) // 2
    sums, first, second = np.empty(pairs), np.empty(pairs, np.int64), np.empty(pairs, np.int64)
    for i in atoms:
        low, high = start[i], start[i + 1]
        if high - low < count:
            continue
        chosen = nearest(square, low, high, count)
        n = 0
        for a in range(count):
            for b in range(a + 1, count):
                u = vector[chosen[a], 0] + vector[chosen[b], 0]
                v = vector[chosen[a], 1] + vector[chosen[b], 1]
                w = vector[chosen[a], 2] + vector[chosen[b], 2]
                sums[n] = u * u + v * v + w * w
                first[n], second[n] = chosen[a], chosen[b]
                n += 1
        order = np.argsort(sums)
        for k in range(count // 2):
            out[i] += sums[order[k]]
        if len(axes):
            for k in range(2):
                d = vector[first[order[k]]] - vector[second[order[k]]]
                axes[i, k] = d / math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
            a, b = axes[i, 0], axes[i, 1]
            axes[i, 2, 0] = a[1] * b[2] - a[2] * b[1]
            axes[i, 2, 1] = a[2] * b[0] - a[0] * b[2]
            axes[i, 2, 2] = a[0] * b[1] - a[1] * b[0]
            axes[i, 2] /= math.sqrt((axes[i, 2] ** 2).sum())


@njit(cache=True, nogil=True)
def common_neighbors(atoms, start, vector, cutoff2, out):
    """Crystal structure by common neighbour analysis: 1 fcc, 2 hcp, 3 bcc, 4 icosahedral, 5 none of them."""
    bonds = np.zeros(14, np.int64)
    common = np.zeros(14, np.int64)
    for i in atoms:
        low, n = start[i], start[i + 1] - start[i]
        out[i] = 5.0
        if n != 12 and n != 14:
            continue
        fcc = hcp = ico = bcc4 = bcc6 = 0
        for j in range(low, low + n):
            c = 0
            for k in range(low, low + n):
                if k != j and ((vector[k] - vector[j]) ** 2).sum() < cutoff2:
                    common[c] = k
                    bonds[c] = 0
                    c += 1
            total = 0
            for a in range(c):
                for b in range(a + 1, c):
                    if ((vector[common[a]] - vector[common[b]]) ** 2).sum() < cutoff2:
                        bonds[a] += 1
                        bonds[b] += 1
                        total += 1
            most, least = 0, 14
            for a in range(c):
                most, least = max(most, bonds[a]), min(least, bonds[a])
            fcc += c == 4 and total == 2 and most == 1 and least == 1
            hcp += c == 4 and total == 2 and most == 2 and least == 0
            ico += c == 5 and total == 5 and most == 2 and least == 2
            bcc4 += c == 4 and total == 4 and most == 2 and least == 2
            bcc6 += c == 6 and total == 6 and most == 2 and least == 2
        if n == 12:
            out[i] = 1.0 if fcc == 12 else 2.0 if fcc == 6 and hcp == 6 else 4.0 if ico == 12 else 5.0
        elif bcc4 == 6 and bcc6 == 8:
            out[i] = 3.0


@njit(cache=True, nogil=True)
def bond_angles(atoms, start, vector, square, legacy, out):
    """Crystal structure by the angles between bonds: 0 unknown, 1 bcc, 2 fcc, 3 hcp, 4 icosahedral."""
    edges = np.array([-0.945, -0.915, -0.755, -0.195, 0.195, 0.245, 0.795])
    for i in atoms:
        low, high = start[i], start[i + 1]
        if high - low < 6:
            continue
        six = nearest(square, low, high, 6)
        mean = 0.0
        for p in six:
            mean += square[p] / 6.0
        near = 0
        wide = 0
        chosen = np.empty(high - low, np.int64)
        for p in range(low, high):
            if square[p] < 1.55 * mean:
                wide += 1
                if square[p] < 1.45 * mean:
                    chosen[near] = p
                    near += 1
        chi = np.zeros(8)
        for a in range(near):
            for b in range(a + 1, near):
                p, q = chosen[a], chosen[b]
                dot = vector[p, 0] * vector[q, 0] + vector[p, 1] * vector[q, 1] + vector[p, 2] * vector[q, 2]
                cosine = dot / math.sqrt(square[p] * square[q])
                k = 0
                while k < 7 and cosine >= edges[k]:
                    k += 1
                chi[k] += 1
        below = chi[5] + chi[6] - chi[4]
        bcc = 0.35 * chi[4] / below if below != 0.0 else (np.inf if chi[4] > 0.0 else np.nan)
        packed = abs(1.0 - chi[6] / 24.0)
        fcc = 0.61 * (abs(chi[0] + chi[1] - 6.0) + chi[2]) / 6.0
        hcp = (abs(chi[0] - 3.0) + abs(chi[0] + chi[1] + chi[2] + chi[3] - 9.0)) / 12.0
        if legacy:
            if chi[0] == 7:
                bcc = 0.0
            elif chi[0] == 6:
                fcc = 0.0
            elif chi[0] <= 3:
                hcp = 0.0
            if chi[7] > 0.0:
                continue
            if chi[4] < 3.0:
                out[i] = 4.0 if 11 <= wide <= 13 else 0.0
            elif bcc <= packed:
                out[i] = 1.0 if wide >= 11 else 0.0
            elif 11 <= wide <= 12:
                out[i] = 2.0 if fcc < hcp else 3.0
        elif chi[7] == 0.0 and near >= 11:
            if chi[0] == 7:
                out[i] = 1.0
            elif chi[0] == 6:
                out[i] = 2.0
            elif chi[0] == 3:
                out[i] = 3.0
            elif near <= 12:
                if wide == 12 and chi[4] < 3.0:
                    out[i] = 4.0
                elif wide <= 12 and bcc <= packed:
                    out[i] = 1.0
                else:
                    out[i] = 2.0 if fcc < hcp else 3.0



@njit(cache=True, nogil=True)
def entropies(atoms, start, square, sigma, cutoff, density, out):
    """Pair entropy from Gaussians of width `sigma` on points as far apart, up to `cutoff`, with the density `density (n,)`."""
    points = int(cutoff / sigma) + 1
    g = np.zeros(points)
    for i in atoms:
        g[:] = 0.0
        rho = density[i]
        scale = 1.0 / (rho * 4.0 * math.pi * math.sqrt(2.0 * math.pi) * sigma) if rho > 0.0 else 0.0
        for p in range(start[i], start[i + 1]):
            if square[p] >= cutoff * cutoff:
                continue
            r = math.sqrt(square[p])
            at = int(r / sigma)
            for k in range(max(at - 3, 1), min(at + 3, points - 1) + 1):
                x = k * sigma
                g[k] += scale / (x * x) * math.exp(-(r - x) ** 2 / (2.0 * sigma * sigma))
        total = 0.0
        for k in range(1, points):
            part = g[k] * math.log(g[k]) - g[k] + 1.0 if g[k] > 1e-10 else 1.0
            total += part * (k * sigma) ** 2 * (0.5 if k == points - 1 else 1.0)
        out[i] = -2.0 * math.pi * rho * total * sigma
