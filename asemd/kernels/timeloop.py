"""The compiled time loop. Terms and fixes are called by address, so that it is compiled once for all runs.

The order of a step is LAMMPS's: initial_integrate, post_integrate, list check, (list built: here, or by Python and the loop is entered
again), pre_force, forces, post_force, final_integrate, end_of_step. All threads run the same text; barriers stand after positions and after
forces are complete. Where one fix alone integrates and nothing happens between its second half of a step and its first half of the next,
its hook `final_initial` does both in one pass over the atoms.
"""
from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from types import ModuleType

import numpy as np

from asemd.kernels import packed
from asemd.kernels.box import corner_moves
from asemd.kernels.clock import now
from asemd.kernels.generate import FAST, Builder, plain_source
from asemd.kernels.hooks import INNER, Calls, compile_ahead, kernel_address, shared
from asemd.kernels.packed import act, call
from asemd.kernels.relist import FINE, NS, WANTED
from asemd.kernels.state import Thread
from asemd.kernels.threads import barrier

FINISHED, REBUILD, BAD = 0, 1, 2
BEGIN, FORCES, LIST = 0, 1, 2       # ``control[RESUME]``: a step begins, or goes on with its forces, or with the list before them
COMPILED = ("initial_integrate", "post_integrate", "pre_force", "post_force", "final_integrate", "end_of_step")
HALVES = ("initial_integrate", "final_integrate", "final_initial")      # strict: a run has the same digits wherever it is cut into pieces
KINDS = (*COMPILED, "final_initial")
# places in `control` (int64) and `numbers` (float64)
STEP, LAST, RESUME, AGO, EVERY, DELAY, CHECK, BEGIN, END, DANGEROUS, ENERGY, VIRIAL, OUTDATED, BOX_MOVES, FORCED, BUILDS, BUILT = range(17)
CONTROLS, NUMBERS = 17, 10
DT, TRIGGER, FARTHEST, UNTIL, PAIR_TIME, BOND_TIME, MODIFY_TIME, COMM_TIME, KSPACE_TIME, NEIGH_TIME = range(10)
TIMES = {"Pair": PAIR_TIME, "Bond": BOND_TIME, "Kspace": KSPACE_TIME, "Modify": MODIFY_TIME, "Comm": COMM_TIME, "Neigh": NEIGH_TIME}
# places in a row of `terms`: addresses of the kernels, of their arguments, and the place of the time spent
PLAIN, WITH_ENERGY, WITH_VIRIAL, ARGUMENTS, TIME = range(5)


def take_timings(numbers: np.ndarray, timings: dict[str, float]) -> None:
    """Add the seconds that the loop has counted to `timings`, and count anew."""
    for name, at in TIMES.items():
        timings[name] += float(numbers[at])
        numbers[at] = 0.0


def hooks_of(fixes: Sequence, kinds: Sequence[dict[str, bool]]) -> Calls:
    """The compiled hooks of fixes; with `final_initial` where one alone integrates and no other looks on between two steps.

    Parameters
    ----------
    fixes : sequence of asemd.fix.Fix
    kinds : sequence of dict
        What `hooks` of each fix says: name -> whether it is compiled.
    """
    hooks = [{name: getattr(f, name) for name in COMPILED if names.get(name)} for f, names in zip(fixes, kinds, strict=True)]
    active = [n for n, fix in enumerate(hooks) if {"initial_integrate", "final_integrate", "end_of_step"} & set(fix)]
    if len(active) == 1:
        one = hooks[active[0]]
        if {"initial_integrate", "final_integrate"} <= set(one) and "end_of_step" not in one and hasattr(fixes[active[0]], "final_initial"):
            one["final_initial"] = fixes[active[0]].final_initial
    return Calls(hooks, [f.every for f in fixes], HALVES)


class Terms:
    """What the loop knows of the terms: a row for each with its kernels (without energy, with energy, with the virial only), its
    arguments, and where its time is counted.

    Parameters
    ----------
    terms : sequence of asemd.term.Term
    arguments : sequence of tuple
        Of each term, for one thread.
    virial : bool
        Fixes want the virial now and then, without energies.
    """

    def __init__(self, terms: Sequence, arguments: Sequence[tuple], virial: bool):
        self.arguments, self.blocks = arguments, [packed.Block(a) for a in arguments]
        self.rows = np.empty((len(terms), 5), packed.HANDLE)
        for row, t, a, block in zip(self.rows, terms, arguments, self.blocks, strict=True):
            kernels = t.kernel(False, False), t.kernel(True, False), t.virial_kernel() if virial else t.kernel(True, False)
            row[:3] = [kernel_address(k, packed.text_of_arguments(a)) for k in kernels]
            row[ARGUMENTS], row[TIME] = packed.handle(block.memory), {"pair": PAIR_TIME, "kspace": KSPACE_TIME}.get(t.category, BOND_TIME)

    def take(self, arguments: Sequence[tuple]) -> bool:
        """Other arguments of the same terms; False if they are of other types, and kernels are to be looked up again."""
        self.arguments = arguments
        return len(arguments) == len(self.blocks) and all(block.take(values) for block, values in zip(self.blocks, arguments))


