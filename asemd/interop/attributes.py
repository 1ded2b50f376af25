"""What atoms know, as attributes of MDAnalysis, and back: per-atom arrays, residues and bonded items."""
from __future__ import annotations

import numpy as np
from ase.data import atomic_numbers

from asemd.atoms import Atoms, elements
from asemd.errors import InputError
from asemd.topology import Topology

# attribute of MDAnalysis -> array of the atoms; those of residues below
ARRAYS = {"ids": "id", "names": "atomtypes", "types": "type", "elements": "numbers", "masses": "masses", "charges": "initial_charges",
          "radii": "radius"}
RESIDUES = {"resids": "residuenumbers", "resnames": "residuenames", "molnums": "mol-id"}
BONDED = {"bond": "bonds", "angle": "angles", "dihedral": "dihedrals", "improper": "impropers", "crossterm": "cmaps"}
# MDAnalysis lists items from the end with the smaller index; which way round they were is kept as their order
FORWARD, REVERSED = "forward", "reversed"


def attributes(atoms) -> dict[str, np.ndarray]:
    """Attribute -> one value for each atom, also for those of residues."""
    a, symbols = atoms.arrays, np.array(atoms.get_chemical_symbols(), object)
    words = {name: np.array([str(w).strip() for w in a[array]], object)
             for name, array in (("names", "atomtypes"), ("resnames", "residuenames")) if array in a}
    n, molecule = len(atoms), a.get("mol-id")
    out = {"ids": a.get("id", np.arange(1, n + 1)),
           "names": words.get("names", symbols),
           "types": np.array([str(t) for t in a["type"]], object) if "type" in a else symbols,
           "elements": np.where(atoms.numbers > 0, symbols, ""),
           "masses": atoms.get_masses(),
           "resids": a.get("residuenumbers", np.ones(n, int) if molecule is None else molecule)}
    if "resnames" in words:
        out["resnames"] = words["resnames"]
    for name, array in (("charges", "initial_charges"), ("radii", "radius"), ("molnums", "mol-id")):
        if array in a:
            out[name] = a[array]
    return out


def topology_of(atoms):
    """The topology of MDAnalysis, without frames."""
    from MDAnalysis.core import topologyattrs as kinds
    from MDAnalysis.core.topology import Topology as Theirs
    made = {"ids": kinds.Atomids, "names": kinds.Atomnames, "types": kinds.Atomtypes, "elements": kinds.Elements, "masses": kinds.Masses,
            "charges": kinds.Charges, "radii": kinds.Radii, "resids": kinds.Resids, "resnames": kinds.Resnames, "molnums": kinds.Molnums}
    known = attributes(atoms)
    residue, first = _residues([known[name] for name in RESIDUES if name in known])
    attrs = [made[name](values[first] if name in RESIDUES else np.array(values)) for name, values in known.items()]
    attrs += [kinds.Resnums(known["resids"][first].copy()), kinds.Segids(np.array(["SYSTEM"], object))]
    for kind, items, types in atoms.topology.every():
        if len(items):
            turned = items[:, 0] > items[:, -1]
            order = None if kind == "bond" else np.where(turned, REVERSED, FORWARD).tolist()
            one = {"bond": kinds.Bonds, "angle": kinds.Angles, "dihedral": kinds.Dihedrals, "improper": kinds.Impropers,
                   "crossterm": kinds.CMaps}[kind]
            attrs.append(one([tuple(row) for row in items.tolist()], types=[str(t) for t in types], order=order))
    return Theirs(len(atoms), len(first), 1, attrs=attrs, atom_resindex=residue, residue_segindex=np.zeros(len(first), int))


