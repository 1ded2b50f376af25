"""Energy of a few atoms at trial positions with all the others: nothing is listed, no force is computed.

From the module it is pasted into: `pair_energy(r2, qq, tables, ti, tj)`, the sum of all pair styles.
"""
from __future__ import annotations

import math
import re
from functools import cache

import numpy as np

from asemd.kernels.trial_cells import around, cell_of, enter, fill, grid, largest, leave

OVERLAP = 1e100        # energy of a trial position that is too near to an atom
BLOCK = 256
ACCEPTABLE = 1e50       # energies beyond are refused without a random number
pair_energy = None


def nearest(x, first, last, p, edges, inverse, r2):
    """Squared distances from a point `p` to the nearest images of atoms first..last-1."""
    px, py, pz, i0, i1, i2, l0, l1, l2 = p[0], p[1], p[2], inverse[0], inverse[1], inverse[2], edges[0], edges[1], edges[2]
    for k in range(last - first):
        j = np.uint64(first + k)
        dx, dy, dz = px - x[j, 0], py - x[j, 1], pz - x[j, 2]
        dx -= np.rint(dx * i0) * l0
        dy -= np.rint(dy * i1) * l1
        dz -= np.rint(dz * i2) * l2
        r2[np.uint64(k)] = dx * dx + dy * dy + dz * dz


def squares(x, axis, first, last, p, edge, inverse, near, far):
    """Squared distances along an axis from `p` to the nearest and to the next images of atoms first..last-1."""
    for k in range(last - first):
        d = p - x[np.uint64(first + k), axis]
        d -= np.rint(d * inverse) * edge
        near[np.uint64(k)] = d * d
        d = edge - abs(d)
        far[np.uint64(k)] = d * d


def add_squares(u, v, w, count, out):
    """Their sums."""
    for k in range(count):
        out[np.uint64(k)] = u[np.uint64(k)] + v[np.uint64(k)] + w[np.uint64(k)]


def image_of(d, edge, inverse, which):
    """The number of the nearest image (0) or the next one (1) at a distance `d` along an axis from the atom itself."""
    n = np.rint(d * inverse)
    if which == 0:
        return n
    return n + 1.0 if d > n * edge else n - 1.0


def near_energy(total, count, near, r2s, which, p, ti, charge, numbers, x, type_of, q, molecule, edges, scale, inverse, low, high, cut2,
                tables):
    """`total` and the energy of an atom at `p` with the first ones of the atoms `near`, whose images `which` are at squared distances
    `r2s`."""
    skip, without = int(numbers[0]), int(numbers[1])
    overlap2, qqr2e, limited = numbers[2], numbers[3], numbers[4] != 0.0
    for k in range(count):
        j, r2 = near[k], r2s[k]
        tj = type_of[j]
        if molecule[j] == without or (r2 >= cut2[ti, tj] and r2 >= overlap2):
            continue
        here, seen = True, True
        for d in range(3):
            a = image_of(p[d] - x[j, d], edges[d], scale[d], which[d])
            if a != 0.0:
                here = False
                if limited and not low[d] <= x[j, d] * inverse[d, d] + a <= high[d]:
                    seen = False
        if not seen or (here and j == skip):
            continue
        if r2 < overlap2:
            return OVERLAP
        if r2 < cut2[ti, tj]:
            total += pair_energy(r2, qqr2e * charge * q[j], tables, ti, tj)
    return total


def aligned_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables):
    """`trial_energy` in a box along the axes that are longer than the cutoff: distances of `BLOCK` atoms at once."""
    total, most, s, r2s, near = 0.0, largest(cut2, numbers[2]), np.empty((6, BLOCK)), np.empty(BLOCK), np.empty(BLOCK, np.int64)
    edges, scale, images = np.empty(3), np.zeros(3), np.ones(3, np.int64)
    for d in range(3):
        edges[d] = cell[d, d]
        if reach[d] >= 0.0:
            scale[d] = inverse[d, d]
        if reach[d] >= 0.5:
            images[d] = 2
    several = images[0] * images[1] * images[2]
    for t in range(at.shape[0]):
        for first in range(0, n, BLOCK):
            last = min(first + BLOCK, n)
            if several > 1:
                for d in range(3):
                    squares(x, d, first, last, at[t, d], edges[d], scale[d], s[2 * d], s[2 * d + 1])
            for combination in range(several):
                which = combination % images[0], combination // images[0] % images[1], combination // (images[0] * images[1])
                if several > 1:
                    add_squares(s[which[0]], s[2 + which[1]], s[4 + which[2]], last - first, r2s)
                else:
                    nearest(x, first, last, at[t], edges, scale, r2s)
                count = 0
                for k in range(last - first):       # without branches
                    r2 = r2s[np.uint64(k)]
                    near[np.uint64(count)], r2s[np.uint64(count)] = first + k, r2
                    count += r2 < most
                total = near_energy(total, count, near, r2s, which, at[t], types[t], charges[t], numbers, x, type_of, q, molecule, edges,
                                    scale, inverse, low, high, cut2, tables)
                if total == OVERLAP:
                    return OVERLAP
    return total


