"""``min_style fire``: damped dynamics with an adaptive timestep, FIRE 2.0."""
from __future__ import annotations

import math

import numpy as np

from asemd.minimize import ETOL, FTOL, MAXITER, MAXVDOTF, Options, Problem, Result
from asemd.minimize._state import State


class FIRE:
    """Dynamics that turn towards the force, speed up while they go downhill and stop dead when they go uphill."""

    style = "fire"

    @staticmethod
    def minimize(problem: Problem, etol: float, ftol: float, maxiter: int, maxeval: int,
                 options: Options | None = None, callback=None) -> Result:
        """Minimise; see `asemd.minimize`. `Problem.masses` and `Problem.dt` matter here; `maxeval` does not end it, as in LAMMPS.

        Source: E. Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006); J. Guenole et al., Comput. Mater. Sci. 175, 109584 (2020).
        """
        state = State(problem, etol, ftol, maxeval, options, callback)
        o = state.options
        mass = np.ones(len(state.x)) if problem.masses is None else np.asarray(problem.masses, dtype=float)
        kick = problem.ftm2v / mass[:, None]
        start_dt, alpha, uphill, last_uphill, at_rest = state.dt, o.alpha0, 0, 0, True
        if o.integrator == "leapfrog":
            state.evaluate(state.x)
            state.v = -0.5 * state.dt * kick * state.f
        for iteration in range(1, maxiter + 1):
            state.iterations, mix = iteration, None
            power = float(np.vdot(state.v, state.f))
            if power > 0.0:
                uphill = 0
                vv, ff = float(np.vdot(state.v, state.v)), float(np.vdot(state.f, state.f))
                mix = 1.0 - alpha, alpha * math.sqrt(vv / ff) if ff > 1e-20 else 0.0
                if iteration - last_uphill > o.delaystep:
                    state.dt = min(state.dt * o.dtgrow, o.tmax * start_dt)
                    alpha *= o.alphashrink
            else:
                last_uphill = iteration
                uphill += 1
                if 0 < o.vdfmax < uphill:
                    return state.result(MAXVDOTF)
                if not (iteration < o.delaystep and o.initialdelay):
                    alpha = o.alpha0
                    if state.dt * o.dtshrink >= o.tmin * start_dt:
                        state.dt *= o.dtshrink
                if o.halfstepback:
                    state.x = state.x - 0.5 * state.dt * state.v
                state.v = np.zeros_like(state.v)
                at_rest = True
            step(state, kick, mix, at_rest)
            at_rest = False
            if etol > 0.0 and iteration - last_uphill > o.delaystep and state.energy_met():
                return state.result(ETOL)
            if state.force_met():
                return state.result(FTOL)
            why = state.report()
            if why:
                return state.result(why)
        return state.result(MAXITER)


def step(state: State, kick: np.ndarray, mix: tuple[float, float] | None, at_rest: bool) -> None:
    """One step of dynamics; `mix` turns the velocity towards the force."""
    o, v = state.options, state.v
    if at_rest:     # positions have changed; the first kick decides how far atoms would go
        state.evaluate(state.x)
    largest = float(np.abs(state.dt * kick * state.f if at_rest else v).max(initial=0.0))
    dt = o.dmax / largest if state.dt * largest > o.dmax else state.dt

    def turned(v):
        return v if mix is None else mix[0] * v + mix[1] * state.f

    if o.integrator == "verlet":
        v = turned(v + 0.5 * dt * kick * state.f)
    elif o.integrator == "eulerexplicit":
        v = turned(v)
    else:
        v = turned(v + dt * kick * state.f)
    x = state.x + dt * v
    if o.integrator == "eulerexplicit":
        v = v + dt * kick * state.f
    state.previous = state.energy
    state.evaluate(x)
    if o.integrator == "verlet":
        v = v + 0.5 * dt * kick * state.f
    state.v = v
