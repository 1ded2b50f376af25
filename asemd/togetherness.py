"""Which periodic images of the atoms of a molecule belong together."""
from __future__ import annotations

import numpy as np

from asemd.topology import Topology, cells_apart


def cells_of_molecules(topology: Topology, n: int, box, x: np.ndarray) -> np.ndarray:
    """Cells (n, 3) by which atoms are to be moved so that bonded ones are close together, counted from the first atom of each molecule.

    Molecules that go on through the periodic cell without an end have zeros.

    Parameters
    ----------
    topology : Topology
    n : int
        Number of atoms.
    box : asemd.box.Box
    x : (n, 3)
        Positions. Each bond is its shortest image.
    """
    ends, apart = [np.zeros((0, 2), np.int64)], [np.zeros((0, 3), np.int64)]
    for kind, atoms, _ in topology.every():
        at = cells_apart(kind, atoms, box, x)
        for k in range(1, atoms.shape[1]):
            ends.append(atoms[:, [0, k]])
            apart.append(at[:, k] - at[:, 0])
    ends, apart, out = np.concatenate(ends), np.concatenate(apart), np.zeros((n, 3), np.int64)
    if not apart.any():
        return out
    from scipy.sparse import coo_matrix, csgraph  # atoms alone need not wait for it
    _, molecule = csgraph.connected_components(coo_matrix((np.ones(len(ends)), ends.T), shape=(n, n)), directed=False)
    source, target, step = np.append(ends[:, 0], ends[:, 1]), np.append(ends[:, 1], ends[:, 0]), np.concatenate([apart, -apart])
    order = np.argsort(source, kind="stable")
    target, step, first = target[order], step[order], np.searchsorted(source[order], np.arange(n + 1))
    front = np.unique(molecule, return_index=True)[1]
    seen = np.zeros(n, bool)
    while len(front):
        seen[front] = True
        count = first[front + 1] - first[front]
        edge = np.repeat(first[front], count) + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        new, which = np.unique(target[edge], return_index=True)
        new, which = new[~seen[new]], which[~seen[new]]
        out[new] = out[np.repeat(front, count)[which]] + step[edge[which]]
        front = new
    endless = molecule[ends[(out[ends[:, 0]] + apart != out[ends[:, 1]]).any(axis=1), 0]]
    out[np.isin(molecule, endless)] = 0
    return out
