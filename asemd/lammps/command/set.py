"""``set style ID keyword values ...``"""
from __future__ import annotations

import re

import numpy as np

from asemd.atom_style import ellipsoid_volume, volume
from asemd.errors import InputError, nearest
from asemd.lammps.set_ellipsoids import set_ellipsoids
from asemd.marsaglia import Marsaglia
from asemd.random import position_seeds, uniform_at
from asemd.words import bounds, number, take, whole

LARGEST = 2**62     # no id is above
CUSTOM = re.compile(r"([id])(2?)_(\w+)(?:\[(\d+)\])?")      # properties of fix property/atom
KEYWORDS = {"type": 1, "type/fraction": 3, "type/ratio": 3, "type/subset": 3, "mol": 1, "x": 1, "y": 1, "z": 1, "vx": 1, "vy": 1, "vz": 1,
            "charge": 1, "mass": 1, "image": 3, "dipole": 3, "dipole/random": 2, "diameter": 1, "density": 1, "density/disc": 1,
            "omega": 3, "angmom": 3, "epsilon": 1, "shape": 3, "quat": 4, "quat/random": 1,
            **dict.fromkeys(("bond", "angle", "dihedral", "improper"), 1)}


def run(session, args):
    scene = session.scene
    system = scene.need_system("set")
    if not system.n:
        raise InputError("set: the system has no atoms yet: use set after create_atoms or read_data")
    scene.sync_groups()
    style, name = take(args, 2, "set")[:2]
    mask = _selected(scene, system, style, name)
    words = args[2:]
    if not words:
        raise InputError("set needs a keyword, for example: set type 1 charge 0.5")
    session.print("Setting atom values ...")
    while words:
        key, what = words[0], f"set {words[0]}"
        custom = CUSTOM.fullmatch(key)
        if key not in KEYWORDS and not custom:
            raise InputError(f"set: keyword {key!r} is unknown or not supported{nearest(key, KEYWORDS)}")
        values = take(words[1:], KEYWORDS.get(key, 1), what)
        count = Setter(session, system, mask, what).apply(key, values)
        session.print(f"  {count} settings made for {key}")
        words = words[1 + len(values):]


def _selected(scene, system, style: str, name: str) -> np.ndarray:
    if style == "group":
        return scene.groups.mask(name, "set group")
    if style == "region":
        return scene.region(name, "set region").inside(system.x)
    if style == "atom":
        values, (first, last) = system.id, bounds(name, 1, LARGEST, "set atom")
    elif style == "type":
        values, (first, last) = system.type, bounds(name, 1, system.counts["ntypes"], "set type", system.labels["atom"])
    elif style == "mol":
        if not system.has_molecules:
            raise InputError(f"set mol: atom_style {system.atom_style} has no molecules")
        values, (first, last) = system.molecule, bounds(name, 1, LARGEST, "set mol")
    else:
        raise InputError(f"set: unknown style {style!r}{nearest(style, ('atom', 'type', 'mol', 'group', 'region'))}")
    return (values >= first) & (values <= last)


