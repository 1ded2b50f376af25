"""``min_style quickmin``: damped dynamics that keeps only the velocity along the force."""
from __future__ import annotations

import numpy as np

from asemd.minimize import ETOL, FTOL, MAXITER, Options, Problem, Result
from asemd.minimize._state import State

REST = 5        # steps after a stop during which the energy criterion is not looked at


class QuickMin:
    """Dynamics whose velocity is turned into the force at every step, and set to zero where it goes uphill."""

    style = "quickmin"

    @staticmethod
    def minimize(problem: Problem, etol: float, ftol: float, maxiter: int, maxeval: int,
                 options: Options | None = None, callback=None) -> Result:
        """Minimise; see `asemd.minimize`. `Problem.masses` and `Problem.dt` matter here; `maxeval` does not end it, as in LAMMPS.

        Source: D. Sheppard, R. Terrell, G. Henkelman, J. Chem. Phys. 128, 134106 (2008).
        """
        state = State(problem, etol, ftol, maxeval, options, callback)
        mass = np.ones(len(state.x)) if problem.masses is None else np.asarray(problem.masses, dtype=float)
        kick = problem.ftm2v / mass[:, None]
        stopped = 0
        for iteration in range(1, maxiter + 1):
            state.iterations = iteration
            power, square = float(np.vdot(state.v, state.f)), float(np.vdot(state.f, state.f))
            if power > 0.0:
                v = power / square * state.f
            else:
                v, stopped = np.zeros_like(state.v), iteration
            largest = float(np.abs(v).max(initial=0.0))
            dt = state.options.dmax / largest if state.dt * largest > state.options.dmax else state.dt
            x, state.v = state.x + dt * v, v + dt * kick * state.f
            state.previous = state.energy
            state.evaluate(x)
            if etol > 0.0 and iteration - stopped > REST and state.energy_met():
                return state.result(ETOL)
            if state.force_met():
                return state.result(FTOL)
            why = state.report()
            if why:
                return state.result(why)
        return state.result(MAXITER)
