"""Plots as Vega-Lite specifications: drawn by the page, and as SVG and PNG by vl-convert."""
from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asemd.errors import InputError

POINTS = 800        # of a curve in a page
HEIGHT = 260        # of a plot, in pixels
WIDTH = 520         # of a static plot
# distinct for the colour-blind too, on white and on black; after P. Tol, "Colour schemes" (2021)
COLOURS = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee7733", "#009988", "#999933", "#882255")


# the same order of hues, lighter
LIGHT = ("#77aadd", "#ee8c96", "#5fc27e", "#eedd88", "#99ddff", "#d68ac0", "#f2a36b", "#44bba4", "#cccc66", "#c98aa8")


def theme(text: str, faint: str, colours: Sequence[str]) -> dict[str, Any]:
    """Vega's configuration for a colour of text, one of lines, and those of curves."""
    font = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif"
    return {"background": None, "font": font, "view": {"stroke": None}, "range": {"category": list(colours)}, "bar": {"color": colours[0]},
            "axis": {"labelColor": text, "titleColor": text, "domainColor": faint, "tickColor": faint, "gridColor": faint,
                     "gridOpacity": 0.5, "labelFontSize": 11, "titleFontSize": 12, "titleFontWeight": "normal", "titlePadding": 8},
            "legend": {"labelColor": text, "titleColor": text, "labelFontSize": 11, "orient": "top", "title": None, "labelLimit": 260,
                       "symbolOpacity": 1},
            "text": {"color": text, "fill": text}, "line": {"strokeWidth": 1.8},
            "title": {"color": text, "anchor": "start", "fontSize": 14}}


THEMES = {"light": theme("#333f4d", "#c9d1da", COLOURS), "dark": theme("#d4dce5", "#46505c", LIGHT)}


