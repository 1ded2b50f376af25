"""The registry of styles: each is found by its LAMMPS name, in the file of that name."""
from __future__ import annotations

import csv
import importlib
import importlib.util
import pkgutil
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from asemd.errors import InputError, nearest

if TYPE_CHECKING:
    from asemd.style import Style

ACCELERATED = ("/opt", "/omp", "/intel", "/kk", "/gpu")
_FINITE = "acts on particles of finite size with an orientation and torques, which asemd does not have yet: run this script with LAMMPS"
# (category, name) -> why a style of LAMMPS is refused
REFUSED = dict.fromkeys([("bond", n) for n in ("bpm/rotational", "oxdna/fene", "oxdna2/fene", "oxrna2/fene")], _FINITE) | {
    ("bond", "rheo/shell"): "acts on fluid particles of package RHEO and ages of bonds, which asemd does not have yet: run this script "
                            "with LAMMPS"}
RENAMED = {("pair", "meam/c"): "meam"}      # former names that LAMMPS refuses, too
known: dict[tuple[str, str], Style] = {}      # by category and name
own: dict[tuple[str, str], type] = {}         # fixes and computes of the user


def register(style: Style) -> Style:
    """Make a force-field style known by its name."""
    known[style.category, style.name] = style
    return style


def remember(category: str, found: type) -> None:
    """Make a fix or compute of the user known by its name; those of asemd are found by their files.

    Raises
    ------
    InputError
        asemd has one of that name.
    """
    name = found.__dict__.get("style", "")
    if not name or found.__module__.startswith("asemd."):
        return
    if importlib.util.find_spec(module_of(category, name)) is not None:
        raise InputError(f"asemd has a {category} {name} already: give yours another name")
    own[category, name] = found


def file_of(name: str) -> str:
    """The name of the file of a style or command, without its ending."""
    return re.sub(r"[^0-9a-zA-Z]", "_", name)


def module_of(category: str, name: str) -> str:
    """The module of a style or command follows from its LAMMPS name."""
    return f"asemd.{category}.{file_of(name)}"


@cache
def of_lammps() -> frozenset[tuple[str, str]]:
    """Category and name of the styles that LAMMPS has, by its manual or newer."""
    found: set[tuple[str, str]] = set()
    for name in ("inventory.csv", "newer.csv"):
        with open(Path(__file__).parent / name, newline="", encoding="utf-8") as f:
            found.update((row["category"], row["style"]) for row in csv.DictReader(f))
    return frozenset(found)


def names(category: str) -> list[str]:
    """LAMMPS names of all styles of a category that exist (imports them)."""
    package = importlib.import_module(f"asemd.{category}")
    for m in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"asemd.{category}.{m.name}")
    return sorted(n for c, n in known if c == category)


def plain_name(name: str) -> str:
    """A style's name without LAMMPS's accelerator suffixes."""
    for suffix in ACCELERATED:
        name = name.removesuffix(suffix)
    return name


def exists(category: str, name: str) -> bool:
    """Whether there is a style of that name; imports its one file."""
    if not re.match(r"[A-Za-z]", name):
        return False
    module = module_of(category, name)
    if (category, name) not in known and importlib.util.find_spec(module) is not None:
        importlib.import_module(module)
    return (category, name) in known


def find(category: str, name: str) -> Style:
    """The style of that LAMMPS name; imports its one file.

    Raises
    ------
    InputError
        Unknown style; the message offers the nearest match.
    """
    name = plain_name(name)
    if (category, name) not in known:
        module = module_of(category, name)
        try:
            importlib.import_module(module)
        except ModuleNotFoundError as e:
            if e.name != module:
                raise
        if (category, name) not in known:
            raise unknown(category, name)
    return known[category, name]


def unknown(category: str, name: str, others: Iterable[str] | None = None) -> InputError:
    """The error for a style that is not there: why it is refused, or the nearest match among `others`, or styles of that category."""
    key = category, plain_name(name)
    if key in REFUSED:
        return InputError(f"{category}_style {name} {REFUSED[key]}")
    if key in RENAMED:
        return InputError(f"{category} style {name} has another name in LAMMPS now: use {RENAMED[key]}")
    if key in of_lammps():
        return InputError(f"{category} style {name} of LAMMPS is not supported yet: run this script with LAMMPS")
    near = nearest(name, names(category) if others is None else others)
    if others is None and not near:
        near = "; asemd styles lists them, one of your own comes with --import FILE"
    return InputError(f"unknown {category} style {name!r}{near}")


def class_of(category: str, name: str, base: type) -> type:
    """The class of a fix, compute, dump ... of that LAMMPS name; imports its one file.

    Raises
    ------
    InputError
        Unknown style; the message offers the nearest match.
    """
    name = plain_name(name)
    if (category, name) in own:
        return own[category, name]
    module = module_of(category, name)
    try:
        found = _styled(importlib.import_module(module), base)
    except ModuleNotFoundError as e:
        if e.name != module:
            raise
        found = None
    if found is None or found.style != name:
        raise unknown(category, name, class_names(category, base))
    return found


def class_names(category: str, base: type) -> list[str]:
    """LAMMPS names of all classes of a category that exist (imports them)."""
    package = importlib.import_module(f"asemd.{category}")
    found = (_styled(importlib.import_module(f"asemd.{category}.{m.name}"), base) for m in pkgutil.iter_modules(package.__path__))
    return sorted(c.style for c in found if c)


def class_called(category: str, name: str, base: type) -> type:
    """The class with that Python name: `TempCSVR` of the style ``temp/csvr``, for a package's ``__getattr__``."""
    if not name.startswith("_"):
        package = importlib.import_module(f"asemd.{category}")
        for m in pkgutil.iter_modules(package.__path__):
            if m.name.replace("_", "") == name.lower():
                found = _styled(importlib.import_module(f"asemd.{category}.{m.name}"), base)
                if found and found.__name__ == name:
                    return found
    raise AttributeError(f"asemd.{category} has no class {name}")


def _styled(module, base: type) -> type | None:
    """The style class that a module defines."""
    own = (c for c in vars(module).values() if isinstance(c, type) and issubclass(c, base) and c.__module__ == module.__name__)
    return next((c for c in own if c.style), None)