class Setter:
    """Sets one property of the atoms of `mask`; every method returns how many settings it made."""

    def __init__(self, session, system, mask: np.ndarray, what: str):
        self.session, self.system, self.mask, self.what = session, system, mask, what
        self.rows = np.flatnonzero(mask)

    def apply(self, key: str, values: list[str]) -> int:
        system, rows = self.system, self.rows
        if key in ("bond", "angle", "dihedral", "improper"):
            return self._items(key, values[0])
        if key == "type/fraction":
            return self._fraction(values)
        if key in ("type/ratio", "type/subset"):
            return self._subset(key, values)
        if key in ("omega", "angmom"):
            return self._spin(key, values)
        if key in ("shape", "quat", "quat/random"):
            return set_ellipsoids(self, key, values)
        if key in ("dipole", "dipole/random"):
            return self._dipole(key, values)
        if key in ("diameter", "density", "density/disc"):
            return self._sphere(key, values[0])
        if key == "image":
            return self._image(values)
        if key not in KEYWORDS:
            return self._custom(key, values[0])
        if key == "type" and not values[0].startswith("v_"):
            system.type[rows] = self._type(values[0], "atom", system.counts["ntypes"])
            return len(rows)
        new = self._values(values[0])
        if key == "type":
            wrong = (new < 1) | (new >= system.counts["ntypes"] + 1)
            if wrong.any():
                raise InputError(f"{self.what}: {new[wrong][0]:g} is outside the valid range 1 to {system.counts['ntypes']}")
            system.type[rows] = new.astype(np.int32)
        elif key == "mol":
            if not system.has_molecules:
                raise InputError(f"{self.what}: atom_style {system.atom_style} has no molecules")
            given = not values[0].startswith("v_")      # a variable's values are cut to whole numbers, as LAMMPS does
            if ((new < 0) | (new > LARGEST) | (given & (new != np.floor(new)))).any():
                raise InputError(f"{self.what}: a molecule number must be whole and not negative, got {values[0]}")
            system.molecule[rows] = new.astype(np.int64)
        elif key == "charge":
            if system.q is None:
                raise InputError(f"{self.what}: atom_style {system.atom_style} has no charges")
            system.q[rows] = new
        elif key == "epsilon":
            if "epsilon" not in system.extra:
                raise InputError(f"{self.what}: atom_style {system.atom_style} has no dielectric constants, use atom_style dielectric")
            if (new <= 0.0).any():
                raise InputError(f"{self.what}: a dielectric constant must be positive, got {values[0]}")
            system.extra["epsilon"][rows] = new
        elif key == "mass":
            if system.rmass is None:
                raise InputError(f"{self.what}: atom_style {system.atom_style} has masses by type, use the mass command")
            if (new <= 0).any():
                raise InputError(f"{self.what}: a mass must be positive")
            system.rmass[rows] = new
        else:
            (system.v if key[0] == "v" else system.x)[rows, "xyz".index(key[-1])] = new
        return len(rows)

    def _custom(self, key: str, word: str) -> int:
        """A property of fix property/atom."""
        kind, wide, _, column = CUSTOM.fullmatch(key).groups()
        array = self.system.extra.get(key.partition("[")[0])
        if array is None or bool(wide) != (array.ndim == 2):
            raise InputError(f"{self.what}: atoms have no property {key.partition('[')[0]}, define it with fix property/atom")
        if bool(column) != bool(wide) or (column and not 1 <= int(column) <= array.shape[1]):
            raise InputError(f"{self.what}: the property has {array.shape[1] if wide else 'no'} columns")
        new = self._values(word)
        if kind == "i" and not word.startswith("v_") and (new != np.floor(new)).any():
            raise InputError(f"{self.what}: expected a whole number, got {word!r}")
        (array[:, int(column) - 1] if column else array)[self.rows] = new
        return len(self.rows)

    def _values(self, word: str) -> np.ndarray:
        """One number for all, or the values of a variable."""
        if word.startswith("v_"):
            if self.session.variables.find(word[2:]).style not in ("atom", "atomfile"):
                raise InputError(f"{self.what}: variable {word[2:]} must be of style atom or atomfile; a number is written $({word})")
            new = self.session.variables.per_atom(word[2:], self.system.n)[self.rows]
            bad = np.flatnonzero(~np.isfinite(new))
            if bad.size:
                raise InputError(f"{self.what}: variable {word[2:]} is not a finite number for atom {self.system.id[self.rows[bad[0]]]}")
            return new
        return np.full(len(self.rows), number(word, self.what))

    def _type(self, word: str, kind: str, count: int) -> int:
        first, last = bounds(word, 1, count, f"{self.what} type", self.system.labels[kind])
        if first != last:
            raise InputError(f"{self.what}: expected one type, got {word}")
        return first

    def _fraction(self, values: list[str]) -> int:
        kind = self._type(values[0], "atom", self.system.counts["ntypes"])
        fraction = number(values[1], self.what)
        if not 0.0 <= fraction <= 1.0:
            raise InputError(f"{self.what}: the fraction must be from 0 to 1, got {values[1]}")
        u = uniform_at(position_seeds(whole(values[2], f"{self.what}: seed"), self.system.x[self.rows]), 1)[:, 0]
        chosen = self.rows[u <= fraction]
        self.system.type[chosen] = kind
        return len(chosen)

    def _subset(self, key: str, values: list[str]) -> int:
        """An exact number of the atoms, or an exact part of them."""
        kind = self._type(values[0], "atom", self.system.counts["ntypes"])
        amount = number(values[1], self.what) if key == "type/ratio" else whole(values[1], self.what)
        if amount < 0 or (key == "type/ratio" and amount > 1.0):
            limits = "the part must be from 0 to 1" if key == "type/ratio" else "the number must not be negative"
            raise InputError(f"{self.what}: {limits}, got {values[1]}")
        seed = whole(values[2], f"{self.what}: seed")
        if not 0 < seed <= 900_000_000:
            raise InputError(f"{self.what}: the seed must be from 1 to 900000000, got {values[2]}")
        count = int(amount * len(self.rows)) if key == "type/ratio" else amount
        if count > len(self.rows):
            raise InputError(f"{self.what}: {count} of {len(self.rows)} selected atoms are wanted")
        self.system.type[self.rows[Marsaglia(seed).subset(len(self.rows), count)]] = kind
        return count

    def _spin(self, key: str, values: list[str]) -> int:
        if key not in self.system.extra:
            kind = {"omega": "velocities", "angmom": "momenta"}[key]
            raise InputError(f"{self.what}: atom_style {self.system.atom_style} has no angular {kind}")
        self.system.extra[key][self.rows] = np.column_stack([self._values(word) for word in values])
        return len(self.rows)

    def _dipole(self, key: str, values: list[str]) -> int:
        if "mu" not in self.system.extra:
            raise InputError(f"{self.what}: atom_style {self.system.atom_style} has no dipoles")
        if key == "dipole":
            mu = np.column_stack([self._values(word) for word in values])
        else:
            seed, length = whole(values[0], f"{self.what}: seed"), number(values[1], self.what)
            if seed <= 0 or length <= 0.0:
                raise InputError(f"{self.what}: seed and length must be positive, got {values[0]} {values[1]}")
            mu = np.zeros((len(self.rows), 3))
            d = self.system.dimension
            mu[:, :d] = uniform_at(position_seeds(seed, self.system.x[self.rows]), d) - 0.5
            mu *= length / np.linalg.norm(mu, axis=1)[:, None]
        self.system.extra["mu"][self.rows] = mu
        return len(self.rows)

    def _sphere(self, key: str, word: str) -> int:
        """Diameters leave the masses as they are; a density gives the mass with the present diameter."""
        extra, new = self.system.extra, self._values(word)
        if "radius" not in extra and ("shape" not in extra or key == "diameter"):
            raise InputError(f"{self.what}: atom_style {self.system.atom_style} has no {key}")
        if (new < 0.0).any() or (key != "diameter" and (new == 0.0).any()):
            raise InputError(f"{self.what}: a {key} must be {'0 or more' if key == 'diameter' else 'positive'}, got {word}")
        if key == "diameter":
            extra["radius"][self.rows] = 0.5 * new
        elif key == "density/disc":
            if self.system.dimension == 3:
                raise InputError(f"{self.what} is for 2d simulations only: use density")
            radius = extra["radius"][self.rows] if "radius" in extra else np.zeros(len(self.rows))
            self.system.rmass[self.rows] = new * np.where(radius > 0.0, np.pi * radius**2, self._ellipsoids())
        else:
            radius = extra["radius"][self.rows] if "radius" in extra else np.zeros(len(self.rows))
            self.system.rmass[self.rows] = new * np.where(radius > 0.0, volume(radius), self._ellipsoids())
        return len(self.rows)

    def _ellipsoids(self) -> np.ndarray | float:
        """Volumes, 1 for points."""
        extra = self.system.extra
        return ellipsoid_volume(extra["shape"][self.rows]) if "shape" in extra else 1.0

    def _image(self, values: list[str]) -> int:
        for k, word in enumerate(values):
            if word == "NULL":
                continue
            new = self._values(word)
            if not self.system.box.periodic[k] and (new != 0).any():
                raise InputError(f"{self.what}: direction {'xyz'[k]} is not periodic, its image flag must stay 0 (or NULL)")
            self.system.image[self.rows, k] = np.trunc(new).astype(np.int32)
        return len(self.rows)

    def _items(self, kind: str, word: str) -> int:
        """The type of every bond (angle, ...) whose atoms are all selected."""
        count = self.system.counts[f"n{kind}types"]
        if not self.system.molecular or count == 0:
            raise InputError(f"{self.what}: this system has no {kind} types")
        atoms, types = self.system.topology.items(kind)
        inside = self.mask[atoms].all(axis=1) if len(atoms) else np.zeros(0, bool)
        types[inside] = self._type(word, kind, count)
        return int(inside.sum())
