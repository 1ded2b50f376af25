"""Who is to blame when energies or forces are not numbers."""
from __future__ import annotations

import numpy as np

from asemd.errors import ONE_PLACE, SimulationError


def not_finite(engine) -> SimulationError:
    """Find who is to blame: coincident atoms, else the first atom with a bad force."""
    s, bad = engine.system, np.flatnonzero(~np.isfinite(engine.system.f).all(axis=1))
    if engine.mode == "cluster":
        close = 1e-3 * max(engine.cutoff, 1e-300)
        i, j, code = engine.plain if engine.expanded else engine.list.expand(engine.k, engine.state, close)
        d = engine.state.x[:, i] - engine.state.x[:, j] - engine.list.shifts[code >> 2].T
        m = int(np.argmin((d * d).sum(0))) if len(i) else 0
        if len(i) and (d[:, m] ** 2).sum() <= close * close:
            a, b = sorted(int(s.id[engine.state.row[t[m]]]) for t in (i, j))
            distance = np.sqrt((d[:, m] ** 2).sum())
            return SimulationError(f"atoms {a} and {b} overlap (distance {distance:.3g}): energy or force is not finite; {ONE_PLACE}")
    who = f"atom {s.id[bad[0]]}: force is not finite (NaN or infinite)" if len(bad) else "the energy is not finite"
    return SimulationError(who + "; atoms overlap, or the time step is too long")