def trial_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables):
    """Energy of atoms at positions `at` (m, 3) with atoms 0..n-1 and their images, which `numbers` chooses.

    Parameters
    ----------
    numbers : (5,) float
        The atom that is left out (its images are not) or -1, the molecule that is left out with its images or -1, the square of the
        distance below which atoms overlap, the Coulomb constant, and whether images count only where `low` and `high` allow.
    inverse, cell : (3, 3)
        Of the box: to fractional coordinates and back.
    reach : (3,)
        The largest cutoff in fractional coordinates; negative where the box is not periodic.
    low, high : (3,)
        Fractional coordinates, from the corner of the box, between which images are seen.
    cut2 : (ntypes+1, ntypes+1)
        Squared cutoffs.
    """
    skip, without = int(numbers[0]), int(numbers[1])
    overlap2, qqr2e, limited = numbers[2], numbers[3], numbers[4] != 0.0
    total = 0.0
    a0, a1, b0, b1, c0, c1 = 0, 0, 0, 0, 0, 0
    if cell[0, 1] == 0.0 and cell[0, 2] == 0.0 and cell[1, 0] == 0.0 and cell[1, 2] == 0.0 and cell[2, 0] == 0.0 and cell[2, 1] == 0.0:
        if max(reach[0], reach[1], reach[2]) < 0.9999:      # in smaller ones an atom sees more images of another
            return aligned_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables)
    for t in range(at.shape[0]):
        ti = types[t]
        for j in range(n):
            if molecule[j] == without:
                continue
            dx, dy, dz = at[t, 0] - x[j, 0], at[t, 1] - x[j, 1], at[t, 2] - x[j, 2]
            if reach[0] >= 0.0:
                f = dx * inverse[0, 0] + dy * inverse[1, 0] + dz * inverse[2, 0]
                a0, a1 = math.ceil(f - reach[0]), math.floor(f + reach[0])
            if reach[1] >= 0.0:
                f = dx * inverse[0, 1] + dy * inverse[1, 1] + dz * inverse[2, 1]
                b0, b1 = math.ceil(f - reach[1]), math.floor(f + reach[1])
            if reach[2] >= 0.0:
                f = dx * inverse[0, 2] + dy * inverse[1, 2] + dz * inverse[2, 2]
                c0, c1 = math.ceil(f - reach[2]), math.floor(f + reach[2])
            if a0 > a1 or b0 > b1 or c0 > c1:
                continue
            tj = type_of[j]
            limit = cut2[ti, tj]
            for a in range(a0, a1 + 1):
                for b in range(b0, b1 + 1):
                    for c in range(c0, c1 + 1):
                        ex = dx - a * cell[0, 0] - b * cell[1, 0] - c * cell[2, 0]
                        ey = dy - a * cell[0, 1] - b * cell[1, 1] - c * cell[2, 1]
                        ez = dz - a * cell[0, 2] - b * cell[1, 2] - c * cell[2, 2]
                        r2 = ex * ex + ey * ey + ez * ez
                        if r2 >= limit and r2 >= overlap2:
                            continue
                        if a != 0 or b != 0 or c != 0:
                            if limited:
                                u = x[j, 0] * inverse[0, 0] + x[j, 1] * inverse[1, 0] + x[j, 2] * inverse[2, 0] + a
                                v = x[j, 0] * inverse[0, 1] + x[j, 1] * inverse[1, 1] + x[j, 2] * inverse[2, 1] + b
                                w = x[j, 0] * inverse[0, 2] + x[j, 1] * inverse[1, 2] + x[j, 2] * inverse[2, 2] + c
                                if not (low[0] <= u <= high[0] and low[1] <= v <= high[1] and low[2] <= w <= high[2]):
                                    continue
                        elif j == skip:
                            continue
                        if r2 < overlap2:
                            return OVERLAP
                        if r2 < limit:
                            total += pair_energy(r2, qqr2e * charges[t] * q[j], tables, ti, tj)
    return total


def fold(x, image, origin, lengths):
    """A position comes into a periodic box along the axes."""
    for d in range(3):
        while x[d] < origin[d]:
            x[d] += lengths[d]
            image[d] -= 1
        while x[d] >= origin[d] + lengths[d]:
            x[d] = max(x[d] - lengths[d], origin[d])
            image[d] += 1