def arguments_of(loop, tid: int, terms: np.ndarray, calls: np.ndarray, starts: np.ndarray, lists: np.ndarray) -> tuple:
    """What `run` takes."""
    e = loop.engine
    return (tid, e.threads, e.state.x, e.state.virial, e.state.box, e.held, e.moved, e.farthest, e.buffers, e.bad, loop._sync,
            loop._scratch, loop._control, loop._numbers, e.acc, terms, calls, starts, loop._relist.live, lists)


def get_ready(loop, steps: bool) -> None:
    """Compile kernels of the terms, in several processes; if there are `steps` to come, those that only they need and the loop itself."""
    e = loop.engine
    arguments = [packed.text_of_arguments(a) for a in e.arguments()[0]]
    kernels = [(t.kernel(energy, False), a) for energy in (True, False)[:1 + steps] for t, a in zip(e.terms, arguments, strict=True)]
    if not steps or packed.WITHOUT_COMPILER:
        return compile_ahead(kernels)
    none = [np.empty(shape, packed.HANDLE) for shape in ((0, 5), (0, 3), 0, (0, 2))]
    return compile_ahead([*kernels, *loop._relist.kernels(e)], [(module().run, arguments_of(loop, 0, *none))])


@cache
def module() -> ModuleType:
    """The loop with its constants written out."""
    b = Builder("time loop")
    b.line("from asemd.kernels.threads import barrier")
    b.line("from asemd.kernels.state import Thread")
    b.line("from asemd.kernels.clock import now")
    b.line("from asemd.kernels.packed import act, call")
    b.use(shared(corner_moves), "corner_moves")
    for name, value in globals().items():
        if name.isupper() and isinstance(value, int):
            b.constant(name, value)
    b.text(plain_source(compute), f"fastmath={FAST}, {INNER}")
    b.text(plain_source(listed), INNER)
    for f in (strides, fill, add_up):
        b.text(plain_source(f), f"fastmath={FAST}, {INNER}")
    b.text(plain_source(run), f"fastmath={FAST}")
    return b.build()


def compute(kind, th, terms, numbers, t0):
    """Call the kernels of all terms; returns the time when they were done."""
    th = Thread(th.tid, th.nth, th.lo, th.hi, th.step, th.begin, th.end, th.dt, th.sync, th.scratch, min(kind, 1))
    for k in range(terms.shape[0]):
        call(terms[k, kind], th, terms[k, ARGUMENTS])
        if th.tid == 0:
            t1 = now()
            numbers[terms[k, TIME]] += t1 - t0
            t0 = t1
    return t0


def listed(th, lists, live, control, numbers, odd, t0):
    """Build a list, unless `odd` or something else is a case for Python; returns whether it is there. All threads call it."""
    if lists.shape[0] == 0 or odd:
        return False
    if th.tid == 0:
        live[WANTED] = t0 <= numbers[UNTIL]
    barrier(th)
    if live[WANTED] == 0:
        return False
    call(lists[0, 0], th, lists[0, 1])
    if th.tid == 0:
        for k in range(1, lists.shape[0]):
            if live[FINE] != 0:
                call(lists[k, 0], th, lists[k, 1])
        control[BUILDS] += live[FINE]
        control[BUILT] = th.step
        numbers[NEIGH_TIME] += now() - t0
    barrier(th)
    return live[FINE] != 0


def strides(x, held, lo, hi, moved, keep):
    """The largest squared displacement since the list was built, 1e301 where a position is not a number; `moved` gets all of them if
    `keep`."""
    m = 0.0
    wrong = 0.0
    for k in range(lo, hi):
        i = np.uint64(k)            # surely not negative: vectorises
        a = x[0, i] - held[0, i]
        b = x[1, i] - held[1, i]
        c = x[2, i] - held[2, i]
        m = max(m, a * a + b * b + c * c)
        wrong += 0.0 * (a + b + c)
    if keep:
        for k in range(lo, hi):
            i = np.uint64(k)
            moved[i] = (x[0, i] - held[0, i]) ** 2 + (x[1, i] - held[1, i]) ** 2 + (x[2, i] - held[2, i]) ** 2
    return m if wrong == 0.0 else 1e301


def fill(f, ns):
    """No forces yet."""
    for d in range(f.shape[0]):
        for i in range(ns):
            f[d, np.uint64(i)] = 0.0


def add_up(buffers, t, lo, hi):
    """The forces that thread `t` found, on a part of the atoms, to those of the first."""
    for d in range(buffers.shape[1]):
        for k in range(lo, hi):
            i = np.uint64(k)
            buffers[0, d, i] += buffers[t, d, i]


