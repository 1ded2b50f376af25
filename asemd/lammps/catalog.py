"""Which commands and styles exist: a name has one file, so existence is a question about files."""
from __future__ import annotations

import csv
import importlib
import pkgutil
from functools import cache
from pathlib import Path

import asemd
from asemd import atom_style, registry
from asemd.errors import InputError, nearest
from asemd.lammps.names import COMMANDS
from asemd.registry import file_of, module_of, plain_name

FORCE_FIELD = ("bond", "angle", "dihedral", "improper", "pair")
PACKAGES = {"command": "asemd.lammps.command",
            **{c: f"asemd.{c}" for c in (*FORCE_FIELD, "kspace", "fix", "compute", "dump", "region", "minimize")}}
INTEGRATE = ("respa", "verlet")
WRAPPERS = ("none", "hybrid")       # styles that are made of others, or of nothing


@cache
def inventory() -> tuple[dict[str, str], ...]:
    """Names that LAMMPS has: category, style, tier (how common), origin (lammps or liggghts), in_wheel (yes or no)."""
    with open(Path(asemd.__file__).parent / "inventory.csv", newline="", encoding="utf-8") as f:
        return tuple(csv.DictReader(f))


@cache
def files(category: str) -> frozenset[str]:
    """Names of the files of a category (``/`` is ``_`` in them)."""
    try:
        package = importlib.import_module(PACKAGES[category])
    except ModuleNotFoundError:
        return frozenset()
    return frozenset(m.name for m in pkgutil.iter_modules(package.__path__))


def exists(category: str, name: str) -> bool:
    """Whether there is a style (or command) of that name; imports the one file it would be in."""
    if category == "atom":
        return name in atom_style.NAMES
    if category == "integrate":
        return name in INTEGRATE
    if category in FORCE_FIELD and (name in WRAPPERS or (category, name) == ("pair", "hybrid/overlay")):
        return True
    if category in FORCE_FIELD:
        return registry.exists(category, plain_name(name))      # also one that the user has defined
    if (category == "kspace" and name == "none") or (category, name) in registry.own:
        return True
    if category not in PACKAGES or not name or file_of(plain_name(name)) not in files(category):
        return False
    if category == "command":
        return file_of(name) == name
    if category == "minimize":
        return not name.startswith("_")
    return any(c.style == plain_name(name) for c in _classes(importlib.import_module(module_of(category, plain_name(name)))))


@cache
def names(category: str) -> tuple[str, ...]:
    """All styles of a category by their LAMMPS names; imports their files."""
    if category == "atom":
        return tuple(sorted(atom_style.NAMES))
    if category == "integrate":
        return INTEGRATE
    if category == "command":
        return tuple(sorted(files(category)))
    if category in FORCE_FIELD:
        own = {"hybrid/overlay"} if category == "pair" else set()
        return tuple(sorted({*registry.names(category), *WRAPPERS, *own}))
    if category == "minimize":
        return tuple(sorted(n for n in files(category) if not n.startswith("_")))
    found = set()
    for name in files(category):
        found.update(c.style for c in _classes(importlib.import_module(f"{PACKAGES[category]}.{name}")))
    return tuple(sorted(found))


def _classes(module) -> list[type]:
    """Classes with a style name, defined in that module."""
    return [c for c in vars(module).values() if isinstance(c, type) and c.__module__ == module.__name__ and getattr(c, "style", "")]


def load(category: str, name: str) -> type:
    """The class of ``fix``, ``compute``, ``dump``, ``region`` or ``minimize`` style `name`.

    Raises
    ------
    InputError
        Unknown style; offers the nearest match.
    """
    if (category, name) in registry.own:
        return registry.own[category, name]
    module = module_of(category, plain_name(name))
    if module.rpartition(".")[2] in files(category):
        for found in _classes(importlib.import_module(module)):
            if found.style == plain_name(name):
                return found
    raise unknown(category, name)


def is_of_lammps(category: str, name: str) -> bool:
    """Whether LAMMPS has a style of that name."""
    listed = {"minimize": "min_style", "integrate": "run_style"}.get(category, category)
    return (listed, plain_name(name)) in registry.of_lammps()


def unknown(category: str, name: str) -> InputError:
    """The error for a name that does not exist here."""
    if category == "command":
        if name in COMMANDS:
            return InputError(f"command {name} of LAMMPS is not supported yet: remove it, or run this script with LAMMPS")
        return InputError(f"unknown command {name!r}{nearest(name, COMMANDS)}")
    said = "min_style" if category == "minimize" else f"{category} style"
    if (category, plain_name(name)) not in registry.REFUSED and is_of_lammps(category, name):
        return InputError(f"{said} {name} of LAMMPS is not supported yet: run this script with LAMMPS")
    if category in FORCE_FIELD:
        return registry.unknown(category, name)
    there = f"; there are {' '.join(names(category))}" if category == "minimize" else ""
    return InputError(f"unknown {said} {name!r}{nearest(name, names(category))}{there}")
