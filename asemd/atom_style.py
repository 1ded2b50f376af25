"""Atom styles: what their atoms have, and the columns of their lines in a data file.

``hybrid`` joins several styles, as ``hybrid full sphere dipole``: position first, then the columns of each that are not there yet.
"""
from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from asemd.errors import InputError
from asemd.quaternion import turned, unit

POSITION = ("x", "y", "z")
DIPOLE, SPIN = ("mux", "muy", "muz"), ("wx", "wy", "wz")
MOMENTUM = ("lx", "ly", "lz")
SPHERE = ("diameter", "density")
SURFACE = ("area", "ed", "em", "epsilon", "curvature")     # of style dielectric: patches of interfaces, and what is around an atom
ELLIPSOID = ("ellipsoid", "density")
SPINS = {"omega": SPIN, "angmom": MOMENTUM}
SHAPE, TURN = ("shapex", "shapey", "shapez"), ("quatw", "quati", "quatj", "quatk")      # of section Ellipsoids
COLUMNS = {
    "atomic": ("id", "type", *POSITION),
    "charge": ("id", "type", "q", *POSITION),
    "bond": ("id", "molecule", "type", *POSITION),
    "angle": ("id", "molecule", "type", *POSITION),
    "molecular": ("id", "molecule", "type", *POSITION),
    "full": ("id", "molecule", "type", "q", *POSITION),
    "dipole": ("id", "type", "q", *POSITION, *DIPOLE),
    "dielectric": ("id", "molecule", "type", "q", *POSITION, *DIPOLE, *SURFACE),
    "sphere": ("id", "type", *SPHERE, *POSITION),
    "ellipsoid": ("id", "type", *ELLIPSOID, *POSITION),
}
# what an atom style can be bonded by
BONDED = {"bond": ("bond",), "angle": ("bond", "angle"), "molecular": ("bond", "angle", "dihedral", "improper"),
          "full": ("bond", "angle", "dihedral", "improper"), "dielectric": ("bond", "angle", "dihedral", "improper"),
          "template": ("bond", "angle", "dihedral", "improper")}
UPRIGHT = (1.0, 0.0, 0.0, 0.0)      # the orientation of a body whose axes are x, y and z
NAMES = (*COLUMNS, "hybrid")
# per-atom arrays beside those every system has -> their unit
UNITS = {"mu": "dipole", "torque": "energy", "radius": "distance", "omega": "1/time", "shape": "distance", "quaternions": "",
         "angmom": "mass*distance*velocity", "area": "distance^2", "ed": "", "em": "", "epsilon": "", "curvature": "1/distance"}


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
    more = {"sphere": SPIN, "ellipsoid": MOMENTUM}
    return ("id", "vx", "vy", "vz", *(c for name in parts(style) for c in more.get(name, ())))


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


def ellipsoid_volume(shape: np.ndarray) -> np.ndarray:
    """Volumes of ellipsoids with diameters (n, 3); 1 for points, whose density is their mass."""
    return np.where(shape[:, 0] > 0.0, math.pi / 6.0 * shape.prod(axis=1), 1.0)


def fresh(style: str, n: int) -> dict:
    """Charges, masses and further arrays of `n` new atoms, as arguments of `asemd.system.System`: spheres have diameter and density 1,
    those of style ellipsoid are points of mass 1, those of style dielectric are in vacuum."""
    out: dict = {"atom_style": style, "q": np.zeros(n) if has(style, "q") else None, "extra": {}}
    if has(style, "area"):
        out["extra"] |= {"mu": np.zeros((n, 3)), "area": np.ones(n), "ed": np.zeros(n), "em": np.ones(n), "epsilon": np.ones(n),
                         "curvature": np.zeros(n)}
    if "dipole" in parts(style):
        out["extra"] |= {"mu": np.zeros((n, 3)), "torque": np.zeros((n, 3))}
    if has(style, "diameter"):
        radius = np.full(n, 0.5)
        out["rmass"] = volume(radius)
        out["extra"] |= {"radius": radius, "omega": np.zeros((n, 3)), "torque": np.zeros((n, 3))}
    if has(style, "ellipsoid"):
        last = next(name for name in reversed(parts(style)) if "density" in COLUMNS[name])      # of a hybrid the last one counts
        if last == "ellipsoid":
            out["rmass"] = np.ones(n)
        out["extra"] |= {"shape": np.zeros((n, 3)), "quaternions": np.tile(UPRIGHT, (n, 1)), "angmom": np.zeros((n, 3)),
                         "torque": np.zeros((n, 3))}
    return out


def with_orientations(extra: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Arrays of ellipsoids with what is missing: upright ones, also where the quaternion is zero, at rest."""
    new = fresh("ellipsoid", len(extra["shape"]))["extra"] | dict(extra)
    q = new["quaternions"]
    new["quaternions"] = unit(np.where(q.any(axis=1, keepdims=True), q, UPRIGHT))
    return new


def rotated(extra: Mapping[str, np.ndarray], rotation: np.ndarray) -> dict[str, np.ndarray]:
    """Those of further arrays that turn with the atoms, when positions become ``x @ rotation``."""
    out = {name: extra[name] @ rotation for name in ("mu", "omega", "angmom") if name in extra}
    return out | ({"quaternions": turned(extra["quaternions"], rotation)} if "quaternions" in extra else {})


def properties(columns: Mapping[str, np.ndarray], spin: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Dipoles, radii, shapes, masses and what is around the atoms from the columns of a data file, as arrays (n, ...) by name.

    Parameters
    ----------
    columns : mapping
        Those of section Atoms, and of section Ellipsoids by the rows of the atoms.
    spin : mapping
        ``omega`` and ``angmom`` (n, 3), by whether the atom style has them.

    Raises
    ------
    InputError
        A diameter, density, area or dielectric constant that cannot be; its attribute ``row`` says where.
    """
    out: dict[str, np.ndarray] = {}
    if "mux" in columns:
        out["mu"] = np.column_stack([columns[c] for c in DIPOLE])
    positive = np.nextafter(0.0, 1.0)
    for name, least in (("diameter", 0.0), ("density", positive), ("area", 0.0), ("epsilon", positive)):
        if name in columns and not (columns[name] >= least).all():
            row = int(np.argmin(columns[name] >= least))
            error = InputError(f"invalid {name} {columns[name][row]:g} of atom {int(columns['id'][row])}")
            error.row = row
            raise error
    out |= spin
    if "density" in columns:
        out["rmass"] = columns["density"].copy()
    if "diameter" in columns:
        out["radius"] = 0.5 * columns["diameter"]
        out["rmass"] *= volume(out["radius"])
    if "ellipsoid" in columns:
        out["shape"] = np.column_stack([columns[c] for c in SHAPE])
        out["quaternions"] = np.column_stack([columns[c] for c in TURN])
        out["rmass"] *= ellipsoid_volume(out["shape"])
    turns = bool(out) and "area" not in columns
    return (out | {name: columns[name] for name in SURFACE if name in columns}
            | ({"torque": np.zeros((len(columns["id"]), 3))} if turns else {}))
