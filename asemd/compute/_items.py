"""Energies and forces of single bonds, angles, dihedrals and impropers, from the compiled loops of their styles."""
from __future__ import annotations

import numpy as np

from asemd.bond_term import present
from asemd.kernels import bonded
from asemd.kernels import rows as by_row
from asemd.kernels.state import cell_arrays

PIECE = 4096        # items at once: their arrays stay in the cache


def evaluate(system, use, category: str, atoms: np.ndarray, types: np.ndarray, units, compat: str,
             with_forces: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Energies and forces of items of one style.

    Parameters
    ----------
    system : asemd.system.System
    use : asemd.forcefield.Use
    atoms : (m, k) int
        Rows of the atoms of the items.
    types : (m,) int
        Their types, which must have coefficients.
    units : asemd.units.Units
    compat : str
        As `asemd.forcefield.Interactions.compat`.
    with_forces : bool
        False: there are no forces in the result, (0, k, 3).

    Returns
    -------
    energies : (m,)
    forces : (m, k, 3)
        On each atom of each item; what is outside the domain of its style has energy and forces nan.
    """
    m, k = atoms.shape
    if use.style.function is None or not m:
        return np.zeros(m), np.zeros((m * with_forces, k, 3))
    style = use.style.bind(use.settings, use.coeff, compat)
    packed = style.pack(use.settings, use.coeff, system.counts[f"n{category}types"], units)
    box = system.box
    cell, periodic = np.ascontiguousarray(box.cell, float), np.array(box.periodic, bool)
    if system.dimension == 2:
        periodic[2] = False
    orthogonal = not np.count_nonzero(cell - np.diag(np.diag(cell))) and bool((np.diag(cell) > 0).all())
    loop = bonded.kernel(style, energy=True, per_atom=True, periodic=bool(periodic.any()), orthogonal=orthogonal)
    arrays = (*packed.arrays, *present(use, system, atoms)) if style.remembers else packed.arrays
    types, piece = np.ascontiguousarray(types, np.int32), m if style.remembers else PIECE
    energies, by_axis, geometry = np.empty(m), np.empty((3, m * k * with_forces)), cell_arrays(cell, periodic)
    places = system.x
    forces = by_axis.T.reshape(-1, k, 3)
    for lo in range(0, m, piece):
        hi = min(lo + piece, m)
        n = (hi - lo) * k         # every item has atoms of its own
        if lo == 0 or hi == m:      # the others are as long as the first
            x, f, shares, virials = np.empty((3, n)), np.empty((3, n)), np.empty(n), np.zeros((6, n))
            items = np.arange(n, dtype=np.int32).reshape(-1, k)
        f[:], shares[:], bad = 0.0, 0.0, np.zeros(4)
        by_row.of_items(places, atoms[lo:hi], x)
        more = (items, types[lo:hi], geometry, packed.coeff, arrays)
        loop(x, f, *more, 0, hi - lo, np.zeros(8), shares, virials, bad)
        energies[lo:hi] = sum(shares[j::k] for j in range(k))
        if with_forces:
            by_axis[:, lo * k:hi * k] = f
        for item in range(int(bad[1]), hi - lo) if bad[0] else ():        # the loop names only the first one
            alone = np.zeros(4)
            loop(x, np.zeros((3, n)), *more, item, item + 1, np.zeros(8), np.zeros(n), np.zeros((6, n)), alone)
            if alone[0]:
                energies[lo + item] = forces[lo + item:lo + item + 1] = np.nan
    return energies, forces


def evaluate_all(system, interactions, category: str, atoms: np.ndarray, types: np.ndarray, units,
                 with_forces: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """As `evaluate`, for items of all styles of a category; what is turned off or has no coefficients counts as zero."""
    energies, forces = np.zeros(len(atoms)), np.zeros((len(atoms) * with_forces, atoms.shape[1], 3))
    for use in interactions.uses[category]:
        known = np.zeros(max(int(types.max(initial=0)), *use.coeff, 0) + 1, bool)
        known[list(use.coeff)] = True
        mine = known[np.maximum(types, 0)]      # below 0: turned off
        if mine.all():
            return evaluate(system, use, category, atoms, types, units, interactions.compat, with_forces)
        energies[mine], found = evaluate(system, use, category, atoms[mine], types[mine], units, interactions.compat, with_forces)
        if with_forces:
            forces[mine] = found
    return energies, forces