def fold_each(x, image, origin, lengths):
    """Positions (m, 3) come into it."""
    for d in range(3):
        low, high = origin[d], origin[d] + lengths[d]
        for i in range(len(x)):
            if x[i, d] < low or x[i, d] >= high:
                fold(x[i], image[i], origin, lengths)


def park(states, k):
    """The next number of stream k."""
    states[k] = states[k] * 16807 % 2147483647
    return states[k] * (1.0 / 2147483647)


def gaussian(states, saved, k):
    """The next gaussian number of stream k, whose other one is in `saved` (nan: none)."""
    if saved[k] == saved[k]:
        value = saved[k]
        saved[k] = math.nan
        return value
    while True:
        v1, v2 = 2.0 * park(states, k) - 1.0, 2.0 * park(states, k) - 1.0
        r = v1 * v1 + v2 * v2
        if 0.0 < r < 1.0:
            factor = math.sqrt(-2.0 * math.log(r) / r)
            saved[k] = v1 * factor
            return v2 * factor


def within(x, corners):
    """Whether a point is in a block."""
    return (corners[0, 0] <= x[0] <= corners[1, 0] and corners[0, 1] <= x[1] <= corners[1, 1]
            and corners[0, 2] <= x[2] <= corners[1, 2])


def atom_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables, cells, near, r2s):
    """`trial_energy` of one atom, with those around it only if there are cells (see `asemd.kernels.trial_cells`)."""
    if len(cells[3]) == 0:
        return trial_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables)
    edges, scale = (cell[0, 0], cell[1, 1], cell[2, 2]), (inverse[0, 0], inverse[1, 1], inverse[2, 2])
    count = around(at[0], x, largest(cut2, numbers[2]), reach, edges, near, r2s, *cells)
    return near_energy(0.0, count, near, r2s, (0, 0, 0), at[0], types[0], charges[0], numbers, x, type_of, q, molecule, edges, scale,
                       inverse, low, high, cut2, tables)


