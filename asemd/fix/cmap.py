r"""Correction maps for pairs of neighbouring torsions: an energy that depends on the angles phi and psi of five atoms in a row.

.. math:: E(\phi, \psi) = \sum_{k,l=0}^{3} c_{kl} \, t^k u^l

in each cell of a grid of 24 x 24 values over -180 to 180 degrees (bicubic interpolation; its slopes at the grid points are those of
cubic splines through the values continued periodically by half a turn on both sides). CHARMM force fields correct the backbone of
proteins this way. Torsions of five atoms: phi is that of the first four, psi that of the last four.

A file of maps has, after comments that begin with ``#``, the values of one map after the other, each row by row: phi is the same within a
row. Cross terms, which name a map by its number and five atoms, come from a data file (``read_data file fix ID crossterm CMAP``).

Source: A. D. MacKerell, M. Feig, C. L. Brooks, J. Am. Chem. Soc. 126, 698 (2004); LAMMPS manual, fix cmap. Units: maps in energy units.
Output: a scalar, the energy.
"""
from __future__ import annotations

import functools
import math

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.kernels.image import closest_general
from asemd.kernels.threads import barrier
from asemd.topology import CROSSTERM
from asemd.words import whole

GRID = 24
OUT = 22            # numbers of a cross term: energy, virial xx yy zz xy xz yz, forces on five atoms


@functools.cache
def _slopes() -> np.ndarray:
    """(24, 24): slopes at the points, per spacing, of the natural spline through 24 values continued by 12 on both sides."""
    n, half = 2 * GRID, GRID // 2
    left, right = 4.0 * np.eye(n), np.zeros((n, n))
    left[0, 0] = left[-1, -1] = 2.0
    for k in range(n - 1):
        left[k, k + 1] = left[k + 1, k] = 1.0
    for k in range(n):
        right[k, min(k + 1, n - 1)] += 3.0
        right[k, max(k - 1, 0)] -= 3.0
    continued = np.eye(GRID)[(np.arange(n) - half) % GRID]
    return (np.linalg.solve(left, right) @ continued)[half:half + GRID]


def with_slopes(maps: np.ndarray) -> np.ndarray:
    """(m, 24, 24, 4) values of maps (m, 24, 24) with their slopes in phi, in psi and the mixed ones, per spacing."""
    d = _slopes()
    return np.ascontiguousarray(np.stack([maps, d @ maps, maps @ d.T, d @ maps @ d.T], axis=-1))


def read_maps(path: str) -> np.ndarray:
    """(m, 24, 24) the maps of a file.

    Raises
    ------
    InputError
        No such file, something that is no number, a map that is not complete.
    """
    what, values = "fix cmap", []
    try:
        with open(path, encoding="utf-8") as f:
            for number, line in enumerate(f, 1):
                for word in line.split("#", 1)[0].split():
                    try:
                        values.append(float(word))
                    except ValueError:
                        raise InputError(f"{what}: expected a number in line {number} of {path}, got {word!r}") from None
    except (OSError, UnicodeDecodeError) as e:
        raise InputError(f"{what}: cannot read {path}: {getattr(e, 'strerror', None) or 'it is not a text file'}") from None
    size = GRID * GRID
    if not np.isfinite(values).all():
        raise InputError(f"{what}: a value of {path} is not finite")
    if len(values) % size or not values:
        raise InputError(f"{what}: {path} has {len(values)} values, not {size} for each map")
    return np.array(values).reshape(-1, GRID, GRID)


def torsion(f, g, h, grad):
    """The angle of a torsion with f = x1 - x2, g = x2 - x3, h = x4 - x3; its gradients for the atoms (4, 3)."""
    ax, ay, az = f[1] * g[2] - f[2] * g[1], f[2] * g[0] - f[0] * g[2], f[0] * g[1] - f[1] * g[0]
    bx, by, bz = h[1] * g[2] - h[2] * g[1], h[2] * g[0] - h[0] * g[2], h[0] * g[1] - h[1] * g[0]
    aa, bb, gg = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, g[0] * g[0] + g[1] * g[1] + g[2] * g[2]
    length = math.sqrt(gg)
    sine = ((by * az - bz * ay) * g[0] + (bz * ax - bx * az) * g[1] + (bx * ay - by * ax) * g[2]) / length
    fg, hg = (f[0] * g[0] + f[1] * g[1] + f[2] * g[2]) / gg, (h[0] * g[0] + h[1] * g[1] + h[2] * g[2]) / gg
    wa, wb = -length / aa, length / bb
    a, b = (wa * ax, wa * ay, wa * az), (wb * bx, wb * by, wb * bz)
    for d in range(3):
        inner = -fg * a[d] - hg * b[d]
        grad[0, d], grad[1, d], grad[2, d], grad[3, d] = a[d], inner - a[d], -inner - b[d], b[d]
    return math.atan2(sine, ax * bx + ay * by + az * bz)


