"""Plots of a report: error against run time, and each knob by itself; as PNG and SVG."""
from __future__ import annotations

import math
import textwrap
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from asemd import units as unit_styles
from asemd.page.plot import COLOURS
from asemd.report import advice
from asemd.report.nve import drift_unit
from asemd.report.result import Curve, Point, Report
from asemd.report.text import span_word

LEAST = 1e-17           # an error of zero is drawn here
MARKERS = "osD^v<>phXPd"
EXACT = 1e-13           # round-off: below it forces are the same


@dataclass
class Line:
    """One curve: `x` run time with quartiles `low` and `high`, `y` error with standard error `noise`, labels; `model` curves are dashed."""

    name: str
    x: list[float] = field(default_factory=list)
    y: list[float] = field(default_factory=list)
    low: list[float] = field(default_factory=list)
    high: list[float] = field(default_factory=list)
    noise: list[float] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    model: bool = False
    remark: str = ""


@dataclass
class Picture:
    """A plot of error against run time, ready to draw: `tie` is the band of errors that tie with the script's, `script` its own point."""

    name: str
    title: str
    xlabel: str
    ylabel: str
    lines: list[Line]
    tie: tuple[float, float] | None = None
    script: tuple[float, float] | None = None
    best: tuple[float, float] | None = None

    def front(self) -> list[tuple[float, float]]:
        """Points that nothing beats in both directions, from fast to slow; those of other models are no part of it, and ties are one."""
        out, lowest, least = [], math.inf, self.tie[1] if self.tie and self.name in FLOORS else 0.0
        for x, y in sorted((x, y) for line in self.lines if not line.model for x, y in zip(line.x, line.y)):
            if max(y, least) < lowest:
                out.append((x, y))
                lowest = max(y, least)
        return out


FLOORS = ("drift", "temperature", "configurational")       # pictures of errors around zero, so that all below the tie band ties
KINDS = {"force_error": ("force-error", "Force error against run time", "relative force error (RMS)"),
         "relative_fluctuation": ("fluctuation", "Fluctuation of the conserved quantity against run time",
                                  "fluctuation relative to that of the kinetic energy"),
         "drift": ("drift", "Drift of the conserved quantity against run time", "drift, {drift}"),
         "constraint_error": ("constraints", "Error of constraints against run time", "largest error of constraints"),
         "configurational_offset": ("configurational", "Configurational temperature against run time",
                                    "relative error of the configurational temperature"),
         "temperature_offset": ("temperature", "Error of the temperature against run time", "relative error of the temperature")}


def pictures(report: Report) -> list[Picture]:
    """Error against run time, for every error that some knob changes."""
    out = []
    for metric, (name, title, ylabel) in KINDS.items():
        lines = [line for curve in report.curves if (line := _line(curve, metric, report)) is not None]
        if not lines:
            continue
        own = metric.endswith("_offset")        # of runs with the script's own fixes, whose error is that against the target
        several = Curve("", "together", "", metric, False, points=report.combined)
        if report.combined and not own and (line := _line(several, metric, report)):
            lines.append(line)
        tie = None
        if own:
            found = [getattr(p, advice.NOISE[metric]) for p in report.points if p.fixes == "own" and not p.failed]
            found = [e for e in found if math.isfinite(e)]
            tie = (LEAST, advice.SIGMA * float(np.median(found))) if found else None
        elif metric in advice.NOISE and math.isfinite(value := abs(getattr(report.script, metric))):
            found = [getattr(p, advice.NOISE[metric]) for p in report.points if not p.failed]
            noise = advice.SIGMA * math.sqrt(2.0) * float(np.median([e for e in found if math.isfinite(e)] or [0.0]))
            tie = (max(value - noise, LEAST), value + noise) if noise > 0.0 else None
        out.append(Picture(name, title, time_label(report), ylabel.format(drift=drift_unit(report.units)), lines, tie,
                           None if own else _spot(report.script, metric, report), None if own else _spot(report.best, metric, report)))
    return out


def _error(p: Point, metric: str, report: Report) -> float:
    """An error of a point. Of forces it holds what the script's settings miss of better ones, so that all points can be compared."""
    missed = max((q.given_error for q in report.points), default=0.0) if metric == "force_error" and p.given_error == 0.0 else 0.0
    return math.hypot(getattr(p, metric), missed)


def _axis(metric: str) -> str:
    """Of the axis of an error, those that have no picture of their own too."""
    return KINDS[metric][2] if metric in KINDS else metric.replace("_", " ")


