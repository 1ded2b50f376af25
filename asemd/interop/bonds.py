"""Bonds for atoms that come without: found by distance when somebody asks for it, angles and torsions that follow, types that are said."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from asemd.errors import InputError
from asemd.topology import ATOMS, Topology

Types = Mapping[tuple, int | None]


def find_bonds(atoms, cutoffs: float | Mapping[tuple[str, str], float]) -> np.ndarray:
    """Pairs of atoms that are close enough for a bond, by ASE's neighbour list; nothing in asemd does that unasked.

    Parameters
    ----------
    atoms : ase.Atoms
    cutoffs : float or mapping
        Pairs of elements -> largest length of their bond in Angstrom, as ``{("O", "H"): 1.2}``, other pairs have none; or a factor for
        the sums of ASE's covalent radii (``ase.neighborlist.natural_cutoffs``), as 1.1.

    Returns
    -------
    (m, 2) int
        Atom rows i < j, sorted.

    Raises
    ------
    InputError
        An atom that would be bonded to its own image, or twice to another one: the cell is too small, repeat it first; a cutoff that is no
        positive number.
    """
    from ase.neighborlist import natural_cutoffs, neighbor_list
    given = cutoffs.values() if isinstance(cutoffs, Mapping) else [cutoffs]
    for value in given:
        if isinstance(value, (str, bool)) or not np.isscalar(value) or not 0.0 < value < np.inf:
            raise InputError(f"find_bonds: a cutoff must be a positive number, got {value!r}")
    reach = dict(cutoffs) if isinstance(cutoffs, Mapping) else natural_cutoffs(atoms, mult=cutoffs)
    i, j = neighbor_list("ij", atoms, reach, self_interaction=False) if len(reach) and len(atoms) else np.zeros((2, 0), int)
    if (i == j).any():
        raise InputError(f"find_bonds: atom {i[i == j][0]} would be bonded to its own periodic image: repeat the cell first")
    pairs, times = np.unique(np.column_stack([i, j])[i < j].reshape(-1, 2), axis=0, return_counts=True)
    if (times > 1).any():
        a, b = pairs[times > 1][0]
        raise InputError(f"find_bonds: atoms {a} and {b} would be bonded through several periodic images: repeat the cell first")
    return pairs


def topology_from_bonds(atoms, bonds, bond_types: Types, angle_types: Types | None = None, dihedral_types: Types | None = None) -> Topology:
    """The topology that follows from bonds: angles are two bonds with an atom in common, torsions three bonds in a row.

    Parameters
    ----------
    atoms : ase.Atoms
    bonds : (m, 2) int
        Atom rows, as of `find_bonds` or of a guesser of MDAnalysis.
    bond_types, angle_types, dihedral_types : mapping
        Names of the atoms of an item -> its type, as ``{("C", "H"): 1, ("C", "C"): 2}``; either way round. Names are elements, or numbers
        of the array ``type``. None: such items are left out. Kinds without a mapping are not made.

    Returns
    -------
    Topology

    Raises
    ------
    InputError
        An item whose names are in no mapping: all of them are told.
    """
    bonds = np.unique(np.sort(np.asarray(bonds, int).reshape(-1, 2), axis=1), axis=0)
    if len(bonds) and not 0 <= bonds.min() <= bonds.max() < len(atoms):
        raise InputError(f"a bond names atom {bonds.max() if bonds.min() >= 0 else bonds.min()}, but the atoms are 0 to {len(atoms) - 1}")
    parts = {}
    for kind, types in (("bond", bond_types), ("angle", angle_types), ("dihedral", dihedral_types)):
        if types is not None:
            items = {"bond": lambda b: b, "angle": angles_of, "dihedral": dihedrals_of}[kind](bonds)
            items, numbers = _typed(atoms, items, types, kind)
            parts |= {f"{kind}s": items, f"{kind}_types": numbers}
    return Topology(**parts)


def angles_of(bonds: np.ndarray) -> np.ndarray:
    """(m, 3) rows of all angles of bonds (m, 2), sorted by the middle atom; the smaller end comes first."""
    both = np.concatenate([bonds, bonds[:, ::-1]])
    both = both[np.lexsort((both[:, 1], both[:, 0]))]       # middle atom, end
    starts = np.searchsorted(both[:, 0], np.unique(both[:, 0]))
    out = [np.column_stack([ends[a], np.full(len(a), middle), ends[b]])
           for ends, middle in ((group[:, 1], group[0, 0]) for group in np.split(both, starts[1:]) if len(group))
           for a, b in [np.triu_indices(len(ends), 1)]]
    return np.concatenate(out) if out else np.zeros((0, 3), int)


def dihedrals_of(bonds: np.ndarray) -> np.ndarray:
    """(m, 4) rows of all torsions of bonds (m, 2), by their middle bond; rings of three have none."""
    partners: dict[int, list[int]] = {}
    for a, b in bonds.tolist():
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    out = [(i, j, k, m) for j, k in bonds.tolist() for i in sorted(partners[j]) if i != k for m in sorted(partners[k]) if m not in (i, j)]
    return np.array(out, int).reshape(-1, 4)


def _typed(atoms, items: np.ndarray, types: Types, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Items and their types by the names of their atoms."""
    known = {}
    for names, number in types.items():
        if not isinstance(names, tuple) or len(names) != ATOMS[kind]:
            raise InputError(f"{kind}_types: {names!r} must be {ATOMS[kind]} names of atoms, as {('C',) * ATOMS[kind]!r}")
        if number is not None and (isinstance(number, bool) or not isinstance(number, (int, np.integer)) or number < 1):
            raise InputError(f"{kind}_types: types are whole numbers from 1, or None, got {number!r} for {_word(names)}")
        if known.get(names, number) != number:
            raise InputError(f"{kind}_types: {_word(names)} has the types {known[names]} and {number}")
        known |= {names: number, names[::-1]: number}
    numbered = any(not isinstance(name, str) for names in known for name in names)
    if numbered and "type" not in atoms.arrays:
        raise InputError(f"{kind}_types go by atom types, but the atoms have no array 'type'")
    names = atoms.arrays["type"].tolist() if numbered else atoms.get_chemical_symbols()
    found = [tuple(names[a] for a in item) for item in items.tolist()]
    missing = sorted({min(f, f[::-1]) for f in found if f not in known})
    if missing:
        raise InputError(f"{kind}_types does not say what type {', '.join(map(_word, missing))} {'is' if len(missing) == 1 else 'are'} "
                         f"(None leaves such {kind}s out)")
    kept = [k for k, f in enumerate(found) if known[f] is not None]
    return items[kept].reshape(-1, ATOMS[kind]), np.array([known[found[k]] for k in kept], int)


def _word(names: tuple) -> str:
    return "-".join(map(str, names))