def atom_moves(states, saved, limits, p, counts, n, gone, x, image, type_of, q, molecule, row, gas, moved, v, id_of, mass, origin, lengths,
               region, numbers, inverse, cell, reach, low, high, cut2, tables):
    """A series of attempts with single atoms in a periodic box along the axes, as `asemd.fix.gcmc_moves` has them one by one.

    Parameters
    ----------
    states, saved : (2,)
        Random streams: of all processes, of one of them; as LAMMPS draws from them.
    limits : (9,) int
        Moves, exchanges, type, least and most gas atoms, which stream decides, whether all gas atoms count as of that type, whether
        velocities are drawn before the decision, whether atoms outside the block are left alone.
    p : (7,) float
        Longest move, 1 / kT, activity times volume, speed, charges of an atom that is tried and of one that is there, mass.
    region : (2, 3)
        Corners of the block in which it happens.
    gone : (1,) int
        Becomes 1 if an atom of the system went.

    Returns
    -------
    int
        How many atoms there are now.
    """
    tries, kind, decides, confined = limits[0] + limits[1], limits[2], limits[5], limits[8] != 0
    chosen, count = np.empty(len(gas), np.int64), 0
    at, types, charges, new_v, no_image = np.zeros((1, 3)), np.zeros(1, np.int64), np.zeros(1), np.zeros(3), np.zeros(3, np.int32)
    changed = True
    many = grid(n, reach)
    cells = origin, inverse, many, np.empty(many[0] * many[1] * many[2], np.int64), np.empty(len(gas), np.int64)
    near, r2s = np.empty(len(gas), np.int64), np.empty(len(gas))
    fill(n, x, *cells)
    others = x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables, cells, near, r2s
    for _ in range(tries):
        if changed:
            count, changed = 0, False
            for i in range(n):
                if gas[i] and (not confined or within(x[i], region)):
                    chosen[count] = i
                    count += 1
        if int(park(states, 0) * tries) + 1 <= limits[0]:
            park(states, 0)
            counts[0] += 1
            if count == 0:
                continue
            i = chosen[int(count * park(states, 0))]
            types[0], charges[0] = kind if limits[6] else type_of[i], q[i]
            numbers[0] = i
            at[0] = x[i]
            before = atom_energy(at, types, charges, n, numbers, *others)
            r2 = 2.0
            while r2 > 1.0 or (confined and not within(at[0], region)):
                r2 = 0.0
                for d in range(3):
                    r = 2.0 * park(states, 1) - 1.0
                    at[0, d] = x[i, d] + p[0] * r
                    r2 += r * r
            after = atom_energy(at, types, charges, n, numbers, *others)
            if after < ACCEPTABLE and park(states, decides) < math.exp(min(p[1] * (before - after), 700.0)):
                leave(i, x, *cells)
                x[i] = at[0]
                fold(x[i], image[i], origin, lengths)
                enter(i, x, *cells)
                moved[i], changed = True, confined
                counts[1] += 1
        elif park(states, 0) < 0.5:
            counts[4] += 1
            if count == 0 or count <= limits[3]:
                continue
            i = chosen[int(count * park(states, 0))]
            types[0], charges[0] = kind if limits[6] else type_of[i], q[i]
            numbers[0] = i
            at[0] = x[i]
            energy = atom_energy(at, types, charges, n, numbers, *others)
            if park(states, decides) < count * math.exp(min(p[1] * energy, 700.0)) / p[2]:
                n -= 1
                if row[i] >= 0:
                    gone[0] = 1
                leave(i, x, *cells)
                if i < n:
                    leave(n, x, *cells)
                x[i], image[i], v[i] = x[n], image[n], v[n]
                type_of[i], q[i], molecule[i], row[i], gas[i], moved[i] = type_of[n], q[n], molecule[n], row[n], gas[n], moved[n]
                id_of[i], mass[i] = id_of[n], mass[n]
                if i < n:
                    enter(i, x, *cells)
                changed = True
                counts[5] += 1
        else:
            counts[2] += 1
            if count >= limits[4]:
                continue
            for d in range(3):
                at[0, d] = region[0, d] + park(states, 0) * (region[1, d] - region[0, d])
            fold(at[0], no_image, origin, lengths)
            types[0], charges[0] = kind, p[4]
            numbers[0] = -1.0
            if limits[7]:
                for d in range(3):
                    new_v[d] = gaussian(states, saved, 1) * p[3]
            energy = atom_energy(at, types, charges, n, numbers, *others)
            if energy < ACCEPTABLE and park(states, decides) < p[2] * math.exp(min(-p[1] * energy, 700.0)) / (count + 1):
                if not limits[7]:
                    for d in range(3):
                        new_v[d] = gaussian(states, saved, 1) * p[3]
                last = 0
                for i in range(n):
                    last = max(last, id_of[i])
                x[n], v[n], image[n] = at[0], new_v, 0
                type_of[n], q[n], molecule[n], row[n], gas[n], moved[n] = kind, p[5], 0, -1, True, False
                id_of[n], mass[n] = last + 1, p[6]
                enter(n, x, *cells)
                n += 1
                changed = True
                counts[3] += 1
    return n


def _written_out(source: str, count: int) -> str:
    """Calls of `pair_energy` written out for some pair styles: what stands in tables is looked up once, not for each pair."""
    found = re.search(r"( *)total \+= pair_energy\(r2, (.*), tables, ti, tj\)\n", source)
    lines = ["one = 0.0"]
    for k in range(count):
        lines += [f"fp, ev, ec = pair{k}(r2, {found[2]}, w{k}[0], w{k}[1], w{k}[1], rows{k}, constants{k}, arrays{k}, ti, tj)",
                  "one += ev + ec"]
    source = source.replace(found[0], "".join(f"{found[1]}{line}\n" for line in [*lines, "total += one"]))
    head, body = source.split("\n", 1)
    return "\n".join([head, *(f"    rows{k}, constants{k}, arrays{k}, w{k} = tables[{k}]" for k in range(count)), body])


@cache
def kernel(styles: tuple):
    """The module of `trial_energy` and `atom_moves` for the sum of some pair styles.

    `tables` has (rows, constants, arrays, factors (2,)) of each.
    """
    from asemd.kernels.generate import Builder, plain_source
    from asemd.kernels.pair import list_kernel
    b = Builder(f"trial energies: {' '.join(style.name for style in styles)}")
    b.constant("OVERLAP", OVERLAP)
    b.constant("ACCEPTABLE", ACCEPTABLE)
    b.constant("BLOCK", BLOCK)
    for f in (nearest, squares, add_squares, image_of, fold, fold_each, largest, grid, cell_of, fill, enter, leave, around):
        b.function(f)
    for k, style in enumerate(styles):
        b.use(list_kernel(style, style.parts, wanted=True)[1], "pair_energy_one", f"pair{k}")
    b.text(_written_out(plain_source(near_energy), len(styles)))
    b.function(aligned_energy)
    b.text(_written_out(plain_source(trial_energy), len(styles)))
    for f in (park, gaussian, within, atom_energy, atom_moves):
        b.function(f)
    return b.build()
