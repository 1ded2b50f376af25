r"""``min_style hftn``: Hessian-free truncated Newton in a trust region.

Every iteration minimises the model

$$m(p) = E - f \cdot p + \tfrac12\, p \cdot H p$$

by conjugate gradients inside a sphere, the trust region. Products with the Hessian $H$ are differences of forces. Close to a minimum the
steps are those of Newton.

Source: the LAMMPS manual page of ``min_style``; S. Nash, J. Comput. Appl. Math. 124, 45 (2000); T. Steihaug, SIAM J. Numer. Anal. 20, 626
(1983); J. Nocedal, S. Wright, Numerical Optimization (1999), chapters 4 and 6. Constants and order of the tests are those with which LAMMPS
takes the same steps.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.minimize import ETOL, FTOL, MAXEVAL, MAXITER, SMALLREGION, Options, Problem, Result
from asemd.minimize._state import State

EPS = float(np.finfo(float).eps)
FORWARD = 2.0 * math.sqrt(1000.0 * EPS)         # length of the displacement of one-sided differences
CENTRAL = (3000.0 * EPS) ** (1.0 / 3.0)         # and of two-sided ones,
SMALL_FORCE = 1000.0 * math.sqrt(EPS)           # which are taken below this length of the forces
NEWTON, BOUNDARY, LONG, NEGATIVE, MANY = range(5)    # how the inner iteration ended; LONG: an atom would move further than dmax


class HFTN:
    """Newton steps found by conjugate gradients, as far as the quadratic model can be trusted."""

    style = "hftn"

    @staticmethod
    def minimize(problem: Problem, etol: float, ftol: float, maxiter: int, maxeval: int,
                 options: Options | None = None, callback=None) -> Result:
        """Minimise; see `asemd.minimize`. Of the options only `dmax` matters."""
        state = State(problem, etol, ftol, maxeval, options, callback)
        if state.options.norm == "max":
            raise InputError("min_style hftn: min_modify norm max is not possible with it, use norm two or inf")
        state.previous = state.energy
        widest = state.options.dmax * math.sqrt(state.x.size)
        region = Region(state, widest)
        if state.force_met():
            return state.result(FTOL)
        for iteration in range(1, maxiter + 1):
            why = region.step(iteration)
            if why:
                state.uncounted = 1
                return state.result(why)
            state.iterations = iteration
            why = state.report()
            if why:
                return state.result(why)
        return state.result(MAXITER)


class Region:
    """The trust region: a sphere around the positions of `state`."""

    def __init__(self, state: State, widest: float):
        self.state, self.widest = state, widest
        self.radius = min(widest, 1.5 * float(np.linalg.norm(state.f)))
        self.again = False      # the last step was taken back

    def step(self, iteration: int) -> str:
        """Try one step; why the minimisation ends with it, or an empty string."""
        state = self.state
        state.evaluations += self.again     # LAMMPS computes the forces once more
        x, f, energy = state.x, state.f.copy(), state.energy
        difference = Difference(state, f)
        how, p = self._inner(difference, f, iteration)
        if p is None:
            state.evaluations += 2
            return ETOL
        slope = float(np.vdot(f, p))
        expected = slope - 0.5 * float(np.vdot(p, difference(p, last=True)))
        before, state.previous = state.previous, difference.energy
        state.evaluate(x + p)
        length = float(np.linalg.norm(p))
        why = FTOL if state.force_met() else ETOL if length > 0.0 and state.energy_met() else ""
        if why:
            state.previous = before     # what LAMMPS reports as next to last
            return why
        self._adjust(how, length, difference.energy - state.energy, expected)
        if self.again:
            if state.problem.shown is not None and state.problem.shown(iteration):
                state.evaluate(x)       # output shows what was computed last
            state.x, state.f, state.energy, state.previous = x, f, energy, before
        if self.radius < EPS:
            return SMALLREGION
        return MAXEVAL if state.evaluations >= state.maxeval else ""

    def _adjust(self, how: int, length: float, gained: float, expected: float) -> None:
        """Accept the step or not, and choose the next radius from how well the model did.

        As in LAMMPS, `gained` is an energy per atom where output is normalised (units lj) and `expected` is not: the radius grows less.
        """
        self.again = not gained > 0.0
        if self.again:
            if length == 0.0:
                self.radius *= 0.1
            elif gained < -expected:
                self.radius = (0.1 if how == NEGATIVE else 0.2) * length
            else:
                self.radius = 0.25 * length
        elif how == LONG:
            self.radius = min(self.radius, 2.0 * length)
        elif how in (BOUNDARY, NEGATIVE) and gained > 0.75 * expected:
            self.radius = 2.0 * length
        self.radius = min(self.radius, self.widest)

    def _inner(self, difference: Difference, f: np.ndarray, iteration: int) -> tuple[int, np.ndarray | None]:
        """How the conjugate gradients ended, and the step; None where there are no evaluations left for one."""
        state = self.state
        p, r = np.zeros_like(f), f.copy()
        d, rr = r.copy(), float(np.vdot(r, r))
        enough = max(min(0.1 / iteration, 0.5 * math.sqrt(rr)), state.ftol) ** 2 * rr
        for _ in range(f.size):
            if state.evaluations >= state.maxeval - 1:
                return MANY, p if p.any() else None
            product = difference(d)
            curvature = float(np.vdot(d, product))
            if curvature <= 0.0:
                state.evaluations += 1
                return NEGATIVE, self._lowest(p, d, f, r, curvature)
            alpha = rr / curvature
            trial = p + alpha * d
            if np.linalg.norm(trial) >= self.radius:
                trial = p + self._to_boundary(p, d)[1] * d
                return (LONG, p) if np.abs(trial).max() > state.options.dmax else (BOUNDARY, trial)
            if np.abs(trial).max() > state.options.dmax:
                return LONG, p
            p, r = trial, r - alpha * product
            last, rr = rr, float(np.vdot(r, r))
            if rr < enough:
                return NEWTON, p
            d = r + rr / last * d
        return MANY, p

    def _to_boundary(self, p: np.ndarray, d: np.ndarray) -> tuple[float, float]:
        """The two lengths along `d` that lead from `p` to the surface of the region."""
        pd, dd = float(np.vdot(p, d)), float(np.vdot(d, d))
        root = math.sqrt(max(0.0, pd * pd + dd * (self.radius**2 - float(np.vdot(p, p)))))
        return (-pd - root) / dd, (-pd + root) / dd

    def _lowest(self, p, d, f, r, curvature: float) -> np.ndarray:
        """The point on the surface of the region, along a direction of negative curvature, where the model is lowest."""
        slope = float(np.vdot(r, d))        # r is the force of the model at p
        tau = min(self._to_boundary(p, d), key=lambda t: 0.5 * curvature * t * t - slope * t)
        return p + tau * d


class Difference:
    """Products of the Hessian at the positions of `state` with directions, from forces at displaced positions.

    Two-sided differences start where the last one ended, as LAMMPS's do: a little aside, by much less than the forces vary over. `energy`
    is what LAMMPS takes for the energy at the start.
    """

    def __init__(self, state: State, f: np.ndarray):
        self.state, self.x, self.f, self.energy = state, state.x, f, state.energy
        self.forward = float(np.linalg.norm(f)) > SMALL_FORCE

    def __call__(self, d: np.ndarray, last: bool = False) -> np.ndarray:
        """The Hessian times `d`; the evaluations are counted as LAMMPS makes them, repeated ones are not carried out."""
        state, length = self.state, float(np.linalg.norm(d))
        if length == 0.0:
            state.evaluations += 1
            return np.zeros_like(d)
        if self.forward:
            step = FORWARD / length
            state.evaluate(self.x + step * d)
            state.evaluations += 1
            return (self.f - state.f) / step
        step = CENTRAL / length
        state.evaluate(self.x + step * d)
        ahead = state.f.copy()
        state.evaluate(self.x - step * d)
        product = (state.f - ahead) / (2.0 * step)
        self.x = self.x - step * d
        if last:
            self.energy = state.evaluate(self.x)
        return product
