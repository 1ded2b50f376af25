r"""Short runs of a copy of a scene: what is conserved and how well, by which order in the timestep, at which temperatures.

At constant energy the conserved quantity is :math:`E = K + U`, of thermostats besides :math:`-\int \dot Q\,dt`. Its drift is the slope of a
straight line through E(t), in :math:`k_B T` per degree of freedom and nanosecond (``units lj``: per 1000 :math:`\tau`); its fluctuation is
the root mean square around that line, which velocity Verlet makes proportional to :math:`\Delta t^2`. A pair energy that is cut off and
not shifted jumps at the cutoff although the force does not: here it is shifted, for that is what the forces conserve.

The configurational temperature :math:`k_B T = \langle |\nabla U|^2 \rangle / \langle \nabla^2 U \rangle` knows nothing of velocities.

Source: L. Verlet, Phys. Rev. 159, 98 (1967); H. H. Rugh, Phys. Rev. Lett. 78, 772 (1997), for the configurational
temperature.
"""
from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from asemd import units as unit_styles
from asemd.compute.temp import Temp
from asemd.engine import Settings
from asemd.errors import InputError, SimulationError
from asemd.fix.nve import NVE
from asemd.loop import Loop
from asemd.report.configurational import Probe
from asemd.report.constraints import holding
from asemd.report.copies import copied, load, warm
from asemd.report.statistics import block_error, fit_exponent, residual, slope
from asemd.scene import Scene


@dataclass
class Series:
    """What a run showed, sample by sample, in units of the scene.

    Attributes
    ----------
    dt : float
        Timestep.
    time, potential, kinetic, conserved, temperature : (m,) arrays
        Of the samples, the first one before the first step. `temperature` is the kinetic one.
    configurational : (m,) array
        Configurational temperature; nan where it was not asked for.
    constraint : (m,) array
        Largest error of constraints, as fixes with ``constraint_error(loop)`` tell it; zeros without any.
    dof : float
        Degrees of freedom.
    seconds : (m - 1,) array
        Wall time of each stretch between samples, list builds included, without set-up.
    processor : (m - 1,) array
        Processor time of the same stretches, of all threads together.
    setup_seconds : float
        Wall time of set-up: lists, first forces, compilation.
    steps : int
        Steps carried out.
    builds, dangerous : int
        Lists built in these steps; builds that may have come too late.
    failed : str
        Why the run ended early, empty if it did not.
    system : asemd.system.System
        The copy, as it was at the end.
    """

    dt: float
    units: str
    n: int
    dof: float
    time: np.ndarray
    potential: np.ndarray
    kinetic: np.ndarray
    conserved: np.ndarray
    temperature: np.ndarray
    configurational: np.ndarray
    constraint: np.ndarray
    seconds: np.ndarray
    processor: np.ndarray
    setup_seconds: float
    steps: int
    builds: int = 0
    dangerous: int = 0
    failed: str = ""
    system: object = field(default=None, repr=False)

    @property
    def kt(self) -> float:
        """Boltzmann's constant times the mean kinetic temperature, energy units."""
        return unit_styles.get(self.units).boltz * float(np.mean(self.temperature)) if len(self.time) else math.nan

    @property
    def span(self) -> float:
        """The time that drifts refer to: one nanosecond, 1000 tau in ``units lj``; in time units."""
        return span(self.units)

    def _scale(self) -> float:
        return self.span / (self.kt * self.dof) if self.kt * self.dof > 0.0 else math.nan

    @property
    def drift(self) -> float:
        """Slope of the conserved quantity in kT per degree of freedom and ns (1000 tau in ``units lj``)."""
        return slope(self.time, self.conserved)[0] * self._scale()

    @property
    def drift_error(self) -> float:
        """Standard error of `drift`, by blocks."""
        return slope(self.time, self.conserved)[1] * self._scale()

    @property
    def fluctuation(self) -> float:
        """Root mean square of the conserved quantity around its straight line, energy units of the whole system."""
        return float(np.sqrt(np.mean(residual(self.time, self.conserved) ** 2))) if len(self.time) > 2 else math.nan

    @property
    def fluctuation_error(self) -> float:
        """Standard error of `fluctuation`, from its values in five stretches of the run."""
        if len(self.time) < 20:
            return math.nan
        squares = [float(np.mean(part)) for part in np.array_split(residual(self.time, self.conserved) ** 2, 5)]
        return float(np.std(squares, ddof=1)) / math.sqrt(5.0) / (2.0 * self.fluctuation) if self.fluctuation > 0.0 else 0.0

    @property
    def relative_fluctuation(self) -> float:
        """`fluctuation` divided by that of the kinetic energy; above 0.2 a timestep is too long."""
        scatter = float(np.std(self.kinetic))
        return self.fluctuation / scatter if scatter > 0.0 else math.nan

    @property
    def seconds_per_step(self) -> float:
        """Median over the stretches."""
        return float(np.median(self.step_seconds)) if len(self.step_seconds) else math.nan

    @property
    def step_seconds(self) -> np.ndarray:
        """Wall time of one step in each stretch; the first stretch is left out where there are others."""
        return self._per_step(self.seconds)

    @property
    def step_processor(self) -> np.ndarray:
        """Processor time of one step in each stretch, likewise."""
        return self._per_step(self.processor)

    def _per_step(self, seconds: np.ndarray) -> np.ndarray:
        steps = np.diff(self.time) / self.dt
        per = seconds[:len(steps)] / steps
        return per[1:] if len(per) > 1 else per


