r"""Are atoms closer than they can ever come, and are the first forces so large that they throw atoms out?

Two atoms at 25 :math:`k_B T` above zero of their pair energy do not get there by themselves: somebody put them there.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check import pairs
from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

HIGH, HUGE = 25.0, 1e4      # kT
JUMP = 0.2                  # of the distance between neighbours, that a force may move an atom in one step
SAME = 1e-4                 # of the cutoff: atoms in one place
WAYS = ("minimize first, or run a few hundred steps with fix nve/limit and a soft pair style (see the workflow polymer-melt); "
        "look also for atoms twice in the data file and for the periodic box")
ONE_PLACE = 1e-10           # of the cutoff: no force tells in which direction atoms should part
APART = ("delete one of the two (delete_atoms overlap), or move one (displace_atoms): neither minimize nor fix nve/limit takes apart "
         "atoms in one place; look also for atoms twice in the data file and for the periodic box")


@static("overlaps")
def overlaps(case: Case) -> list[Finding]:
    name, e = "overlaps", case.engine
    if not e.pair_terms:
        raise DoesNotApply(pairs.why_none(case))
    why = pairs.can_list(case)
    if why is not None:
        raise DoesNotApply(str(why))
    kt = case.units.boltz * case.temperature
    walls = pairs.wall(case, (HIGH * kt, HUGE * kt))
    n = case.system.counts["ntypes"] + 1
    limit = np.zeros((2, n, n))
    for (i, j), (near, inside) in walls.items():
        limit[:, i, j] = limit[:, j, i] = near, inside
    found, r, kinds = pairs.close_pairs(case, max(float(limit[0].max()), SAME * e.cutoff) * 1.0001)
    found, r = found[kinds == 0], r[kinds == 0]        # bonded atoms are looked at by the check of exclusions
    a, b = case.system.type[found[:, 0]], case.system.type[found[:, 1]]
    close = np.flatnonzero((r < limit[0, a, b]) | (r < SAME * e.cutoff))
    if not len(close):
        return [Finding("ok", name, "No pair of atoms is closer than a collision brings it.", limit=f"{HIGH:g} kT")]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = r[close] / limit[0, a[close], b[close]]
    worst = close[int(np.argmin(np.nan_to_num(ratio, nan=0.0)))]
    i, j = sorted(case.ids(found[worst]))
    energy = pairs.interaction(case, int(a[worst]), int(b[worst]))(float(r[worst]))[0] if r[worst] > 0.0 else math.inf
    deep = bool((r[close] < limit[1, a[close], b[close]]).any()) or r[worst] < SAME * e.cutoff
    stuck = r[worst] < ONE_PLACE * e.cutoff
    severity = "error" if stuck else "note" if case.gentle else "error" if deep else "warning"
    closest = float(limit[0, a[worst], b[worst]])
    ids = list(dict.fromkeys(int(k) for row in close[np.argsort(r[close])][:8] for k in case.ids(found[row])))
    text = (f"{len(close)} pair{'s' * (len(close) > 1)} of atoms overlap{'s' * (len(close) == 1)}, the worst {i}-{j} at distance "
            f"{r[worst]:.4g}" + (f" where their energy is {energy / kt:.3g} kT" if math.isfinite(energy) else "")
            + (f" ({HIGH:g} kT is at {closest:.4g})" if closest > 0.0 else "") + ".")
    if case.relaxes:
        text += " The script minimises first."
    advice = APART if stuck else "" if case.gentle else WAYS
    return [Finding(severity, name, text, ids, float(r[worst]), closest or SAME * e.cutoff, advice)]


@static("first step")
def first_step(case: Case) -> list[Finding]:
    """How far the first forces move an atom in one step: the sum of everything, bonded forces too."""
    name = "first step"
    if case.result is None and any(use.style.stirred for use in case.interactions.uses["pair"]):
        raise DoesNotApply("forces of friction and noise are those of a run")
    if case.result is None:
        severity = "note" if case.relaxes else "error"
        return [Finding(severity, name, f"There are no forces: {case.failure}.", advice="nothing can run before this is mended")]
    if not case.dt:
        raise DoesNotApply("no timestep")
    dt = min((m.dt for m in case.motions), default=abs(case.dt))
    f = case.forces
    way = np.where(case.moving, np.linalg.norm(f, axis=1) * case.units.ftm2v / case.masses * dt * dt, 0.0)
    limit = JUMP * case.spacing
    worst = int(np.argmax(way))
    value = float(way[worst])
    ids = case.ids(np.argsort(-way)[:5])
    if value > limit:
        return [Finding("note" if case.gentle else "error" if value > 10.0 * limit else "warning", name, f"The force on atom {ids[0]} "
                        f"({np.linalg.norm(f[worst]):.3g}) moves it by {value:.3g} in a single step.", ids, value, limit,
                        "" if case.gentle else "relax the structure first (minimize, fix nve/limit), or start with a shorter timestep")]
    return [Finding("ok", name, f"The largest force moves atom {ids[0]} by {value:.3g} in a step.", ids[:1], value, limit)]
