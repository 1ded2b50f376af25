"""``min_style cg``: conjugate gradients of Polak and Ribiere with restarts."""
from __future__ import annotations

import numpy as np

from asemd.minimize import MAXITER, Options, Problem, Result
from asemd.minimize._state import State


class CG:
    """Every direction is the force plus a share of the last direction; the share is never negative (a restart)."""

    style = "cg"

    @staticmethod
    def minimize(problem: Problem, etol: float, ftol: float, maxiter: int, maxeval: int,
                 options: Options | None = None, callback=None) -> Result:
        """Minimise; see `asemd.minimize`.

        Source: E. Polak, G. Ribiere, Rev. Fr. Inform. Rech. Oper. 16-R1, 35 (1969).
        """
        state = State(problem, etol, ftol, maxeval, options, callback)
        h = g = state.f.copy()
        gg = float(np.vdot(g, g))
        restart = max(1, state.x.size)
        for iteration in range(1, maxiter + 1):
            state.iterations, state.previous = iteration, state.energy
            why = state.search(h) or state.stop()
            if why:
                return state.result(why)
            ff = float(np.vdot(state.f, state.f))
            beta = max(0.0, (ff - float(np.vdot(state.f, g))) / gg)
            if (iteration + 1) % restart == 0:
                beta = 0.0
            gg, g = ff, state.f.copy()
            h = g + beta * h
            if np.vdot(g, h) <= 0.0:
                h = g
            why = state.report()
            if why:
                return state.result(why)
        return state.result(MAXITER)
