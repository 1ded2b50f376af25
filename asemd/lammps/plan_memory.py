"""What a run of a scene holds in memory, from the sizes of its arrays; nothing is allocated."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asemd.cluster_term import PairTerm
from asemd.embedded_term import EmbeddedTerm
from asemd.engine import Engine
from asemd.kernels.cluster import CLUSTER
from asemd.manybody_term import ManyBodyTerm
from asemd.term import BondedTerm, PairListTerm, PairRowsTerm


@dataclass
class Holding:
    """Some arrays: what they are, how many bytes, and what needs them."""

    name: str
    bytes: float
    what: str
    why: str


def pairs_around(e: Engine) -> float:
    """Expected entries of the half list per atom, from the density."""
    s = e.system
    density = s.n / max(s.box.volume, 1e-300)
    ball = 4.0 / 3.0 * math.pi * e.reach**3 if s.dimension == 3 else math.pi * e.reach**2 * s.box.lengths[2]
    full = density * ball
    if not e.periodic.all():
        full = min(full, max(s.n - 1.0, 0.0))
    return 0.5 * full


def slots(e: Engine) -> int:
    """Places for atoms in the sorted arrays: columns of clusters are padded."""
    n = e.system.n
    if e.mode != "cluster":
        return n + 8
    wa, wb, wc = 1.0 / np.linalg.norm(np.linalg.inv(e.vectors), axis=0)
    share = CLUSTER / max(n, 1)
    h = max((share * abs(float(np.linalg.det(e.vectors)))) ** (1 / 3), *((share * u * v) ** 0.5 for u, v in ((wa, wb), (wb, wc), (wc, wa))),
            share * max(wa, wb, wc))
    return n + max(1, round(wa / h)) * max(1, round(wb / h)) * CLUSTER + 2 * CLUSTER


def size(*things) -> float:
    """Bytes of the arrays among `things` and in their attributes."""
    total, seen = 0.0, set()
    for thing in things:
        values = thing if isinstance(thing, (list, tuple)) else [thing] if isinstance(thing, np.ndarray) else \
            list(vars(thing).values()) if hasattr(thing, "__dict__") else []
        for v in values:
            if isinstance(v, np.ndarray) and id(v) not in seen:
                seen.add(id(v))
                total += v.nbytes
            elif isinstance(v, (list, tuple)) and v and all(isinstance(a, np.ndarray) for a in v):
                total += size(list(v))
    return total


def holdings(e: Engine, per_atom: bool = False) -> list[Holding]:
    """Everything that grows with the scene, the largest first; `per_atom`: with energies and virials of single atoms."""
    s, n, threads = e.system, e.system.n, e.threads
    cap, pairs = slots(e), pairs_around(e) * e.system.n
    charges = s.has_charge
    out = [Holding("atoms", size(s) + size(list(s.extra.values())), "id type x image v f" + " q" * charges, "the atom style"),
           Holding("sorted atoms", cap * (116 + 24 * threads), f"{cap} places, forces for each thread", "compiled code works on these"),
           Holding("constants by atom", 52.0 * n, "type, mass, charge, groups, molecule", "each list copies them into the sorted arrays"),
           Holding("frames to go back to", 104.0 * cap + 24.0 * n, "the last two good states", "the watchdog of a run")]
    if s.topology is not None and not s.topology.is_empty:
        items = ", ".join(f"{m} {k}s" for k, m in s.topology.counts().items() if m)
        out.append(Holding("topology", size(s.topology), items, "the data file"))
    if e.mode == "cluster":
        around = min(float(n), 2.0 * pairs_around(e))
        marked = e.settings.outdated or e.sparse
        entries = (cap / CLUSTER * (1.5 * around + 64) + 1024 * threads) * (5 if marked else 4)
        pruned = sum(isinstance(t, PairTerm) and t.prunes(e) for t in e.terms)
        room = cap * (62 + 5 * threads) + 74e3 * threads
        out.append(Holding("neighbour list", entries * (1 + pruned) + room, f"about {pairs:.3g} pairs, in clusters", "pair_style"))
    if e.mode == "plain" or e.expanded or e.sparse:
        held = 4.0 * pairs * (1 + len(e.rows)) if e.sparse else 12.0 * pairs if e.expanded else 12.0 * _power(pairs)
        out.append(Holding("pairs one by one", held, f"about {pairs:.3g} pairs", e.why if e.mode == "plain" else "pair_style"))
    for t in e.terms:
        if t.category == "kspace":
            out.append(Holding(f"k-space {t.solver.style}", *_of_solver(t, cap, threads), "kspace_style"))
        elif isinstance(t, PairTerm):
            out.append(Holding(f"pair {t.style.name}", ((64.0 if t.owner.is_plain else 88.0) * cap + 47e3) * threads,
                               "positions and forces by cluster", "pair_style"))
        elif isinstance(t, PairRowsTerm) and not t.owner.is_plain:
            out.append(Holding(f"pair {t.style.name}", 24.0 * cap * threads, "forces before their factor", "pair_style"))
        elif isinstance(t, EmbeddedTerm):
            out.append(Holding(f"pair {t.style.name}", (72.0 if t.owner.is_plain else 96.0) * threads * cap + 6.0 * pairs,
                               "positions, densities and forces by cluster, pairs in reach", "pair_style"))
        elif isinstance(t, ManyBodyTerm):
            out.append(Holding(f"pair {t.style.name}", 24.0 * cap + 10.0 * pairs, "rows of all neighbours", "pair_style"))
        elif isinstance(t, BondedTerm):
            m, k = t.items.shape
            out.append(Holding(f"{t.category} {t.style.name}", m * (8.0 * k + 12.0) + 4.0 * n, f"{m} {t.category}s in order of the atoms",
                               f"{t.category}_style"))
        elif isinstance(t, PairListTerm) and t.pairs == "special":
            out.append(Holding(f"pair {t.style.name} (special)", 12.0 * len(e.exclusions.weighted), f"{len(e.exclusions.weighted)} pairs",
                               "special_bonds"))
    x = e.exclusions
    if x.partners is not None:
        held = size(list(x.partners), x.weighted, x.weighted_kinds) + size([x.pairs, x.kinds])
        out.append(Holding("bonded partners", held, "pairs with another factor", "special_bonds"))
        if e.mode == "cluster" and not (e.expanded or e.sparse):
            out.append(Holding("excluded partners", 4.0 * _power(len(x.partners[1]) / 2.0), "those near each cluster", "special_bonds"))
    if per_atom:
        out.append(Holding("energy and virial by atom", 56.0 * (threads + 1) * cap, "", "a compute or dump asks for them"))
    return sorted(out, key=lambda h: -h.bytes)


def _of_solver(t, cap: int, threads: int) -> tuple[float, str]:
    """Bytes of a long-range solver without shares of atoms, and what they are."""
    mesh = getattr(t, "mesh", getattr(t.solver, "mesh", None))
    if mesh is not None:
        points, fields = math.prod(mesh), 1 if getattr(t.solver, "ad", True) else 3
        weights = cap * (24.0 + 64.0 * (6 if fields == 1 else 3))
        return points * (8.0 * threads + 32.0 + 24.0 * fields) + weights, f"{points} points of a mesh"
    waves = getattr(t.solver, "waves", None)
    waves = len(t.solver.numbers) if waves is None else waves
    most = int(np.max(t.solver.most)) if hasattr(t.solver, "most") else 8
    return waves * (104.0 + 16.0 * threads) + 48.0 * (1 + most) * cap, f"{waves} waves"


def _power(n: float) -> float:
    """Room that is doubled from 64 on until it is enough."""
    return 64.0 * 2.0 ** max(0, math.ceil(math.log2(max(n, 1.0) / 64.0)))
