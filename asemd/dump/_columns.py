"""The columns of dumps: name -> kind and values of the atoms of a snapshot."""
from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from asemd.errors import InputError, nearest

AXES = "xyz"


class View:
    """Some atoms of a snapshot, in the order they are written; every array is made when it is first asked for.

    Parameters
    ----------
    snapshot : asemd.engine.Snapshot
    rows : (m,) int array
    element : list of str
        Names of the types from 1 on; C if empty, as in LAMMPS.
    variables : asemd.variable.Variables, optional
    general : bool
        Positions and vectors in the frame in which a general triclinic box was given; scaled positions are the same there.
    """

    def __init__(self, snapshot, rows: np.ndarray, element: Sequence[str], variables=None, general: bool = False):
        self.system, self.rows, self.variables, self._element = snapshot.system, rows, variables, element
        box = self.system.box
        self.box, self.rotation = (box, None) if box.is_lammps_frame else box.to_lammps()
        self.back = self.system.rotation.T if general else None

    def _vector(self, array: np.ndarray) -> np.ndarray:
        values = array[self.rows] if self.rotation is None else array[self.rows] @ self.rotation
        return values if self.back is None else values @ self.back

    def _position(self, x: np.ndarray) -> np.ndarray:
        return x if self.back is None else (x - self.box.origin) @ self.back + self.box.origin

    @cached_property
    def id(self):
        return self.system.id[self.rows]

    @cached_property
    def x(self):
        return self._position(self._inside)

    @cached_property
    def _inside(self):
        """Positions in LAMMPS's frame."""
        if self.rotation is None:
            return self.system.x[self.rows]
        return (self.system.x[self.rows] - self.system.box.origin) @ self.rotation + self.box.origin

    @cached_property
    def v(self):
        return self._vector(self.system.v)

    @cached_property
    def f(self):
        return self._vector(self.system.f)

    @cached_property
    def image(self):
        return self.system.image[self.rows]

    @cached_property
    def xs(self):
        """Scaled positions, by the arithmetic of an upper triangular inverse: last digits as LAMMPS has them."""
        box, d = self.box, self._inside - self.box.lo
        lx, ly, lz = box.hi - box.lo
        if not box.triclinic:
            return d * (1.0 / lx, 1.0 / ly, 1.0 / lz)
        xy, xz, yz = box.tilt
        return np.column_stack([d[:, 0] / lx - xy / (lx * ly) * d[:, 1] + (yz * xy - ly * xz) / (lx * ly * lz) * d[:, 2],
                                d[:, 1] / ly - yz / (ly * lz) * d[:, 2], d[:, 2] / lz])

    @cached_property
    def xu(self):
        return self._position(self._inside + self.image @ self.box.cell)

    @cached_property
    def xsu(self):
        return self.xs + self.image

    def _extra(self, name: str, what: str) -> np.ndarray:
        if name not in self.system.extra:
            raise InputError(f"dump: atom style {self.system.atom_style} has no {what} (property {name})")
        array = self.system.extra[name]
        return self._vector(array) if array.ndim == 2 else array[self.rows]

    @cached_property
    def mu(self):
        return self._extra("mu", "dipoles")

    @cached_property
    def torque(self):
        return self._extra("torque", "torques")

    @cached_property
    def omega(self):
        return self._extra("omega", "angular velocities")

    @cached_property
    def angmom(self):
        return self._extra("angmom", "angular momenta")

    @cached_property
    def radius(self):
        return self._extra("radius", "radius")

    def custom(self, name: str) -> np.ndarray:
        """Values of ``fix property/atom``: i_name, d_name, i2_name[k] or d2_name[k]."""
        base, _, index = name.rstrip("]").partition("[")
        if base not in self.system.extra:
            raise InputError(f"dump: atoms have no property {base}, define it with fix property/atom")
        values = self.system.extra[base]
        if (values.ndim == 2) != bool(index) or index and not 1 <= int(index) <= values.shape[1]:
            raise InputError(f"dump: {name}: property {base} has {values.shape[1] if values.ndim == 2 else 'no'} columns")
        return values[self.rows, int(index) - 1] if index else values[self.rows]

    def element(self) -> list[str]:
        if not self._element:
            return ["C"] * len(self.rows)
        return [self._element[t - 1] for t in self.system.type[self.rows].tolist()]

    def labels(self) -> list[str]:
        known = self.system.labels.get("atom", {})
        missing = {int(t) for t in np.unique(self.system.type[self.rows])} - set(known)
        if missing:
            raise InputError(f"dump: atom type {min(missing)} has no label, use the labelmap command")
        return [known[t] for t in self.system.type[self.rows].tolist()]

    def charge(self) -> np.ndarray:
        if self.system.q is None:
            raise InputError(f"dump: atom style {self.system.atom_style} has no charges for the column q")
        return self.system.q[self.rows]

    def molecule(self) -> np.ndarray:
        if not self.system.has_molecules:
            raise InputError(f"dump: atom style {self.system.atom_style} has no molecules for the column mol")
        return self.system.molecule[self.rows]


