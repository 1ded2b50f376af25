r"""Do pair energies and forces end with a jump at their cutoff?

Forces know nothing of a jump of the energy, so atoms that cross the cutoff change the total energy by it; minimisation stumbles over it and
the pressure lacks its share. Across a jump of the force velocity Verlet is not of second order any more. Judged by :math:`k_B T`, that of
the force over the distance of neighbours.

Source: S. Toxvaerd, J. C. Dyre, J. Chem. Phys. 134, 081102 (2011), for what jumps of energy and force do.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check import pairs
from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

ENERGY = (0.1, 0.25)        # kT: note, warning
FORCE = (0.5, 2.0)          # kT per distance of neighbours
BESIDE = 1e-9               # of the cutoff
SHIFT = ("pair_modify shift yes takes the jump of the energy away (that of the force stays); a pair style that is switched to zero, or a "
         "longer cutoff, both")
LONGER = "a pair style that is switched to zero (lj/charmm/coul/charmm), or a longer cutoff"
CHARGED = ("charges that end at a cutoff heat the run and order the liquid around it: use a style that is switched or shifted to zero "
           "(lj/charmm/coul/charmm, lj/charmmfsw/coul/charmmfsh)")


@static("jump at the cutoff")
def jump_at_the_cutoff(case: Case) -> list[Finding]:
    name, kt, worst = "jump at the cutoff", case.units.boltz * case.temperature, (-1.0,)
    if not case.engine.pair_terms or not pairs.tabled(case):
        none = "no pair forces that depend on the distance alone"
        raise DoesNotApply(pairs.why_none(case) if case.engine.many_terms and not case.engine.pair_terms else none)
    q = _charges(case)
    for i, j in pairs.type_pairs(case):
        qq = q[i] * q[j]
        of = pairs.interaction(case, i, j, 0, qq)
        for cut in pairs.cutoffs(case, i, j):
            energy, force = (_difference(a, b) for a, b in zip(of(cut * (1.0 - BESIDE)), of(cut * (1.0 + BESIDE)), strict=True))
            size = max(energy / kt / ENERGY[1], force * case.spacing / kt / FORCE[1])
            if size > worst[0]:
                worst = size, energy / kt, force * case.spacing / kt, i, j, cut, qq
    if worst[0] < 0.0:
        raise DoesNotApply("no pair forces")
    _, energy, force, i, j, cut, qq = worst
    if energy <= ENERGY[0] and force <= FORCE[0]:
        return [Finding("ok", name, f"Pair energies end smoothly enough: the largest jump is {energy:.2g} kT.", value=f"{energy:.2g} kT",
                        limit=f"{ENERGY[1]:g} kT")]
    severity = "warning" if energy > ENERGY[1] or force > FORCE[1] else "note"
    of_force = f"{force:.2g} kT over the distance of neighbours"
    if energy > ENERGY[0]:
        text = f"At the cutoff {cut:.4g} the pair energy of types {i} and {j} jumps by {energy:.2g} kT, and the force by {of_force}."
        advice = CHARGED if _of_charges(case, i, j, cut, qq) else SHIFT
        return [Finding(severity, name, text, value=f"{energy:.2g} kT", limit=f"{ENERGY[1]:g} kT", advice=advice)]
    text = f"At the cutoff {cut:.4g} the pair energy of types {i} and {j} does not jump, but the force does, by {of_force}."
    return [Finding(severity, name, text, value=f"{force:.2g} kT", limit=f"{FORCE[1]:g} kT", advice=LONGER)]


def _difference(inside: float, outside: float) -> float:
    """0 where there is no number: other checks tell of that."""
    return abs(inside - outside) if math.isfinite(inside - outside) else 0.0


def _charges(case: Case) -> dict[int, float]:
    """Typical charge of each type, so that the product of two is an energy times a distance."""
    kinds, q = np.unique(case.system.type), case.system.q
    if q is None:
        return dict.fromkeys((int(t) for t in kinds), 0.0)
    root = math.sqrt(case.units.qqr2e / case.interactions.dielectric)
    out = {}
    for kind in kinds:
        mine = q[case.system.type == kind]
        out[int(kind)] = root * math.copysign(float(np.abs(mine).mean()), float(mine.mean()))
    return out


def _of_charges(case: Case, i: int, j: int, cut: float, qq: float) -> bool:
    """Whether most of a jump is that of charges."""
    def jump(product: float) -> float:
        of = pairs.interaction(case, i, j, 0, product)
        return _difference(of(cut * (1.0 - BESIDE))[0], of(cut * (1.0 + BESIDE))[0])
    return bool(qq) and jump(0.0) < 0.5 * jump(qq)
