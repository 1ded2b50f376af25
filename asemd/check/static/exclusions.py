"""Do bonded atoms repel each other as if they were strangers? Then exclusions (special_bonds) are missing: bonds fight the pair force."""
from __future__ import annotations

import numpy as np

from asemd.check import pairs
from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.exclusions import replaced_pairs
from asemd.finding import Finding

HIGH = {1: 5.0, 2: 10.0, 3: 25.0}      # kT of the weighted pair energy, by kind
WORDS = {1: "bonded", 2: "1-3", 3: "1-4"}


@static("exclusions")
def exclusions(case: Case) -> list[Finding]:
    name, e, system = "exclusions", case.engine, case.system
    if not len(system.topology.bonds):
        raise DoesNotApply("no bonds")
    if not e.pair_terms:
        raise DoesNotApply(pairs.why_none(case))
    kt = case.units.boltz * case.temperature
    special, kinds = case.interactions.special_pairs(system)
    replaced = {tuple(sorted(map(int, p))) for p in replaced_pairs(system, case.interactions)}
    if any(use.settings.get("overlay/pair") for use in case.interactions.uses["bond"]):
        raise DoesNotApply("bonds lie over the pair force on purpose")
    found, weights = [], e.exclusions.weight_lj
    for kind, high in HIGH.items():
        mine = _listed(case, special[kinds == kind])
        if replaced and kind == 1:
            mine = np.array([p for p in mine if tuple(sorted(map(int, p))) not in replaced]).reshape(-1, 2)
        if not len(mine):
            continue
        walls = pairs.wall(case, (high * kt,), kind)
        n = system.counts["ntypes"] + 1
        limit = np.zeros((n, n))
        for (i, j), (r,) in walls.items():
            limit[i, j] = limit[j, i] = r
        r = np.linalg.norm(system.box.minimum_image(system.x[mine[:, 0]] - system.x[mine[:, 1]])[0], axis=1)
        near = limit[system.type[mine[:, 0]], system.type[mine[:, 1]]]
        bad = np.flatnonzero(r < near)
        if len(bad) and 2 * len(bad) > int((near > 0.0).sum()):
            worst = bad[int(np.argmin(r[bad] / near[bad]))]
            i, j = case.ids(mine[worst])
            energy = pairs.interaction(case, *map(int, system.type[mine[worst]]), kind)(r[worst])[0]
            text = (f"{len(bad)} of {len(mine)} {WORDS[kind]} pairs sit high in their pair energy, such as {i}-{j} at distance "
                    f"{r[worst]:.4g} with {energy / kt:.3g} kT: the factor of special_bonds for them is {weights[kind]:g}.")
            found.append(Finding("warning", name, text, (i, j), float(r[worst]), float(near[worst]), _advice(case, kind)))
    return found or [Finding("ok", name, "No bonded atoms are high in their pair energy.")]


def _listed(case: Case, among: np.ndarray) -> np.ndarray:
    """The pairs of rows that ``neigh_modify exclude`` leaves in the list."""
    i, j = among[:, 0], among[:, 1]
    keep = np.ones(len(among), bool)
    for kind, *masks in case.settings.exclude:
        if kind == "group":
            a, b = masks
            keep &= ~((a[i] & b[j]) | (a[j] & b[i]))
        elif kind == "molecule/intra":
            keep &= ~(masks[0][i] & masks[0][j] & (case.system.molecule[i] == case.system.molecule[j]))
    return among[keep]


def _advice(case: Case, kind: int) -> str:
    if kind == 1 and case.interactions.style_name("bond") == "fene":
        return "special_bonds fene: the bond style has the repulsion of its atoms already"
    wanted = "lj/coul 0.0 1.0 1.0" if kind == 1 else "lj/coul 0.0 0.0 1.0" if kind == 2 else "lj/coul 0.0 0.0 0.0"
    return f"special_bonds {wanted}, or what the force field says (amber, charmm, dreiding)"
