r"""Extended Tersoff potential (ExTeP) of boron and nitrogen: Tersoff's bonds and a correction by the coordinations of both atoms.

$$E=E_{Tersoff}+\tfrac12\sum_i\sum_{j\ne i}f_C(r_{ij})f_A(r_{ij})\,F_{ij}(N^d_{ij},N^d_{ji})\,e(N_{ij})e(N_{ji})[1-u(N_{ij})u(N_{ji})],
\quad N_{ij}=\sum_{k\ne i,j}f_C(r_{ik})$$

$N^d_{ij}$ counts neighbours of the other element alone, F is a bicubic function between the values of the file, the envelope e goes from 1
at 3 to 0 at 4, and $u(x)=(1-x)^2$ below 1. The file has Tersoff's entries, and for pairs of elements lines with two whole coordinations,
value and derivatives.
"""
from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np

from asemd.errors import InputError
from asemd.kernels.manybody import add_stretch, add_virial, gather_near, scatter
from asemd.kernels.threads import barrier
from asemd.manybody import element_of
from asemd.pair.tersoff import Tersoff, angular, attraction, longer, order, repulsion, taper, tersoff
from asemd.potential_file import Record
from asemd.style import register

ENERGY = False
POINTS = 5      # coordinations 0 to 4


def smooth(x):
    """From 1 at 3 to 0 at 4, and its derivative."""
    d = min(max(4.0 - x, 0.0), 1.0)
    return (3.0 - 2.0 * d) * d * d, -6.0 * d * (1.0 - d)


def envelope(x, y):
    """How much of the correction counts, and its derivatives."""
    ex, dx = smooth(x)
    ey, dy = smooth(y)
    a, b = max(1.0 - x, 0.0), max(1.0 - y, 0.0)
    lone = 1.0 - a * a * b * b
    return lone * ex * ey, (lone * dx + 2.0 * a * b * b * ex) * ey, (lone * dy + 2.0 * a * a * b * ey) * ex


def corner(s, t, f, fx, fy, gx, gy):
    """What the corner (0, 0) of a square adds at (s, t), and its derivatives: `f` is the value there, `gx` and `gy` the neighbours' along
    the edges, `fx` and `fy` the derivatives."""
    u, v = 1.0 - s, 1.0 - t
    a, b = fx - gx + f, fy - gy + f       # what the derivatives have beyond those of a plane
    g = f + s * u * a + t * v * b
    return u * v * g, v * (-g + u * (1.0 - 2.0 * s) * a), u * (-g + v * (1.0 - 2.0 * t) * b)


def correction(table, x, y):
    """F and its derivatives from values and derivatives (5, 5, 3)."""
    k, m = min(int(x), 3), min(int(y), 3)
    s, t = min(x - k, 1.0), min(y - m, 1.0)
    value, dx, dy = 0.0, 0.0, 0.0
    for a in range(2):
        for b in range(2):
            p, sx, sy = table[k + a, m + b], 1.0 - 2.0 * a, 1.0 - 2.0 * b
            e, ex, ey = corner(s if a == 0 else 1.0 - s, t if b == 0 else 1.0 - t, p[0], sx * p[1], sy * p[2], table[k + 1 - a, m + b, 0],
                               table[k + a, m + 1 - b, 0])
            value += e
            dx += sx * ex
            dy += sy * ey
    return value, dx, dy


