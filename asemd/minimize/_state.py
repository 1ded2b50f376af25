"""What minimisers share: the state they move, the stopping rules, the line searches."""
from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.minimize import DOWNHILL, EPS_ENERGY, ETOL, FTOL, INTERRUPTED, MAXEVAL, ZEROALPHA, ZEROFORCE, ZEROQUAD, Options, Problem, Result

ALPHA_MAX = 1.0         # longest step along the direction, in units of it
ALPHA_REDUCE = 0.5      # backtracking halves the step
BACKTRACK_SLOPE = 0.4   # part of the linear estimate the energy must fall by
QUADRATIC_TOL = 0.1     # how well the energy must look like a parabola
EMACH = 1.0e-8          # energy changes below this are noise
EPS_QUAD = 1.0e-28      # slopes below this are zero
GRADIENT_TOL = 0.1      # forcezero: part of the first slope that may be left,
FIRST_FALL = 0.1        # part of the energy by which the first step may lower it,
SHORTEST = 1.0e-14      # shortest step,
NOISE = 1.0e-12         # rise of the energy that counts for nothing


class State:
    """Positions, velocities, energy and forces of a minimisation, and the counts.

    Parameters
    ----------
    problem : Problem
    options : Options, mapping of its fields, or None for the defaults
    callback : callable or None
    """

    def __init__(self, problem: Problem, etol: float, ftol: float, maxeval: int,
                 options: Options | Mapping | None, callback: Callable | None):
        self.problem, self.etol, self.ftol, self.maxeval, self.callback = problem, etol, ftol, maxeval, callback
        self.options = options if isinstance(options, Options) else Options(**(options or {}))
        self.x = np.array(problem.x0, dtype=float)
        self.v = np.zeros_like(self.x)
        self.dt = float(problem.dt)
        self.alpha, self.iterations, self.evaluations, self.uncounted = 0.0, 0, 0, 0
        self._look()
        self.initial, self.previous = self.energy, 0.0
        self.first = self._norms()

    def _look(self) -> None:
        energy, forces = self.problem.evaluate(self.x)
        self.energy, self.f = float(energy) / self.problem.norm, np.asarray(forces, dtype=float)
        if not (np.isfinite(self.energy) and np.isfinite(self.f).all()):
            bad = np.flatnonzero(~np.isfinite(self.f).all(axis=1))
            raise SimulationError("minimize: the " + (f"force on atom row {bad[0]}" if bad.size else "energy") + " is not a finite number")

    def evaluate(self, x: np.ndarray) -> float:
        """Go to `x`; the energy there."""
        self.x = x
        self.evaluations += 1
        if self.problem.move is not None:
            self.problem.move(self.v)
        self._look()
        return self.energy

    def _norms(self) -> tuple[float, float]:
        return float(np.sqrt(np.vdot(self.f, self.f))), float(np.abs(self.f).max(initial=0.0))

    def energy_met(self) -> bool:
        """The relative change of energy in the last iteration is below etol."""
        return abs(self.energy - self.previous) < self.etol * 0.5 * (abs(self.energy) + abs(self.previous) + EPS_ENERGY)

    def force_met(self) -> bool:
        """The norm of the forces that ``min_modify norm`` chose is below ftol."""
        if self.ftol <= 0.0:
            return False
        kind = self.options.norm
        if kind == "two":
            square = np.vdot(self.f, self.f)
        elif kind == "max":
            square = (self.f * self.f).sum(axis=1).max(initial=0.0)
        else:
            square = (self.f * self.f).max(initial=0.0)
        return square < self.ftol * self.ftol

    def stop(self) -> str:
        """The criterion met after a line search, or an empty string."""
        return MAXEVAL if self.evaluations >= self.maxeval else ETOL if self.energy_met() else FTOL if self.force_met() else ""

    def report(self) -> str:
        """Tell the callback that an iteration is over; what stops the minimisation if it asks for that."""
        asked = self.callback is not None and self.callback(self.iterations, self.x, self.v, self.energy * self.problem.norm, self.f)
        return asked if isinstance(asked, str) else INTERRUPTED if asked else ""

    def result(self, criterion: str) -> Result:
        norm, largest = self._norms()
        return Result(criterion, self.initial, self.previous, self.energy, self.first[0], norm, self.first[1], largest,
                      self.alpha, self.alpha * largest, self.iterations, self.evaluations, self.x, self.v, self.f, self.dt,
                      self.iterations + self.uncounted)

    def search(self, h: np.ndarray) -> str:
        """Move along the direction `h` by the line search of the options; why it failed, or an empty string."""
        slope = float(np.vdot(self.f, h)) / self.problem.norm
        if slope <= 0.0:
            return DOWNHILL
        box = self.problem.box
        if not h.any():
            return ZEROFORCE
        largest = float(np.abs(h if box is None else h[:box.n]).max())
        alpha = self.options.dmax / largest if largest > 0.0 else ALPHA_MAX
        if self.options.line != "forcezero":
            alpha = min(ALPHA_MAX, alpha)
        if box is not None:
            alpha = min(alpha, box.longest(h))
            box.start(self.x)
        lines = {"quadratic": self._quadratic, "backtrack": self._backtrack, "forcezero": self._force_zero}
        if self.options.line not in lines:
            raise InputError(f"min_modify line {self.options.line} is for spins, which are not supported: choose {' '.join(lines)}")
        why = lines[self.options.line](h, slope, alpha)
        if box is not None and not why and box.accept(self.iterations, self.x):
            self._look()
        return why

    def _slope(self, h: np.ndarray) -> float:
        return float(np.vdot(self.f, h)) / self.problem.norm

    def _give_up(self, x0: np.ndarray, start: float, why: str) -> str:
        """Back to where the search began; if the energy had still fallen a little, the energy has converged."""
        fallen = self.energy < start
        self.evaluate(x0)
        if why == ZEROALPHA and fallen:
            return ETOL
        return why

    def _backtrack(self, h, slope, alpha):
        """Halve the step until the energy falls by enough (Nocedal and Wright, Numerical Optimization, procedure 3.1)."""
        x0, start = self.x, self.energy
        while True:
            self.alpha = alpha
            self.evaluate(x0 + alpha * h)
            wanted = -BACKTRACK_SLOPE * alpha * slope
            if self.energy - start <= wanted:
                return ""
            alpha *= ALPHA_REDUCE
            if alpha <= 0.0 or wanted >= -EMACH:
                return self._give_up(x0, start, ZEROALPHA)

    def _quadratic(self, h, slope, alpha):
        """Backtracking, with a jump to the zero of the slope's secant where the energy looks like a parabola."""
        x0, start, longest = self.x, self.energy, alpha
        previous, previous_energy, previous_alpha = slope, start, 0.0
        while True:
            self.alpha = alpha
            energy = self.evaluate(x0 + alpha * h)
            now = self._slope(h)
            change = now - previous
            if abs(now) < EPS_QUAD or abs(change) < EPS_QUAD:
                return self._give_up(x0, start, ZEROQUAD)
            error = abs(1.0 - (0.5 * (alpha - previous_alpha) * (now + previous) + energy) / previous_energy) if previous_energy else 1.0
            zero = alpha - (alpha - previous_alpha) * now / change
            if error <= QUADRATIC_TOL and 0.0 < zero < longest:
                energy = self.evaluate(x0 + zero * h)     # the reported alpha stays that of the first try
                if energy - start < EMACH:
                    return ""
            wanted = -BACKTRACK_SLOPE * alpha * slope
            if energy - start <= wanted:
                return ""
            previous, previous_energy, previous_alpha = now, energy, alpha
            alpha *= ALPHA_REDUCE
            if alpha <= 0.0 or wanted >= -EMACH:
                return self._give_up(x0, start, ZEROALPHA)

    def _force_zero(self, h, slope, alpha):
        """Walk by secants until the slope has all but vanished, as long as the energy falls; shorten the step where it does not."""
        x0, start, longest = self.x, self.energy, alpha
        before, before_slope, before_energy = 0.0, slope, start
        delta = min(0.5 * longest, max(FIRST_FALL * abs(start) / slope, EPS_QUAD))
        while delta > SHORTEST:
            alpha = before + delta
            energy, now = self.evaluate(x0 + alpha * h), self._slope(h)
            fell = energy - before_energy <= NOISE
            if fell and abs(now) <= GRADIENT_TOL * slope:
                self.alpha = alpha
                return ""
            if now < 0.0:       # past the zero
                delta *= before_slope / (before_slope - now)
            elif not fell:
                delta *= 0.1
            else:               # on; not where the slope does not fall, and not too far
                ahead = delta * now / (before_slope - now) if now < before_slope else longest
                if alpha + ahead > longest:
                    self.alpha = alpha
                    return ""
                before, before_slope, before_energy, delta = alpha, now, energy, ahead
        self.alpha = before
        self.evaluate(x0)
        return ZEROALPHA
