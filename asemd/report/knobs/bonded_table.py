"""Bonded styles replaced by their own tables."""
from __future__ import annotations

import math
import os

import numpy as np

from asemd.errors import InputError
from asemd.report.constraints import held
from asemd.report.knob import Knob
from asemd.report.knobs.pair_table import HIGH, thermal_energy

VALUES = (("linear", 1000), ("spline", 1000), ("linear", 10000), ("linear", 200), ("spline", 200))
FILE = 3            # values on file for each one of the table
COORDINATE = {"bond": "r", "angle": "theta", "dihedral": "phi"}


class BondTable(Knob):
    """``bond_style table linear|spline N`` with a file written by ``bond_write``."""

    name, title, order = "bond-table", "bond table", 52
    kind = "bond"

    def needs(self, scene):
        inter, kind = scene.interactions, self.kind
        items, types = scene.system.topology.items(kind)
        if not len(items) or not inter.uses[kind]:
            return f"no {kind}s"
        if holder := held(scene, kind):
            return f"{holder} holds {kind}s: they have no forces, and it takes what they are held at from the {kind} style"
        if inter.hybrid[kind]:
            return f"{kind}_style hybrid: its sub-styles are not replaced by tables"
        use = inter.uses[kind][0]
        if use.style.name == "table":
            return f"the {kind} style is a table already"
        if use.style.function is None:
            return f"{kind} style {use.style.name} has no forces"
        style = use.style.bind(use.settings, use.coeff, inter.compat)
        if style.coordinates != (COORDINATE[kind],) or style.weight_14 or style.history or getattr(style, "pair_weights", ()):
            return f"{kind} style {use.style.name} depends on more than its {'length' if kind == 'bond' else 'angle'}"
        return None

    def values(self, scene):
        return list(VALUES)

    def current(self, scene):
        return None

    def commands(self, scene, value, folder):
        style, n = value
        kind = self.kind
        # a file for each type: a reader goes through the whole file for each of its sections
        paths = {t: os.path.join(folder, f"{kind}{t}.table") for t in sorted(scene.interactions.uses[kind][0].coeff)}
        write = [f"{kind}_write {t} {FILE * n} {self.range(scene, t)}{path} TABLE" for t, path in paths.items()]
        return [*write, f"{kind}_style table {style} {n}", *(f"{kind}_coeff {t} {path} TABLE" for t, path in paths.items())]

    def range(self, scene, t: int) -> str:
        """Words of ``bond_write`` for lengths that bonds can have."""
        lo, hi = bond_range(scene, t)
        return f"{lo:.10g} {hi:.10g} "

    def label(self, value):
        return "exact" if value is None else f"{value[0]} {value[1]}"

    def phrase(self, value):
        return f"exact {self.kind} forces" if value is None else f"{self.kind} table {self.label(value)}"

    def number(self, value, position):
        return float(value[1]) if value else float(position)


class AngleTable(BondTable):
    """``angle_style table linear|spline N`` with a file written by ``angle_write``."""

    name, title, order = "angle-table", "angle table", 53
    kind = "angle"

    def range(self, scene, t):
        return ""


class DihedralTable(AngleTable):
    """``dihedral_style table linear|spline N`` with a file written by ``dihedral_write``."""

    name, title, order = "dihedral-table", "dihedral table", 54
    kind = "dihedral"


def bond_range(scene, t: int) -> tuple[float, float]:
    """Lengths up to which a bond of that type has less energy than it can get, and beyond which it is not defined."""
    from asemd.lammps.session import Session
    from asemd.lammps.table_write import style_of
    system = scene.system
    items, types = system.topology.items("bond")
    mine = items[types == t]
    if not len(mine):
        mine = items
    vectors, _ = system.box.minimum_image(system.x[mine[:, 0]] - system.x[mine[:, 1]])
    lengths = np.sqrt((vectors * vectors).sum(axis=1))
    start, kt = float(np.median(lengths)), thermal_energy(scene)
    function = style_of(Session(scene=scene, passive=True), "bond", t, "bond_write")[2]
    if not math.isfinite(function(start)[0]):
        raise InputError(f"bond of type {t} at {start:g}: its energy is not finite")
    lowest, ends = function(start)[0], []
    limit = max(HIGH * kt, 10.0 * abs(lowest), 1e-300)
    for step in (-1.0, 1.0):
        r = start
        for _ in range(400):
            new = r + 0.01 * step * start
            try:
                energy = function(new)[0] if new > 0.02 * start else math.inf
            except (ArithmeticError, ValueError):
                energy = math.inf
            if not math.isfinite(energy):
                break
            lowest, r = min(lowest, energy), new
            if energy - lowest > limit:
                break
        ends.append(r)
    return ends[0], ends[1]