def time_label(report: Report) -> str:
    """Of the axis of run time."""
    return f"{'processor' if report.busy else 'wall'} time of {span_word(report.units, '1 ns')} / s"


def _spot(p: Point | None, metric: str, report: Report) -> tuple[float, float] | None:
    if p is None or p.failed or not math.isfinite(getattr(p, metric)):
        return None
    return p.seconds_per_span, max(_error(p, metric, report), LEAST)


def _line(curve: Curve, metric: str, report: Report) -> Line | None:
    """The curve of a knob, or None where the knob has nothing to do with this error."""
    points = [p for p in curve.points if not p.failed and math.isfinite(getattr(p, metric)) and p.seconds_per_span > 0.0]
    if all(p.own for p in points):
        return None
    values = [abs(getattr(p, metric)) for p in points]
    if curve.metric != metric and (metric.endswith("_offset") or max(values) < 1.05 * min(values) or max(values) < EXACT):
        return None
    line = Line(curve.title, model=curve.model, remark=curve.remark)
    for p in points:
        scale = p.seconds_per_span / p.seconds_per_step
        line.x.append(p.seconds_per_span)
        line.y.append(max(_error(p, metric, report), LEAST))
        line.low.append(p.quartiles[0] * scale)
        line.high.append(p.quartiles[1] * scale)
        line.noise.append(getattr(p, advice.NOISE.get(metric, ""), 0.0))
        line.labels.append(curve.script_label if p.own else p.label)
    return line


# --------------------------------------------------------------------------------------------------------------------- drawing ---

def draw(report: Report, folder: Path, until: float = math.inf) -> tuple[list[str], list[str]]:
    """Write plots as PNG and SVG until a reading of ``time.perf_counter``: names without ending of those written, and of those not.

    Raises
    ------
    InputError
        matplotlib is not installed.
    """
    plt = _pyplot()
    todo = [(f"time-{p.name}", partial(_draw_picture, plt, p)) for p in pictures(report)]
    todo += [(f"knob-{c.name}", partial(_draw_curve, plt, c, report)) for c in report.curves if sum(not p.failed for p in c.points) > 1]
    names: list[str] = []
    for name, figure in todo:
        if names and time.perf_counter() > until:
            break
        names.append(_save(plt, figure(), folder, name))
    return names, [name for name, _ in todo[len(names):]]


def _pyplot():
    from asemd.errors import InputError
    try:
        import matplotlib
    except ImportError:
        raise InputError("the plots of a report need matplotlib: pip install matplotlib") from None
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"svg.hashsalt": "asemd", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
                         "axes.titlelocation": "left", "axes.titlesize": 10, "legend.frameon": False})
    return plt


def _save(plt, figure, folder: Path, name: str) -> str:
    for ending in ("png", "svg"):
        figure.savefig(folder / f"{name}.{ending}", dpi=160, metadata={"Date": None} if ending == "svg" else None)
    plt.close(figure)
    return name


def _draw_picture(plt, picture: Picture):
    figure, ax = plt.subplots(figsize=(7.6, 4.6))
    figure.subplots_adjust(0.13, 0.11, 0.71, 0.93)
    for k, line in enumerate(picture.lines):
        order = np.argsort(line.x)
        x, y = np.array(line.x)[order], np.array(line.y)[order]
        spans = np.abs(np.array([line.low, line.high])[:, order] - x)
        noise = np.minimum(np.nan_to_num(np.array(line.noise)[order]), 0.9 * y)
        label = line.name + (f"\n({textwrap.fill(line.remark, 24)})" if line.model else "")
        style = "none" if line.name == "together" else "--" if line.model else "-"
        ax.errorbar(x, y, xerr=spans, yerr=noise, color=COLOURS[k % len(COLOURS)], marker=MARKERS[k % len(MARKERS)], markersize=5,
                    linewidth=1.1, linestyle=style, elinewidth=0.7, label=label)
    front = picture.front()
    if len(front) > 1:
        ax.step(*zip(*front), where="post", color="0.55", linewidth=4, alpha=0.35, zorder=0, label="Pareto front")
    for spot, marker, label in ((picture.script, "*", "script"), (picture.best, "P", "recommended")):
        if spot:
            ax.plot(*spot, marker, color="#d62728", markersize=13, markeredgecolor="white", zorder=5, label=label, linestyle="none")
    ax.set(xscale="log", yscale="log", xlabel=picture.xlabel, ylabel=picture.ylabel, title=picture.title)
    if picture.tie:
        low = min(ax.get_ylim()[0], 0.5 * picture.tie[1])
        ax.axhspan(max(picture.tie[0], low), picture.tie[1], color="0.5", alpha=0.15, linewidth=0,
                   label="tie with the script" if picture.script else "no error beyond the noise")
        ax.set_ylim(bottom=low)
    _plain_numbers(ax.xaxis)
    ax.grid(True, which="major", alpha=0.25)
    ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8)
    return figure