def _residues(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The residue of each atom, numbered by first appearance, and the first atom of each residue: same values in all columns."""
    code = np.zeros(len(columns[0]), np.int64)
    for column in columns:
        _, inverse = np.unique(column.astype(str) if column.dtype == object else column, return_inverse=True)
        _, code = np.unique(code * (inverse.max(initial=0) + 1) + inverse, return_inverse=True)
    _, first, inverse = np.unique(code, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return rank[inverse], np.sort(first)


# ---- back -------------------------------------------------------------------------------------------------------------------------------
def _has(ag, name: str) -> bool:
    return hasattr(ag.universe._topology, name)


def update(atoms: Atoms, ag, before: dict[str, np.ndarray]) -> None:
    """Give atoms the values of an AtomGroup that are not those of `before`, the attributes of all atoms of its universe."""
    for name in [*ARRAYS, *RESIDUES]:
        if _has(ag, name):
            values = getattr(ag, name)
            if name not in before or not np.array_equal(values, before[name][ag.ix]):
                _set(atoms, name, values)


def new_atoms(ag) -> Atoms:
    """Atoms with the attributes of an AtomGroup, at the origin."""
    present = {name: getattr(ag, name) for name in [*ARRAYS, *RESIDUES] if _has(ag, name)}
    masses = present.get("masses", np.zeros(len(ag)))
    if "elements" in present and any(present["elements"]):
        numbers = _numbers(present["elements"])
    else:
        types = present.get("types", np.full(len(ag), "X"))
        labels, code = np.unique(np.asarray(types, str), return_inverse=True)
        numbers = elements(code, np.where(masses > 0, masses, np.nan), {k: label.capitalize() for k, label in enumerate(labels)})
    atoms = Atoms(numbers=numbers)
    symbols = np.array(atoms.get_chemical_symbols(), object)
    skipped = {"elements"} | ({"types"} if np.array_equal(present.get("types"), symbols) else set())
    skipped |= {"masses"} if not masses.any() else set()
    if "resnames" not in present:
        skipped.add("resids")
        if "molnums" not in present and "resids" in present:
            present["molnums"] = present["resids"]
    for name, values in present.items():
        if name not in skipped:
            _set(atoms, name, values)
    return atoms


def _numbers(symbols) -> np.ndarray:
    return np.array([atomic_numbers.get(str(s).strip().capitalize(), 0) for s in symbols], int)


def _set(atoms: Atoms, name: str, values) -> None:
    """Give atoms the values of one attribute."""
    array = (ARRAYS | RESIDUES)[name]
    if name == "elements":
        atoms.numbers = _numbers(values)
    elif name == "types":
        numbers, labels = numbered([str(v) for v in values])
        atoms.set_array(array, numbers.astype(np.int32))
        if labels:
            atoms.info.setdefault("labels", {})["atom"] = labels
    elif name in ("names", "resnames"):
        atoms.set_array(array, np.array([str(v) for v in values]))
    elif name in ("ids", "resids", "molnums"):
        atoms.set_array(array, np.asarray(values, np.int64))
    elif name == "masses":
        atoms.set_masses(values)
    else:
        atoms.set_array(array, np.asarray(values, float))


def numbered(words: list[str]) -> tuple[np.ndarray, dict[int, str]]:
    """Numbers of types, and which word each stands for; none if the words are the numbers."""
    try:
        return np.array([int(w) for w in words], int), {}
    except ValueError:
        labels, code = np.unique(np.asarray(words, str), return_inverse=True)
        return code + 1, {k: str(label) for k, label in enumerate(labels, 1)}


def connections(ag, labels: dict) -> Topology:
    """The bonded items among the atoms of an AtomGroup; an item that has an atom outside goes.

    Types that are no numbers are numbered, and `labels` gets kind -> {number: word}. Items without a type have the types of their atoms
    for one, ``C-H``.
    """
    universe, parts = ag.universe, {}
    new = np.full(len(universe.atoms), -1, np.int64)
    new[ag.ix[::-1]] = np.arange(len(ag))[::-1]
    for kind, name in BONDED.items():
        attr = getattr(universe._topology, name, None)
        if attr is None or not len(attr.values):
            continue
        rows = new[np.array(attr.values, np.int64)]
        inside = np.flatnonzero((rows >= 0).all(axis=1))
        rows, order = rows[inside], np.array(attr.order, object)[inside]
        turned = order == REVERSED
        rows[turned] = rows[turned, ::-1]
        words = [_type_of(attr.types[k], ag, row) for k, row in zip(inside, rows)]
        numbers, named = numbered(words)
        if named:
            labels[kind] = named
        parts |= {f"{kind}s": rows, f"{kind}_types": numbers}
    try:
        return Topology(**parts)
    except ValueError as e:
        raise InputError(f"from_mdanalysis: {e}") from None


def _type_of(given, ag, row) -> str:
    """The type of an item as a word; by the types of its atoms where it has none."""
    if given is None and _has(ag, "types"):
        given = tuple(ag.types[row])
    if isinstance(given, (tuple, list)):
        words = [str(w) for w in given]
        return "-".join(min(words, words[::-1]))
    return "1" if given is None else str(given)


def same_items(one: Topology, other: Topology) -> bool:
    """Whether two topologies list the same, the two ends of bonds in any order."""
    return all(np.array_equal(np.sort(a, axis=1) if kind == "bond" else a, np.sort(b, axis=1) if kind == "bond" else b)
               and np.array_equal(s, t) for (kind, a, s), (_, b, t) in zip(one.every(), other.every()))


