"""What the formulas of variables see of a session: thermo keywords, computes, fixes, atoms, groups."""
from __future__ import annotations

import numpy as np

from asemd import thermo, units
from asemd.errors import InputError, nearest
from asemd.formula_functions import Clock
from asemd.lammps import features

AXES = {"x": 0, "y": 1, "z": 2}
LONGEST = 10**6     # elements of the vector of a fix that does not say how many it has
TENSOR = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "yz": (1, 2), "xz": (0, 2)}


class Providers:
    """`asemd.variable.Provider` of a session."""

    def __init__(self, session):
        self.session = session

    @property
    def scene(self):
        return self.session.scene

    @property
    def system(self):
        if self.scene.system is None:
            raise InputError("a formula with simulation quantities before simulation box is defined")
        return self.scene.system

    def thermo(self, keyword: str) -> float:
        if keyword not in thermo.KEYWORDS:
            raise InputError(f"unknown word {keyword!r} in a formula{nearest(keyword, thermo.KEYWORDS)}")
        system = self.system
        norm = self.scene.thermo.is_normalised(self.scene.units)
        return float(thermo.evaluate(self.session.moment, keyword, norm and system.n > 0))

    def reference(self, kind: str, id: str, index: list[int]) -> float:
        return thermo.value_of(self.session.moment, kind, id, index)

    def has(self, kind: str, id: str, what: str) -> bool:
        """Whether a compute or fix gives ``scalar``, ``vector``, ``array`` or ``per_atom`` values."""
        from asemd.compute import Compute
        from asemd.fix import Fix
        source, base = self.source(kind, id), Compute if kind == "c" else Fix
        if (outputs := getattr(source, "outputs", None)) is not None:       # depends on what it was asked for
            return what in outputs
        found = type(source)
        return getattr(found, what, None) is not getattr(base, what, None)

    def source(self, kind: str, id: str):
        table, what = (self.scene.computes, "compute") if kind == "c" else (self.scene.fixes, "fix")
        if id not in table:
            raise InputError(f"there is no {what} {id}{nearest(id, table)}")
        return table[id]

    def per_atom(self, kind: str, id: str, column: int | None) -> np.ndarray:
        self.source(kind, id)
        moment = self.session.moment
        values = np.asarray(moment.per_atom(id) if kind == "c" else self.source("f", id).per_atom(moment.snapshot))
        if values.ndim == 1 and column is None:
            return values
        if values.ndim == 2 and column is not None and 1 <= column <= values.shape[1]:
            return values[:, column - 1]
        shown, width = f"{kind}_{id}{f'[{column}]' if column else ''}", values.shape[1] if values.ndim == 2 else "no"
        raise InputError(f"{shown}: the values per atom have {width} columns")

    def per_atom_columns(self, kind: str, id: str) -> int:
        """How many columns the values per atom of a compute (c), fix (f) or property (i2, d2) have."""
        if kind in ("i2", "d2"):
            name = f"{kind}_{id}"
            if name not in self.system.extra:
                raise InputError(f"atoms have no property {name}, define it with fix property/atom")
            return self.system.extra[name].shape[1]
        source = self.source(kind, id)
        if hasattr(source, "per_atom_columns"):
            return source.per_atom_columns()
        moment = self.session.moment
        values = np.asarray(moment.per_atom(id) if kind == "c" else source.per_atom(moment.snapshot))
        if values.ndim != 2:
            raise InputError(f"{kind}_{id}[*]: the values per atom have no columns")
        return values.shape[1]

    def thermo_words(self, step: int) -> tuple:
        """The keywords of the thermo row of a step and its `Moment`; no keywords if the step has no row."""
        session = self.session
        return (session.last_words if session.last_thermo_step == step else ()), session.moment

    def thermo_row(self, step: int) -> dict[str, float]:
        """LAMMPS's name of each column of the thermo row of a step and its value; empty if the step has no row."""
        session, words = self.session, self.thermo_words(step)[0]
        names = [thermo.KEYWORDS[w].column if w in thermo.KEYWORDS else w for w in words]
        return dict(zip(names, session.last_thermo.values()))

    def local(self, kind: str, id: str, column: int | None) -> np.ndarray:
        """Local values of a compute or fix; `column` counts from 1, None for a vector."""
        width = self.local_columns(kind, id)
        if column is None and width:
            raise InputError(f"{kind}_{id}: the local values have {width} columns, say which one: {kind}_{id}[1]")
        if column is not None and not 1 <= column <= width:
            raise InputError(f"{kind}_{id}[{column}]: the local values have {width or 'no'} columns")
        moment = self.session.moment
        values = np.asarray(moment.local(id) if kind == "c" else self.source(kind, id).local(moment.snapshot))
        return values if column is None else values[:, column - 1]

    def local_columns(self, kind: str, id: str) -> int:
        """See `asemd.compute.Compute.local_columns`."""
        source = self.source(kind, id)
        width = source.local_columns()
        if width is None:
            raise InputError(f"{kind}_{id}: {'compute' if kind == 'c' else 'fix'} {id} (style {source.style}) has no local values")
        return width

    def vector_length(self, kind: str, id: str) -> int:
        """How many elements the global vector of a compute (c), fix (f) or vector-style variable (v) has."""
        if kind == "v":
            return len(self.session.variables.vector(id))
        source = self.source(kind, id)
        size = getattr(source, "size", None)
        if size is None and kind == "c":
            size = len(self.session.moment.vector(id))
        if not size:
            raise InputError(f"{kind}_{id}[*]: its length is not known, write the elements out: {kind}_{id}[1] {kind}_{id}[2]")
        return size

    def vector(self, kind: str, id: str, column: int | None) -> np.ndarray:
        """A global vector, or a column (from 1) of a global array."""
        source = self.source(kind, id)
        if kind == "f":
            return fix_vector(source, column)
        if column is None:
            return np.asarray(self.session.moment.vector(id))
        values = np.asarray(self.session.moment.array(id))
        if not 1 <= column <= values.shape[1]:
            raise InputError(f"c_{id}[{column}]: the array has {values.shape[1]} columns")
        return values[:, column - 1]

    def atoms(self, name: str) -> np.ndarray:
        s = self.system
        if name == "mass":
            return s.atom_masses()
        if name in ("id", "type", "mol"):
            return (s.molecule if name == "mol" else getattr(s, name)).astype(float)
        if name == "q":
            if s.q is None:
                raise InputError(f"atom style {s.atom_style} has no charges")
            return s.q
        if name == "radius":
            if "radius" not in s.extra:
                raise InputError(f"atom style {s.atom_style} has no radius")
            return s.extra["radius"]
        return (s.x if len(name) == 1 else {"v": s.v, "f": s.f}[name[0]])[:, AXES[name[-1]]]      # x y z, vx .. fz

    def property(self, name: str, column: int | None) -> np.ndarray:
        """Values (n,) of i_name, d_name, or of a column (from 1) of i2_name, d2_name."""
        values = self.system.extra.get(name)
        if values is None:
            raise InputError(f"atoms have no property {name}, define it with fix property/atom")
        if column is None:
            return values.astype(float)
        if not 1 <= column <= values.shape[1]:
            raise InputError(f"{name}[{column}]: the property has {values.shape[1]} columns")
        return values[:, column - 1].astype(float)

    def row(self, atom_id: int) -> int:
        rows = np.flatnonzero(self.system.id == atom_id)
        if not rows.size:
            raise InputError(f"there is no atom with id {atom_id}")
        return int(rows[0])

    def group(self, name: str) -> np.ndarray:
        self.system     # noqa: B018  raises before the box is there
        return self.scene.groups.mask(name)

    def region(self, name: str) -> np.ndarray:
        if name not in self.scene.regions:
            raise InputError(f"there is no region {name}{nearest(name, self.scene.regions)}")
        return self.scene.regions[name].inside(self.system.x)

    def clock(self) -> Clock:
        p = self.session.moment.progress
        end = p.last if p.stop is None else p.stop
        return Clock(self.scene.step, p.first, max(end, p.first), self.scene.dt, self.session.running or self.session.between)

    def defined(self, category: str, name: str) -> bool:
        return features.defined(self.session, category, name)

    def available(self, category: str, name: str) -> bool:
        return features.available(category, name)

    def active(self, category: str, name: str) -> bool:
        return features.active(self.scene, category, name)

    def setting(self, name: str) -> int:
        return features.setting(self.session, name)

    def type_of(self, kind: str, label: str) -> int | None:
        return features.type_of(self.system, kind, label)

    def python(self, function: str, values: list[float] | None) -> str:
        return self.session.python.call(function, values)

    def group_function(self, name: str, mask: np.ndarray, word: str | None) -> float:
        """The value of ``xcm(group,x)`` and its relatives over the atoms of `mask`."""
        words = {"bound": [a + e for a in AXES for e in ("min", "max")], "inertia": list(TENSOR)}.get(name, list(AXES))
        if word is not None and word not in words:
            raise InputError(f"{name}(): the direction must be one of {' '.join(words)}, got {word!r}")
        system = self.system
        if name in ("count", "charge"):
            if name == "count":
                return float(mask.sum())
            return float(system.q[mask].sum()) if system.q is not None else _no_charge(system)
        if name == "bound":
            column = system.x[mask][:, AXES[word[0]]]
            return float(column.min(initial=1e20) if word.endswith("min") else column.max(initial=-1e20))
        body = Body(system, mask)
        if name in ("mass", "gyration"):
            return getattr(body, name)()
        if name == "ke":
            return 0.5 * units.get(system.units).mvv2e * float((body.m[:, None] * body.v**2).sum())
        value = getattr(body, name)()
        return float(value[TENSOR[word]] if name == "inertia" else value[AXES[word]])