COLUMNS: dict[str, tuple[str, Callable[[View], Sequence]]] = {
    "id": ("integer", lambda w: w.id),
    "mol": ("integer", View.molecule),
    "proc": ("integer", lambda w: np.zeros(len(w.rows), int)),
    "procp1": ("integer", lambda w: np.ones(len(w.rows), int)),
    "type": ("integer", lambda w: w.system.type[w.rows]),
    "typelabel": ("string", View.labels),
    "element": ("string", View.element),
    "mass": ("float", lambda w: w.system.atom_masses()[w.rows]),
    "q": ("float", View.charge),
    "mu": ("float", lambda w: np.linalg.norm(w.mu, axis=1)),
    "radius": ("float", lambda w: w.radius),
    "diameter": ("float", lambda w: 2.0 * w.radius),
}
LABELS = ("typelabel", "element")


def _component(array: str, axis: int) -> Callable[[View], np.ndarray]:
    return lambda w: getattr(w, array)[:, axis]


for _k, _a in enumerate(AXES):
    for _suffix, _array in (("", "x"), ("s", "xs"), ("u", "xu"), ("su", "xsu")):
        COLUMNS[_a + _suffix] = ("float", _component(_array, _k))
    COLUMNS["v" + _a] = ("float", _component("v", _k))
    COLUMNS["f" + _a] = ("float", _component("f", _k))
    for _name, _array in (("mu", "mu"), ("tq", "torque"), ("omega", "omega"), ("angmom", "angmom")):
        COLUMNS[_name + _a] = ("float", _component(_array, _k))
    COLUMNS["i" + _a] = ("integer", _component("image", _k))


def kind_of(name: str) -> str:
    """``integer``, ``float`` or ``string``.

    Raises
    ------
    InputError
        No such column.
    """
    if re.fullmatch(r"[cfv]_\w+(\[\d+\])?", name):
        return "float"
    if custom := re.fullmatch(r"([id])(_\w+|2_\w+\[\d+\])", name):
        return "integer" if custom[1] == "i" else "float"
    if name not in COLUMNS:
        raise InputError(f"dump: column {name!r} is unknown or not supported{nearest(name, COLUMNS)}")
    return COLUMNS[name][0]


def column_of(view: View, name: str) -> Sequence:
    """The values of one column."""
    if name in COLUMNS:
        return COLUMNS[name][1](view)
    if name[0] in "id":
        return view.custom(name)
    kind, source = name[0], name[2:]
    if view.variables is None:
        raise InputError(f"dump: column {name} needs a session")
    if kind == "v":
        return np.asarray(view.variables.per_atom(source, view.system.n))[view.rows]
    index = re.fullmatch(r"(\w+?)(?:\[(\d+)\])?", source)
    return np.asarray(view.variables.provider.per_atom(kind, index[1], int(index[2]) if index[2] else None), dtype=float)[view.rows]
