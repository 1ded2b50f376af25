r"""The multiple time step integrator r-RESPA: fast forces on short steps, slow forces on long ones.

Level 1 is the innermost one. Every level kicks the velocities by its own forces with its own step; the innermost one moves the atoms:

.. math:: \Delta t_{l-1} = \Delta t_l / n_l, \qquad \Delta t_N = \Delta t

The pair force may be split by distance into an inner, a middle and an outer piece. Between two limits `a < b` a piece goes over into the
next one with :math:`s = t^2 (3 - 2 t)`, :math:`t = (r - a) / (b - a)`. Energy and virial are those of the whole force.

Source: M. Tuckerman, B. J. Berne, G. J. Martyna, J. Chem. Phys. 97, 1990 (1992); LAMMPS manual, run_style.
"""
from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np

from asemd.cluster_term import PairTerm
from asemd.errors import InputError, SimulationError
from asemd.kernels import timeloop as tl
from asemd.kernels.box import corner_moves
from asemd.kernels.hooks import Calls, bound
from asemd.kernels.state import Thread
from asemd.loop import Loop
from asemd.respa_pieces import ShortClusterTerm, ShortListTerm
from asemd.term import PairListTerm, PairRowsTerm, look, rewind

FORCES = ("bond", "angle", "dihedral", "improper", "pair", "kspace")
PIECES = ("inner", "middle", "outer")
SHORT = 0.9         # pieces that end before this part of the reach have a list of their own


@dataclass
class Levels:
    """How often each level acts, and where each kind of force is.

    Parameters
    ----------
    factors : list of int
        How many steps of a level make one of the next, from the innermost on; one less than there are levels.
    level : dict of str to int
        ``bond angle dihedral improper kspace``, and ``pair`` or ``inner [middle] outer`` -> level, from 1.
    cuts : (4,) tuple of float
        Where the inner piece begins and has come to its end, then the same for the piece before the outer one (distance units).
    hybrid : list of int
        Instead of ``pair``: the level of each sub-style of pair_style hybrid.
    """

    factors: list[int]
    level: dict[str, int] = field(default_factory=dict)
    cuts: tuple[float, ...] = ()
    hybrid: list[int] = field(default_factory=list)

    @property
    def n(self) -> int:
        """Number of levels."""
        return len(self.factors) + 1

    def steps(self, dt: float) -> list[float]:
        """The time step of each level, innermost first, for the outermost step `dt`."""
        out = [dt]
        for factor in reversed(self.factors):
            out.insert(0, out[0] / factor)
        return out

    def forces(self, level: int) -> list[str]:
        """What acts on a level, in LAMMPS's words."""
        names = {**{kind: kind for kind in FORCES[:5]}, **{piece: f"pair-{piece}" for piece in PIECES}}
        out = [name for kind, name in names.items() if self.level.get(kind) == level]
        return out + [f"hybrid-{k}" for k, at in enumerate(self.hybrid, 1) if at == level] + ["kspace"] * (self.level["kspace"] == level)

    def check(self, interactions, pair_terms) -> None:
        """Whether these interactions can have these levels.

        Raises
        ------
        InputError
            A pair style whose force cannot be split, or is cut off too early; another number of sub-styles; 1-4 pairs of dihedrals on
            another level than the rest of the pair forces.
        """
        what, pairs = "run_style respa", interactions.uses["pair"]
        if self.hybrid and not (interactions.hybrid["pair"] and len(pairs) == len(self.hybrid)):
            raise InputError(f"{what} hybrid has levels of {len(self.hybrid)} sub-styles, but pair_style changed: give run_style again")
        if "inner" in self.level:
            for use in pairs:
                if not use.style.splits:
                    raise InputError(f"{what}: pair style {use.style.name} does not support inner, middle and outer: put its force on one "
                                     "level, with the keyword pair or hybrid")
            for t in pair_terms:
                for (i, j), coeff in t.filled.items():
                    shortest = min(t.style.cutoffs(coeff, t.use.settings))
                    if shortest < self.cuts[3]:
                        raise InputError(f"{what}: the cutoff {shortest:g} of pair style {t.style.name}, types {i} {j}, is below the limit "
                                         f"{self.cuts[3]:g} of the {'middle' if 'middle' in self.level else 'inner'} forces")
        for use in interactions.uses["dihedral"]:
            weight = use.style.weight_14
            if weight and any(c.get(weight) for c in use.coeff.values()):
                for kind in ("pair", "outer"):
                    if self.level.get(kind, self.level["dihedral"]) != self.level["dihedral"]:
                        raise InputError(f"{what}: dihedral style {use.style.name} must be set to same r-RESPA level as {kind!r}, for its "
                                         "1-4 pairs are pair forces")


