r"""A general three-body form with all its functions in tables, which can stand for Tersoff, Stillinger-Weber and embedded-atom potentials.

$$E=\tfrac12\sum_i\sum_{j\ne i}\big[U_{IJ}(r_{ij})-F_{IJ}(X_{ij})V_{IJ}(r_{ij})\big],\quad
X_{ij}=\sum_{k\ne i,j}W_{IK}(r_{ik})\,G_{JIK}(\cos\theta_{jik})\,P_{IK}(r_{ij}-\xi_{IJ}r_{ik})$$

With the flag eta of the file at 1 the second term is that of an embedded atom, $-\tfrac12F_{II}(X_i)$ with $X_i=\sum_kW_{KK}(r_{ik})$;
2 is as 0, and with 3 there is a $P_{JIK}$ for each triple. Around each point of a table functions are cubic, half way to the next one as
in LAMMPS, where they have steps of a few units in the ninth digit.
"""
from __future__ import annotations

import math
import warnings

import numpy as np

from asemd.errors import InputWarning
from asemd.kernels.manybody import PER_ATOM, add_stretch, directions, share_pair, share_triple
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
from asemd.potential_file import Record
from asemd.style import register
from asemd.words import real


def look(table, x, first, scale):
    """Value and slope of a table of cubics (m, 4), each around the point it belongs to; it ends at its ends."""
    t = min(max((x - first) * scale, 0.0), table.shape[0] - 1.0)
    k = int(t + 0.5)
    p = t - k
    b, c, d = table[k, 1], table[k, 2], table[k, 3]
    return table[k, 0] + p * (b + p * (c + p * d)), (b + p * (2.0 * c + p * 3.0 * d)) * scale


