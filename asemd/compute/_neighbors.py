"""The pairs that a neighbour list has, found again from the positions."""
from __future__ import annotations

import numpy as np

from asemd.pairing import complete


def neighbors(state, scene, group: str, within: bool, touching: bool) -> np.ndarray:
    """Rows (m, 2) of all pairs of a group within the cutoffs of the pair styles, one entry for each periodic image.

    Parameters
    ----------
    state : asemd.result.Snapshot
    scene : asemd.scene.Scene
    group : str
    within : bool
        True: pairs within the cutoff; False: within cutoff plus skin.
    touching : bool
        Instead of the cutoff the sum of the radii counts.
    """
    from ase.neighborlist import primitive_neighbor_list
    system, interactions, n = state.system, scene.interactions, state.system.counts["ntypes"]
    cut = np.zeros((n + 1, n + 1))
    for use, filled in complete(interactions, n):
        for (i, j), c in filled.items():
            cut[i, j] = cut[j, i] = max(cut[i, j], use.style.reach(c, use.settings))
    settings = scene.settings()
    reach = np.where(cut > 0.0, cut + settings.skin, 0.0)
    x, image = system.x.copy(), system.image.copy()
    system.box.wrap(x, image)
    i, j, d, shift = primitive_neighbor_list("ijdS", system.box.periodic, system.box.cell, x - system.box.origin, float(reach.max()))
    forward = (i < j) | (i == j) & ((shift[:, 0] > 0) | (shift[:, 0] == 0) & ((shift[:, 1] > 0) | (shift[:, 1] == 0) & (shift[:, 2] > 0)))
    mask, t = state.mask(group), system.type
    limit = reach[t[i], t[j]]
    keep = forward & (d <= limit) & (limit > 0.0) & mask[i] & mask[j] & ~_excluded(system, settings.exclude, i, j)
    if within:
        keep &= d < (system.extra["radius"][i] + system.extra["radius"][j] if touching else cut[t[i], t[j]])
    keep &= ~_hidden(system, interactions, i, j, d)
    order = np.lexsort((j[keep], i[keep]))
    return np.column_stack([i[keep], j[keep]])[order]


def _excluded(system, rules: list, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Pairs that ``neigh_modify exclude`` takes out of the list."""
    out = np.zeros(len(i), bool)
    for kind, *args in rules:
        if kind == "type":
            a, b = args
            out |= (system.type[i] == a) & (system.type[j] == b) | (system.type[i] == b) & (system.type[j] == a)
        elif kind == "group":
            a, b = args
            out |= a[i] & b[j] | b[i] & a[j]
        else:
            same = system.molecule[i] == system.molecule[j]
            out |= args[0][i] & args[0][j] & (same if kind == "molecule/intra" else ~same)
    return out


def _hidden(system, interactions, i: np.ndarray, j: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Bonded partners whose weights are zero, at their nearest image."""
    pairs, kind = interactions.special_pairs(system)
    zero = [k for k, lj, coul in zip((1, 2, 3), interactions.special_lj, interactions.special_coul) if lj == coul == 0.0]
    pairs = pairs[np.isin(kind, zero)].astype(np.int64)
    partner = np.isin(i * system.n + j, pairs[:, 0] * system.n + pairs[:, 1])
    nearest = np.linalg.norm(system.box.minimum_image(system.x[i[partner]] - system.x[j[partner]])[0], axis=1)
    partner[partner] = d[partner] < nearest * (1.0 + 1e-9) + 1e-12
    return partner
