r"""Energy minimisers on a plain function of positions. One minimiser, one file: ``cg``, ``sd``, ``fire``, ``quickmin``, ``hftn``.

A minimiser is a class with one static method::

    minimize(problem, etol, ftol, maxiter, maxeval, options, callback) -> Result

`find` gives the class by its LAMMPS name. It works for anything that can be evaluated::

    from asemd.minimize import Options, Problem, find
    problem = Problem(x0=atoms.positions, evaluate=energy_and_forces)
    result = find("cg").minimize(problem, 0.0, 1e-6, 1000, 10000, Options(), None)

`callback(iteration, x, v, energy, forces)` is called after every iteration that did not end the minimisation (output of that step).
When it returns True the minimiser stops with the criterion "interrupted", when it returns text with that criterion.
"""
from __future__ import annotations

import importlib
import math
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from asemd.errors import InputError, nearest

EPS_ENERGY = 1.0e-8     # keeps the relative energy criterion finite near zero energy

ETOL, FTOL = "energy tolerance", "force tolerance"
MAXITER, MAXEVAL = "max iterations", "max force evaluations"
DOWNHILL = "search direction is not downhill"
ZEROALPHA = "linesearch alpha is zero"
ZEROFORCE = "forces are zero"
ZEROQUAD = "quadratic factors are zero"
MAXVDOTF = "max iterations with v.f negative"
SMALLREGION = "trust region too small"
WALLTIME = "walltime limit reached"
INTERRUPTED = "interrupted"


@dataclass
class Problem:
    """What is minimised.

    Parameters
    ----------
    x0 : (n, 3) float array
        Positions to start from, not wrapped; not changed.
    evaluate : callable
        ``x (n, 3) -> (energy, forces (n, 3))``; total energy.
    masses : (n,) float array, optional
        Used by damped dynamics (fire) only; default 1.
    dt : float
        Timestep of damped dynamics.
    units : asemd.units.Units, optional
        Its ``ftm2v`` turns force over mass into acceleration (fire); None is 1, as in ASE's units.
    norm : float
        Energies are divided by this in the energy criterion, in the line search and in the result: the number of atoms
        if thermodynamic output is normalised (units lj), else 1.
    shown : callable, optional
        ``iteration -> bool``: whether output is due, which wants energy and forces where the iteration ends (hftn takes steps back).
    box : object, optional
        If rows of `x0` behind those of the atoms are a box (cg and sd): ``start(x)`` is told of each line search, ``longest(direction)``
        gives its longest step, ``accept(iteration, x)`` whether the energy has another reference after it, `n` the number of atoms.
    move : callable, optional
        Told the velocities (n, 3) of damped dynamics before each evaluation, where forces depend on them.
    """

    x0: np.ndarray
    evaluate: Callable[[np.ndarray], tuple[float, np.ndarray]]
    masses: np.ndarray | None = None
    dt: float = 0.005
    units: Any = None
    norm: float = 1.0
    shown: Callable[[int], bool] | None = None
    box: Any = None
    move: Callable[[np.ndarray], None] | None = None

    @property
    def ftm2v(self) -> float:
        return 1.0 if self.units is None else self.units.ftm2v


