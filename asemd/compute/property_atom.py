"""What atoms have, as per-atom values: ids, types, positions, charges ...

Attributes: id mol proc type mass, x y z (as they are), xs ys zs (scaled), xu yu zu (unwrapped), ix iy iz (images), vx vy vz, fx fy fz, q,
nbonds (bonds that belong to the atom: those of which it is the first one, or with ``newton off`` all), and where the atom style has them
mux muy muz mu, radius diameter, omegax omegay omegaz, tqx tqy tqz, angmomx angmomy angmomz, shapex shapey shapez, quatw quati quatj quatk
(points of style ellipsoid count as upright ones of diameter 1, as in LAMMPS), area ed em epsilon curvature and q_scaled, the charge
divided by epsilon; i_name, d_name, i2_name[k], d2_name[k] of fix
property/atom.

Source: LAMMPS manual, compute property/atom.
"""
from __future__ import annotations

import re

import numpy as np

from asemd.atom_style import SHAPE, SURFACE, TURN, UPRIGHT
from asemd.compute import Compute
from asemd.dump._columns import COLUMNS, LABELS, View
from asemd.errors import InputError, nearest

LEFT_OUT = {"element", "procp1", *LABELS, *(f"{a}su" for a in "xyz")}
SOLID = {name: (array, k) for array, own in (("shape", SHAPE), ("quaternions", TURN)) for k, name in enumerate(own)}
ATTRIBUTES = (*(c for c in COLUMNS if c not in LEFT_OUT), "nbonds", *SOLID, *SURFACE, "q_scaled")
CUSTOM = re.compile(r"[id](_\w+|2_\w+\[\d+\])")


class PropertyAtom(Compute):
    """Attributes.

    Parameters
    ----------
    group : str
        The atoms it reports.
    names : sequence of str
        Of `ATTRIBUTES`, or properties such as ``d_name``.
    newton : bool
        A bond belongs to its first atom only.

    Raises
    ------
    InputError
        No attribute, or an unknown one.
    """

    style = "property/atom"

    def __init__(self, group: str = "all", names=(), newton: bool = True):
        super().__init__(group)
        self.names, self.newton = list(names), newton
        if not self.names:
            raise InputError("compute property/atom needs at least one attribute, for example: id")
        for name in self.names:
            if name not in ATTRIBUTES and not CUSTOM.fullmatch(name):
                raise InputError(f"compute property/atom: attribute {name!r} is unknown or not supported{nearest(name, ATTRIBUTES)}")

    @classmethod
    def from_lammps(cls, group, words, session):
        new, system = cls(group, words, session.scene.newton[1]), session.scene.need_system("compute property/atom")
        for name in new.names:
            new._column(View(_Bare(system), np.zeros(0, int), []), name)
        return new

    def to_lammps(self) -> list[str]:
        return self.names

    def per_atom_columns(self) -> int:
        return len(self.names)

    def _column(self, view: View, name: str) -> np.ndarray:
        if name == "nbonds":
            topology, n = view.system.topology, view.system.n
            bonds = topology.bonds[topology.bond_types != 0]
            return np.bincount((bonds[:, 0] if self.newton else bonds.ravel()), minlength=n).astype(float)[view.rows]
        if name in SURFACE or name == "q_scaled":
            extra, rows = view.system.extra, view.rows
            if name not in extra and "epsilon" not in extra:
                raise InputError(f"compute property/atom {name}: atom style {view.system.atom_style} has no dielectric constants")
            return extra[name][rows] if name in extra else view.system.q[rows] / extra["epsilon"][rows]
        if name in SOLID:
            extra, (array, k) = view.system.extra, SOLID[name]
            if array not in extra:
                raise InputError(f"compute property/atom {name}: atom style {view.system.atom_style} has no ellipsoids")
            point = UPRIGHT[k] if array == "quaternions" else 1.0
            return np.where(extra["shape"][view.rows, 0] > 0.0, extra[array][view.rows, k], point)
        try:
            values = view.custom(name) if CUSTOM.fullmatch(name) else COLUMNS[name][1](view)
        except InputError as e:
            raise InputError(f"compute property/atom {name}: {e.message.removeprefix('dump: ')}") from None
        return np.asarray(values, float)

    def per_atom(self, state) -> np.ndarray:
        """(n,) for one attribute, (n, k) for several; zero outside the group."""
        view, mask = View(state, np.arange(state.system.n), []), state.mask(self.group)
        columns = [np.where(mask, self._column(view, name), 0.0) for name in self.names]
        return columns[0] if len(columns) == 1 else np.column_stack(columns)


class _Bare:
    """What `View` needs of a snapshot."""

    def __init__(self, system):
        self.system = system
