"""From points to advice: what is a tie, what is on the Pareto front, what may replace the script's settings."""
from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from asemd.report.knob import Knob
from asemd.report.result import Curve, Point

SIGMA = 2.0             # standard errors within which two values are the same
SCATTER = 1.5           # ratio of quartiles above which a gain is told with them
FORCE = 1e-5            # relative force error that no run notices beside that of its timestep
DRIFT = 0.05            # kT per degree of freedom and ns (1000 tau), below which a drift does not matter
FLUCTUATION = 0.1       # of the conserved quantity, relative to that of the kinetic energy
SHORTEST = 100          # steps of a run that may judge another timestep
FASTER = 1.03           # what is gained must be more than this, for some knobs more than their `worth`
NOISE = {"drift": "drift_error", "relative_fluctuation": "relative_fluctuation_error", "temperature": "temperature_error",
         "configurational": "configurational_error", "temperature_offset": "offset_error",
         "configurational_offset": "configurational_offset_error"}

OFF = ("drift", "temperature_offset", "configurational_offset")     # errors with a sign, zero if nothing is wrong


def tied(a: Point, b: Point, name: str) -> bool:
    """Whether two points have the same value of an error, as far as one can see."""
    noise = math.hypot(_finite(getattr(a, NOISE[name])), _finite(getattr(b, NOISE[name])))
    return abs(getattr(a, name) - getattr(b, name)) <= SIGMA * noise


def mark_ties(points: Sequence[Point], script: Point) -> None:
    """Fill `Point.ties`: with the script's point, for runs with the script's own fixes with no error at all."""
    for p in points:
        if p.fixes == "own":
            p.ties = [name for name in OFF if not p.failed and abs(getattr(p, name)) <= SIGMA * _finite(getattr(p, NOISE[name]))]
        else:
            p.ties = [name for name in NOISE if not p.own and not p.failed and tied(p, script, name)]


def objections(point: Point, script: Point, force: float = FORCE) -> list[str]:
    """Why a point is not as good as the script's own settings; empty if it is."""
    if point.failed:
        return [f"the run failed: {point.failed}"]
    out = []
    if math.isfinite(script.relative_fluctuation) and not math.isfinite(point.relative_fluctuation):
        out.append("its run was cut short by the budget")
    if point.force_error > max(force, 1.05 * _finite(script.force_error), 1.05 * point.given_error):
        out.append(f"force error {point.force_error:.2g}")
    if point.dangerous > script.dangerous:
        out.append(f"{point.dangerous} dangerous list builds")
    if point.relative_fluctuation > max(FLUCTUATION, 1.05 * _finite(script.relative_fluctuation)):
        out.append(f"the conserved quantity fluctuates by {point.relative_fluctuation:.2g} of the kinetic energy's fluctuation")
    noise = math.hypot(_finite(point.drift_error), _finite(script.drift_error))
    if abs(point.drift) > max(DRIFT, abs(_finite(script.drift)) + SIGMA * noise):
        out.append(f"drift {point.drift:.2g}")
    noise = math.hypot(_finite(point.offset_error), _finite(script.offset_error))
    if abs(point.temperature_offset) > abs(_finite(script.temperature_offset)) + SIGMA * noise:
        out.append(f"kinetic and configurational temperature differ by {point.temperature_offset:+.1%}")
    if point.constraint_error > 1.05 * script.constraint_error + 1e-12:
        out.append(f"constraint error {point.constraint_error:.2g}")
    return out


def worth(point: Point, knobs: Mapping[str, Knob]) -> float:
    """What its knobs must gain to be worth the trouble."""
    return max((knobs[name].worth for name in point.settings), default=FASTER)


def gain(point: Point, script: Point) -> float:
    """How many times faster than the script a simulated nanosecond is."""
    return script.seconds_per_span / point.seconds_per_span if point.seconds_per_span > 0.0 else 0.0


def errors(point: Point, script: Point) -> tuple[float, ...]:
    """What the front looks at; differences to the script within the noise, and errors that do not matter, count as none.

    What was not measured counts as infinitely wrong.
    """
    out = [FORCE if point.force_error <= 1.05 * point.given_error else max(_known(point.force_error), FORCE)]
    for name, least in (("relative_fluctuation", 0.0), ("drift", DRIFT), ("temperature_offset", 0.0)):
        same = name in point.ties or point is script
        value = getattr(script if same else point, name)
        out.append(max(abs(_known(value)), least) if math.isfinite(getattr(script, name)) else 0.0)
    return tuple(out)


