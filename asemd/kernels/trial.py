"""Energy of a few atoms at trial positions with all the others: nothing is listed, no force is computed.

From the module it is pasted into: `pair_energy(r2, qq, tables, ti, tj)`, the sum of all pair styles.
"""
from __future__ import annotations

import math
import re
from functools import cache

import numpy as np

OVERLAP = 1e100        # energy of a trial position that is too near to an atom
ACCEPTABLE = 1e50       # energies beyond are refused without a random number
pair_energy = None


def aligned_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables):
    """`trial_energy` in a box along the axes: images that are too far along one of them are passed over."""
    skip, without = int(numbers[0]), int(numbers[1])
    overlap2, qqr2e, limited = numbers[2], numbers[3], numbers[4] != 0.0
    i0, i1, i2, l0, l1, l2 = inverse[0, 0], inverse[1, 1], inverse[2, 2], cell[0, 0], cell[1, 1], cell[2, 2]
    total = 0.0
    a0, a1, b0, b1, c0, c1 = 0, 0, 0, 0, 0, 0
    for t in range(at.shape[0]):
        ti = types[t]
        for j in range(n):
            if molecule[j] == without:
                continue
            dx, dy, dz = at[t, 0] - x[j, 0], at[t, 1] - x[j, 1], at[t, 2] - x[j, 2]
            if reach[0] >= 0.0:
                a0, a1 = math.ceil(dx * i0 - reach[0]), math.floor(dx * i0 + reach[0])
            if reach[1] >= 0.0:
                b0, b1 = math.ceil(dy * i1 - reach[1]), math.floor(dy * i1 + reach[1])
            if reach[2] >= 0.0:
                c0, c1 = math.ceil(dz * i2 - reach[2]), math.floor(dz * i2 + reach[2])
            if b0 > b1 or c0 > c1:
                continue
            tj = type_of[j]
            limit = cut2[ti, tj]
            most = max(limit, overlap2)
            for a in range(a0, a1 + 1):
                ex = dx - a * l0
                rx = ex * ex
                if rx >= most or (limited and a != 0 and not low[0] <= x[j, 0] * i0 + a <= high[0]):
                    continue
                for b in range(b0, b1 + 1):
                    ey = dy - b * l1
                    ry = rx + ey * ey
                    if ry >= most or (limited and b != 0 and not low[1] <= x[j, 1] * i1 + b <= high[1]):
                        continue
                    for c in range(c0, c1 + 1):
                        ez = dz - c * l2
                        r2 = ry + ez * ez
                        if r2 >= most or (limited and c != 0 and not low[2] <= x[j, 2] * i2 + c <= high[2]):
                            continue
                        if j == skip and a == 0 and b == 0 and c == 0:
                            continue
                        if r2 < overlap2:
                            return OVERLAP
                        if r2 < limit:
                            total += pair_energy(r2, qqr2e * charges[t] * q[j], tables, ti, tj)
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


def atom_moves(states, saved, limits, p, counts, n, gone, x, image, type_of, q, molecule, row, gas, moved, v, id_of, mass, origin, lengths,
               numbers, inverse, cell, reach, low, high, cut2, tables):
    """A series of attempts with single atoms in a periodic box along the axes, as `asemd.fix.gcmc_moves` has them one by one.

    Parameters
    ----------
    states, saved : (2,)
        Random streams: of all processes, of one of them; as LAMMPS draws from them.
    limits : (8,) int
        Moves, exchanges, type, least and most gas atoms, which stream decides, whether all gas atoms count as of that type, whether
        velocities are drawn before the decision.
    p : (7,) float
        Longest move, 1 / kT, activity times volume, speed, charges of an atom that is tried and of one that is there, mass.
    gone : (1,) int
        Becomes 1 if an atom of the system went.

    Returns
    -------
    int
        How many atoms there are now.
    """
    tries, kind, decides = limits[0] + limits[1], limits[2], limits[5]
    chosen, count = np.empty(len(gas), np.int64), 0
    at, types, charges, new_v = np.zeros((1, 3)), np.zeros(1, np.int64), np.zeros(1), np.zeros(3)
    changed = True
    for _ in range(tries):
        if changed:
            count, changed = 0, False
            for i in range(n):
                if gas[i]:
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
            before = trial_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables)
            r2 = 2.0
            while r2 > 1.0:
                r2 = 0.0
                for d in range(3):
                    r = 2.0 * park(states, 1) - 1.0
                    at[0, d] = x[i, d] + p[0] * r
                    r2 += r * r
            after = trial_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables)
            if after < ACCEPTABLE and park(states, decides) < math.exp(min(p[1] * (before - after), 700.0)):
                for d in range(3):
                    x[i, d] = at[0, d]
                    while x[i, d] < origin[d]:
                        x[i, d] += lengths[d]
                        image[i, d] -= 1
                    while x[i, d] >= origin[d] + lengths[d]:
                        x[i, d] = max(x[i, d] - lengths[d], origin[d])
                        image[i, d] += 1
                moved[i] = True
                counts[1] += 1
        elif park(states, 0) < 0.5:
            counts[4] += 1
            if count == 0 or count <= limits[3]:
                continue
            i = chosen[int(count * park(states, 0))]
            types[0], charges[0] = kind if limits[6] else type_of[i], q[i]
            numbers[0] = i
            at[0] = x[i]
            energy = trial_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables)
            if park(states, decides) < count * math.exp(min(p[1] * energy, 700.0)) / p[2]:
                n -= 1
                if row[i] >= 0:
                    gone[0] = 1
                x[i], image[i], v[i] = x[n], image[n], v[n]
                type_of[i], q[i], molecule[i], row[i], gas[i], moved[i] = type_of[n], q[n], molecule[n], row[n], gas[n], moved[n]
                id_of[i], mass[i] = id_of[n], mass[n]
                changed = True
                counts[5] += 1
        else:
            counts[2] += 1
            if count >= limits[4]:
                continue
            for d in range(3):
                at[0, d] = origin[d] + park(states, 0) * lengths[d]
                if at[0, d] >= origin[d] + lengths[d]:
                    at[0, d] = origin[d]
            types[0], charges[0] = kind, p[4]
            numbers[0] = -1.0
            if limits[7]:
                for d in range(3):
                    new_v[d] = gaussian(states, saved, 1) * p[3]
            energy = trial_energy(at, types, charges, n, numbers, x, type_of, q, molecule, inverse, cell, reach, low, high, cut2, tables)
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
    for k, style in enumerate(styles):
        b.use(list_kernel(style, style.parts, energy=True, per_atom=False)[1], "pair_energy_one", f"pair{k}")
    for f in (aligned_energy, trial_energy):
        b.text(_written_out(plain_source(f), len(styles)))
    for f in (park, gaussian, atom_moves):
        b.function(f)
    return b.build()
