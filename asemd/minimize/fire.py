"""``min_style fire``: damped dynamics with an adaptive timestep, FIRE 2.0, and ABC-FIRE, which corrects the bias of its first steps."""
from __future__ import annotations

import math

import numpy as np

from asemd.minimize import ETOL, FTOL, MAXITER, MAXVDOTF, Options, Problem, Result
from asemd.minimize._state import State

COLUMNS = {"dmax": 5, "delaystep": 9, "dtgrow": 6, "dtshrink": 8, "alpha0": 6, "alphashrink": 11, "tmax": 4, "tmin": 4, "integrator": 14,
           "halfstepback": 12, "abcfire": 11}
SMALLEST = 1.0e-10      # alpha of ABC-FIRE, so that its correction stays finite


class FIRE:
    """Dynamics that turn towards the force, speed up while they go downhill and stop dead when they go uphill."""

    style = "fire"

    @staticmethod
    def parameters(options: Options) -> str:
        """The table of settings in LAMMPS's log."""
        def cell(name: str, width: int) -> str:
            value = getattr(options, name)
            return f"{('no', 'yes')[value] if isinstance(value, bool) else str(value).removesuffix('.0'):^{width}}"
        return "\n".join(["  Parameters for fire:", "    " + " ".join(f"{name:^{width}}" for name, width in COLUMNS.items()),
                          "    " + " ".join(cell(name, width) for name, width in COLUMNS.items())])

    @staticmethod
    def minimize(problem: Problem, etol: float, ftol: float, maxiter: int, maxeval: int,
                 options: Options | None = None, callback=None) -> Result:
        """Minimise; see `asemd.minimize`. `Problem.masses` and `Problem.dt` matter here; `maxeval` does not end it, as in LAMMPS.

        Source: E. Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006); J. Guenole et al., Comput. Mater. Sci. 175, 109584 (2020);
        ``abcfire``: S. Echeverri Restrepo, P. Andric, Comput. Mater. Sci. 218, 111978 (2023).
        """
        state = State(problem, etol, ftol, maxeval, options, callback)
        o = state.options
        mass = np.ones(len(state.x)) if problem.masses is None else np.asarray(problem.masses, dtype=float)
        kick = problem.ftm2v / mass[:, None]
        start_dt, alpha, uphill, downhill, last_uphill, at_rest = state.dt, o.alpha0, 0, 0, 0, True
        if o.integrator == "leapfrog":
            state.evaluate(state.x)
            state.v = -0.5 * state.dt * kick * state.f
        for iteration in range(1, maxiter + 1):
            state.iterations, mix = iteration, None
            power = float(np.vdot(state.v, state.f))
            if power > 0.0:
                uphill, downhill = 0, downhill + 1
                vv, ff = float(np.vdot(state.v, state.v)), float(np.vdot(state.f, state.f))
                mix = 1.0 - alpha, alpha * math.sqrt(vv / ff) if ff > 1e-20 else 0.0
                if o.abcfire:
                    bias = 1.0 - (1.0 - max(alpha, SMALLEST)) ** downhill
                    mix = mix[0] / bias, mix[1] / bias
                if iteration - last_uphill > o.delaystep:
                    state.dt = min(state.dt * o.dtgrow, o.tmax * start_dt)
                    alpha *= o.alphashrink
            else:
                last_uphill, downhill = iteration, 0
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
    o, v, dt = state.options, state.v, state.dt
    if not o.abcfire:
        if at_rest:     # positions have changed; the first kick decides how far atoms would go
            state.evaluate(state.x)
        largest = float(np.abs(dt * kick * state.f if at_rest else v).max(initial=0.0))
        if dt * largest > o.dmax:
            dt = o.dmax / largest

    def turned(v):
        if mix is None:
            return v
        v = mix[0] * v + mix[1] * state.f
        return np.clip(v, -o.dmax / dt, o.dmax / dt) if o.abcfire else v

    if o.integrator == "verlet":
        v = turned(v + 0.5 * dt * kick * state.f)
    elif o.integrator == "eulerexplicit":
        v = turned(v)
    else:
        v = turned(v + dt * kick * state.f)
    x = state.x + dt * v
    if o.integrator == "eulerexplicit":
        v = v + dt * kick * state.f
    state.previous, state.v = state.energy, v
    state.evaluate(x)
    if o.integrator == "verlet":
        state.v = v + 0.5 * dt * kick * state.f
