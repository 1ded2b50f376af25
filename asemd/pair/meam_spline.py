r"""Modified embedded-atom method with all its functions as cubic splines.

$$E=\sum_{i<j}\phi(r_{ij})+\sum_i\big[U(\rho_i)-U(0)\big],\quad
\rho_i=\sum_j\rho(r_{ij})+\sum_{j<k}f(r_{ij})f(r_{ik})\,g(\cos\theta_{jik})$$

Of several elements $\phi$ and g belong to pairs of them (g to those of the neighbours), $\rho$ and f to the neighbour, U to the atom.
Beyond their ends splines go on as lines, up to the cutoff, which is the end of the farthest. Types are what their elements in
``pair_coeff`` say, several of one element and NULL too; LAMMPS has one type for each element of the file, in the file's order.

Source: LAMMPS manual, pair_style meam/spline; Lenosky et al., Modelling Simul. Mater. Sci. Eng. 8, 825 (2000).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.kernels.manybody import PER_ATOM, share_pair, share_triple
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
from asemd.potential_file import PotentialFile, Record
from asemd.style import register

WITH_TRIPLES = False      # triples have energies of their own (meam/sw/spline)


def look(splines, knots, which, x):
    """Value and slope of a spline: xmin, width, 1/h, h, intervals, first row; value and slope at the ends. Rows: end of an interval, value
    there, slope of the chord, sixths of the second derivatives by h at both ends."""
    s = splines[which]
    x -= s[0]
    if x <= 0.0:
        return s[6] + s[7] * x, s[7]
    if x >= s[1]:
        return s[8] + s[9] * (x - s[1]), s[9]
    row = knots[int(s[5]) + min(int(x * s[2]), int(s[4]) - 1)]
    h = s[3]
    a = row[0] - x
    b = h - a
    value = row[1] - a * row[2] + (a * a - h * h) * a * row[3] + (b * b - h * h) * b * row[4]
    return value, row[2] + (3.0 * b * b - h * h) * row[4] - (3.0 * a * a - h * h) * row[3]


def meam_spline(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    """`which`: splines of phi and g by pair of types (4, nt, nt), of them G; `of_one`: rho, U, f and F by type."""
    splines, knots, which, of_one = arrays
    energy, rho = 0.0, 0.0
    for k in range(n):
        t = types[k]
        r = math.sqrt(near[3, k])
        ir = 1.0 / r
        ux, uy, uz = near[0, k] * ir, near[1, k] * ir, near[2, k] * ir
        room[0, k], room[1, k], room[2, k], room[3, k] = ux, uy, uz, ir
        e, room[4, k] = look(splines, knots, of_one[0, t], r)
        rho += e
        room[5, k], room[6, k] = look(splines, knots, of_one[2, t], r)
        if WITH_TRIPLES:
            room[7, k], room[8, k] = look(splines, knots, of_one[3, t], r)
        if k < m:
            e, d = look(splines, knots, which[0, ti, t], r)
            energy += e
            grad[0, k] += d * ux
            grad[1, k] += d * uy
            grad[2, k] += d * uz
            if PER_ATOM:
                share_pair(shares, k, e, d * ux, d * uy, d * uz)
    for j in range(n - 1):
        for k in range(j + 1, n):
            c = room[0, j] * room[0, k] + room[1, j] * room[1, k] + room[2, j] * room[2, k]
            g, dg = look(splines, knots, which[1, types[j], types[k]], c)
            rho += room[5, j] * room[5, k] * g
    u, du = look(splines, knots, of_one[1, ti], rho)
    u -= splines[of_one[1, ti], 10]
    energy += u
    if PER_ATOM:
        shares[0][shares[2]] += u
    for k in range(n):
        d = du * room[4, k]
        grad[0, k] += d * room[0, k]
        grad[1, k] += d * room[1, k]
        grad[2, k] += d * room[2, k]
        if PER_ATOM:
            share_pair(shares, k, 0.0, d * room[0, k], d * room[1, k], d * room[2, k])
    for j in range(n - 1):
        ux, uy, uz = room[0, j], room[1, j], room[2, j]
        for k in range(j + 1, n):
            vx, vy, vz = room[0, k], room[1, k], room[2, k]
            c = ux * vx + uy * vy + uz * vz
            g, dg = look(splines, knots, which[1, types[j], types[k]], c)
            a = du * room[6, j] * room[5, k] * g
            b = du * room[5, j] * room[6, k] * g
            w = du * room[5, j] * room[5, k] * dg
            if WITH_TRIPLES:
                g, dg = look(splines, knots, which[2, types[j], types[k]], c)
                e = room[7, j] * room[7, k] * g
                energy += e
                if PER_ATOM:
                    shares[0][shares[2]] += e
                a += room[8, j] * room[7, k] * g
                b += room[7, j] * room[8, k] * g
                w += room[7, j] * room[7, k] * dg
            s, t = w * room[3, j], w * room[3, k]
            a -= c * s
            b -= c * t
            gjx, gjy, gjz = a * ux + s * vx, a * uy + s * vy, a * uz + s * vz
            gkx, gky, gkz = b * vx + t * ux, b * vy + t * uy, b * vz + t * uz
            grad[0, j] += gjx
            grad[1, j] += gjy
            grad[2, j] += gjz
            grad[0, k] += gkx
            grad[1, k] += gky
            grad[2, k] += gkz
            if PER_ATOM:
                share_triple(shares, j, k, 0.0, gjx, gjy, gjz, gkx, gky, gkz)
    return energy


class SplineReader:
    """Splines of a file one after the other; `flags`: a line of four numbers follows their end slopes."""

    def __init__(self, file: PotentialFile):
        self.file, self.lines = file, [(k, line.split()) for k, line in file.lines if k > 1]
        self.flags = True

    def record(self, what: str) -> Record:
        if not self.lines:
            raise self.file.error(f"the file ends before {what}", len(self.file.raw))
        number, words = self.lines.pop(0)
        return Record(words, self.file.where(number), self.file.what)

    def spline(self, name: str) -> dict:
        """The next spline: knots x and y, slopes at its ends.

        Raises
        ------
        InputError
            Knots are too few or not evenly spaced, something is missing or no number.
        """
        if not self.flags and (kind := (record := self.record(f"spline {name}")).word()) != "spline3eq":
            raise InputError(f"{record.what}: expected spline3eq before spline {name}, got {kind}", record.where)
        record = self.record(f"spline {name}")
        count, where = record.whole(f"the number of knots of {name}"), record.where
        record = self.record(f"the slopes of {name}")
        slopes = record.number(f"the first slope of {name}"), record.number(f"the last slope of {name}")
        if self.flags:
            self.record(f"the flags of {name}")
        knots = []
        for _ in range(count):
            record = self.record(f"the {count} knots of {name}")
            knots.append((record.number("x"), record.number("y")))
        x, y = np.array(knots).reshape(-1, 2).T
        if count < 2 or not (x[1:] > x[:-1]).all() or np.abs(np.linspace(x[0], x[-1], count) - x).max() > 1e-8:
            raise InputError(f"{self.file.what}: {name} needs two knots or more, evenly spaced, in rising order", where)
        spline = {"x": x, "y": y, "slopes": slopes}
        try:
            with np.errstate(all="ignore"):
                fits = all(np.isfinite(part).all() for part in packed(spline, 1.0, 0))
        except ValueError:      # of scipy
            fits = False
        if not fits:
            raise InputError(f"{self.file.what}: the numbers of {name} are too large for a spline", where)
        return spline


def packed(spline: dict, unit: float, first: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of a spline and its rows, see `look`; its values are multiplied with `unit`."""
    from scipy.interpolate import CubicSpline
    x, y, slopes = spline["x"], unit * spline["y"], [unit * s for s in spline["slopes"]]
    n = len(x) - 1
    h, width = (x[-1] - x[0]) / n, x[-1] - x[0]
    bend = CubicSpline(x, y, bc_type=((1, slopes[0]), (1, slopes[1])))(x, 2) / (6.0 * h)
    rows = np.column_stack([x[1:] - x[0], y[1:], np.diff(y) / h, bend[:-1], bend[1:]])
    return np.array([x[0], width, 1.0 / h, h, n, first, y[0], slopes[0], y[-1], slopes[1], 0.0]), rows