@dataclass
class Options:
    """Settings of ``min_modify``, with LAMMPS's defaults.

    Parameters
    ----------
    dmax : float
        Largest move of any coordinate in one line search or step, distance units.
    line : str
        ``quadratic``, ``backtrack``, ``forcezero``; ``spin_cubic`` and ``spin_none`` are for spins, and cg and sd cannot use them.
    norm : str
        ``two`` (length of the whole force vector), ``max`` (longest force on an atom) or ``inf`` (largest component).
    integrator, tmax, tmin, delaystep, dtgrow, dtshrink, alpha0, alphashrink, vdfmax, halfstepback, initialdelay, abcfire
        Of style fire; see ``min_modify``.
    """

    dmax: float = 0.1
    line: str = "quadratic"
    norm: str = "two"
    integrator: str = "eulerimplicit"
    tmax: float = 10.0
    tmin: float = 0.02
    delaystep: int = 20
    dtgrow: float = 1.1
    dtshrink: float = 0.5
    alpha0: float = 0.25
    alphashrink: float = 0.99
    vdfmax: int = 2000
    halfstepback: bool = True
    initialdelay: bool = True
    abcfire: bool = False

    WORDS = {"line": ("quadratic", "backtrack", "forcezero", "spin_cubic", "spin_none"), "norm": ("two", "max", "inf"),
             "integrator": ("eulerimplicit", "verlet", "leapfrog", "eulerexplicit")}

    def modify(self, words: list[str]) -> None:
        """Apply the words of a ``min_modify`` command.

        Raises
        ------
        InputError
            Unknown keyword, missing or wrong value.
        """
        kinds = {f.name: type(getattr(self, f.name)) for f in fields(self)}
        if not words:
            raise InputError("min_modify needs a keyword and a value")
        if len(words) % 2:
            raise InputError(f"min_modify: keyword {words[-1]!r} has no value")
        for key, word in zip(words[::2], words[1::2]):
            if key in ("alpha_damp", "discrete_factor"):
                raise InputError(f"min_modify {key} {word} is for spins, which are not supported")
            if key not in kinds:
                raise InputError(f"min_modify: unknown keyword {key!r}{nearest(key, kinds)}")
            setattr(self, key, self._read(key, word, kinds[key]))

    def _read(self, key: str, word: str, kind: type) -> Any:
        if key in self.WORDS:
            if word not in self.WORDS[key]:
                raise InputError(f"min_modify {key}: expected one of {' '.join(self.WORDS[key])}, got {word!r}")
            return word
        if kind is bool:
            if word not in ("yes", "no", "on", "off", "true", "false"):
                raise InputError(f"min_modify {key}: expected yes or no, got {word!r}")
            return word in ("yes", "on", "true")
        try:
            value = kind(word)
        except ValueError:
            raise InputError(f"min_modify {key}: expected a number, got {word!r}") from None
        if not math.isfinite(value) or (value <= 0 and key not in ("vdfmax", "delaystep", "tmin", "alpha0")):
            raise InputError(f"min_modify {key}: {word} is not a positive number")
        return value


class Result(NamedTuple):
    """The numbers of LAMMPS's block ``Minimization stats``, and the final state.

    Energies are divided by `Problem.norm`.
    """

    criterion: str
    energy_initial: float
    energy_previous: float
    energy_final: float
    fnorm_initial: float
    fnorm_final: float
    fmax_initial: float
    fmax_final: float
    alpha: float
    max_move: float
    iterations: int
    evaluations: int
    x: np.ndarray
    v: np.ndarray
    forces: np.ndarray
    dt: float
    steps: int          # of output: `iterations`, and one more where a style does not count the one that converges

    @property
    def converged(self) -> bool:
        """True unless a limit on the number of iterations or evaluations, or an interruption, ended it."""
        return self.criterion not in (MAXITER, MAXEVAL, MAXVDOTF, WALLTIME, INTERRUPTED)

    def text(self) -> str:
        """LAMMPS's block, for the log."""
        return "\n".join([
            "Minimization stats:",
            f"  Stopping criterion = {self.criterion}",
            "  Energy initial, next-to-last, final = ",
            f"    {self.energy_initial:18.15g} {self.energy_previous:18.15g} {self.energy_final:18.15g}",
            f"  Force two-norm initial, final = {self.fnorm_initial:.8g} {self.fnorm_final:.8g}",
            f"  Force max component initial, final = {self.fmax_initial:.8g} {self.fmax_final:.8g}",
            f"  Final line search alpha, max atom move = {self.alpha:.8g} {self.max_move:.8g}",
            f"  Iterations, force evaluations = {self.iterations} {self.evaluations}"])


def find(style: str) -> type:
    """The class of a minimiser by its LAMMPS name.

    Raises
    ------
    InputError
        Unknown style; the message offers the nearest match.
    """
    known = [m.name for m in pkgutil.iter_modules(__path__) if not m.name.startswith("_")]
    if style not in known:
        raise InputError(f"unknown min_style {style!r}{nearest(style, known)}; there are {' '.join(sorted(known))}")
    module = importlib.import_module(f"asemd.minimize.{style}")
    return next(c for c in vars(module).values() if getattr(c, "style", "") == style)
