"""Energy of a few atoms at trial positions with all the others: nothing is listed, no force is computed.

From the module it is pasted into: `pair_energy(r2, qq, tables, ti, tj)`, the sum of all pair styles.
"""
from __future__ import annotations

import math
from functools import cache

OVERLAP = 1e100        # energy of a trial position that is too near to an atom
pair_energy = None


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


@cache
def kernel(styles: tuple):
    """`trial_energy` for the sum of some pair styles; `tables` has (rows, constants, arrays, factors (2,)) of each."""
    from asemd.kernels.generate import Builder
    from asemd.kernels.pair import list_kernel
    b = Builder(f"trial energies: {' '.join(style.name for style in styles)}")
    b.constant("OVERLAP", OVERLAP)
    lines = ["def pair_energy(r2, qq, tables, ti, tj):", "    total = 0.0"]
    for k, style in enumerate(styles):
        b.use(list_kernel(style, style.parts, energy=True, per_atom=False)[1], "pair_energy_one", f"pair{k}")
        lines += [f"    rows, constants, arrays, w = tables[{k}]",
                  f"    fp, ev, ec = pair{k}(r2, qq, w[0], w[1], rows, constants, arrays, ti, tj)", "    total += ev + ec"]
    b.text("\n".join([*lines, "    return total"]))
    b.function(trial_energy)
    return b.build().trial_energy
