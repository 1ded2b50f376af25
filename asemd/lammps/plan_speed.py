"""How fast a scene will run: its counts, times the costs of the parts of a step on this machine."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asemd.cluster_term import PairTerm
from asemd.embedded_term import EmbeddedTerm
from asemd.engine import Engine
from asemd.lammps.calibration import Costs
from asemd.lammps.plan_memory import pairs_around
from asemd.manybody_term import ManyBodyTerm
from asemd.term import BondedTerm, PairListTerm, PairRowsTerm

EMBEDDED = 4        # an embedded-atom potential over clusters costs about so many times the pairs of a simple one
MANY = 4            # a many-body style costs about so many times the pairs, one by one
PYTHON = 2e-4       # seconds of a step with a hook in Python


@dataclass
class Speed:
    """Expected seconds of a step by part: Pair, Bond, Kspace, Neigh, Modify, Output; `builds` is the number of steps from list to list."""

    parts: dict[str, float]
    builds: float

    @property
    def steps_per_second(self) -> float:
        return 1.0 / max(sum(self.parts.values()), 1e-12)


def between_builds(e: Engine, dt: float) -> float:
    """Steps from list to list: the fastest atom goes half the skin."""
    s, settings = e.system, e.settings
    if not settings.check:
        return float(max(settings.every, 1))
    fastest = float(np.linalg.norm(s.v, axis=1).max(initial=0.0))
    if fastest == 0.0 or dt <= 0.0:
        return 1e3
    return max(1.0, settings.every, settings.delay, 1.0 + 0.5 * settings.skin / (fastest * dt))


def of_solver(t, n: int, costs: Costs) -> float:
    """Seconds that a step of a long-range solver takes with n atoms."""
    order, mesh = (getattr(t, name, getattr(t.solver, name, None)) for name in ("order", "mesh"))
    if mesh is not None:
        return costs.spread * n * order**3 + costs.mesh * math.prod(mesh)
    waves = getattr(t.solver, "waves", None)
    return costs.wave * n * (waves if waves is not None else len(t.solver.numbers))


def expected(e: Engine, costs: Costs, dt: float, moving: bool = True, rows: float = 0.0, python: int = 0) -> Speed:
    """The expected speed of a run.

    Parameters
    ----------
    e : Engine
        Not yet loaded: its terms and counts are enough.
    costs : Costs
    dt : float
        Timestep.
    moving : bool
        Whether atoms move, so that lists are built again.
    rows : float
        Thermo rows and dumps per step.
    python : int
        Hooks in Python, called in each step.
    """
    n = e.system.n
    pairs = pairs_around(e) * n if e.mode != "none" else 0.0
    parts = {"Pair": 0.0, "Bond": 0.0}
    for t in e.terms:
        if isinstance(t, BondedTerm):
            parts["Bond"] += len(t.items) * costs.items["bond" if t.category == "pair" else t.category]
            continue
        if isinstance(t, EmbeddedTerm):
            parts["Pair"] += pairs * EMBEDDED * costs.pair
            continue
        if isinstance(t, ManyBodyTerm):
            parts["Pair"] += pairs * MANY * costs.single
            continue
        if t.category == "kspace":
            parts["Kspace"] = parts.get("Kspace", 0.0) + of_solver(t, n, costs)
            continue
        each = costs.formula(p.function for p in t.style.parts)
        if isinstance(t, PairTerm):
            parts["Pair"] += pairs * each * (0.7 if t.single else 1.0)
        elif isinstance(t, PairRowsTerm) or (isinstance(t, PairListTerm) and t.pairs == "all"):
            parts["Pair"] += pairs * (costs.single + max(0.0, each - costs.pair))
        elif isinstance(t, PairListTerm):
            count = len(e.exclusions.weighted) if t.pairs == "special" else len(getattr(t, "one_four", ((),))[0])
            parts["Pair"] += count * (costs.single + max(0.0, each - costs.pair))
    steps = between_builds(e, dt) if moving else math.inf
    parts["Neigh"] = (pairs * costs.build + n * costs.atom) / steps
    parts["Modify"] = costs.step + n * costs.atom + python * PYTHON
    parts["Output"] = rows * (costs.row + parts["Pair"] + parts["Bond"])
    return Speed(parts, steps)