@dataclass
class Series:
    """Points of one curve of a log-log plot.

    Attributes
    ----------
    name : str
    x, y : (n,) arrays
    low, high : (n,) arrays, optional
        What y may be just as well, drawn as a band: points whose bands overlap are ties.
    labels : (n,) str, optional
        Said when a point is touched.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    low: Sequence[float] | None = None
    high: Sequence[float] | None = None
    labels: Sequence[str] | None = None


@dataclass
class Plot:
    """A plot.

    Attributes
    ----------
    title : str
    spec : dict
        Vega-Lite, without size and theme.
    name : str
        For file names.
    height : int
        In pixels.
    """

    title: str
    spec: dict[str, Any]
    name: str = ""
    height: int = HEIGHT

    def __post_init__(self):
        self.name = self.name or re.sub(r"[^a-z0-9]+", "-", self.title.lower()).strip("-") or "plot"

    def static(self, width: int = WIDTH) -> dict[str, Any]:
        """The specification for paper: with title, size, and colours for white."""
        return {"$schema": "https://vega.github.io/schema/vega-lite/v6.json", **self.spec, "title": self.title, "width": width,
                "height": self.height, "config": {**THEMES["light"], "background": "white"}, "padding": 12}

    def save(self, path: str | os.PathLike, width: int = WIDTH) -> Path:
        """Write the plot as SVG, PNG (at twice the resolution) or PDF, by the ending of `path`; returns the path.

        Raises
        ------
        InputError
            Another ending, or vl-convert-python is not installed.
        """
        path = Path(path)
        try:
            import vl_convert
        except ImportError:
            raise InputError("plots as SVG and PNG need vl-convert-python: pip install asemd[pages]") from None
        spec = self.static(width)
        if path.suffix == ".svg":
            path.write_text(vl_convert.vegalite_to_svg(spec), encoding="utf-8")
        elif path.suffix == ".png":
            path.write_bytes(vl_convert.vegalite_to_png(spec, scale=2))
        elif path.suffix == ".pdf":
            path.write_bytes(vl_convert.vegalite_to_pdf(spec))
        else:
            raise InputError(f"a plot is saved as .svg, .png or .pdf, not as {path.name!r}")
        return path


def thin(x: np.ndarray, y: np.ndarray, most: int = POINTS) -> np.ndarray:
    """Indices of at most `most` points that show the same curve: of each stretch its lowest and highest, and both ends."""
    n = len(x)
    if n <= most:
        return np.arange(n)
    keep = {0, n - 1}
    for part in np.array_split(np.arange(n), (most - 2) // 2):
        known = part[np.isfinite(y[part])]
        if len(known):
            keep |= {int(known[np.argmin(y[known])]), int(known[np.argmax(y[known])])}
        else:
            keep.add(int(part[0]))
    return np.array(sorted(keep))


def number(value: float) -> float | None:
    """A number for JSON, to seven digits; None for what is not finite."""
    return float(f"{value:.7g}") if math.isfinite(value) else None


def curve_plot(title: str, x: np.ndarray, curves: Mapping[str, np.ndarray], xlabel: str, ylabel: str,
               band: Mapping[str, tuple] | None, limits: tuple[float, float] | None) -> Plot:
    """See `asemd.page.Page.curve`."""
    rows, shade = [], []
    for name, y in curves.items():
        if y.shape != x.shape:
            raise InputError(f"curve {name!r} of {title!r} has {y.size} values for {x.size} places")
        low, high = (np.asarray(v, float) for v in band[name]) if band and name in band else (None, None)
        for i in thin(x, y):
            rows.append({"x": float(x[i]), "y": number(y[i]), "s": name})
            if low is not None:
                shade.append({"x": float(x[i]), "low": number(low[i]), "high": number(high[i]), "s": name})
    names = list(curves)
    colour: dict[str, Any] = {"field": "s", "type": "nominal", "scale": {"domain": names}, "legend": {} if len(names) > 1 else None}
    xs = {"field": "x", "type": "quantitative", "title": xlabel, "scale": {"zero": False, "nice": False},
          "axis": {"tickCount": 6, "labelOverlap": "greedy", "labelSeparation": 8}}
    span = {"zero": False} if limits is None else {"zero": False, "domain": list(limits)}
    ys = {"field": "y", "type": "quantitative", "title": ylabel, "scale": span, "axis": {"tickCount": 5}}
    tip = [{"field": "s", "title": "curve"}] * (len(names) > 1) + [{"field": "x", "title": xlabel or "x", "format": ".7~g"},
                                                                  {"field": "y", "title": ylabel or "y", "format": ".7~g"}]
    layer: list[dict[str, Any]] = []
    if shade:
        layer.append({"data": {"values": shade}, "mark": {"type": "area", "opacity": 0.18, "clip": True},
                      "encoding": {"x": xs, "y": {**ys, "field": "low"}, "y2": {"field": "high"}, "color": colour}})
    layer.append({"mark": {"type": "line", "point": len(x) == 1, "clip": True}, "encoding": {"x": xs, "y": ys, "color": colour}})
    layer.append({"params": [{"name": "near", "select": {"type": "point", "on": "pointerover", "nearest": True, "clear": "pointerout"}}],
                  "mark": {"type": "point", "filled": True, "size": 60, "clip": True},
                  "encoding": {"x": xs, "y": ys, "color": colour, "tooltip": tip,
                               "opacity": {"condition": {"param": "near", "empty": False, "value": 1}, "value": 0}}})
    return Plot(title, {"data": {"values": rows}, "layer": layer})


def pareto(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Indices of the points which no other point beats in both, by growing x."""
    best, keep = math.inf, []
    for i in np.lexsort((y, x)):
        if y[i] < best:
            keep.append(int(i))
            best = y[i]
    return np.array(keep, int)