@dataclass
class Order:
    """How the fluctuation of the conserved quantity depends on the timestep: ``fluctuation ~ dt**exponent``.

    Attributes
    ----------
    dt, fluctuation, drift : (k,) arrays
        Of the runs that reached their end.
    exponent, error : float
        Slope of a straight line in both logarithms and its standard error; near 2 for velocity Verlet.
    series : list of Series
        All runs, those that failed included.
    """

    dt: np.ndarray
    fluctuation: np.ndarray
    drift: np.ndarray
    exponent: float
    error: float
    series: list[Series] = field(repr=False, default_factory=list)


# ------------------------------------------------------------------------------------------------------------------------ runs ---

def run(source, dt: float | None = None, steps: int = 1000, settings: Settings | None = None, *, precision: str | None = None,
        threads: int | None = None, fixes: str = "nve", levels=None, samples: int = 200, configurational: int = 0,
        temperature: float | None = None, seed: int = 1, shift: bool = True, observe: Callable | None = None,
        deadline: float = math.inf) -> Series:
    """Run a copy of a scene.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        See `asemd.report.copies.load`.
    dt : float, optional
        Timestep in time units of the scene; by default its own.
    steps : int
    settings : asemd.engine.Settings, optional
        Neighbour settings in place of the scene's own; its exclusions are those of the scene (group names).
    precision, threads : optional
        In place of those of the scene.
    fixes : str
        ``nve``: constant energy for the atoms that the script's own fixes move (all if none does), under its forces that do not depend on
        velocities. ``own``: the fixes of the scene as they are.
    levels : asemd.respa.Levels, optional
        Multiple timesteps, by default those of the scene (``run_style respa``); `dt` is the outermost one.
    samples : int
        How often energies are looked at, at equal distances; each sample costs one computation of energies.
    configurational : int
        How many of the samples have a configurational temperature; none has where fixes hold distances, for its formula asks for free
        coordinates.
    temperature : float, optional
        Fresh velocities of this temperature before the run; by default those of the scene.
    seed : int
        Of fresh velocities, and of the directions that the configurational temperature is measured along.
    shift : bool
        Shift pair energies to zero at the cutoff, which changes no force.
    observe : callable, optional
        ``observe(k, loop, result)`` sees each sample, from k = 0; it must change nothing.
    deadline : float
        Reading of ``time.perf_counter`` at which the run stops early, between two samples.

    Returns
    -------
    Series
        With ``failed`` set if the run could not reach its end.

    Raises
    ------
    InputError
        What `load` finds, an unknown word, a number that is not positive.
    """
    scene = copied(source) if isinstance(source, Scene) else load(source)
    if fixes not in ("nve", "own"):
        raise InputError(f"fixes must be 'nve' or 'own', got {fixes!r}")
    dt = scene.dt if dt is None else float(dt)
    if not (dt > 0.0 and steps >= 1 and samples >= 1):
        raise InputError(f"a run needs a positive timestep, steps and samples, got dt {dt:g}, steps {steps}, samples {samples}")
    prepare(scene, settings, precision, threads, shift)
    if temperature is not None:
        warm(scene, temperature, seed)
    chosen = constant_energy(scene) if fixes == "nve" else [*scene.dynamic_groups.values(), *scene.fixes.values()]
    potentials = [f for f in scene.fixes.values() if f in chosen and f.minimizes and f.modify_option("energy", "yes", None)]
    baths = [f for f in chosen if f.ecouple]
    for fix in baths:
        if hasattr(fix, "tally"):
            fix.tally = True
    loop = make_loop(scene, chosen, dt, levels or scene.respa)
    configurational = 0 if holding(scene) else configurational
    probe = Probe(scene, seed) if configurational else None
    return _carry_out(scene, loop, steps, samples, configurational, potentials, baths, probe, observe, deadline)


