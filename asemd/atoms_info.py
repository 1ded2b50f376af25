"""The topology as entries of ``atoms.info``, which ASE's files keep: extxyz and trajectories hold nothing else for bonds.

Entries begin with ``asemd_``: ``asemd_bonds`` and its relatives have rows of a type and atom indices, ``asemd_types`` and
``asemd_molecules`` are the arrays that trajectories drop, ``asemd_atoms`` is the number of atoms and a checksum of their elements, by which
entries are found out that plain `ase.Atoms` kept while they were sliced.
"""
from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from asemd.errors import InputError
from asemd.topology import WIDTHS, Partners, Topology

PREFIX = "asemd_"
PAIRS = "frozen_pairs"      # of a `Partners`
ARRAYS = {"types": "type", "molecules": "mol-id"}      # entry -> array of the atoms


def entries(topology: Topology, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What `info` holds for atoms with these arrays; nothing without a topology and types of their own.

    All are two-dimensional: ASE's extxyz takes nine numbers in a row for a matrix.
    """
    out = {}
    for prefix, top in (("", topology), ("frozen_", topology.frozen)):
        for kind, atoms, types in top.every() if isinstance(top, Topology) else ():
            if len(atoms):
                out[f"{PREFIX}{prefix}{kind}s"] = np.column_stack([types, atoms]).astype(int)
    if isinstance(topology.frozen, Partners):
        out[PREFIX + PAIRS] = np.column_stack([topology.frozen.kinds, topology.frozen.pairs]).astype(int).reshape(-1, 3)
    for name, array in ARRAYS.items():
        if array in arrays and np.any(arrays[array] != arrays[array][:1]):
            out[PREFIX + name] = np.asarray(arrays[array], int)[:, None]
        elif array in arrays and len(arrays[array]):
            out[PREFIX + name] = np.array([[int(arrays[array][0])]])
    return out | ({PREFIX + "atoms": _mark(arrays["numbers"])} if out else {})


def _mark(numbers: np.ndarray) -> np.ndarray:
    return np.array([[len(numbers), zlib.crc32(np.asarray(numbers, "<i8").tobytes())]])


def drop(info: dict[str, Any]) -> None:
    """Take the entries away."""
    for name in [n for n in info if isinstance(n, str) and n.startswith(PREFIX)]:
        del info[name]


def holds(info: Mapping[str, Any]) -> bool:
    """Whether there is a topology, or atom types."""
    data = info.get("data")
    return PREFIX + "atoms" in info or (isinstance(data, Mapping) and ("topology" in data or PREFIX + "atoms" in data))


def found(info: Mapping[str, Any], numbers: np.ndarray) -> tuple[Topology | None, dict[str, np.ndarray]]:
    """The topology and the arrays that `info` holds for atoms of these elements; None and nothing where it holds none.

    Raises
    ------
    InputError
        They belong to other atoms, or are damaged.
    """
    if PREFIX + "atoms" not in info:        # ase.db holds it as data: atoms.info, or the topology alone
        data = info["data"] if holds(info) else {}
        return found(data, numbers) if PREFIX + "atoms" in data else (Topology(**data["topology"]) if data else None, {})
    try:
        if not np.array_equal(np.ravel(info[PREFIX + "atoms"]), np.ravel(_mark(numbers))):
            raise InputError(f"the bonds in atoms.info belong to {int(np.ravel(info[PREFIX + 'atoms'])[0])} other atoms than these "
                             f"{len(numbers)}: make asemd.Atoms of what was read before it is sliced, sorted or repeated")
        frozen = _topology(info, "frozen_")
        top = _topology(info, "", None if frozen.is_empty else frozen)
        if PREFIX + PAIRS in info:
            rows = np.asarray(info[PREFIX + PAIRS], int).reshape(-1, 3)
            top.frozen = Partners(rows[:, 1:], rows[:, 0])
        arrays = {array: np.broadcast_to(np.ravel(info[PREFIX + name]).astype(int), len(numbers)).copy()
                  for name, array in ARRAYS.items() if PREFIX + name in info}
    except (ValueError, TypeError, IndexError) as e:
        raise InputError(f"the topology in atoms.info cannot be read: {e}") from None
    return top, arrays


def _topology(info: Mapping[str, Any], prefix: str, frozen: Topology | None = None) -> Topology:
    given: dict[str, Any] = {}
    for kind, width in WIDTHS.items():
        rows = info.get(f"{PREFIX}{prefix}{kind}s")
        if rows is not None:
            rows = np.asarray(rows, int).reshape(-1, 1 + width)
            given |= {f"{kind}s": rows[:, 1:], f"{kind}_types": rows[:, 0]}
    return Topology(**given, frozen=frozen)
