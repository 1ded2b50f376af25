"""The compiled time loop: text generated for exactly the terms of a run; fixes are called by address (`asemd.kernels.hooks`).

The order of a step is LAMMPS's: initial_integrate, post_integrate, list check, (list built by Python, loop entered again), pre_force,
forces, post_force, final_integrate, end_of_step. All threads run the same text; barriers stand after positions and after forces are
complete. Where one fix alone integrates and nothing happens between its second half of a step and its first half of the next, its hook
`final_initial` does both in one pass over the atoms.
"""
from __future__ import annotations

import textwrap
from collections.abc import Sequence
from types import ModuleType

from asemd.kernels import box
from asemd.kernels.generate import FAST, Builder
from asemd.kernels.hooks import Calls, shared

FINISHED, REBUILD, BAD = 0, 1, 2
COMPILED = ("initial_integrate", "post_integrate", "pre_force", "post_force", "final_integrate", "end_of_step")
HALVES = ("initial_integrate", "final_integrate", "final_initial")      # strict: a run has the same digits wherever it is cut into pieces
KINDS = (*COMPILED, "final_initial")
# places in `control` (int64) and `numbers` (float64)
STEP, LAST, RESUME, AGO, EVERY, DELAY, CHECK, BEGIN, END, DANGEROUS, ENERGY, VIRIAL = range(12)
DT, TRIGGER, PAIR_TIME, BOND_TIME, MODIFY_TIME, COMM_TIME = range(6)


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


