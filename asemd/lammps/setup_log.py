"""What the log says when a scene is made ready: partners of bonded atoms, mixed coefficients, the neighbour list.

Same lines and numbers as in LAMMPS's logs, as far as there is such a thing here: no ghost atoms, bins, or stencils.
"""
from __future__ import annotations

import time

import numpy as np

from asemd import units as unit_styles
from asemd.cluster_term import in_double
from asemd.errors import InputError
from asemd.kspace import NEUTRAL, solve
from asemd.pairing import complete
from asemd.topology import Topology


def report_special(session) -> None:
    """Which atoms are one, two and three bonds apart; nothing for atoms without bonds."""
    scene = session.scene
    system, interactions = scene.system, scene.interactions
    if session.passive or not system.molecular:
        return
    started = time.perf_counter()
    kinds = listed(interactions)
    topology = system.topology.frozen if isinstance(system.topology.frozen, Topology) else system.topology
    lines = ["Finding 1-2 1-3 1-4 neighbors ...", f"  special bond factors lj:    {_row(interactions.special_lj)}",
             f"  special bond factors coul:  {_row(interactions.special_coul)}"]
    counts = walks(topology, system.n)
    lines += [f"{int(counts[k].max(initial=0)):>6} = max # of 1-{k + 2} neighbors" for k in range(kinds)]
    flags = interactions.special_angle and kinds > 1, interactions.special_dihedral and kinds > 2
    if any(flags):
        lines += _trimmed(topology, system.n, *flags)
    pairs, kind = interactions.special_pairs(system)
    each = np.bincount(pairs[kind <= kinds].ravel(), minlength=1)
    scene.max_special = max(scene.max_special, int(each.max())) + scene.special_room
    scene.special_room = 0
    lines += [f"{scene.max_special:>6} = max # of special neighbors", f"  special bonds CPU = {time.perf_counter() - started:.3f} seconds"]
    session.print("\n".join(lines))


def listed(interactions) -> int:
    """How many of the kinds 1-2, 1-3, 1-4 are of interest: the last ones only if their pairs do not interact as all others do."""
    ordinary = [lj == coul == 1.0 for lj, coul in zip(interactions.special_lj, interactions.special_coul, strict=True)]
    return 3 if not ordinary[2] else 2 if not ordinary[1] else 1


def walks(topology: Topology, n: int) -> np.ndarray:
    """(3, n) ways of one, two and three bonds from each atom, as LAMMPS counts them: not back with the second bond, but with the third."""
    first, both = topology.partners(n)
    near, far = both.T
    one = np.diff(first)
    two = np.bincount(near, one[far] - 1, n)
    three = np.bincount(near, np.bincount(near, one[far], n)[far] - one[near], n)
    return np.array([one, two, three]).astype(np.int64)


def _trimmed(topology: Topology, n: int, angle: bool, dihedral: bool) -> list[str]:
    """How many partners ``special_bonds angle yes`` and ``dihedral yes`` leave, both directions counted."""
    first, both = topology.partners(n)
    lines, ends = [], both
    for name, wanted in (("1-3", angle), ("1-4", dihedral)):
        count = np.diff(first)[ends[:, 1]]
        row = np.repeat(np.arange(len(ends)), count)
        at = np.repeat(first[ends[:, 1]], count) + np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        ends = np.column_stack([ends[row, 0], both[at, 1]])
        ends = np.unique(ends[ends[:, 0] != ends[:, 1]], axis=0)
        if wanted:
            a, d = topology.angles, topology.dihedrals
            given = np.concatenate([a[:, [0, 2]], d[:, [0, 2]], d[:, [1, 3]]] if name == "1-3" else [d[:, [0, 3]]]).astype(np.int64)
            keys = np.append(given @ (n, 1), given @ (1, n))
            left, what = int(np.isin(ends @ (n, 1), keys).sum()), name.replace("1-", "")
            kind = "angle" if what == "3" else "dihedral"
            lines += [f"  {len(ends)} = # of {name} neighbors before {kind} trim", f"  {left} = # of {name} neighbors after {kind} trim"]
    return lines