def run(tid, nth, x, virial, box, held, moved, farthest, buffers, bad, sync, scratch, control, numbers, acc, terms, calls, starts, live,
        lists):
    """Steps up to ``control[LAST]``; returns FINISHED, REBUILD (a list is due that Python makes) or BAD (`bad` says which item).

    `lists` are the calls that build a list, none if only Python can, and `live` what they share, see `asemd.kernels.relist`. They are for
    ordinary builds only: not where an atom has moved so far (``numbers[FARTHEST]``) or so much time has passed (``numbers[UNTIL]``) that
    the watchdog wants to look.
    """
    step = control[STEP]
    last = control[LAST]
    resume = control[RESUME]
    ago = control[AGO]
    every = control[EVERY]
    delay = control[DELAY]
    check = control[CHECK]
    begin = control[BEGIN]
    end = control[END]
    dt = numbers[DT]
    trigger = numbers[TRIGGER]
    ns = live[NS]
    lo = ns * tid // nth
    hi = ns * (tid + 1) // nth
    f = buffers[tid]
    ready = False          # whether the first half of the next step is done
    t0 = now()
    th = Thread(tid, nth, lo, hi, step, begin, end, dt, sync, scratch, 0)
    if tid == 0:
        numbers[UNTIL] += t0
    barrier(th)
    while resume != BEGIN or step < last:
        need = resume == LIST
        odd = False
        if resume == BEGIN:
            step += 1
            th = Thread(tid, nth, lo, hi, step, begin, end, dt, sync, scratch, 0)
            if not ready:
                act(np.int64(0), th, calls, starts)
            ready = False
            act(np.int64(1), th, calls, starts)
            ago += 1
            due = ago >= delay and ago % every == 0
            forced = step == control[FORCED]
            if due or forced or control[OUTDATED] != 0:
                scratch[tid, 1] = strides(x, held, lo, hi, moved, control[OUTDATED] != 0)
            if tid == 0:
                t1 = now()
                numbers[MODIFY_TIME] += t1 - t0
                t0 = t1
            barrier(th)
            m = 0.0
            for t in range(nth):
                m = max(m, scratch[t, 1])
            gone = corner_moves(box) if control[BOX_MOVES] != 0 else 0.0
            farthest[tid] = m if gone == 0.0 else (math.sqrt(m) + gone) ** 2
            need = due and (check == 0 or (m > trigger if gone == 0.0 else math.sqrt(m) + 0.5 * gone > math.sqrt(trigger)))
            if tid == 0:
                t1 = now()
                numbers[COMM_TIME] += t1 - t0
                t0 = t1
            if need or forced:
                if tid == 0:
                    control[STEP] = step
                    if need and check != 0 and ago == max(every, delay):
                        control[DANGEROUS] += 1
                odd = forced or farthest[tid] > numbers[FARTHEST]
                need = True
        else:
            farthest[tid] = 0.0
        if need:
            if not listed(th, lists, live, control, numbers, odd, t0):
                return REBUILD
            ago = 0
            farthest[tid] = 0.0
            ns = live[NS]
            lo = ns * tid // nth
            hi = ns * (tid + 1) // nth
            th = Thread(tid, nth, lo, hi, step, begin, end, dt, sync, scratch, 0)
            if tid == 0:
                t0 = now()
        resume = BEGIN
        act(np.int64(2), th, calls, starts)
        fill(f, ns)
        for c in range(6):
            virial[tid, c] = 0.0
        kind = PLAIN
        if control[ENERGY] != 0 and step == last:
            kind = WITH_ENERGY
        elif control[VIRIAL] != 0 and step % control[VIRIAL] == 0:
            kind = WITH_VIRIAL
        if kind != PLAIN:
            for k in range(acc.shape[1]):
                for c in range(8):
                    acc[tid, k, c] = 0.0
        t0 = compute(kind, th, terms, numbers, t0)
        if nth > 1:
            barrier(th)
            for t in range(1, nth):
                add_up(buffers, t, lo, hi)
        for t in range(nth):
            for k in range(bad.shape[1]):
                if bad[t, k, 0] != 0.0:
                    if tid == 0:
                        control[STEP] = step
                    return BAD
        if tid == 0:
            t1 = now()
            numbers[COMM_TIME] += t1 - t0
            t0 = t1
        act(np.int64(3), th, calls, starts)
        if starts[7] > starts[6] and step < last:
            act(np.int64(6), th, calls, starts)
            ready = True
        else:
            act(np.int64(4), th, calls, starts)
        act(np.int64(5), th, calls, starts)
        if tid == 0:
            t1 = now()
            numbers[MODIFY_TIME] += t1 - t0
            t0 = t1
    barrier(th)
    if tid == 0:
        control[STEP] = step
        control[AGO] = ago
    return FINISHED
