r"""Forces of triples from tables of two distances and the angle between them, as coarse-grained molecules have them.

An entry of the file is i j k with a cutoff, the name of a file of tables, the keyword of a table in it, ``linear`` and N. The table has N
distances from rmin to rmax for each neighbour, the farther one in the inner loop, and 2N angles; where j and k are of one element, only
distances that are not less than the first. A line has index, $r_{ij}$, $r_{ik}$, the angle, then what the vectors $\mathbf r_{ij}$ and
$\mathbf r_{ik}$ are multiplied with for the force on i, $\mathbf r_{ij}$ and $\mathbf r_{jk}$ for j, $\mathbf r_{ik}$ and
$\mathbf r_{jk}$ for k, and the energy. As in LAMMPS nothing is interpolated: the point next to the triple counts, so that energies have
steps and forces are those of the table, not their derivatives. Of two entries i j k and i k j that differ, the one whose second type has
the lower number counts.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.kernels.manybody import add_virial, gather_near, share_triple
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
from asemd.style import register
from asemd.tabulated import read_section
from asemd.triples import read_triples

ENERGY = PER_ATOM = False
PARAMETERS = {"N": 1, "rmin": 1, "rmax": 1}


def place_of(near_r, far_r, cosine, p):
    """The row of the table, -1 for none; `p`: rmin, step, N, whether the distances are ordered, first row."""
    if near_r < p[0] - 0.5 * p[1] or far_r > p[0] + (p[2] - 0.5) * p[1]:
        return -1
    n = int(p[2])
    a = min(int((near_r - p[0] + 0.5 * p[1] - 1e-8) / p[1]), n - 1)
    b = min(int((far_r - p[0] + 0.5 * p[1] - 1e-8) / p[1]), n - 1)
    angle = math.acos(min(max(cosine, -1.0), 1.0)) * 180.0 / math.pi
    t = min(max(int((angle - 1e-8) * n / 90.0), 0), 2 * n - 1)
    row = a * n - a * (a - 1) // 2 + b - a if p[3] == 1.0 else a * n + b
    return int(p[4]) + row * 2 * n + t


def table_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                 grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """As `asemd.kernels.manybody.site_forces`; the force on the site is one of its own."""
    three, entries, rows = arrays
    for i in range(lo, hi):
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        ti = type_of[i]
        shares = (atom_energy, atom_virial, np.int32(i), near, slots)
        for k in range(n):
            grad[0, k] = 0.0
            grad[1, k] = 0.0
            grad[2, k] = 0.0
            room[0, k] = math.sqrt(near[3, k]) if near[3, k] < entries[three[ti, types[k], types[k]], 5] else -1.0
        fx, fy, fz, energy = 0.0, 0.0, 0.0, 0.0
        for first_of_two in range(n - 1):
            for second in range(first_of_two + 1, n):
                j, k = first_of_two, second
                if room[0, j] < 0.0 or room[0, k] < 0.0:
                    continue
                entry = three[ti, min(types[j], types[k]), max(types[j], types[k])]
                if room[0, j] > room[0, k]:
                    j, k = k, j
                ax, ay, az, ra = near[0, j], near[1, j], near[2, j], room[0, j]
                bx, by, bz, rb = near[0, k], near[1, k], near[2, k], room[0, k]
                row = place_of(ra, rb, (ax * bx + ay * by + az * bz) / (ra * rb), entries[entry])
                if row < 0:
                    continue
                i1, i2, j1, j2, k1, k2 = rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4], rows[row, 5]
                energy += rows[row, 6]
                fx += i1 * ax + i2 * bx
                fy += i1 * ay + i2 * by
                fz += i1 * az + i2 * bz
                gjx, gjy, gjz = -j1 * ax - j2 * (bx - ax), -j1 * ay - j2 * (by - ay), -j1 * az - j2 * (bz - az)
                gkx, gky, gkz = -k1 * bx - k2 * (bx - ax), -k1 * by - k2 * (by - ay), -k1 * bz - k2 * (bz - az)
                grad[0, j] += gjx
                grad[1, j] += gjy
                grad[2, j] += gjz
                grad[0, k] += gkx
                grad[1, k] += gky
                grad[2, k] += gkz
                if PER_ATOM:
                    share_triple(shares, j, k, rows[row, 6], gjx, gjy, gjz, gkx, gky, gkz)
        f[0, i] += fx
        f[1, i] += fy
        f[2, i] += fz
        for k in range(n):
            f[0, slots[k]] -= grad[0, k]
            f[1, slots[k]] -= grad[1, k]
            f[2, slots[k]] -= grad[2, k]
        if ENERGY:
            acc[0] += energy
            add_virial(acc, n, near, grad)


class ThreeBodyTable(ManyBody):
    """Entries by triples of elements, each with a table."""

    def read(self, file, elements, settings):
        out = {}
        for key, (p, where) in read_triples(file, elements, "cut *table *keyword *style N").items():
            what = f"{file.what}: entry {' '.join(key)}"
            if not p["cut"] > 0.0:
                raise InputError(f"{what}: the cutoff must be positive, got {p['cut']:g}", where)
            if p["style"] != "linear":
                raise InputError(f"{what}: the style of the table must be linear, got {p['style']!r}", where)
            ordered = key[1] == key[2]
            table = read_section(p["table"], p["keyword"], PARAMETERS, 11, what,
                                 lines_of=lambda n, ordered=ordered: n * n * (n + 1) if ordered else 2 * n**3)
            n, rmin, rmax = (table.parameters.get(name, (0.0,))[0] for name in PARAMETERS)
            if not 0.0 < rmin < rmax:
                raise InputError(f"{what}: table {p['keyword']} needs rmin and rmax, 0 < rmin < rmax", table.where)
            out[key] = {"cut": p["cut"], "grid": (rmin, (rmax - rmin) / (n - 1.0), n, float(ordered)), "rows": table.columns[:, 4:]}
        return out

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, n = element_of(filled, ntypes), ntypes + 1
        c = next(iter(filled.values()))
        self.unit_factor(c, units)
        data = c["data"]
        names = list(data)
        starts = np.cumsum([0, *(len(data[key]["rows"]) for key in names)])
        entries = np.array([[*data[key]["grid"], start, data[key]["cut"] ** 2] for key, start in zip(names, starts)])
        rows, three = np.zeros((1, n, n)), np.zeros((n, n, n), np.int64)
        for a, b in filled:
            for i, j in {(a, b), (b, a)}:
                for k in range(1, n):
                    if element[k] is not None:
                        three[i, j, k] = names.index((element[i], element[j], element[k]))
                        rows[0, i, j] = max(rows[0, i, j], entries[three[i, j, j], 5])
        rows[0] = np.maximum(rows[0], rows[0].T)
        return PairTables(rows, np.zeros(1), (three, entries, np.concatenate([data[key]["rows"] for key in names])))


register(ThreeBodyTable("threebody/table", forces=table_forces, helpers=(place_of,), rooms=1, converts=False,
                        example="spce2.3b type1", see="LAMMPS manual, pair_style threebody/table"))