def module(kernels: Sequence[tuple], categories: Sequence[str], outdated: bool = False, box_moves: bool = False,
           virial: bool = False) -> ModuleType:
    """The loop module.

    Parameters
    ----------
    kernels : sequence of (plain, with_energy, with_virial)
        Compiled kernels of each term; the last one is not used without `virial`.
    categories : sequence of str
        ``pair`` or other, per term, for the timing table.
    outdated : bool
        The list may be: kernels look at how far each slot has moved.
    box_moves : bool
        A fix changes the box: what its corners have moved is taken from the skin, as LAMMPS does.
    virial : bool
        Fixes want the virial of the terms now and then.
    """
    b = Builder("time loop")
    b.line("from asemd.kernels.threads import barrier")
    b.line("from asemd.kernels.state import Thread")
    b.line("from asemd.kernels.clock import now")
    b.line("from asemd.kernels.packed import act")
    b.line("import math")
    if box_moves:
        b.use(shared(box.corner_moves), "corner_moves")
    for k, (plain, energy, with_virial) in enumerate(kernels):
        for f, alias in ((plain, f"term{k}"), (energy, f"term{k}_energy"), *([(with_virial, f"term{k}_virial")] if virial else [])):
            g = getattr(f, "py_func", f)
            b.line(f"from {g.__module__} import {g.__name__} as {alias}")

    def terms(suffix: str, indent: int) -> str:
        lines, last = [], None
        for k, category in enumerate(categories):
            at = "PAIR_TIME" if category == "pair" else "BOND_TIME"
            if last not in (None, at):
                lines += ["if tid == 0:", "    t1 = now()", f"    numbers[{globals()[last]}] += t1 - t0", "    t0 = t1"]
            lines.append(f"term{k}{suffix}(*terms[{k}])")
            last = at
        if last:
            lines += ["if tid == 0:", "    t1 = now()", f"    numbers[{globals()[last]}] += t1 - t0", "    t0 = t1"]
        return textwrap.indent("\n".join(lines) or "t0 = t0", " " * indent)

    on_virial_steps = textwrap.indent(f"""elif step % control[{VIRIAL}] == 0:
    for k in range(acc.shape[1]):
        for c in range(8):
            acc[tid, k, c] = 0.0
{terms("_virial", 4)}""", " " * 8) if virial else ""

    b.text(f'''def run(tid, nth, ns, s, held, moved, farthest, buffers, bad, sync, scratch, control, numbers, acc, terms, calls, starts):
    step = control[{STEP}]
    last = control[{LAST}]
    resume = control[{RESUME}]
    ago = control[{AGO}]
    every = control[{EVERY}]
    delay = control[{DELAY}]
    check = control[{CHECK}]
    begin = control[{BEGIN}]
    end = control[{END}]
    energy = control[{ENERGY}]
    dt = numbers[{DT}]
    trigger = numbers[{TRIGGER}]
    lo = ns * tid // nth
    hi = ns * (tid + 1) // nth
    f = buffers[tid]
    x0, x1, x2 = s.x[0, lo:hi], s.x[1, lo:hi], s.x[2, lo:hi]            # slices: indices that are surely not negative vectorise
    held0, held1, held2 = held[0, lo:hi], held[1, lo:hi], held[2, lo:hi]
    away = moved[lo:hi]
    ready = False          # whether the first half of the next step is done
    t0 = now()
    th = Thread(tid, nth, lo, hi, step, begin, end, dt, sync, scratch)
    barrier(th)
    while resume != 0 or step < last:
        if resume == 0:
            step += 1
            th = Thread(tid, nth, lo, hi, step, begin, end, dt, sync, scratch)
            if not ready:
                act(0, th, calls, starts)
            ready = False
            act(1, th, calls, starts)
            ago += 1
            due = ago >= delay and ago % every == 0
            if {outdated} or due:
                m = 0.0
                odd = 0.0
                for i in range(hi - lo):
                    a = x0[i] - held0[i]
                    b = x1[i] - held1[i]
                    c = x2[i] - held2[i]
                    m = max(m, a * a + b * b + c * c)
                    odd += 0.0 * (a + b + c)                # not zero where a position is not a number
                    {"away[i] = a * a + b * b + c * c" if outdated else ""}
                scratch[tid, 1] = m if odd == 0.0 else 1e301
            if tid == 0:
                t1 = now()
                numbers[{MODIFY_TIME}] += t1 - t0
                t0 = t1
            barrier(th)
            m = 0.0
            for t in range(nth):
                m = max(m, scratch[t, 1])
            {"gone = corner_moves(s.box)" if box_moves else "gone = 0.0"}
            farthest[tid] = m if gone == 0.0 else (math.sqrt(m) + gone) ** 2
            need = due and (check == 0 or (m > trigger if gone == 0.0 else math.sqrt(m) + 0.5 * gone > math.sqrt(trigger)))
            if tid == 0:
                t1 = now()
                numbers[{COMM_TIME}] += t1 - t0
                t0 = t1
            if need:
                if tid == 0:
                    control[{STEP}] = step
                    if check != 0 and ago == max(every, delay):
                        control[{DANGEROUS}] += 1
                return {REBUILD}
        else:
            farthest[tid] = 0.0
        resume = 0
        act(2, th, calls, starts)
        for d in range(f.shape[0]):
            for i in range(ns):
                f[d, i] = 0.0
        for c in range(6):
            s.virial[tid, c] = 0.0
        if energy != 0 and step == last:
            for k in range(acc.shape[1]):
                for c in range(8):
                    acc[tid, k, c] = 0.0
{terms("_energy", 12)}
{on_virial_steps}
        else:
{terms("", 12)}
        if nth > 1:
            barrier(th)
            for t in range(1, nth):
                for d in range(f.shape[0]):
                    sum_of, part = buffers[0, d, lo:hi], buffers[t, d, lo:hi]
                    for i in range(hi - lo):
                        sum_of[i] += part[i]
        for t in range(nth):
            for k in range(bad.shape[1]):
                if bad[t, k, 0] != 0.0:
                    if tid == 0:
                        control[{STEP}] = step
                    return {BAD}
        if tid == 0:
            t1 = now()
            numbers[{COMM_TIME}] += t1 - t0
            t0 = t1
        act(3, th, calls, starts)
        if starts[7] > starts[6] and step < last:
            act(6, th, calls, starts)
            ready = True
        else:
            act(4, th, calls, starts)
        act(5, th, calls, starts)
        if tid == 0:
            t1 = now()
            numbers[{MODIFY_TIME}] += t1 - t0
            t0 = t1
    barrier(th)
    if tid == 0:
        control[{STEP}] = step
        control[{AGO}] = ago
    return {FINISHED}''', f"fastmath={FAST}")
    return b.build()