def place(angle):
    """The cell of a grid in which an angle is, and where in it, from 0 to 1."""
    u = (angle + math.pi) * (24.0 / (2.0 * math.pi))
    if not u < 24.0:        # half a turn, or not a number
        return 0, u - 24.0
    k = int(u)
    return k, u - k


def bicubic(grid, phi, psi):
    """Energy and its slopes in phi and psi (radians) of a map with slopes (24, 24, 4)."""
    i, t = place(phi)
    j, u = place(psi)
    e, e1, e2 = 0.0, 0.0, 0.0
    for n in range(2):
        row = (i + n) % 24
        p = t * t * (3.0 - 2.0 * t)
        p, q = (p, t * t * (t - 1.0)) if n else (1.0 - p, t * (t - 1.0) * (t - 1.0))
        dp, dq = 6.0 * t * (1.0 - t) * (2 * n - 1), (3.0 * t - 2.0) * t if n else (3.0 * t - 1.0) * (t - 1.0)
        for m in range(2):
            c = grid[row, (j + m) % 24]
            r = u * u * (3.0 - 2.0 * u)
            r, s = (r, u * u * (u - 1.0)) if m else (1.0 - r, u * (u - 1.0) * (u - 1.0))
            dr, ds = 6.0 * u * (1.0 - u) * (2 * m - 1), (3.0 * u - 2.0) * u if m else (3.0 * u - 1.0) * (u - 1.0)
            value, slope = r * c[0] + s * c[2], r * c[1] + s * c[3]
            e += p * value + q * slope
            e1 += dp * value + dq * slope
            e2 += p * (dr * c[0] + ds * c[2]) + q * (dr * c[1] + ds * c[3])
    return e, e1 * (24.0 / (2.0 * math.pi)), e2 * (24.0 / (2.0 * math.pi))


def cross_term(x, slot, cell, item, grid, out, grad):
    """One cross term: energy, virial and forces into `out` (22,); `grad` (2, 4, 3) is room for the gradients of both angles."""
    i, j, k, l, m = slot[item[0]], slot[item[1]], slot[item[2]], slot[item[3]], slot[item[4]]
    f = closest_general(x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j], cell)
    g = closest_general(x[0, j] - x[0, k], x[1, j] - x[1, k], x[2, j] - x[2, k], cell)
    h = closest_general(x[0, l] - x[0, k], x[1, l] - x[1, k], x[2, l] - x[2, k], cell)
    w = closest_general(x[0, m] - x[0, l], x[1, m] - x[1, l], x[2, m] - x[2, l], cell)
    phi = torsion(f, g, h, grad[0])
    psi = torsion(g, (-h[0], -h[1], -h[2]), w, grad[1])
    out[0], slope1, slope2 = bicubic(grid, phi, psi)
    for n in range(5):
        for d in range(3):
            first, last = grad[0, n, d] if n < 4 else 0.0, grad[1, n - 1, d] if n else 0.0
            out[7 + 3 * n + d] = -slope1 * first - slope2 * last
    for c in range(6):      # places of the atoms counted from the third one: g + f, g, 0, h, h + w
        p, q = (c, c) if c < 3 else (0, c - 2) if c < 5 else (1, 2)
        out[1 + c] = (out[7 + p] * (g[q] + f[q]) + out[10 + p] * g[q] + out[16 + p] * h[q] + out[19 + p] * (h[q] + w[q]))


