"""Which LAMMPS names asemd has: the inventory of names compared with the code."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from asemd import registry
from asemd.errors import InputError, nearest
from asemd.lammps import catalog
from asemd.text_table import Table

STATES = ("done", "partial", "missing", "extra")
# category of the inventory -> category of the catalog, where they differ
CATALOG = {"min_style": "minimize", "run_style": "integrate"}
# what exists in part: what is not there
PARTIAL = {
    ("pair", "mliap"): "models linear, quadratic and nn, descriptors sna and so3",
    ("command", "atom_modify"): "id no: atoms keep their ids, which files show",
    ("command", "atom_style"): "the styles listed under atom",
    ("fix", "msst"): "no dftb",
    ("command", "molecule"): "no bodies",
    ("command", "read_dump"): "formats native (text) and xyz",
    ("command", "rerun"): "formats native (text) and xyz",
    ("command", "kspace_style"): "the styles listed under kspace",
    **dict.fromkeys([("kspace", "msm"), ("kspace", "msm/cg")], "pressure/scalar yes: the pressure is that of the virial all the same"),
    ("command", "read_data"): "fix property/atom and cmap read sections; sections of the atom styles listed under atom",
    ("command", "read_restart"): "files of LAMMPS itself through the lammps package: styles and coefficients are to be given again",
    ("command", "run_style"): "verlet; respa",
    ("command", "set"): "keywords of the atom styles listed under atom",
    ("command", "special_bonds"): "one/five yes needs atom_style amoeba",
    ("atom", "dipole"): "only fixes nve/sphere, nvt/sphere, npt/sphere and nph/sphere turn dipoles, of atom_style hybrid sphere dipole",
    ("dump", "image"): "atoms, bonds, box and axes; no perspective, no lines, triangles, bodies, grids",
    ("dump", "movie"): "as dump image; gif, webp, apng, others with the program ffmpeg",
}
# words in the place of a style that are no style
OTHERWISE: dict[str, set[str]] = {"kspace": {"none"}, "region": {"delete"}}
# names that are read but do nothing useful yet
REFUSED = registry.REFUSED


@dataclass(frozen=True)
class Name:
    """One LAMMPS name; `state` is done, partial, missing, or extra for names that the inventory does not have."""

    category: str
    style: str
    state: str
    note: str = ""
    tier: str = ""
    origin: str = ""


def categories() -> list[str]:
    """Categories of the inventory, in its order."""
    return list(dict.fromkeys(row["category"] for row in catalog.inventory()))


def present(category: str) -> frozenset[str]:
    """Names of a category of the inventory that exist in the code."""
    if category == "units":
        from asemd import units
        return frozenset(units.LAMMPS_STYLES)
    if category == "variable":
        from asemd.variable import STYLES
        return frozenset(STYLES)
    if category == "granmodel":
        return frozenset()
    found = set(catalog.names(CATALOG.get(category, category))) | OTHERWISE.get(category, set())
    return frozenset(found - {name for c, name in REFUSED if c == category})


def coverage(category: str | None = None, word: str = "", state: str = "") -> list[Name]:
    """Every name with its state.

    Parameters
    ----------
    category : str, optional
        Of the inventory: pair, fix, command, ...
    word : str
        Only names that contain it.
    state : str
        Only names in that state.

    Raises
    ------
    InputError
        Unknown category or state.
    """
    if category is not None and category not in categories():
        raise InputError(f"unknown category {category!r}{nearest(category, categories())}; there are {' '.join(categories())}")
    if state and state not in STATES:
        raise InputError(f"unknown state {state!r}{nearest(state, STATES)}; there are {' '.join(STATES)}")
    names = [n for c in ([category] if category else categories()) for n in _of_category(c)]
    return [n for n in names if word in n.style and state in ("", n.state)]


def _of_category(category: str) -> Iterable[Name]:
    have, listed = present(category), set()
    for row in catalog.inventory():
        if row["category"] != category:
            continue
        name = row["style"]
        listed.add(name)
        note = PARTIAL.get((category, name), "") if name in have else REFUSED.get((category, name), "")
        yield Name(category, name, ("partial" if note else "done") if name in have else "missing", note, row["tier"], row["origin"])
    for name in sorted(have - listed):
        note = PARTIAL.get((category, name), "")
        yield Name(category, name, "extra", note)


def counts(names: Iterable[Name]) -> dict[str, dict[str, int]]:
    """Category -> state -> how many."""
    out: dict[str, dict[str, int]] = {}
    for n in names:
        out.setdefault(n.category, dict.fromkeys(STATES, 0))[n.state] += 1
    return out


def parts(names: list[Name], detailed: bool) -> list[Table | str]:
    """The counts, and the names: a row for each if `detailed`, else those that exist by category."""
    table = Table("LAMMPS names in asemd", ("category", *STATES, "all"))
    found = counts(names)
    for category, by_state in found.items():
        table.rows.append((category, *(str(by_state[s]) for s in STATES), str(sum(by_state.values()))))
    if len(found) > 1:
        table.rows.append(("all", *(str(sum(b[s] for b in found.values())) for s in STATES), str(len(names))))
    if detailed:
        return [table, Table("", ("category", "name", "state", "note"), [(n.category, n.style, n.state, n.note) for n in names])]
    listed = Table("What exists (* in part, + not in the inventory)", ("category", "names"))
    for category in found:
        mark = {"done": "", "partial": "*", "extra": "+"}
        listed.rows.append((category, " ".join(n.style + mark[n.state] for n in names if n.category == category and n.state != "missing")))
    return [table, listed, "asemd styles CATEGORY lists every name of a category, asemd styles --state missing what is not there"]


def to_dict(names: list[Name]) -> dict[str, Any]:
    """Counts and names, JSON-able."""
    return {"counts": counts(names), "names": [asdict(n) for n in names]}