def _plain_numbers(axis) -> None:
    """Ticks at 1, 2 and 5 times powers of ten, written as people write numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=9))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _at_least(ax, decades: float) -> None:
    """An axis of errors or times over so many powers of ten: over less there are no ticks that people can read."""
    low, high = np.log10(ax.get_ylim())
    if high - low < decades:
        middle = 0.5 * (low + high)
        ax.set_ylim(10.0 ** (middle - 0.5 * decades), 10.0 ** (middle + 0.5 * decades))


def _draw_curve(plt, curve: Curve, report: Report):
    """Error and run time against the value of one knob."""
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(5.6, 5.4), sharex=True)
    points = [p for p in curve.points if not p.failed]
    numbers = [curve.script_number if p.own else p.number for p in points]
    labels = [curve.script_label if p.own else p.label for p in points]
    measured = f"measured: {curve.exponent:.2f} \u00b1 {curve.exponent_error:.2f}"
    plain = len(set(numbers)) == len(numbers) and curve.unit in ("time", "distance")
    first, longest = (0, 5) if plain else (len(labels[0]), max(map(len, labels)))        # characters; labels are turned
    figure.subplots_adjust(min(0.3, max(0.17, 0.01 * first)), min(0.3, 0.07 + 0.0065 * longest), 0.97, 0.95, hspace=0.08)
    x = np.array(numbers if plain else range(len(points)), float)
    values = np.array([max(abs(getattr(p, curve.metric)), LEAST) for p in points])
    error = np.array([getattr(p, advice.NOISE.get(curve.metric, ""), 0.0) for p in points])
    top.errorbar(x, values, yerr=np.minimum(np.nan_to_num(error), 0.9 * values), color=COLOURS[0], marker="o", markersize=5, linewidth=1.1)
    if curve.metric == "relative_fluctuation" and plain and math.isfinite(curve.exponent_error):
        k = int(np.argmin(np.abs(np.log(x / report.script.dt))))
        top.plot(x, values[k] * (x / x[k]) ** 2, ":", color="0.5", label="second order")
        top.plot([], [], " ", label=measured)
        top.legend(fontsize=8)
    low, high = (np.array([p.quartiles[k] / p.seconds_per_step * p.seconds_per_span for p in points]) for k in (0, 1))
    times = np.array([p.seconds_per_span for p in points])
    bottom.errorbar(x, times, yerr=np.abs(np.array([low, high]) - times), color=COLOURS[1], marker="s", markersize=5, linewidth=1.1)
    for k, p in enumerate(points):
        if p.own:
            for ax, y in ((top, values), (bottom, times)):
                ax.plot(x[k], y[k], "*", color="#d62728", markersize=13, markeredgecolor="white", zorder=5)
    ylabel = textwrap.fill(_axis(curve.metric).format(drift=drift_unit(report.units)), 30)
    top.set(yscale="log", ylabel=ylabel, title=f"{curve.title[0].upper()}{curve.title[1:]} (star: script)")
    bottom.set(yscale="log", ylabel=time_label(report))
    _plain_numbers(bottom.yaxis)
    if plain:
        bottom.set(xscale="log", xlabel=f"{curve.title} / {unit_styles.name(curve.unit, report.units)}")
        bottom.set_xticks(x, [f"{v:g}" for v in x])
        bottom.minorticks_off()
    else:
        bottom.set_xticks(x, labels, rotation=30, ha="right")
    for ax, decades in ((top, 2.0), (bottom, 0.9)):
        ax.grid(True, which="major", alpha=0.25)
        ax.margins(0.06, 0.15)
        _at_least(ax, decades)
    if curve.metric == "force_error" and values.max() < EXACT:      # digits of round-off mean nothing
        top.set_ylim(LEAST, 1e-12)
        top.axhspan(LEAST, EXACT, color="0.5", alpha=0.15, linewidth=0, label="round-off")
        top.legend(fontsize=8)
    return figure