def loglog_plot(title: str, series: Sequence[Series], xlabel: str, ylabel: str, front: bool, floor: float | None,
                here: tuple[float, float, str] | None) -> Plot:
    """See `asemd.page.Page.loglog`."""
    rows, bands = [], []
    for s in series:
        x, y = np.asarray(s.x, float), np.asarray(s.y, float)
        low, high = (np.asarray(v, float) if v is not None else y for v in (s.low, s.high))
        labels = list(s.labels) if s.labels is not None else [""] * len(x)
        if not len(x) == len(y) == len(low) == len(high) == len(labels):
            raise InputError(f"series {s.name!r} of {title!r}: x, y, low, high and labels must be of one length")
        for i in range(len(x)):
            if x[i] > 0.0 and y[i] > 0.0 and math.isfinite(x[i]) and math.isfinite(y[i]):
                rows.append({"x": number(x[i]), "y": number(y[i]), "s": s.name, "t": labels[i], "k": i})
                if s.low is not None or s.high is not None:
                    bands.append({"x": number(x[i]), "s": s.name, "low": number(low[i] if low[i] > 0.0 else y[i]), "high": number(high[i])})
    if not rows:
        raise InputError(f"{title!r}: no point is positive in both directions, which logarithmic axes need")
    log = {"type": "quantitative", "scale": {"type": "log", "nice": False, "padding": 14}}
    xs = {"field": "x", "title": xlabel, **log, "axis": {"format": "~g", "labelOverlap": True}}
    ys = {"field": "y", "title": ylabel, **log, "axis": {"format": "~e", "labelOverlap": True}}
    colour = {"field": "s", "type": "nominal", "scale": {"domain": [s.name for s in series]}, "legend": {} if len(series) > 1 else None}
    tip = [{"field": "s", "title": "knob"}] * (len(series) > 1) + [{"field": "t", "title": "setting"}] * any(r["t"] for r in rows) + [
        {"field": "x", "title": xlabel or "x", "format": ".4~g"}, {"field": "y", "title": ylabel or "y", "format": ".4~g"}]
    layer: list[dict[str, Any]] = []
    if floor is not None and floor > 0.0:
        least = min(floor, *(r["y"] for r in rows)) / 2.0
        layer.append({"data": {"values": [{"y": number(least), "top": number(floor)}]},
                      "mark": {"type": "rect", "opacity": 0.14, "color": "#888888", "tooltip": "below the sampling noise"},
                      "encoding": {"y": ys, "y2": {"field": "top"}}})
    if bands:
        layer.append({"data": {"values": bands}, "mark": {"type": "area", "opacity": 0.16},
                      "encoding": {"x": xs, "y": {**ys, "field": "low"}, "y2": {"field": "high"}, "color": colour}})
        layer.append({"data": {"values": bands}, "mark": {"type": "rule", "opacity": 0.6, "strokeWidth": 1.2},
                      "encoding": {"x": xs, "y": {**ys, "field": "low"}, "y2": {"field": "high"}, "color": colour}})
    if front:
        chosen = [rows[i] for i in pareto(np.array([r["x"] for r in rows]), np.array([r["y"] for r in rows]))]
        plain = [{"x": r["x"], "y": r["y"]} for r in chosen]
        steps = {"type": "line", "interpolate": "step-after", "strokeDash": [6, 4], "color": "#888888"}
        rings = {"type": "point", "size": 190, "strokeWidth": 1.6, "color": "#888888"}
        layer += [{"data": {"values": plain}, "mark": mark, "encoding": {"x": xs, "y": ys}} for mark in (steps, rings)]
    layer.append({"mark": {"type": "line"}, "encoding": {"x": xs, "y": ys, "color": colour, "order": {"field": "k"}}})
    layer.append({"mark": {"type": "point", "filled": True, "size": 60, "opacity": 1},
                  "encoding": {"x": xs, "y": ys, "color": colour, "tooltip": tip}})
    if here is not None:
        point = [{"x": number(here[0]), "y": number(here[1]), "t": here[2]}]
        diamond = {"type": "point", "shape": "diamond", "filled": True, "size": 170, "color": "#d62728", "tooltip": here[2]}
        layer.append({"data": {"values": point}, "mark": diamond, "encoding": {"x": xs, "y": ys}})
        layer.append({"data": {"values": point}, "mark": {"type": "text", "dy": -14, "fontSize": 12, "fontWeight": "bold"},
                      "encoding": {"x": xs, "y": ys, "text": {"field": "t"}}})
    return Plot(title, {"data": {"values": rows}, "layer": layer}, height=360)


def bar_plot(title: str, values: Mapping[str, float], xlabel: str) -> Plot:
    """See `asemd.page.Page.bars`."""
    rows = [{"n": name, "v": number(v)} for name, v in values.items()]
    plain = {"ticks": False, "domain": False, "labelLimit": 150}
    ys = {"field": "n", "type": "nominal", "title": None, "sort": list(values), "axis": plain}
    xs = {"field": "v", "type": "quantitative", "title": xlabel, "axis": {"tickCount": 5}}
    tip = [{"field": "n", "title": "part"}, {"field": "v", "title": xlabel or "value", "format": ".4~g"}]
    layer = [{"mark": {"type": "bar", "cornerRadiusEnd": 3}, "encoding": {"x": xs, "y": ys, "tooltip": tip}},
             {"mark": {"type": "text", "align": "left", "dx": 5}, "encoding": {"x": xs, "y": ys, "text": {"field": "v", "format": ".3~g"}}}]
    return Plot(title, {"data": {"values": rows}, "layer": layer}, height=max(90, 30 * len(rows)))
