"""What computes of clusters share: the smallest atom ID of all atoms that hang together."""
from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components


def smallest_ids(state, mask: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """(n,) the smallest ID of the atoms connected with each atom of `mask` by the links i-j between such atoms; 0 for the others."""
    n, ids = state.system.n, state.system.id
    keep = mask[i] & mask[j]
    links = coo_matrix((np.ones(int(keep.sum()), bool), (i[keep], j[keep])), shape=(n, n))
    count, label = connected_components(links, directed=False)
    least = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(least, label, ids)
    return np.where(mask, least[label], 0).astype(float)


def bonded(state) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the two atoms of each bond that is not broken."""
    bonds, types = state.system.topology.items("bond")
    bonds = np.asarray(bonds)[np.asarray(types) != 0].reshape(-1, 2)
    return bonds[:, 0], bonds[:, 1]