class RespaLoop(Loop):
    """A `Loop` whose steps have levels.

    Parameters
    ----------
    levels : Levels
    others
        As `Loop`.

    Raises
    ------
    InputError
        A fix that does not know levels, or what `Levels.check` finds.
    """

    in_levels = True

    def __init__(self, *args, levels: Levels, **keywords):
        super().__init__(*args, **keywords)
        self.levels = levels
        self._level_forces: list[np.ndarray] = []
        for fix in self.fixes:
            if set(fix.hooks()) - {"end_of_step"} and not fix.levels:
                raise InputError(f"run_style respa does not work with fix {fix.id} (style {fix.style}), which has no levels: leave it "
                                 "out or use run_style verlet")
        levels.check(self.interactions, self.engine.pair_terms)

    # ---- set-up -------------------------------------------------------------------------------------------------------------------------
    def _set_up_fixes(self) -> None:
        self._times, total = self.levels.steps(self.dt), self.engine.buffers[0].copy()
        self._before = [np.zeros(3) for _ in self.fixes]
        self._new_lists()
        self._level_forces = [np.zeros_like(total) for _ in self._times]
        self.state.virial[:] = 0.0
        rewind(self.engine)
        for level in range(1, self.levels.n + 1):
            self._forces(level, True, fixes=())
        self.engine.buffers[0] = total
        for n, fix in enumerate(self.fixes):
            fix.setup(self)
            for level, forces in enumerate(self._level_forces, 1) if n in self._forcing else ():
                self.engine.buffers[0] = forces
                self._post_force(n, fix, level)
                forces[:] = self.engine.buffers[0]
            self._total()
        acted = [self.fixes[n] for n in self._forcing if not self.fixes[n].integrates]
        if acted:       # until the first step LAMMPS leaves the forces of the level on which a fix acted last, not their sum
            last = self.levels.n if hasattr(acted[-1], "elsewhere") else self._own_level(acted[-1])
            self.engine.buffers[0] = self._level_forces[last - 1]

    def _own_level(self, fix) -> int:
        return min(fix.level or self.levels.n, self.levels.n)

    def _total(self) -> None:
        """The sum of all levels, which everybody sees."""
        self.engine.buffers[0] = sum(self._level_forces)

    def _make_module(self) -> None:
        """Hooks of the fixes, those of the inner levels too, and which terms are on which level."""
        self.engine.changed = False
        self._kinds = [f.hooks() for f in self.fixes]
        self._sort_hooks()
        hooks = []
        for fix, kinds in zip(self.fixes, self._kinds):
            mine = {name: getattr(fix, name) for name in tl.COMPILED if kinds.get(name)}
            if fix.integrates:
                inner = fix.inner or fix
                final = getattr(fix, "inner_final", inner.final_integrate)
                mine |= {"inner_initial": inner.initial_integrate, "inner_final": final, "middle": getattr(fix, "middle", final)}
                mine["outer_initial"] = getattr(fix, "outer_initial", fix.final_integrate)
            hooks.append(mine)
        self._forcing = [n for n, kinds in enumerate(self._kinds) if "post_force" in kinds]
        self._calls = Calls(hooks, [f.every for f in self.fixes], tl.HALVES)
        self._make_levels()

    def _next_whole(self, step: int) -> int:
        return step + 1

    def _make_levels(self) -> None:
        """`_work`: the terms of each level; `_whole`: those that are computed for the energy only, because their force is split."""
        e, at = self.engine, self.levels.level
        self._work: list[list] = [[] for _ in range(self.levels.n)]
        self._whole, self._pieces = [], []
        self._term_calls: dict[tuple[int, bool], list] = {}
        for t in e.terms:
            if t.category != "pair" or getattr(t, "pairs", "") == "one_four":
                self._work[at["dihedral" if t.category == "pair" else t.category] - 1].append(t)
                continue
            owner = next(p for p in e.pair_terms + e.many_terms if p.tables is t.tables)
            if self.levels.hybrid:
                self._work[self.levels.hybrid[self._number(owner.use)] - 1].append(t)
            elif "pair" in at:
                self._work[at["pair"] - 1].append(t)
            else:
                self._whole.append(t)
                for piece in PIECES:
                    if piece in at:
                        self._pieces.append(self._piece(t, owner, piece))
                        self._work[at[piece] - 1].append(self._pieces[-1])

    def _number(self, use) -> int:
        return next(k for k, other in enumerate(self.interactions.uses["pair"]) if other is use)

    def _piece(self, t, owner, piece: str):
        """The term of one piece of a term's force."""
        a, b, c, d = self.levels.cuts
        near, far = {"inner": (0.0, b), "middle": (a, d), "outer": (c, np.inf)}[piece]
        numbers = [a, 1.0 / max(b - a, 1e-30), c, 1.0 / max(d - c, 1e-30), near * abs(near), far * far]
        owner = replace(owner, tables=replace(owner.tables, constants=np.append(owner.tables.constants, numbers)))
        within = far + self.settings.skin
        short = within < SHORT * self.engine.reach and not self.engine.box_moves        # a second list has images of its own
        if isinstance(t, PairListTerm):
            kind = ShortListTerm if short and t.pairs == "all" else PairListTerm
            new = kind(owner.style, owner.tables, t.parts, t.pairs, owner=owner)
        elif isinstance(t, PairTerm):
            new = (ShortClusterTerm if short else PairTerm)(owner, t.single)
        else:
            new = PairRowsTerm(owner)
        new.piece, new.index, new.within = piece, t.index, within
        return new

    def _new_lists(self) -> None:
        """After each list build: the pieces' lists; kernels get other arguments."""
        e = self.engine
        for piece in self._pieces:
            piece.rebuild(e)
        e.changed = False       # the pieces' buffers, perhaps
        self._term_calls.clear()

    def _kernels(self, level: int, energy: bool) -> list[tuple]:
        """Terms of one level, or of no level (0) but as a whole, and the calls of their kernels by thread."""
        if (level, energy) not in self._term_calls:
            e, found = self.engine, []
            for t in self._work[level - 1] if level else self._whole:
                wanted = energy and t not in self._pieces
                kernel = t.kernel(wanted, False)
                found.append((t, [bound(kernel, t.arguments(e, tid), int(wanted)) for tid in range(e.threads)]))
            self._term_calls[level, energy] = found
        return self._term_calls[level, energy]

    # ---- steps --------------------------------------------------------------------------------------------------------------------------
    def _python_step(self, energy: bool, shares: set[str]) -> None:
        self.step += 1
        self._times = self.levels.steps(self.dt)
        needs = self._needs(self.step) | shares
        self._recurse(self.levels.n, energy or bool(needs) or bool(self._virial_every) and self.step % self._virial_every == 0)
        self._total()
        if needs:
            self._collect()
            self.engine.per_atom(self.result, needs)
        self._hook("end_of_step")

    def _recurse(self, level: int, energy: bool) -> None:
        """The steps of one level that make one of the next; energies belong to the last of them."""
        n = self.levels.n
        times = 1 if level == n else self.levels.factors[level - 1]
        for k in range(times):
            self._integrate(level, "inner_initial" if level == 1 < n else "middle" if level < n else
                            "outer_initial" if n > 1 else "initial_integrate")
            if level == 1:
                self._hook("post_integrate")
            if level == n:
                self.state.virial[:] = 0.0      # the first half may ask for that of the last step
                self._look_at_list()
                self._hook("pre_force")
            wanted = energy and k == times - 1
            if level > 1:
                self._recurse(level - 1, wanted)
            self._forces(level, wanted, self._forcing)
            self._integrate(level, "final_integrate" if level == n else "inner_final" if level == 1 else "middle", True)

    def _integrate(self, level: int, name: str, second: bool = False) -> None:
        """A half step of one level by all fixes that move atoms; after the second half others may act, too."""
        began = time.perf_counter()
        th = Thread(0, 1, 0, self.engine.ns, self.step, self.begin, self.end, self._times[level - 1], self._sync, self._scratch)
        forces = self._level_forces[level - 1]
        state = self.state._replace(f=forces[:3], torque=forces[3:])
        for n, fix in enumerate(self.fixes):
            if fix.integrates:
                self._calls.call(n, name, th, state, self.fix_data, keep=False)
            elif second and hasattr(fix, "after_kick"):
                fix.after_kick(self, level)
        self.engine.timings["Modify"] += time.perf_counter() - began

    def _look_at_list(self) -> None:
        """Once in a step, after the outermost kick: a fresh list if it is time; the forces of the levels keep their atoms."""
        e, s = self.engine, self.settings
        self._ago += 1
        if not any(f.next_reneighbor == self.step for f in self.fixes):
            if self._ago < s.delay or self._ago % s.every:
                return
            limit = max(0.0, 0.5 * (s.skin - corner_moves(e.state.box))) if e.box_moves else 0.5 * s.skin
            if s.check and e.k.moved(e.state.x, e.held, e.ns) <= limit**2:
                return
            if s.check and self._ago == max(s.every, s.delay):
                e.dangerous += 1
        self._hook("pre_exchange")
        self._hook("pre_neighbor")
        old = e.state.row[:e.ns]
        self._by_row = np.zeros((self.levels.n, e.buffers.shape[1], self.system.n))
        for forces, f in zip(self._by_row, self._level_forces):
            forces[:, old[old >= 0]] = f[:, :len(old)][:, old >= 0]
        self._rebuild()
        new = e.state.row[:e.ns]
        self._level_forces = [np.zeros_like(e.buffers[0]) for _ in self._by_row]
        for forces, f in zip(self._by_row, self._level_forces):
            f[:, :len(new)][:, new >= 0] = forces[:, new[new >= 0]]
        self._new_lists()
        self._hook("post_neighbor")

    def remove(self, rows) -> None:
        super().remove(rows)
        if self._level_forces:
            self._by_row = np.delete(self._by_row, rows, axis=2)

    def next_velocity(self, level: int, part: float) -> np.ndarray:
        """(3, cap) with which the innermost level moves the atoms next, if no force but those known on this and the inner levels acts:
        `part` of this level's step is still to come, and the first half of a step of each inner one."""
        times, forces = self._times, [f[:3] for f in self._level_forces[:level - 1]]
        push = part * times[level - 1] * self._level_forces[level - 1][:3] + sum(0.5 * dt * f for dt, f in zip(times, forces))
        return self.state.v + self.state.inverse_mass * push

    def _forces(self, level: int, energy: bool, fixes) -> None:
        """The forces of one level, with what `fixes` do to them; of its terms, energies and virials too."""
        e, calls = self.engine, self._kernels(level, energy)
        if self.settings.outdated:
            e.farthest[:] = e.k.displacements(e.state.x, e.held, e.ns, e.moved)
        if energy:
            e.acc[:, [t.index for t in self._work[level - 1] if t not in self._pieces]] = 0.0
            if level == self.levels.level.get("outer"):
                e.acc[:, [t.index for t in self._whole]] = 0.0
                self._compute(self._kernels(0, True))
        self._compute(calls)
        began, before = time.perf_counter(), self.state.virial.copy()
        for n in fixes:
            self._post_force(n, self.fixes[n], level)
        if not energy:      # of the steps of a level the last one counts
            self.state.virial[:] = before
        self._level_forces[level - 1][:] = self.engine.buffers[0]
        e.timings["Modify"] += time.perf_counter() - began

    def _compute(self, calls) -> None:
        """Clear the forces, run kernels."""
        e, spent = self.engine, np.zeros(len(calls))
        look(e)

        def work(tid):
            e.k.clear(e.buffers[tid], e.ns)
            for k, (_, call) in enumerate(calls):
                began = time.perf_counter()
                call[tid]()
                if tid == 0:
                    spent[k] += time.perf_counter() - began
        e.parallel(work)
        if e.threads > 1:
            e.k.add_buffers(e.buffers, e.ns)
        for (t, _), seconds in zip(calls, spent):
            e.timings["Pair" if t.category == "pair" else "Bond"] += seconds
        for t, _ in calls if e.bad[:, :, 0].any() else ():
            for found, item, value, _ in e.bad[:, t.index]:
                if found:
                    e.bad[:] = 0.0
                    e.store()
                    raise SimulationError(f"step {self.step}: {t.describe(e, int(item), float(value))}")

    def _post_force(self, n: int, fix, level: int) -> None:
        """A fix that acts on one level may do something on the others, too; what it counts is the sum over levels."""
        if hasattr(fix, "on_level"):
            self._level_forces[level - 1][:] = self.engine.buffers[0]
            fix.on_level(self, level)
            self.engine.buffers[0] = self._level_forces[level - 1]
            return
        own = self._own_level(fix)
        if fix.levels == "every" or level == own:
            self._call(n, "post_force")
        if not hasattr(fix, "elsewhere"):
            return
        if level == 1:
            self._before[n][:] = 0.0
        if level == own:
            fix.before += self._before[n]
        else:
            self._before[n] += fix.elsewhere(self)


__all__ = ["FORCES", "Levels", "RespaLoop"]