class CMAP(Forcing):
    """Correction maps.

    Parameters
    ----------
    maps : (m, 24, 24) array or path
        Energies at -180, -165, ... 165 degrees, in energy units of the scene: first index phi, second psi; or a file with them.
    group : str
        Without meaning; cross terms name their atoms.

    The cross terms are those of the atoms: `crossterms` and `crossterm_types` of their `asemd.topology.Topology`.

    Raises
    ------
    InputError
        A file that cannot be read, maps of another shape; at the start of a run, cross terms without a map or without an atom.
    """

    style = "cmap"
    before_box = writedata = True
    modifies = ("energy", "virial")
    thermo_energy = True
    thermo_virial = True
    told = 1

    def __init__(self, maps, group: str = "all"):
        super().__init__(group)
        self.path = maps if isinstance(maps, str) else ""
        self.maps = read_maps(maps) if self.path else np.array(maps, float)
        if self.maps.ndim != 3 or self.maps.shape[1:] != (GRID, GRID):
            raise InputError(f"fix cmap: maps must have the shape (m, {GRID}, {GRID}), got {self.maps.shape}")
        self.grids = with_slopes(self.maps)
        self.items, self.out = np.zeros((0, 5), np.int32), np.zeros((0, OUT))
        self.promised: int | None = None

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) != 1:
            raise InputError(f"fix cmap needs one word, the file of the maps, got {' '.join(words) or 'none'}")
        other = next((f.id for f in session.scene.fixes.values() if isinstance(f, cls) and f.id != session.defining), None)
        if other is not None:
            raise InputError(f"fix cmap: there is fix {other} of this style already, all maps and cross terms belong to one")
        session.print(f"Reading CMAP parameters from: {words[0]}")
        fix = cls(words[0], group)
        session.print(f"  Read in CMAP data for {len(fix.maps)} crossterm types")
        return fix

    def to_lammps(self) -> list[str]:
        return [self.path]

    # ---- data files
    def read_header(self, words: list[str]) -> None:
        """The header line ``N crossterms``."""
        self.promised = whole(words[0], "number of crossterms")

    def read_section(self, system, lines, offset: int = 0) -> None:
        """Cross terms from the lines (place, words) of a section of a data file; `offset` is added to atom ids."""
        what, items, types = "CMAP section", [], []
        if self.promised != len(lines):
            place, lost = (lines[-1][0], f"{len(lines)} lines") if lines else (None, "no lines")
            raise InputError(f"{what} has {lost}, the header says {self.promised or 0} crossterms", place)
        for where, words in lines:
            if len(words) != 7:
                raise InputError(f"{what}: expected a number, a map and five atom ids, got {len(words)} words", where)
            try:
                numbers = [whole(w, what) for w in words]
                if not 1 <= numbers[1] <= len(self.maps):
                    raise InputError(f"{what}: there is no map {numbers[1]}, fix {self.id} has {len(self.maps)}")
                if len(set(numbers[2:])) < 5:
                    raise InputError(f"{what}: an atom appears twice in cross term {'-'.join(words[2:])}")
                items.append(system.index_of(np.array(numbers[2:]) + offset))
            except InputError as e:
                raise e.at(where) from None
            types.append(numbers[1])
        system.topology.add_crossterms(np.array(items, int).reshape(-1, 5), types)
        self.promised = None

    def data_header(self, system) -> str:
        """Its line in the header of a data file."""
        return f"{len(system.topology.crossterms)} crossterms"

    def data_sections(self, system) -> dict[str, dict]:
        """Its sections of a data file: heading -> columns."""
        top = system.topology
        if not len(top.crossterms):
            return {}
        ids = dict(enumerate(system.id[top.crossterms].T))
        return {"CMAP": {"number": np.arange(1, len(top.crossterms) + 1), "type": top.crossterm_types, **ids}}

    def detach(self, system) -> None:
        if system is not None:
            system.topology.drop_crossterms()

    def state(self):
        return {"crossterms": len(self.items)} if len(self.items) else {}

    def restore(self, state) -> None:
        """Cross terms are kept with the bonds."""

    # ---- a run
    def prepare(self, loop) -> None:
        system = loop.system
        torn = next((ids for kind, _, ids in system.torn if kind == CROSSTERM), None)
        if torn is not None:
            raise SimulationError(f"CMAP atoms {' '.join(map(str, torn))} missing at step {loop.step}: an atom of a cross term was deleted")
        types = system.topology.crossterm_types
        wrong = types[(types < 1) | (types > len(self.maps))]
        if len(wrong):
            raise InputError(f"fix cmap: a cross term has map {wrong[0]}, there are {len(self.maps)}")

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        top = loop.system.topology
        self.items, self.out = np.ascontiguousarray(top.crossterms, np.int32), np.zeros((len(top.crossterms), OUT))
        self.types = np.ascontiguousarray(top.crossterm_types, np.int32)
        return self.items, self.types, self.grids, self.out, np.zeros((64, 2, 4, 3))

    @hook(uses=[closest_general, torsion, place, bicubic, cross_term])
    def post_force(th, s, p, a):
        items, types, grids, out, room = a
        count = items.shape[0]
        for n in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
            cross_term(s.x, s.slot, s.box.cell, items[n], grids[types[n] - 1], out[n], room[th.tid % 64])
        barrier(th)
        for n in range(count):      # each thread adds the forces on its own atoms
            for k in range(5):
                i = s.slot[items[n, k]]
                if th.lo <= i < th.hi:
                    for d in range(3):
                        s.f[d, i] += out[n, 7 + 3 * k + d]
        if th.tid == 0:
            energy = 0.0
            for n in range(count):
                energy += out[n, 0]
                if p[1] != 0.0:
                    for c in range(6):
                        s.virial[0, c] += out[n, 1 + c]
            p[3] = energy
        barrier(th)

    # ---- outputs
    def scalar(self) -> float:
        """Energy of all cross terms, energy units."""
        return float(self.p[3])

    def _shares(self, state, columns: slice) -> np.ndarray:
        """Numbers of the cross terms by atom: a fifth for each of the five."""
        total = np.zeros((state.system.n, columns.stop - columns.start))
        for atoms in self.items.T:
            np.add.at(total, atoms, 0.2 * self.out[:, columns])
        return total

    def energies(self, state) -> np.ndarray:
        """(n,) each atom's share of the energy."""
        return self._shares(state, slice(0, 1))[:, 0]

    def virials(self, state) -> np.ndarray:
        return self._shares(state, slice(1, 7))

    def broken_constraint(self, loop) -> str:
        bad = np.flatnonzero(~np.isfinite(self.out[:, 0]))
        if not len(bad):
            return ""
        return f"fix {self.id or 'cmap'}: atoms {' '.join(map(str, loop.system.id[self.items[bad[0]]]))} have no torsions, three are on a line"