def start(source: Scene, fixes: str = "nve") -> Loop:
    """A loop for a copy of a scene as it is, set up and ready for ``advance``."""
    scene = copied(source)
    chosen = constant_energy(scene) if fixes == "nve" else [*scene.dynamic_groups.values(), *scene.fixes.values()]
    loop = make_loop(scene, chosen, scene.dt, scene.respa)
    loop.setup(loop.step, loop.step)
    return loop


def _carry_out(scene, loop, steps, samples, configurational, potentials, baths, probe, observe, deadline) -> Series:
    every = max(1, steps // samples)
    marks = [*range(every, steps, every), steps]
    looks = set(np.unique(np.linspace(0, len(marks), configurational + 1, dtype=int)[1:])) if configurational else set()
    temp = Temp(movers(scene, loop.fixes))
    keep = {name: [] for name in ("time", "potential", "kinetic", "conserved", "temperature", "configurational", "constraint")}
    seconds, processor, failed, done = [], [], "", 0

    def look(k: int, result) -> None:
        state = loop.snapshot()
        dof, t = temp.dof(state), temp.scalar(state)
        kinetic = 0.5 * dof * state.units.boltz * t
        potential = result.potential + sum(f.scalar() for f in potentials)
        values = (done * loop.dt, potential, kinetic, kinetic + potential + sum(f.scalar() for f in baths), t,
                  probe.temperature(loop.system) if k in looks else math.nan,
                  max((f.constraint_error(loop) for f in loop.fixes if hasattr(f, "constraint_error")), default=0.0))
        for series, value in zip(keep.values(), values, strict=True):
            series.append(value)
        if observe is not None:
            observe(k, loop, result)

    began = time.perf_counter()
    try:
        result = loop.setup(loop.step, loop.step + steps)
        loop.advance(0)
        setup = time.perf_counter() - began
        builds = loop.engine.builds
        look(0, result)
        for k, mark in enumerate(marks, 1):
            began = time.perf_counter()
            if began > deadline and done:
                break
            own = time.process_time()
            result = loop.advance(mark - done)
            seconds.append(time.perf_counter() - began)
            processor.append(time.process_time() - own)
            done = mark
            look(k, result)
            if not math.isfinite(keep["conserved"][-1]):
                failed = f"step {done}: the energy is not finite"
                break
    except SimulationError as error:
        failed = str(error)
        setup, builds = (setup, builds) if keep["time"] else (time.perf_counter() - began, 0)
    dof = temp.dof(loop.snapshot()) if keep["time"] else math.nan
    return Series(loop.dt, scene.units, scene.system.n, dof, *(np.array(v) for v in keep.values()), np.array(seconds), np.array(processor),
                  setup, done,
                  loop.engine.builds - builds, loop.engine.dangerous, failed, scene.system)


def order(source, dts: Sequence[float], duration: float | None = None, **options) -> Order:
    """The order of the integrator, from runs that start alike and cover the same time.

    Parameters
    ----------
    source
        As of `run`.
    dts : sequence of float
        Timesteps, two or more; best over a factor of 4 or more, all of them stable.
    duration : float, optional
        Time each run covers; by default 200 of the longest steps.
    **options
        Of `run`.

    Raises
    ------
    InputError
        Fewer than two timesteps.
    """
    dts = sorted(float(dt) for dt in dts)
    if len(set(dts)) < 2:
        raise InputError("the order needs runs with two timesteps or more")
    scene = source if isinstance(source, Scene) else load(source)
    duration = 200 * dts[-1] if duration is None else float(duration)
    options.setdefault("samples", max(20, int(round(duration / dts[-1]))))
    series = [run(scene, dt, max(1, int(round(duration / dt))), **options) for dt in dts]
    good = [s for s in series if not s.failed and s.fluctuation > 0.0]
    x, y = np.array([s.dt for s in good]), np.array([s.fluctuation for s in good])
    exponent, error = fit_exponent(x, y)
    return Order(x, y, np.array([s.drift for s in good]), exponent, error, series)


# -------------------------------------------------------------------------------------------------------------------- the copy ---

def prepare(scene: Scene, settings: Settings | None = None, precision: str | None = None, threads: int | None = None,
            shift: bool = True) -> None:
    """Put settings into a scene that is ours; shifted pair energies conserve what the forces conserve."""
    if settings is not None:
        scene.neighbor = replace(settings, exclude=scene.neighbor.exclude)
    scene.precision = scene.precision if precision is None else precision
    scene.threads = scene.threads if threads is None else threads
    if shift:
        scene.interactions.shift, scene.interactions.tail = True, False
        for use in scene.interactions.uses["pair"]:
            use.modify.pop("shift", None)
            use.modify.pop("tail", None)


def constant_energy(scene: Scene) -> list:
    """Fixes of a run at constant energy: one `NVE` for all atoms that move, and the forces that the scene's fixes add."""
    own = [f for f in scene.fixes.values() if f.minimizes]
    mask = np.zeros(scene.system.n, bool)
    for fix in scene.fixes.values():
        if fix.integrates:
            mask |= scene.groups.mask(fix.group)
    if not mask.any() or mask.all():
        return [NVE("all"), *own]
    scene.groups["moving atoms"] = mask
    return [NVE("moving atoms"), *own]


def left_out(scene: Scene) -> list[str]:
    """Fixes that act on the motion but have no place in a run at constant energy, in words."""
    return [f"fix {f.id} ({f.style})" for f in scene.fixes.values()
            if not f.minimizes and f.style != "nve" and set(f.hooks()) - {"end_of_step"}]


def movers(scene: Scene, fixes) -> str:
    """The group that moves: that of the only fix that integrates, else all."""
    groups = {f.group for f in fixes if f.integrates}
    return groups.pop() if len(groups) == 1 else "all"


def make_loop(scene: Scene, fixes: list, dt: float, levels=None) -> Loop:
    """A loop for a copy of a scene; it moves the copy."""
    parts = (scene.system, scene.interactions, scene.settings(), fixes, scene.groups, dt)
    if levels is None:
        loop = Loop(*parts, step=scene.step)
    else:
        from asemd.respa import RespaLoop
        loop = RespaLoop(*parts, step=scene.step, levels=levels)
    loop.watchdog.explains = False      # what fails is told without a search for the culprit
    return loop


def span(units: str) -> float:
    """One nanosecond in time units; 1000 of them in ``units lj``."""
    return 1000.0 if units == "lj" else 1e6 * unit_styles.get(units).femtosecond


def drift_unit(units: str) -> str:
    """What `Series.drift` is counted in."""
    return "kT per degree of freedom and 1000 tau" if units == "lj" else "kT per degree of freedom and ns"


__all__ = ["Order", "Probe", "Series", "block_error", "fit_exponent", "order", "run", "start", "warm"]
