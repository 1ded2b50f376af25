"""Atoms, bonds and box as the small numbers that a page draws them from."""
from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np

from asemd.page.plot import COLOURS

GRID = 65535            # positions are whole numbers from 0 to this, across what is shown
MOST = 100_000          # atoms that are shown
SIZE = 60.0             # what is shown is this wide in the viewer's units: units of length differ by 1e10
NEIGHBOURS = 3000       # atoms whose next neighbour is looked for
EDGES = ((0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7))


@dataclass
class Kind:
    """A type of atoms: what the legend says, colour, size relative to the others, how many."""

    name: str
    colour: str
    radius: float
    count: int


def describe(system) -> dict[str, Any]:
    """What the viewer needs, JSON-able.

    Parameters
    ----------
    system : asemd.System or ase.Atoms
    """
    if not hasattr(system, "topology") or not hasattr(system, "box"):
        from asemd.system import System
        system = System.from_ase(system)
    whole = system.n
    system = _thinned(system)
    box = system.box
    x = np.array(system.x, float)
    image = np.zeros((system.n, 3), np.int32)
    box.wrap(x, image)
    corners = box.origin + np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], float) @ box.cell
    if system.dimension == 2:
        corners[:, 2] = corners[0, 2] = x[:, 2].mean() if system.n else 0.0
    seen = np.concatenate([x, corners])
    low, span = seen.min(axis=0), max(float(np.ptp(seen, axis=0).max(initial=0.0)), 1e-300)
    scale = SIZE / span
    kinds, kind = _kinds(system)
    bonds, shift = _bonds(system, x)
    spacing = _spacing(x, bonds, shift, box.cell, box.volume if system.dimension == 3 else 0.0)
    edges = EDGES if system.dimension == 3 else [e for e in EDGES if max(e) < 4]
    crossing = np.flatnonzero(shift.any(axis=1))
    return {"n": int(system.n), "of": int(whole), "flat": system.dimension == 2, "grid": SIZE / GRID,
            "position": _pack(np.rint((x - low) / span * GRID).astype("<u2")), "kind": _pack(kind.astype("<u2")), "id": _ids(system.id),
            "bonds": _pack(bonds.astype("<u4")), "crossing": [int(i) for i in crossing],
            "toward": np.round(shift[crossing] @ box.cell * scale, 3).tolist(), "spacing": spacing * scale,
            "kinds": [[k.name, k.colour, round(k.radius, 3), k.count] for k in kinds],
            "centre": np.round((seen.max(axis=0) - low) * 0.5 * scale, 3).tolist(),
            "corners": np.round((corners - low) * scale, 3).tolist(), "edges": [list(e) for e in edges]}


def _thinned(system):
    """Every second, third ... atom of very large systems, or molecule where there are bonds, so that browsers can draw them."""
    step = -(-system.n // MOST)
    if step <= 1:
        return system
    single = system.topology.is_empty or system.molecule is None
    number = np.arange(system.n) if single else np.unique(system.molecule, return_inverse=True)[1]
    return system.select(number % step == 0)


def _pack(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")


def _ids(id: np.ndarray) -> str | None:
    """None for 1, 2, 3 ..., which need not be said."""
    return None if np.array_equal(id, np.arange(1, len(id) + 1)) else _pack(id.astype("<u4"))


def _kinds(system) -> tuple[list[Kind], np.ndarray]:
    """The types there are, and the place in that list for each atom."""
    from ase.data import chemical_symbols, covalent_radii
    from ase.data.colors import jmol_colors

    from asemd.atoms import elements
    labels = system.labels.get("atom", {})
    reduced = system.units == "lj"
    masses = np.full(system.n, np.nan) if system.mass is None and system.rmass is None else system.atom_masses()
    factor = 1.0
    if not reduced:
        from asemd import units
        factor = units.factor("mass", system.units)
    number = elements(system.type, masses * factor, labels, guess=not reduced)
    present, kind, count = np.unique(system.type, return_inverse=True, return_counts=True)
    kinds = []
    # where several types are one element, its colour alone would not tell them apart
    known = {int(t): int(number[np.argmax(system.type == t)]) for t in present}
    elemental = len(present) > 0 and all(known.values())
    for i, t in enumerate(present):
        z, label = known[int(t)], labels.get(int(t), "")
        name = f"{label or (chemical_symbols[z] if z else '')} (type {t})" if label or z else f"type {t}"
        if elemental:
            rgb = np.array(jmol_colors[z]) * 0.92       # white would vanish on paper
            colour = "#" + "".join(f"{int(255 * c):02x}" for c in rgb)
        else:
            colour = COLOURS[i % len(COLOURS)]
        radius = float(covalent_radii[z] / covalent_radii[6]) ** 0.6 if z else 1.0
        kinds.append(Kind(name, colour, radius, int(count[i])))
    return kinds, np.ravel(kind)


def _bonds(system, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of rows, and the number of cells the second atom has to be moved to be next to the first."""
    pairs = np.asarray(system.topology.bonds).reshape(-1, 2)
    fraction = (x[pairs[:, 1]] - x[pairs[:, 0]]) @ system.box.inverse
    return pairs, -np.where(system.box.periodic, np.rint(fraction), 0.0)


def _spacing(x: np.ndarray, bonds: np.ndarray, shift: np.ndarray, cell: np.ndarray, volume: float) -> float:
    """A length that atoms are apart: of bonds where there are any, else of next neighbours."""
    if len(bonds):
        return float(np.median(np.linalg.norm(x[bonds[:, 1]] + shift @ cell - x[bonds[:, 0]], axis=1))) or 1.0
    if len(x) > 1:
        from scipy.spatial import cKDTree
        some = x[:: max(1, len(x) // NEIGHBOURS)]
        near = cKDTree(x).query(some, k=2)[0][:, 1]
        return float(np.median(near)) or 1.0
    return (volume ** (1.0 / 3.0) if volume > 0.0 else 1.0) / 10.0
