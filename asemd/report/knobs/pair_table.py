"""A pair style replaced by its own table: what interpolation costs, and what it is worth."""
from __future__ import annotations

import os

import numpy as np

from asemd import units as unit_styles
from asemd.lammps.command.pair_write import pair_value
from asemd.report.knob import Knob

VALUES = (("linear", 1000), ("spline", 1000), ("linear", 10000), ("linear", 200), ("spline", 200), ("spline", 4000))
FILE = 3            # values on file for each one of the table
HIGH = 100.0        # energies up to this many kT are tabulated
MOST = 15           # pairs of types


def thermal_energy(scene) -> float:
    """kT of a scene's velocities."""
    system, boltz = scene.system, unit_styles.get(scene.units).boltz
    twice = unit_styles.get(scene.units).mvv2e * float(np.einsum("i,ij,ij->", np.nan_to_num(system.atom_masses(), nan=1.0),
                                                                 system.v, system.v))
    return boltz * (twice / (max(system.n, 1) * system.dimension * boltz))


class PairTable(Knob):
    """``pair_style table linear|spline N`` with a file written by ``pair_write``."""

    name, title, order = "table", "pair table", 50

    def needs(self, scene):
        inter, ntypes = scene.interactions, scene.system.counts["ntypes"]
        if not inter.uses["pair"]:
            return "no pair style"
        if inter.hybrid["pair"]:
            return "pair_style hybrid: its sub-styles are not replaced by tables"
        style = inter.uses["pair"][0].style
        if style.name == "table":
            return "the pair style is a table already"
        if not style.parts:
            what = "many-body forces, which no table of distances holds" if style.many else "no forces"
            return f"pair style {style.name} has {what}"
        if style.charged:
            return f"pair style {style.name} depends on charges, which a table of distances cannot hold"
        if ntypes * (ntypes + 1) // 2 > MOST:
            return f"more than {MOST} pairs of types"
        if any(u.style.weight_14 or getattr(u.style, "repulsion", "") for kind in ("angle", "dihedral") for u in inter.uses[kind]):
            return "a bonded style takes coefficients from the pair style"
        return None

    def values(self, scene):
        return list(VALUES)

    def current(self, scene):
        return None

    def commands(self, scene, value, folder):
        style, n = value
        ntypes = scene.system.counts["ntypes"]
        terms = scene.interactions.pair_terms(ntypes, unit_styles.get(scene.units))
        kt = thermal_energy(scene)
        write, use = [], [f"pair_style table {style} {n}"]
        for i in range(1, ntypes + 1):
            for j in range(i, ntypes + 1):
                cut = float(terms[0].tables.rows[terms[0].cut_rows, i, j].max()) ** 0.5
                if cut == 0.0:
                    cut, inner = 1e-3, 1e-4
                else:
                    inner = innermost(terms, i, j, cut, kt)
                outer = cut * (1.0 - 1e-9)      # at the cutoff itself the energy is zero
                path = os.path.join(folder, f"pair{i}-{j}.table")
                write.append(f"pair_write {i} {j} {FILE * n} rsq {inner:.10g} {outer:.12g} {path} TABLE")
                use.append(f"pair_coeff {i} {j} {path} TABLE")
        return [*write, *use]

    def label(self, value):
        return "exact" if value is None else f"{value[0]} {value[1]}"

    def phrase(self, value):
        return "exact pair forces" if value is None else f"pair table {self.label(value)}"

    def number(self, value, position):
        return float(value[1]) if value else float(position)


def innermost(terms, i: int, j: int, cut: float, kt: float) -> float:
    """The distance at which two atoms have more energy than they can get."""
    grid = cut * np.linspace(0.98, 0.05, 187)
    energies = np.array([pair_value(terms, i, j, r * r, 0.0)[0] for r in grid.tolist()])
    high = np.flatnonzero(energies > HIGH * max(kt, abs(float(energies.min()))))
    return float(grid[high[0]]) if len(high) else 0.05 * cut
