"""The time loop: fixes, forces and list builds over many steps, compiled where nothing needs Python."""
from __future__ import annotations

import math
import time
import warnings

import numpy as np

from asemd import atom_shares, hook_order, population
from asemd.engine import Engine
from asemd.errors import InputError, InputWarning, LostAtoms, SimulationError
from asemd.fix import NEVER, Fix, first_forces
from asemd.interrupt import Interrupt
from asemd.kernels import relist
from asemd.kernels import timeloop as tl
from asemd.kernels.box import corner_moves
from asemd.kernels.state import Thread, aligned
from asemd.relist import NO_CALLS, Relist
from asemd.result import Result, Settings, Snapshot
from asemd.watchdog import Watchdog

IN_A_STEP = ("initial_integrate", "post_integrate", "pre_force", "post_force", "final_integrate")
ABOUT_LISTS = ("pre_exchange", "pre_neighbor", "post_neighbor")


def warn(message: str) -> None:
    """A Python warning; `Loop.warn` may be another function."""
    warnings.warn(message, InputWarning, stacklevel=3)


class Loop:
    """Runs a system under its fixes.

    Parameters
    ----------
    system : asemd.system.System
        Moved in place.
    interactions : asemd.forcefield.Interactions
    settings : asemd.engine.Settings
    fixes : list of Fix
    groups : mapping
        Group name -> (n,) bool; the position of a name is its bit unless the mapping has a method `bit`.
    dt : float
        Time step, in the system's units.
    step : int
    """

    in_levels = False       # whether fixes act on the forces of one level after the other

    def __init__(self, system, interactions, settings: Settings, fixes: list[Fix], groups, dt: float, step: int = 0):
        self.system, self.interactions, self.settings = system, interactions, settings
        self.fixes, self.groups, self.dt, self.step = list(fixes), groups, float(dt), int(step)
        self.begin = self.end = self.step
        for f in self.fixes:
            f.join(self)
        moves = {f.box_moves for f in self.fixes} - {""}
        self.engine = Engine(system, interactions, settings, "shape" if "shape" in moves else "".join(moves))
        self.units, self.result, self.engine.loop = self.engine.units, None, self
        self.gone, self.natoms = {}, system.n       # what left each group since `setup`, less what joined; atoms that there should be
        self.warn, self.say, self.fix_data, self._collected = warn, str, (), -1       # `say` is told what fixes print: nobody listens yet
        self.engine.set_groups(groups, {name: self.group_bit(name) for name in groups})
        self._sync, self._scratch = np.zeros(8, np.int64), aligned((self.engine.threads, 8))
        self._control, self._numbers = np.zeros(tl.CONTROLS, np.int64), np.zeros(tl.NUMBERS)
        self._chunk, self.halted, self._in_sync = 100, False, None       # whether the system has what the slots have; None: not known
        self._relist, self.watchdog, self.trial_step = Relist(), Watchdog(self), 0      # the step that a minimisation evaluates

    def group_bit(self, name: str) -> int:
        """The bit value of a group: 1 for ``all``, 2, 4, ...; `InputError` for an unknown one, or one too many."""
        if name not in self.groups:
            raise InputError(f"unknown group {name!r}")
        at = self.groups.bit(name) if hasattr(self.groups, "bit") else list(self.groups).index(name)
        if at > 30:
            raise InputError(f"group {name}: fixes can act on the first 31 groups only")
        return 1 << at

    @property
    def state(self):
        return self.engine.state

    @property
    def nslots(self) -> int:
        return self.engine.ns

    # ---- set-up -------------------------------------------------------------------------------------------------------------------------
    def setup(self, begin: int | None = None, end: int | None = None, needs=(), moves: bool = True) -> Result:
        """Lists, first forces with what `needs` names, the fixes' part in them; compiles what steps need, if the loop `moves` by itself."""
        e, self.fix_data, self.begin = self.engine, (), self.step if begin is None else int(begin)
        self.end = self.begin if end is None else int(end)
        for f in self.fixes:
            f.prepare(self)
        self._with_lost(e.load)
        self.gone, self.natoms, self._ago = {}, self.system.n, 0
        e.bonds.hold(True)
        tl.get_ready(self, moves and self.end > self.step)
        e.forces(True)
        e.store()       # fixes see positions that fit the image flags
        self.fix_data = tuple((np.ascontiguousarray(f.parameters(self), float), self.arrays_of(f)) for f in self.fixes)
        self._make_module()
        if moves and self._next_whole(self.step) > self.step + 1 <= self.end:
            self._enter(0, False)       # which moves nothing
        self._wanted = needs
        first_forces.settle(self)
        self._set_up_fixes()
        self._collect().take_shares(self._first)
        e.timings, e.builds, e.dangerous = dict.fromkeys(e.timings, 0.0), 0, 0
        self.watchdog.begin()
        return self.result

    def first_shares(self) -> None:
        """Atoms' shares that the first step shows, as soon as there are forces: fixes may move atoms then."""
        self._first = self.engine.per_atom(self._collect(), self._wanted)

    def _set_up_fixes(self) -> None:
        """One after the other: `Fix.setup`, and its part in the first forces."""
        for n, f in enumerate(self.fixes):
            f.setup(self)
            if "post_force" in self._kinds[n]:
                self._call(n, "post_force")

    def arrays_of(self, fix: Fix) -> np.ndarray | tuple[np.ndarray, ...]:
        a = fix.atom_arrays(self)
        return a if isinstance(a, tuple) else np.zeros((1, 1)) if a is None else np.ascontiguousarray(a, float)

    def _collect(self, late: bool = False) -> Result:
        """The result of this step, whose energies were computed."""
        self.result, self._collected = self.engine.collect(late), self.step
        return self.result

    def _make_module(self) -> None:
        self.engine.changed = False
        self._kinds = [f.hooks() for f in self.fixes]
        self._sort_hooks()
        self._calls, self._packed = tl.hooks_of(self.fixes, self._kinds), [None] * self.engine.threads

    def _sort_hooks(self) -> None:
        """Which fixes act in Python, and when; which of them want a virial."""
        self._in_python = [f for f, own in zip(self.fixes, self._kinds) if f.follows or any(not own.get(name, True) for name in IN_A_STEP)]
        self._ends = [n for n, kinds in enumerate(self._kinds) if not kinds.get("end_of_step", True)]
        self._mixed = hook_order.before_compiled(self.fixes, self._kinds)
        self._about_lists = [f for f, kinds in zip(self.fixes, self._kinds) if any(name in kinds for name in ABOUT_LISTS)]
        self._compiled = not (self._in_python or any("post_neighbor" in kinds for kinds in self._kinds))
        self._virial_every = math.gcd(*(f.virial_every for f in self.fixes))
        self._fleeting = atom_shares.fleeting(self.fixes, self._kinds, self.interactions)

    def _next_whole(self, step: int) -> int:
        """The next step after `step` that is made by Python, hook by hook."""
        return min(hook_order.next_mixed(self._mixed, step), *(f.next_step(step) for f in self._in_python), NEVER)

    def _next_end(self, step: int) -> int:
        """The next step after `step` with an `end_of_step` in Python."""
        return min((self.fixes[n].next_end(step) for n in self._ends), default=NEVER)

    def _needs(self, step: int) -> set[str]:
        """What fixes that act in Python on a step want to see of it."""
        return set().union(*(f.needs for f in self._in_python if f.next_step(step - 1) == step),
                           *(self.fixes[n].needs for n in self._ends if self.fixes[n].next_end(step - 1) == step))

    # ---- running ------------------------------------------------------------------------------------------------------------------------
    def advance(self, steps: int, virial: bool = True, energies: bool = False, virials: bool = False, progress=None) -> Result | None:
        """Run exactly `steps` steps, or until a fix sets `halted`; the system is in sync afterwards.

        Parameters
        ----------
        virial : bool
            Energies and virial are wanted at the last step; otherwise None is returned and `result` keeps its old energies.
        energies, virials : bool
            Per-atom shares are wanted at the last step.
        progress : callable, optional
            Called with the present step now and then.

        Raises
        ------
        SimulationError
            Names the step and the atoms; its attribute `verdict` has what `asemd.watchdog` found.
        KeyboardInterrupt
            After Ctrl-C, between two steps: `step` and the system are those of the last complete one, and the loop can go on.
        """
        shares = {name for name, wanted in (("energies", energies), ("virials", virials)) if wanted}
        want, last, self.halted = virial or energies or virials, self.step + int(steps), False
        self.engine.bonds.hold(False)
        with Interrupt() as interrupt, self.watchdog as watchdog:
            while self.step < last and not (interrupt.asked or self.halted):
                whole, due = self._next_whole(self.step), self._next_end(self.step)
                if self._fleeting:
                    whole = min([whole, *[last] * bool(shares), *[due] * (due <= last and bool(atom_shares.KINDS & self._needs(due)))])
                if whole == self.step + 1:
                    self._python_step(want and whole == last, shares if whole == last else set())
                else:
                    began, at = time.perf_counter(), self.step
                    stop = min(last, at + self._chunk, whole - 1, due)
                    needs = self._needs(stop) if stop == due else set()
                    self._segment(stop, bool(needs) or (want and stop == last))
                    spent = time.perf_counter() - began
                    self._chunk = max(20, int(0.2 * (stop - at) / max(spent, 1e-9)))
                    if stop == due:
                        self._end(needs)
                watchdog.look()
                if progress is not None:
                    progress(self.step)
        if interrupt.asked:
            self.engine.store()
            raise KeyboardInterrupt
        tl.take_timings(self._numbers, self.engine.timings)
        if not want or self.step < last:
            self.engine.store()
            return None
        with self.watchdog as watchdog:
            before, result = self.result, self._collect()
            watchdog.energy(result)
        if self._fleeting and shares:
            result.take_shares(before)
        return self.engine.per_atom(result, shares)

    def _end(self, needs: set[str]) -> None:
        """The `end_of_step` hooks in Python that are due."""
        began = time.perf_counter()
        if needs:
            self.engine.per_atom(self._collect(late=True), needs)
            self._in_sync = True
        for n in self._ends:
            if self.fixes[n].next_end(self.step - 1) == self.step:
                self._in_sync = bool(self._in_sync) if self.fixes[n].observes else None
                self.fixes[n].end_of_step(self)
        self._in_sync = self.system.late = None
        self.engine.timings["Modify"] += time.perf_counter() - began

    def _segment(self, last: int, energy: bool) -> None:
        """Compiled steps up to `last`, with list builds in between."""
        resume = tl.BEGIN
        while True:
            began, status = self.step, self._enter(last, energy, resume)
            if status == tl.FINISHED:
                return
            if status == tl.BAD:
                self.engine.store()
                try:
                    self.engine.check()
                except SimulationError as error:
                    raise SimulationError(f"step {self.step}: {error}") from None
            if not (resume == tl.LIST and self.step == began):      # that was a list it could not build
                seen = self._relist.known and self.watchdog.glance()
                for name in ("pre_exchange", "pre_neighbor") if self._about_lists else ():
                    self._hook(name)
                if (seen or self._about_lists) and self._compiled and self.watchdog.content() and self._relist.ready(self.engine):
                    resume = tl.LIST
                    continue
            self._rebuild()
            self._hook("post_neighbor")
            resume = tl.FORCES

    def _rebuild(self) -> None:
        try:
            self.watchdog.before_build(not self._in_python)
            self._with_lost(self.engine.rebuild)
        except SimulationError as error:
            self.engine.store()
            error.args = (f"step {self.step}: {error}",)
            raise
        if self.engine.changed:
            self._make_module()
        self._ago = 0
        self.watchdog.after_build()

    def _with_lost(self, build) -> None:
        """A list build; atoms that are lost by then leave the system, unless `settings.lost` makes that an error."""
        try:
            build()
        except LostAtoms as error:
            if self.settings.lost == "error":
                raise
            self.remove(error.rows)

    def remove(self, rows) -> None:
        """See `asemd.population.remove`."""
        population.remove(self, rows)

    def _enter(self, last: int, energy: bool, resume: int = tl.BEGIN) -> int:
        e, s, c, x = self.engine, self.settings, self._control, self._numbers
        last = last or self.step
        forced = min((f.next_reneighbor for f in self.fixes if f.next_reneighbor > self.step), default=NEVER)
        c[:] = [self.step, last, resume, self._ago, s.every, s.delay, s.check, self.begin, self.end, 0, energy, self._virial_every,
                  s.outdated, bool(e.box_moves), forced, 0, 0]
        x[tl.DT], x[tl.TRIGGER], (x[tl.FARTHEST], x[tl.UNTIL]) = self.dt, (0.5 * s.skin) ** 2, self.watchdog.patience()
        self._sync[:], status = 0, [0] * e.threads
        run, (calls, starts) = tl.module().run, self._calls.table(tl.KINDS, e.state, self.fix_data)
        terms = [self._terms(t) for t in range(e.threads)]
        acts = any(f.next_list(self.step) <= last for f in self._about_lists)
        lists, live = NO_CALLS if acts else self._relist.table(e), self._relist.live
        live[relist.NS] = e.ns

        def work(tid):
            status[tid] = run(*tl.arguments_of(self, tid, terms[tid], calls, starts, lists))
        e.parallel(work)
        self.step, self._ago = int(c[tl.STEP]), int(c[tl.AGO])
        e.dangerous += int(c[tl.DANGEROUS])
        self._relist.take(e, int(c[tl.BUILDS]))
        self.watchdog.built(int(c[tl.BUILT]))
        return status[0]

    def _terms(self, tid: int) -> np.ndarray:
        """For the loop: kernels, arguments and clock of each term."""
        arguments = self.engine.arguments()[tid]
        known = self._packed[tid]
        if known is None or (known.arguments is not arguments and not known.take(arguments)):
            alone = bool(self._virial_every) and not any(f.with_energies for f in self.fixes)
            known = self._packed[tid] = tl.Terms(self.engine.terms, arguments, alone)
        return known.rows

    # ---- steps with Python hooks --------------------------------------------------------------------------------------------------------
    def _thread(self, dt: float | None = None) -> Thread:
        return Thread(0, 1, 0, self.engine.ns, self.step, self.begin, self.end, dt or self.dt, self._sync, self._scratch)

    def _call(self, n: int, name: str, state=None, dt: float | None = None) -> None:
        """One hook of one fix, compiled or not, on all slots; with another step, perhaps, than that of the run."""
        if self._kinds[n][name] and name in tl.COMPILED:
            if self.fixes[n].follows == name:
                self.fixes[n].follow(self)
            self._calls.call(n, name, self._thread(dt), self.engine.state if state is None else state, self.fix_data, state is None)
        else:
            getattr(self.fixes[n], name)(self)

    def _hook(self, name: str) -> None:
        began = time.perf_counter()
        for n, fix in enumerate(self.fixes):
            kind = self._kinds[n].get(name)
            if kind is None or (not kind and name in IN_A_STEP and fix.next_step(self.step - 1) != self.step):
                continue
            if name != "end_of_step" or (self.step % fix.every == 0 if kind else fix.next_end(self.step - 1) == self.step):
                self._call(n, name)
        self.engine.timings["Modify"] += time.perf_counter() - began

    def _python_step(self, energy: bool, shares: set[str]) -> None:
        e, s = self.engine, self.settings
        self.step += 1
        needs = self._needs(self.step) | shares
        energy = energy or bool(needs) or bool(self._virial_every) and self.step % self._virial_every == 0
        self._hook("initial_integrate")
        self._hook("post_integrate")
        self._ago, need = self._ago + 1, False
        if self._ago >= s.delay and self._ago % s.every == 0:
            limit = max(0.0, 0.5 * (s.skin - corner_moves(e.state.box))) if e.box_moves else 0.5 * s.skin
            need = not s.check or not e.k.moved(e.state.x, e.held, e.ns) <= limit**2
            if need and s.check and self._ago == max(s.every, s.delay):
                e.dangerous += 1
        if need or any(f.next_reneighbor == self.step for f in self.fixes):
            self._hook("pre_exchange")
            self._hook("pre_neighbor")
            self._rebuild()
            self._hook("post_neighbor")
        self._hook("pre_force")
        try:
            e.forces(energy)
        except SimulationError as error:
            e.store()
            raise SimulationError(f"step {self.step}: {error}") from None
        if needs:
            e.per_atom(self._collect(), needs)
        for name in ("post_force", "final_integrate", "end_of_step"):
            self._hook(name)

    # ---- exchange with the system -------------------------------------------------------------------------------------------------------
    def sync_out(self) -> None:
        """Positions, velocities and forces of the slots into the system; observers of a step one after the other share them."""
        if not self._in_sync:
            self.engine.store(late=self._in_sync is not None)
            self._in_sync = self._in_sync is not None or None

    def evaluate(self) -> Result:
        """Energy, forces and virial at the system's positions, with what the fixes do to forces; the list stays while it serves."""
        e = self.engine
        e.bonds.hold(False)
        self.sync_in()
        if not e.k.moved(e.state.x, e.held, e.ns) <= max(0.0, 0.5 * (self.settings.skin - corner_moves(e.state.box))) ** 2:
            e.rebuild()
            self._make_module()
        self._hook("pre_force")
        e.forces(True)
        self._hook("post_force")
        return self._collect()

    def sync_in(self) -> None:
        """Positions and velocities of the system into the slots (the list stays)."""
        e = self.engine
        e.k.load(self.system.x, self.system.v, self.system.x, e.state.x, e.state.v, e.state.row, e.ns, False)

    def end_of_step(self) -> None:
        """What fixes do when a step is over, for steps that are not made by the loop."""
        self._hook("end_of_step")

    def finish(self) -> None:
        """End of a run: results of fixes are read back, the system is in sync."""
        for f in self.fixes:
            f.finish(self)
        self.system.step = self.step

    def snapshot(self) -> Snapshot:
        """What observers see now."""
        return Snapshot(self.system, self.result, self.groups, self.dt, self.step, self.fixes, self.gone, self._collected == self.step,
                        self.engine)
