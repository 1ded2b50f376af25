"""Energies and forces of single bonds, angles, dihedrals and impropers, from the compiled loops of their styles."""
from __future__ import annotations

import numpy as np

from asemd.bond_term import present
from asemd.kernels import bonded
from asemd.kernels.state import cell_arrays


def evaluate(system, use, category: str, atoms: np.ndarray, types: np.ndarray, units, compat: str) -> tuple[np.ndarray, np.ndarray]:
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

    Returns
    -------
    energies : (m,)
    forces : (m, k, 3)
        On each atom of each item; what is outside the domain of its style has energy and forces nan.
    """
    m, k = atoms.shape
    if use.style.function is None or not m:
        return np.zeros(m), np.zeros((m, k, 3))
    style = use.style.bind(use.settings, use.coeff, compat)
    packed = style.pack(use.settings, use.coeff, system.counts[f"n{category}types"], units)
    box = system.box
    cell, periodic = np.ascontiguousarray(box.cell, float), np.array(box.periodic, bool)
    if system.dimension == 2:
        periodic[2] = False
    orthogonal = not np.count_nonzero(cell - np.diag(np.diag(cell))) and bool((np.diag(cell) > 0).all())
    loop = bonded.kernel(style, energy=True, per_atom=True, periodic=bool(periodic.any()), orthogonal=orthogonal)
    n = m * k                     # every item has atoms of its own
    x = np.ascontiguousarray(system.x[atoms.ravel()].T)
    forces, shares, virial = np.zeros((3, n)), np.zeros(n), np.zeros((6, n))
    items, types = np.arange(n, dtype=np.int32).reshape(m, k), np.ascontiguousarray(types, np.int32)
    arrays = (*packed.arrays, *present(use, system, atoms)) if style.remembers else packed.arrays
    args = (x, forces, items, types, cell_arrays(cell, periodic), packed.coeff, arrays)
    bad = np.zeros(4)
    loop(*args, 0, m, np.zeros(8), shares, virial, bad)
    energies, forces = shares.reshape(m, k).sum(axis=1), forces.T.reshape(m, k, 3)
    if bad[0]:                    # the loop names only the first one
        first = int(bad[1])
        for item in range(first, m):
            alone = np.zeros(4)
            loop(*args[:1], np.zeros((3, n)), *args[2:], item, item + 1, np.zeros(8), np.zeros(n), np.zeros((6, n)), alone)
            if alone[0]:
                energies[item] = forces[item] = np.nan
    return energies, forces


def evaluate_all(system, interactions, category: str, atoms: np.ndarray, types: np.ndarray, units) -> tuple[np.ndarray, np.ndarray]:
    """As `evaluate`, for items of all styles of a category; what is turned off or has no coefficients counts as zero."""
    energies, forces = np.zeros(len(atoms)), np.zeros((*atoms.shape, 3))
    for use in interactions.uses[category]:
        mine = np.isin(types, list(use.coeff))
        energies[mine], forces[mine] = evaluate(system, use, category, atoms[mine], types[mine], units, interactions.compat)
    return energies, forces
