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

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.kernels.correction_map import GRID, OUT, USES, cross_terms, with_slopes
from asemd.kernels.threads import barrier
from asemd.topology import CROSSTERM
from asemd.words import real, whole


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
                        values.append(real(word))
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
    restarts = ("global", "peratom")
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
        return self.items, self.types, self.grids, self.out, np.zeros((loop.engine.threads, 2, 4, 3))

    @hook(uses=USES)
    def post_force(th, s, p, a):
        items, types, grids, out, room = a
        count = items.shape[0]
        first, last = count * th.tid // th.nth, count * (th.tid + 1) // th.nth
        cross_terms(s.x, s.slot, s.box.cell, items, types, grids, out, room[th.tid], first, last)
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
        ids = " ".join(map(str, loop.system.id[self.items[bad[0]]]))
        return f"the torsions of atoms {ids} are not defined: three of them are on a line"
