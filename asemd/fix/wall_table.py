r"""Walls with a potential from a table file, interpolated linearly or by cubic splines.

.. math:: E = E_{table}(r) - E_{table}(r_c)

Source: LAMMPS manual, fix wall/table. Arguments: linear or spline, N nodes; face, position, file, keyword of the section, cutoff for each
wall. Output: a scalar, the energy; a vector, the force on each wall.
"""
from __future__ import annotations

import numpy as np

from asemd.bonded_table import inner_table, interpolate
from asemd.errors import InputError, Where
from asemd.fix import hook
from asemd.fix.wall import Wall, forces_with
from asemd.tabulated import read_section
from asemd.words import choice, take, whole


def table_energy(r, p, at, a):
    """Energy and slope from the inner table that begins at row ``p[at + 9]`` of ``a``; in front of its first node those of the node."""
    return interpolate(max(r, p[at + 6]), p[at + 6], p[at + 8], p[at + 9], p[at + 10], p[at + 11], a)


class WallTable(Wall):
    """Walls with a tabulated potential.

    Parameters
    ----------
    group : str
        The atoms that feel the walls.
    walls : mapping of str to sequence
        Face ``xlo`` to ``zhi`` -> position, file, keyword, cutoff, in units of the scene.
    pbc : bool
        Walls may stand in periodic directions.
    interpolation : str
        ``linear`` or ``spline``.
    nodes : int
        Of the inner table.

    Raises
    ------
    InputError
        Also for a table that cannot be read or ends before the cutoff.
    """

    style = "wall/table"
    names = ("file", "keyword")

    def __init__(self, group: str = "all", walls=None, pbc: bool = False, interpolation: str = "linear", nodes: int = 1000):
        self.interpolation, self.nodes = choice(interpolation, ("linear", "spline"), "fix wall/table"), nodes
        if nodes < 2:
            raise InputError(f"fix wall/table: N must be at least 2, got {nodes}")
        super().__init__(group, walls, pbc)
        self.tables, self.units, start = [], "", 0
        for face, (_, file, keyword, cutoff) in self.walls.items():
            what = f"fix wall/table {face}"
            section = read_section(file, keyword, {"N": 1, "FP": 2, "EQ": 1}, 4, what)
            x, e, f = section.columns[:, 1:].T
            section.check_increasing(x, what)
            if cutoff > x[-1]:
                raise InputError(f"{what}: cutoff {cutoff:g} is larger than table outer cutoff {x[-1]:g}")
            ends = section.parameters.get("FP") or ((f[1] - f[0]) / (x[1] - x[0]), (f[-1] - f[-2]) / (x[-1] - x[-2]))
            lo, hi, delta, values = inner_table((x, e, f, *ends), nodes, interpolation == "spline")
            self.tables.append(([lo, hi, delta, start, len(values), interpolation == "spline"], values))
            self.units, start = section.units or self.units, start + len(values)
            self.file = file

    @classmethod
    def read_head(cls, words):
        interpolation, nodes = take(words, 2, "fix wall/table")
        del words[:2]
        return {"interpolation": interpolation, "nodes": whole(nodes, "fix wall/table N")}

    @classmethod
    def read_coefficient(cls, word, name, what, session):
        return word

    def head_words(self) -> list[str]:
        return [self.interpolation, str(self.nodes)]

    def numbers(self, loop) -> list[float]:
        if self.units and self.units != loop.system.units:
            raise InputError(f"fix wall/table: {self.file} requires {self.units} units but {loop.system.units} units are in use",
                             Where(self.file, 1))
        return super().numbers(loop)

    def block(self, m, face, values):
        place, _, _, cutoff = values
        return super().block(m, face, [place, *self.tables[m][0], cutoff])

    def energy_at(self, cutoff: float, block: np.ndarray) -> float:
        linear = block.copy()
        linear[11] = 0.0        # as LAMMPS, for splines too
        return table_energy(cutoff, linear, 0, self.all_nodes())[0]

    def all_nodes(self) -> np.ndarray:
        """(m, 4) the nodes of all tables."""
        return np.concatenate([values for _, values in self.tables])

    def uses_atoms(self) -> bool:
        return False

    def atom_arrays(self, loop) -> np.ndarray:
        return self.all_nodes()

    @hook(uses=[interpolate, table_energy, forces_with("table_forces", "table_energy(r, p, at, a)")])
    def post_force(th, s, p, a):
        table_forces(th, s, p, a)  # noqa: F821