def _row(factors) -> str:
    return " ".join(f"{f:<8.10g}" for f in factors)


def report_mixing(session, command: str = "") -> None:
    """How many coefficients of unlike types follow from a mixing rule; `command` is one that makes the scene ready by itself."""
    if command:
        session.print(f"System init for {command} ...")
    scene = session.scene
    uses, n = scene.interactions.uses["pair"], scene.system.counts["ntypes"]
    if session.passive or not uses:
        return
    try:
        terms = complete(scene.interactions, n)
        solver = solve(scene.system, scene.interactions, unit_styles.get(scene.system.units), scene.neighbor.skin)
    except InputError:      # what is missing is told when a run needs it
        return
    if solver is not None and (lines := solver.lines()):
        charge = solver.qsum if solver.coulomb else 0.0
        session.print(lines[0])
        if abs(charge) > NEUTRAL and not session.told_charge:
            session.warn(f"System is not charge neutral, net charge = {charge:.8g}")
            session.told_charge = True
        if lines[1:]:
            session.print("\n".join(lines[1:]))
    if any(use.style.many for use in uses):
        return
    mixed = sum(pair not in use.coeff for use, filled in terms if _mixes_energies(use.style) for pair in filled)
    rules = [use.modify["mix"] for use in uses if "mix" in use.modify]
    rule = (rules or [scene.interactions.mix or ("geometric" if scene.interactions.hybrid["pair"] else uses[0].style.mix_rule)])[-1]
    if uses[0].style.name.startswith("lj/class2") and not scene.interactions.hybrid["pair"]:
        rule = f"sixthpower/{rule}"
    session.print(f"Generated {mixed} of {n * (n - 1) // 2} mixed pair_coeff terms from {rule} mixing rule")


def _mixes_energies(style) -> bool:
    """LAMMPS does not count where only lengths are mixed."""
    return any(how not in ("distance", "geometric") for how in style.mix.values())


def report_list(session, engine) -> None:
    """The neighbour list, where it is another one than before, and what fixes told meanwhile."""
    if engine.mode != "none":
        _report_list(session, engine)
        _report_precision(session, engine)
    for line in session.later:
        session.print(line)
    session.later.clear()


def _report_list(session, engine) -> None:
    scene = session.scene
    s = scene.neighbor
    full = any(not getattr(t.style, "half_list", False) for t in engine.many_terms)
    ghost = ", ghost" if any(getattr(t.style, "ghost_list", False) for t in engine.many_terms) else ""
    text = "\n".join([
        "Neighbor list info ...",
        f"  update: every = {s.every} steps, delay = {s.delay} steps, check = {'yes' if s.check else 'no'}",
        f"  master list distance cutoff = {engine.reach:.8g}",
        "  1 neighbor lists, perpetual/occasional/extra = 1 0 0",
        f"  (1) pair {scene.interactions.style_name('pair')}, perpetual",
        f"      attributes: {'full' if full else 'half'}, newton {'on' if scene.newton[0] else 'off'}{ghost}",
        f"      pair build: {engine.mode}"])
    if text != session.list_told:
        session.list_told = text
        session.print(text)


def _report_precision(session, engine) -> None:
    """Mixed precision that is asked for in vain, once."""
    names, why = in_double(engine) if engine.settings.precision == "mixed" else ([], "")
    text = f"mixed precision: pair style {', '.join(names)} stays in double precision ({why})"
    if names and text != session.precision_told:
        session.precision_told = text
        session.log.warn(text)


def partners_per_atom(session) -> float:
    """Mean number of atoms one, two and three bonds apart."""
    scene = session.scene
    system, interactions = scene.system, scene.interactions
    known = (system.topology, interactions.special_line())
    if session.partners_told is None or session.partners_told[0][0] is not known[0] or session.partners_told[0][1] != known[1]:
        _, kind = interactions.special_pairs(system)
        session.partners_told = known, 2.0 * float((kind <= listed(interactions)).sum())
    return session.partners_told[1] / max(system.n, 1)
