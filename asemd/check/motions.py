r"""The motions of a scene that are fast by themselves: each bonded style and type, and collisions of pairs.

Collisions take the curvature of the pair energy where it is one :math:`k_B T` above zero, with the reduced mass of the two atoms.
"""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asemd.check import pairs

CONTACT = 1.25              # of the distance of a collision: closer pairs are taken to meet
ORDINARY = {"lj": 1.0}      # a temperature for scenes without one; 300 K in other units


@dataclass
class Motion:
    """One kind of motion.

    Attributes
    ----------
    label : str
        ``bond type 2 (harmonic)``, ``collisions of types 1 and 1``.
    omega : float
        Typical frequency (the median of its items), 1/time of the scene.
    fastest : float
        That of the stiffest item as it is now.
    atoms : tuple of int
        Ids of the stiffest item; of a collision none.
    dt : float
        The timestep with which its forces act: of its level under r-RESPA. nan: not known.
    """

    label: str
    omega: float
    fastest: float
    atoms: tuple[int, ...]
    dt: float

    @property
    def period(self) -> float:
        """Typical period."""
        return 2.0 * math.pi / self.omega


def temperature(case) -> float:
    """The highest temperature in sight: of the velocities, of thermostats; an ordinary one if there is none."""
    u, system, found = case.units, case.system, []
    for fix in case.fixes.values():
        found += [float(t) for t in (getattr(fix, "start", None), getattr(fix, "stop", None)) if hasattr(fix, "damping") and _number(t)]
    twice = u.mvv2e * float((case.masses[:, None] * system.v**2).sum())
    now = twice / (u.boltz * system.dimension * max(system.n - 1, 1))
    if math.isfinite(now):
        found.append(now)
    best = max(found, default=0.0)
    return best if best > 0.0 else ORDINARY.get(u.name, 300.0)


def _number(value) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value)


def level_dt(case, category: str) -> float:
    """The timestep with which forces of a category act."""
    if not case.dt:
        return math.nan
    if case.respa is None:
        return abs(case.dt)
    levels = case.respa
    at = levels.level.get(category)
    if at is None and category == "pair":
        at = levels.level.get("inner", min(levels.hybrid, default=levels.n))
    return levels.steps(abs(case.dt))[(at or levels.n) - 1]


def motions(case) -> list[Motion]:
    """All kinds of motion, the one that asks for the shortest timestep first."""
    out = [m for items in case.items for m in _bonded(case, items)] + _collisions(case)
    return sorted(out, key=lambda m: -m.omega * (m.dt if math.isfinite(m.dt) else 1.0))


def _bonded(case, items) -> list[Motion]:
    """By type, and by the masses of its atoms."""
    free = case.vibrates(items.category, items.atoms)
    masses = case.masses[items.atoms]
    ends = np.minimum(masses, masses[:, ::-1])      # an item and its mirror image are alike
    keys = np.column_stack([items.types, ends])[free]
    out, rows = [], np.flatnonzero(free)
    _, which = np.unique(keys, axis=0, return_inverse=True)
    which = which.ravel()
    order = np.argsort(which, kind="stable")
    for mine in np.split(rows[order], np.flatnonzero(np.diff(which[order])) + 1):
        omega = items.omega[mine]
        typical = float(np.median(omega)) if len(mine) else 0.0
        if typical > 0.0:
            worst = mine[int(np.argmax(omega))]
            out.append(Motion(f"{items.category} type {items.types[worst]} ({items.style.name})", typical, float(omega.max()),
                              case.ids(items.atoms[worst]), level_dt(case, items.category)))
    return out


def _collisions(case) -> list[Motion]:
    u, system, out = case.units, case.system, []
    kt = u.boltz * temperature(case)
    lightest = {int(t): float(case.masses[system.type == t].min()) for t in np.unique(system.type)} if case.engine.pair_terms else {}
    walls = {key: r for key, (r,) in pairs.wall(case, (kt,)).items() if r > 0.0} if lightest else {}
    meet = _meeting(case, walls)
    alone = {int(t) for t, n in zip(*np.unique(system.type, return_counts=True)) if n == 1}
    for (i, j), r in walls.items():
        if (i, j) in meet and not (i == j and i in alone):
            stiff = pairs.curvature(pairs.interaction(case, i, j), r)
            omega2 = stiff * (1.0 / lightest[i] + 1.0 / lightest[j]) * u.ftm2v
            if omega2 > 0.0 and math.isfinite(omega2):
                omega = math.sqrt(omega2)
                out.append(Motion(f"collisions of types {i} and {j}", omega, omega, (), level_dt(case, "pair")))
    return out


def _meeting(case, walls) -> set[tuple[int, int]]:
    """Pairs of types that collide: those that are near contact now, and those without bonds, which nothing can shield.

    Hydrogens of water have a tiny core inside that of their oxygen, which no other atom reaches.
    """
    system = case.system
    bonded = np.unique(system.type[system.topology.bonds.ravel()]) if len(system.topology.bonds) else np.zeros(0, int)
    out = {key for key in walls if not np.isin(key, bonded).all()}
    rest = [key for key in walls if key not in out]
    if rest and pairs.can_list(case) is None:
        n = system.counts["ntypes"] + 1
        limit = np.zeros((n, n))
        for i, j in rest:
            limit[i, j] = limit[j, i] = CONTACT * walls[i, j]
        near, r, kinds = pairs.close_pairs(case, float(limit.max()))
        a, b = system.type[near[:, 0]], system.type[near[:, 1]]
        touching = (r < limit[a, b]) & (kinds == 0)
        out |= {(int(min(p)), int(max(p))) for p in np.unique(np.column_stack([a, b])[touching], axis=0)} & set(rest)
    return out