def mark_front(points: Sequence[Point], script: Point) -> None:
    """Fill `Point.pareto`: nothing else is at least as good in time and all errors, and better in one."""
    alive = [p for p in points if not p.failed and math.isfinite(p.seconds_per_span)]
    values = {id(p): (p.seconds_per_span, *errors(p, script)) for p in alive}
    for p in points:
        p.pareto = p in alive and not any(dominates(values[id(q)], values[id(p)]) for q in alive if q is not p)


def dominates(a: Sequence[float], b: Sequence[float]) -> bool:
    """Whether a is nowhere larger than b and somewhere smaller."""
    return all(x <= y for x, y in zip(a, b)) and any(x < y for x, y in zip(a, b))


def candidates(curves: Sequence[Curve], script: Point, knobs: Mapping[str, Knob], force: float = FORCE) -> list[Point]:
    """Points worth trying together: the two fastest faultless values of each knob, the largest gains first."""
    out = []
    for curve in curves:
        good = [p for p in curve.points if not p.own and not faults(p, script, knobs, force) and gain(p, script) > worth(p, knobs)]
        out += sorted(good, key=lambda p: p.seconds_per_span)[:2]
    return sorted(out, key=lambda p: p.seconds_per_span)


def together(base: Mapping[str, object], more: Mapping[str, object], knobs: Mapping[str, Knob]) -> dict | None:
    """The settings of both; None if they have a knob in common, or knobs that exclude each other."""
    for a in base:
        for b in more:
            if a == b or b in knobs[a].excludes or a in knobs[b].excludes:
                return None
    return {**base, **more}


def faults(point: Point, script: Point, knobs: Mapping[str, Knob], force: float = FORCE) -> list[str]:
    """Why a point is not recommended: its `objections`, another model, a risk."""
    out = objections(point, script, force)
    steps = min(point.steps, script.steps)
    if point.dt != script.dt and steps < SHORTEST:
        out.append(f"runs of {steps} steps are too short to judge another timestep")
    for name, value in point.settings.items():
        if knobs[name].model:
            out.append(f"{knobs[name].title}: another model")
        if risk := knobs[name].risk(value):
            out.append(f"{knobs[name].title}: {risk}")
    return out


def choose(points: Sequence[Point], script: Point, knobs: Mapping[str, Knob], force: float = FORCE) -> Point | None:
    """The fastest point that is as good as the script's settings, None if the script's own are."""
    good = [p for p in points if not p.own and not faults(p, script, knobs, force) and gain(p, script) > worth(p, knobs)]
    return min(good, key=lambda p: p.seconds_per_span) if good else None


def sentence(best: Point | None, script: Point, knobs: Mapping[str, Knob], times: float,
             quartiles: tuple[float, float] = (math.nan, math.nan)) -> str:
    """The recommendation; `times` faster, with quartiles, which are told where they are far apart."""
    if script.failed:
        return f"The script's own settings fail: {script.failed}. Mend that first; asemd check tells what is wrong."
    if not math.isfinite(script.seconds_per_span):
        return "Nothing was measured."
    if best is None:
        return "Keep the script's settings: nothing that was tried is faster at the same error."
    words = ", ".join(knobs[name].phrase(value) for name, value in sorted(best.settings.items(), key=lambda kv: knobs[kv[0]].order))
    out = f"{words[0].upper()}{words[1:]}: {times:.1f}x faster than the script's settings"
    rougher = best.relative_fluctuation > 1.05 * script.relative_fluctuation and "relative_fluctuation" not in best.ties
    out += " with errors within the limits below" if rougher else " at the same error"
    if quartiles[1] > SCATTER * quartiles[0]:
        out += f" (half of the comparisons between {quartiles[0]:.1f}x and {quartiles[1]:.1f}x: other work disturbed them)"
    if rougher:
        out += (f"; the conserved quantity fluctuates by {best.relative_fluctuation:.2g} of the kinetic energy's fluctuation, it was "
                f"{script.relative_fluctuation:.2g}")
    return f"{out}."


def _known(x: float) -> float:
    return x if math.isfinite(x) else math.inf


def _finite(x: float) -> float:
    return x if math.isfinite(x) else 0.0
