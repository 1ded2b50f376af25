r"""Threads that run one compiled loop together: a barrier and a sum with a fixed order.

All threads execute the same steps (SPMD) and meet at barriers. The barrier is one counter that only grows: the ticket a thread draws
says which meeting it belongs to, so nothing is reset and a fast thread cannot overtake a slow one. A waiting thread spins for a moment,
then gives its core away on every look, which keeps loops alive on busy machines. With one thread both functions are free.
"""
from __future__ import annotations

import sys

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from asemd.kernels.target import njit

_GIVE_WAY = "SwitchToThread" if sys.platform == "win32" else "sched_yield"


@intrinsic
def _draw_ticket(context, counter):
    """Add 1 to ``counter[0]`` atomically and return what it was."""
    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.atomic_rmw("add", data, ir.Constant(ir.IntType(64), 1), "seq_cst")
    return types.int64(counter), generate


@intrinsic
def _look(context, counter):
    """``counter[0]``, read anew every time, with all that was written before it was raised."""
    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.load_atomic(data, "acquire", 8)
    return types.int64(counter), generate


@intrinsic
def _give_way(context):
    """Let the operating system run another thread on this core."""
    def generate(context, builder, signature, arguments):
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(ir.IntType(32), []), _GIVE_WAY)
        return builder.call(function, [])
    return types.int32(), generate


@njit(cache=True, nogil=True)
def barrier(th):
    """Return when all ``th.nth`` threads are here; everything written before is visible after.

    Parameters
    ----------
    th : asemd.kernels.state.Thread
        ``th.sync[0]`` is the counter shared by all threads.
    """
    if th.nth > 1:
        ticket = _draw_ticket(th.sync)
        full = (ticket // th.nth + 1) * th.nth
        spins = 0
        while _look(th.sync) < full:
            spins += 1
            if spins > 2000:
                _give_way()


@njit(cache=True, nogil=True)
def reduce_sum(th, value):
    """The sum of every thread's `value`, the same bits on every thread and in every run with this many threads.

    Parameters
    ----------
    th : asemd.kernels.state.Thread
        ``th.scratch (nth, 8)``: one cache line per thread.
    value : float
        This thread's share.

    Returns
    -------
    float
        The total, added in the order of the threads.
    """
    if th.nth == 1:
        return np.float64(value)
    th.scratch[th.tid, 0] = value
    barrier(th)
    total = 0.0
    for t in range(th.nth):
        total += th.scratch[t, 0]
    barrier(th)
    return total