def _no_charge(system):
    raise InputError(f"charge(): atom style {system.atom_style} has no charges")


def fix_vector(fix, column: int | None) -> np.ndarray:
    """All elements of the global vector of a fix, or of a column of its array: those up to the first that it does not have."""
    if hasattr(fix, "whole_vector"):
        return fix.whole_vector(column)
    values: list[float] = []
    size = getattr(fix, "size", None) or LONGEST
    while len(values) < size:
        try:
            k = len(values) + 1
            values.append(float(fix.vector(k) if column is None else fix.array(k, column)))
        except (InputError, IndexError):
            if not values:
                raise
            break
    return np.array(values)


class Body:
    """Mass, momenta and moments of some atoms, with unwrapped positions."""

    def __init__(self, system, mask: np.ndarray):
        self.m, self.v, self.f = system.atom_masses()[mask], system.v[mask], system.f[mask]
        self.x = system.box.unwrap(system.x, system.image)[mask]

    def mass(self) -> float:
        return float(self.m.sum())

    def _mean(self, values: np.ndarray) -> np.ndarray:
        total = self.mass()
        return self.m @ values / total if total > 0.0 else np.zeros(3)

    def xcm(self) -> np.ndarray:
        return self._mean(self.x)

    def vcm(self) -> np.ndarray:
        return self._mean(self.v)

    def fcm(self) -> np.ndarray:
        return self.f.sum(axis=0)

    def gyration(self) -> float:
        return float(np.sqrt(self._mean((self.x - self.xcm()) ** 2).sum()))

    def angmom(self) -> np.ndarray:
        return (self.m[:, None] * np.cross(self.x - self.xcm(), self.v)).sum(axis=0)

    def torque(self) -> np.ndarray:
        return np.cross(self.x - self.xcm(), self.f).sum(axis=0)

    def inertia(self) -> np.ndarray:
        d = self.x - self.xcm()
        return np.eye(3) * (self.m @ (d * d).sum(axis=1)) - (self.m[:, None, None] * d[:, :, None] * d[:, None, :]).sum(axis=0)

    def omega(self) -> np.ndarray:
        """Angular velocity; zero about axes without inertia."""
        return np.linalg.pinv(self.inertia(), rcond=1e-12, hermitian=True) @ self.angmom()
