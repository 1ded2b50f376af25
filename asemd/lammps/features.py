"""What a formula may ask about the program and the session: ``is_defined``, ``is_available``, ``is_active``, settings, labels."""
from __future__ import annotations

import importlib.util
import shutil

from asemd.errors import InputError, nearest
from asemd.lammps import catalog

FEATURES = {"gzip": lambda: True, "exceptions": lambda: True, "png": lambda: _has("PIL"), "jpeg": lambda: _has("PIL"),
            "ffmpeg": lambda: shutil.which("ffmpeg") is not None}
STYLES = {"command": "command", "min": "minimize", "min_style": "minimize", "integrate": "integrate", "run_style": "integrate",
          "atom": "atom", "atom_style": "atom", "kspace": "kspace", "kspace_style": "kspace", "fix": "fix", "compute": "compute",
          "dump": "dump", "region": "region", **{name: c for c in catalog.FORCE_FIELD for name in (c, f"{c}_style")}}
PACKAGES = ("gpu", "intel", "kokkos", "omp")


def defined(session, category: str, name: str) -> bool:
    """Whether there is a compute, dump, fix, group, region or variable of that name."""
    scene = session.scene
    tables = {"compute": scene.computes, "fix": scene.fixes, "group": scene.groups, "region": scene.regions, "dump": scene.dumps,
              "variable": session.variables.table}
    return name in tables[_known(category, tables, "is_defined")]


def available(category: str, name: str) -> bool:
    """Whether a style or feature exists here."""
    if category == "feature":
        return FEATURES[_known(name, FEATURES, "is_available(feature)")]()
    return catalog.exists(STYLES[_known(category, (*STYLES, "feature"), "is_available")], name)


def active(scene, category: str, name: str) -> bool:
    """Whether a package, a style or a setting is in use."""
    uses = scene.interactions.uses
    if category == "package":
        return _known(name, PACKAGES, "is_active(package)") == "omp" and scene.threads > 1
    if category == "newton":
        pair, bond = scene.newton
        return {"pair": pair, "bond": bond, "any": pair or bond}[_known(name, ("pair", "bond", "any"), "is_active(newton)")]
    if category == "pair":
        _known(name, ("single", "respa", "manybody", "tail", "shift"), "is_active(pair)")
        pairs = bool(uses["pair"])
        splits = pairs and all(use.style.splits for use in uses["pair"])
        many = any(use.style.many for use in uses["pair"])
        return {"single": pairs and not many, "respa": splits, "manybody": many}.get(name, bool(getattr(scene.interactions, name, False)))
    one = {"atom_style": scene.atom_style, "min_style": scene.min_style, "run_style": "respa" if scene.respa else "verlet",
           "comm_style": "brick", "kspace_style": "none"}
    styles = [f"{c}_style" for c in catalog.FORCE_FIELD]
    if _known(category, (*one, *styles, "package", "newton", "pair"), "is_active") in one:
        return one[category].split()[0] == name
    return scene.interactions.style_name(category.removesuffix("_style")) == name


def setting(session, name: str) -> int:
    """A count or flag, as `asemd.lammps.Lammps.extract_setting` gives it.

    Raises
    ------
    InputError
        No setting of that name.
    """
    from asemd.lammps import Lammps
    value = Lammps.of(session).extract_setting(name)
    if value < 0:
        raise InputError(f"extract_setting({name}): there is no such setting")
    return value


def type_of(system, kind: str, label: str) -> int | None:
    """The number of the type with that label, or None."""
    kinds = ("atom", "bond", "angle", "dihedral", "improper")
    for number, text in system.labels[_known(kind, kinds, "label2type and is_typelabel")].items():
        if text == label:
            return number
    return None


def _known(word: str, words, what: str) -> str:
    if word not in words:
        raise InputError(f"{what}: unknown {word!r}{nearest(word, words)}; there are {' '.join(words)}")
    return word


def _has(module: str) -> bool:
    return importlib.util.find_spec(module) is not None