class MeamSpline(ManyBody):
    """Styles meam/spline and, with energies of `triples`, meam/sw/spline."""

    def __init__(self, name: str, triples: bool, **options):
        super().__init__(name, site=meam_spline, helpers=(look,), rooms=9, **options)
        self.triples, self.kernel_constants, self.reads = triples, {"WITH_TRIPLES": triples}, name

    def read(self, file, elements, settings):
        reader = SplineReader(file)
        words = reader.lines[0][1] if reader.lines else []
        if words[:1] == [self.name] and not self.triples:
            record = reader.record("the elements")
            record.word()
            names = tuple(record.word("an element") for _ in range(record.whole("the number of elements")))
            reader.flags = False
            for e in elements:
                if e not in names:
                    raise InputError(f"{file.what}: {file.name} has no element {e}, only {' '.join(names)}")
        elif len(elements) > 1:
            raise InputError(f"{file.what}: {file.name} is of one element, got {' '.join(elements)}")
        else:
            names = tuple(elements)
        n = len(names)
        pairs = [(a, b) for a in range(n) for b in range(a, n)]
        out: dict = {"names": names}

        def take(kind: str, keys) -> None:
            out[kind] = {key: reader.spline(" ".join([kind, *(names[k] for k in np.atleast_1d(key))])) for key in keys}

        take("phi", pairs)
        if self.triples:
            take("F", range(n))
            take("G", pairs)
        take("rho", range(n))
        take("U", range(n))
        take("f", range(n))
        take("g", pairs)
        return out

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c = element_of(filled, ntypes), next(iter(filled.values()))
        data, unit, n = c["data"], self.unit_factor(c, units), ntypes + 1
        names, numbers, rows, at = data["names"], [], [], {}
        for kind in ("phi", "g", "G", "rho", "U", "f", "F"):
            for key, spline in data.get(kind, {}).items():
                at[kind, key] = len(numbers)
                made = packed(spline, unit if kind in ("phi", "U", "G") else 1.0, sum(map(len, rows)))
                numbers.append(made[0])
                rows.append(made[1])
        splines, knots = np.array(numbers), np.concatenate(rows)
        for kind, key in at:
            if kind == "U":
                splines[at[kind, key], 10] = look(splines, knots, at[kind, key], 0.0)[0]
        ends = [float(s["x"][-1]) for kind in ("phi", "rho", "f", *(("F",) if self.triples else ())) for s in data[kind].values()]
        where = [names.index(e) if e is not None else -1 for e in element]
        cut2, which, of_one = np.zeros((1, n, n)), np.zeros((3, n, n), np.int64), np.zeros((4, n), np.int64)
        for i, j in {key for pair in filled for key in (pair, pair[::-1])}:
            cut2[0, i, j] = max(ends) ** 2
            key = tuple(sorted((where[i], where[j])))
            which[:, i, j] = [at.get((kind, key), 0) for kind in ("phi", "g", "G")]
            of_one[:, i] = [at.get((kind, where[i]), 0) for kind in ("rho", "U", "f", "F")]
        return PairTables(cut2, np.zeros(1), (splines, knots, which, of_one))


register(MeamSpline("meam/spline", False, converts=False, doc=__doc__, example="Ti.meam.spline Ti",
                    see="T. J. Lenosky et al., Modelling Simul. Mater. Sci. Eng. 8, 825 (2000)"))