def polymorphic(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    """Tables by pair of types: U V W (pairs, 3, nr, 4), F (pairs, nx, 4); by triple G; by pair or triple P; which pair, triple and P; of
    each pair the cutoff, intervals per distance, xi."""
    pair, triple, which, numbers, radial, spaced, bent, outer = arrays
    widest = constants[1]
    energy, total = 0.0, 0.0
    directions(n, near, room)
    for k in range(n):
        r = math.sqrt(near[3, k])
        room[4, k] = r
        c = pair[ti, types[k]]
        room[5, k], room[6, k] = look(radial[c, 2], r, 0.0, numbers[c, 1])
        if constants[0] == 1.0:
            c = pair[types[k], types[k]]
            room[5, k], room[6, k] = look(radial[c, 2], r, 0.0, numbers[c, 1]) if r < numbers[c, 0] else (0.0, 0.0)
            c = pair[ti, types[k]]
        total += room[5, k]
        if k < m:
            e, d = look(radial[c, 0], r, 0.0, numbers[c, 1])
            energy += e
            add_stretch(k, e, d, room, grad, shares)
    if constants[0] == 1.0:
        e, d = look(outer[pair[ti, ti]], total, 0.0, constants[2])
        if PER_ATOM:
            shares[0][shares[2]] -= 0.5 * e
        for k in range(n):
            add_stretch(k, 0.0, -0.5 * d * room[6, k], room, grad, shares)
        return energy - 0.5 * e
    for j in range(n):
        ux, uy, uz, ij, rj = room[0, j], room[1, j], room[2, j], room[3, j], room[4, j]
        a = pair[ti, types[j]]
        xi = numbers[a, 2]
        sum_x, sum_j = 0.0, 0.0
        for k in range(n):
            if k == j:
                continue
            c = pair[ti, types[k]]
            x = ux * room[0, k] + uy * room[1, k] + uz * room[2, k]
            g, dg = look(bent[triple[types[j], ti, types[k]]], x, -1.0, constants[3])
            p, dp = look(spaced[which[types[j], ti, types[k]]], rj - xi * room[4, k], -widest, constants[4])
            w = room[5, k]
            sum_x += w * g * p
            sum_j += w * g * dp
            room[7, k] = w * dg * p
            room[8, k] = g * (room[6, k] * p - xi * w * dp)
            room[9, k] = x
            room[10, k] = w * g * dp
        v, dv = look(radial[a, 1], rj, 0.0, numbers[a, 1])
        b, db = look(outer[a], sum_x, 0.0, constants[2])
        energy -= 0.5 * b * v
        w = -0.5 * v * db
        d = -0.5 * b * dv
        if PER_ATOM:
            share_pair(shares, j, -0.5 * b * v, d * ux, d * uy, d * uz)
        s = d + w * sum_j
        grad[0, j] += s * ux
        grad[1, j] += s * uy
        grad[2, j] += s * uz
        for k in range(n):
            if k == j:
                continue
            x, vx, vy, vz = room[9, k], room[0, k], room[1, k], room[2, k]
            s = w * room[7, k] * ij
            c = w * room[7, k] * room[3, k]
            d = w * room[8, k] - c * x
            gjx = s * (vx - x * ux)
            gjy = s * (vy - x * uy)
            gjz = s * (vz - x * uz)
            gkx = c * ux + d * vx
            gky = c * uy + d * vy
            gkz = c * uz + d * vz
            grad[0, j] += gjx
            grad[1, j] += gjy
            grad[2, j] += gjz
            grad[0, k] += gkx
            grad[1, k] += gky
            grad[2, k] += gkz
            if PER_ATOM:
                t = w * room[10, k]
                share_triple(shares, j, k, 0.0, gjx + t * ux, gjy + t * uy, gjz + t * uz, gkx, gky, gkz)
    return energy


def cubics(y: np.ndarray) -> np.ndarray:
    """Tables (..., m) as cubics (..., m, 4) from each point to the next, with slopes from five points; a line at the last point."""
    d = np.empty_like(y)
    d[..., 0], d[..., -1] = y[..., 1] - y[..., 0], y[..., -1] - y[..., -2]
    d[..., 1], d[..., -2] = 0.5 * (y[..., 2] - y[..., 0]), 0.5 * (y[..., -1] - y[..., -3])
    d[..., 2:-2] = ((y[..., :-4] - y[..., 4:]) + 8.0 * (y[..., 3:-1] - y[..., 1:-3])) / 12.0
    out = np.zeros((*y.shape, 4))
    rise = np.diff(y)
    out[..., 0], out[..., 1] = y, d
    out[..., :-1, 2], out[..., :-1, 3] = 3.0 * rise - 2.0 * d[..., :-1] - d[..., 1:], d[..., :-1] + d[..., 1:] - 2.0 * rise
    return out


class Polymorphic(ManyBody):
    """The file has all elements' tables one after the other: for each pair U, V, W and P, for each triple G, for each pair F."""

    def read(self, file, elements, settings):
        words, places = [], []
        for number, line in file.lines:
            words += line.split()
            places += [number] * (len(words) - len(places))
        at = 0

        def take(kind, count, name):
            nonlocal at
            if at + count > len(words):
                raise file.error(f"the file ends before the last of {count} numbers of {name}", places[-1] if places else 1)
            at += count
            try:
                if kind is str or np.isfinite([real(w) for w in words[at - count:at]]).all():
                    return [kind(w) for w in words[at - count:at]]
            except ValueError:
                pass
            for word, place in zip(words[at - count:at], places[at - count:at]):      # raises at the first that is none
                getattr(Record([word], file.where(place), file.what), "whole" if kind is int else "number")(f"a value of {name}")

        n, eta = take(int, 2, "the number of elements and eta")
        if eta not in (0, 1, 2, 3):
            raise file.error(f"eta must be 0, 1, 2 or 3, got {eta}", places[1])
        names = [take(str, 3, "an element")[2] for _ in range(n)]
        for element in elements:
            if element not in names:
                raise file.error(f"the file has no element {element}, only {' '.join(names)}", places[0])
        if len(elements) != n:
            raise file.error(f"the file has {n} elements, {' '.join(names)}, and needs them all, got {' '.join(elements)}", places[0])
        nr, ng, nx = take(int, 3, "the lengths of the tables")
        largest, = take(float, 1, "the largest argument of F")
        if min(nr, ng, nx) < 6 or not largest > 0.0:
            raise file.error("tables need six values or more, and F an argument above 0", places[at - 1])
        pairs = n * (n + 1) // 2
        ends = np.array(take(float, 2 * pairs, "cutoffs and xi")).reshape(pairs, 2)
        radial = np.array(take(float, 3 * pairs * nr, "the tables U, V and W")).reshape(3, pairs, nr)
        spaced = np.array(take(float, (n**3 if eta == 3 else pairs) * nr, "the tables P")).reshape(-1, nr)
        bent = np.array(take(float, n**3 * ng, "the tables G")).reshape(n**3, ng)
        outer = np.array(take(float, pairs * nx, "the tables F")).reshape(pairs, nx)
        if at < len(words):
            warnings.warn(f"{file.what}: {file.name} has {len(words) - at} words more than its tables need; if one of them has a number "
                          "too many, all after it are shifted", InputWarning, stacklevel=2)
        if not (ends[:, 0] > 0.0).all():
            raise file.error("cutoffs must be positive", places[7 + 3 * n])
        return {"names": names, "eta": eta, "ends": ends, "radial": radial, "spaced": spaced, "bent": bent,
                "outer": outer, "largest": largest}

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, n = element_of(filled, ntypes), ntypes + 1
        c = next(iter(filled.values()))
        data, unit = c["data"], self.unit_factor(c, units)
        names, ends = data["names"], data["ends"]
        ne = len(names)
        number, place = np.zeros((ne, ne), np.int64), ne
        for a in range(ne):
            number[a, a] = a
            for b in range(a + 1, ne):
                number[a, b] = number[b, a] = place
                place += 1
        where = [names.index(e) if e is not None else -1 for e in element]
        rows, pair = np.zeros((1, n, n)), np.zeros((n, n), np.int64)
        triple, which = np.zeros((n, n, n), np.int64), np.zeros((n, n, n), np.int64)
        for a, b in filled:
            for i, j in ((a, b), (b, a)):
                pair[i, j] = number[where[i], where[j]]
                rows[0, i, j] = ends[pair[i, j], 0] ** 2
                for k in range(1, n):
                    if where[k] >= 0:
                        triple[i, j, k] = (where[i] * ne + where[j]) * ne + where[k]
                        which[i, j, k] = triple[i, j, k] if data["eta"] == 3 else number[where[j], where[k]]
        radial = data["radial"].swapaxes(0, 1).copy()
        radial[:, :2] *= [[[unit], [unit]]]
        nr, widest = radial.shape[2], float(ends[:, 0].max())
        numbers = np.column_stack([ends[:, 0], (nr - 1) / ends[:, 0], ends[:, 1]])
        constants = [float(data["eta"]), widest, (data["outer"].shape[1] - 1) / data["largest"], (data["bent"].shape[1] - 1) / 2.0,
                     (nr - 1) / (2.0 * widest)]
        outer = data["outer"] * (unit if data["eta"] == 1 else 1.0)
        return PairTables(rows, np.array(constants), (pair, triple, which, np.ascontiguousarray(numbers), cubics(radial),
                                                      cubics(data["spaced"]), cubics(data["bent"]), cubics(outer)))


register(Polymorphic("polymorphic", site=polymorphic, helpers=(look,), rooms=11, converts=False, example="GaN_tersoff.poly Ga N",
                     see="X. W. Zhou, M. E. Foster, R. E. Jones, P. Yang, H. Fan, F. P. Doty, J. Mater. Sci. Res. 4, 15 (2015)"))
