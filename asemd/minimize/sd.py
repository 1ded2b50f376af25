"""``min_style sd``: steepest descent."""
from __future__ import annotations

from asemd.minimize import MAXITER, Options, Problem, Result
from asemd.minimize._state import State


class SD:
    """Every direction is the force."""

    style = "sd"

    @staticmethod
    def minimize(problem: Problem, etol: float, ftol: float, maxiter: int, maxeval: int,
                 options: Options | None = None, callback=None) -> Result:
        """Minimise; see `asemd.minimize`."""
        state = State(problem, etol, ftol, maxeval, options, callback)
        for iteration in range(1, maxiter + 1):
            state.iterations, state.previous = iteration, state.energy
            why = state.search(state.f.copy()) or state.stop() or state.report()
            if why:
                return state.result(why)
        return state.result(MAXITER)