def extep_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                 grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """Coordinations of slots lo..hi-1, then forces; arguments as in `asemd.kernels.manybody.site_forces`."""
    three, element, tables = arrays
    for i in range(lo, hi):
        ti = type_of[i]
        shared[0, i], shared[1, i] = 0.0, 0.0
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(n):
            fc, slope = taper(np.sqrt(near[3, k]), three[ti, types[k], types[k]])
            shared[0, i] += fc
            shared[1, i] += fc if element[types[k]] != element[ti] else 0.0
    barrier(meeting)
    for i in range(lo, hi):
        ti = type_of[i]
        m = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        n = gather_near(i, middle[i], last[i], m, x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        if n == 0:
            continue
        for k in range(n):
            grad[0, k] = 0.0
            grad[1, k] = 0.0
            grad[2, k] = 0.0
        shares = (atom_energy, atom_virial, np.int32(i), near, slots)
        energy = tersoff(i, ti, n, m, near, types, room, grad, constants, arrays, shares)
        total, other = 0.0, 0.0
        for j in range(n):
            tj = types[j]
            r = room[4, j]
            p = three[ti, tj, tj]
            fc, slope = taper(r, p)
            kind = 1.0 if element[ti] != element[tj] else 0.0
            ni, nj = max(shared[0, i] - fc, 0.0), max(shared[0, slots[j]] - fc, 0.0)
            di, dj = max(shared[1, i] - kind * fc, 0.0), max(shared[1, slots[j]] - kind * fc, 0.0)
            fa, dfa = attraction(r, p)
            back, _ = attraction(r, three[tj, ti, ti])
            value, vx, vy = correction(tables[element[ti], element[tj]], di, dj)
            e, ex, ey = envelope(ni, nj)
            energy += 0.5 * fa * e * value
            room[5, j] = 0.5 * (fa + back) * ex * value
            room[6, j] = 0.5 * (fa + back) * e * vx
            room[7, j] = slope
            total += room[5, j]
            other += room[6, j]
            add_stretch(j, 0.5 * fa * e * value, 0.5 * dfa * e * value, room, grad, shares)
        for k in range(n):
            d = total - room[5, k]
            if element[types[k]] != element[ti]:
                d += other - room[6, k]
            add_stretch(k, 0.0, d * room[7, k], room, grad, shares)
        if not abs(energy) < np.inf:
            if bad[0] == 0.0:
                bad[0], bad[1], bad[2] = 1.0, i, energy
            continue
        scatter(i, n, f, grad, slots)
        if ENERGY:
            acc[0] += energy
            add_virial(acc, n, near, grad)


class ExTeP(Tersoff):
    """Tersoff's entries and tables of the correction."""

    ghost_list = True

    def parse_settings(self, words):
        return {"shift": 0.0, **super(Tersoff, self).parse_settings(words)}

    def read(self, file, elements, settings):
        tables = {(a, b): np.zeros((POINTS, POINTS, 3)) for a in elements for b in elements}
        rest, seen = [], set()
        for number, line in file.lines:
            words = line.split()
            if len(words) < 3 or not words[2].isdigit() or words[0][0].isdigit():
                rest.append((number, line))
                continue
            record = Record(words, file.where(number), file.what)
            pair = record.word(), record.word()
            i, j = record.whole("a coordination"), record.whole("a coordination")
            value, dx, dy = record.number("the value"), record.number("its derivative"), record.number("its derivative")
            if max(i, j) >= POINTS:
                raise file.error(f"coordinations of the correction go from 0 to {POINTS - 1}, got {i} {j}", number)
            if pair in tables:
                tables[pair][i, j], tables[pair[::-1]][j, i] = (value, dx, dy), (value, dy, dx)
                seen |= {(pair, i, j), (pair[::-1], j, i)}
        missing = [pair for pair in tables if sum(s[0] == pair for s in seen) < POINTS**2]
        if missing:
            raise InputError(f"{file.what}: {file.name} lacks corrections for {' '.join(missing[0])}: one line for each pair of "
                             f"coordinations 0 to {POINTS - 1}")
        entries = copy(file)
        entries.lines = rest
        return {"corrections": tables, **super().read(entries, elements, settings)}

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables, names = super().pack_pairs(settings, filled, ntypes, units, shift), element_of(filled, ntypes)
        c = next(iter(filled.values()))
        used = sorted({e for e in names if e})
        number = np.array([used.index(e) if e else -1 for e in names])
        corrections = np.array([[c["data"]["corrections"][a, b] for b in used] for a in used])
        return replace(tables, arrays=(*tables.arrays, number, corrections))


extep = register(ExTeP("extep", forces=extep_forces, shares=2, rooms=9, converts=False, doc=__doc__, example="BN.extep B",
               helpers=(taper, repulsion, attraction, angular, order, longer, tersoff, smooth, envelope, corner, correction),
               see="J. H. Los, J. M. H. Kroes, K. Albe, R. M. Gordillo, M. I. Katsnelson, A. Fasolino, Phys. Rev. B 96, 184108 (2017)"))
extep.reads = "ExTeP"
