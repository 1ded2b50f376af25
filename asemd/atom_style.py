"""Atom styles: what their atoms have, and the columns of their lines in a data file.

``hybrid`` joins several styles, as ``hybrid full sphere dipole``: position first, then the columns of each that are not there yet.
"""
from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from asemd.errors import InputError

POSITION = ("x", "y", "z")
DIPOLE, SPIN = ("mux", "muy", "muz"), ("wx", "wy", "wz")
SPHERE = ("diameter", "density")
COLUMNS = {
    "atomic": ("id", "type", *POSITION),
    "charge": ("id", "type", "q", *POSITION),
    "bond": ("id", "molecule", "type", *POSITION),
    "angle": ("id", "molecule", "type", *POSITION),
    "molecular": ("id", "molecule", "type", *POSITION),
    "full": ("id", "molecule", "type", "q", *POSITION),
    "dipole": ("id", "type", "q", *POSITION, *DIPOLE),
    "sphere": ("id", "type", *SPHERE, *POSITION),
}
# what an atom style can be bonded by
BONDED = {"bond": ("bond",), "angle": ("bond", "angle"), "molecular": ("bond", "angle", "dihedral", "improper"),
          "full": ("bond", "angle", "dihedral", "improper"), "template": ("bond", "angle", "dihedral", "improper")}
NAMES = (*COLUMNS, "hybrid")
# per-atom arrays beside those every system has -> their unit
UNITS = {"mu": "dipole", "torque": "energy", "radius": "distance", "omega": "1/time"}


def parts(style: str) -> tuple[str, ...]:
    """The styles that a hybrid joins, or the style itself."""
    words = style.split()
    return tuple(words[1:]) if words[:1] == ["hybrid"] else (style,)


def known(style: str) -> bool:
    """Whether data files of the style can be read and written."""
    return bool(parts(style)) and all(name in COLUMNS for name in parts(style))


def columns(style: str) -> tuple[str, ...]:
    """The columns of section Atoms, without image flags."""
    own = [COLUMNS[name] for name in parts(style)]
    return own[0] if style in COLUMNS else tuple(dict.fromkeys(("id", "type", *POSITION, *(c for names in own for c in names))))


def velocity_columns(style: str) -> tuple[str, ...]:
    """The columns of section Velocities."""
    return ("id", "vx", "vy", "vz", *(SPIN if "sphere" in parts(style) else ()))


def bonded(style: str) -> tuple[str, ...]:
    """What atoms of the style can be bonded by: bond, angle, dihedral, improper."""
    return max((BONDED.get(name, ()) for name in parts(style)), key=len, default=())


def has(style: str, column: str) -> bool:
    """Whether atoms of the style have ``q``, ``mux``, ``diameter``, ..."""
    return any(column in COLUMNS.get(name, ()) for name in parts(style))


def mass_by_type(style: str) -> bool:
    """Whether a mass can be given to a type although every atom has its own: hybrids keep both, the one of the atom counts."""
    return has(style, "density") and any("density" not in COLUMNS[name] for name in parts(style))


def volume(radius: np.ndarray) -> np.ndarray:
    """Volumes of spheres; 1 for points, whose density is their mass."""
    return np.where(radius > 0.0, 4.0 / 3.0 * math.pi * radius**3, 1.0)


def fresh(style: str, n: int) -> dict:
    """Charges, masses and further arrays of `n` new atoms, as arguments of `asemd.system.System`: spheres have diameter and density 1."""
    out: dict = {"atom_style": style, "q": np.zeros(n) if has(style, "q") else None, "extra": {}}
    if has(style, "mux"):
        out["extra"] |= {"mu": np.zeros((n, 3)), "torque": np.zeros((n, 3))}
    if has(style, "diameter"):
        radius = np.full(n, 0.5)
        out["rmass"] = volume(radius)
        out["extra"] |= {"radius": radius, "omega": np.zeros((n, 3)), "torque": np.zeros((n, 3))}
    return out


def properties(columns: Mapping[str, np.ndarray], omega: np.ndarray) -> dict[str, np.ndarray]:
    """Dipoles, radii and masses from the columns of a data file, as arrays (n, ...) by name.

    Raises
    ------
    InputError
        A diameter or density that cannot be; its attribute ``row`` says where.
    """
    out: dict[str, np.ndarray] = {}
    if "mux" in columns:
        out["mu"] = np.column_stack([columns[c] for c in DIPOLE])
    if "diameter" in columns:
        for name, good in (("diameter", columns["diameter"] >= 0.0), ("density", columns["density"] > 0.0)):
            if not good.all():
                row = int(np.argmin(good))
                error = InputError(f"invalid {name} {columns[name][row]:g} of atom {int(columns['id'][row])}")
                error.row = row
                raise error
        out |= {"radius": 0.5 * columns["diameter"], "omega": omega}
        out["rmass"] = columns["density"] * volume(out["radius"])
    return out | ({"torque": np.zeros((len(omega), 3))} if out else {})
