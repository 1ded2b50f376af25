"""The pairs of the neighbour list as rows of local values."""
from __future__ import annotations

import numpy as np

from asemd.compute._pairs import Half, half, type_cutoffs


def neighbors(state, group: str, within: bool, touching: bool) -> Half:
    """All pairs of a group within the cutoffs of the pair styles, sorted by rows of atoms: columns of several computes fit together.

    Parameters
    ----------
    state : asemd.result.Snapshot
    group : str
    within : bool
        True: pairs within the cutoff; False: within cutoff plus skin.
    touching : bool
        Instead of the cutoff the sum of the radii counts.
    """
    cut, mask, t = type_cutoffs(state), state.mask(group), state.system.type
    p = half(state, (float(cut.max()) + (0.0 if within and not touching else state.engine.settings.skin)) * (1.0 + 1e-12))
    keep = mask[p.i] & mask[p.j]
    if within:
        radius = state.system.extra["radius"] if touching else None
        keep &= p.r2 < ((radius[p.i] + radius[p.j]) if touching else cut[t[p.i], t[p.j]]) ** 2
    p = p.take(keep)
    turned = p.i > p.j
    p.i[turned], p.j[turned] = p.j[turned], p.i[turned]
    p.d[turned] *= -1.0
    return p.take(np.lexsort((p.r2, p.j, p.i)))
