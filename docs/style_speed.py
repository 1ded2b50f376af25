"""What docs/measured/speed.json says of a style: a plot of error against processor time, one line that reads it, and a table."""
from __future__ import annotations

import io
import math
import re

from style_plots import COLOURS, INK

from asemd import style as registry

WHAT = {"bond": "a bond", "angle": "an angle", "dihedral": "a dihedral", "improper": "an improper", "pair": "a pair within the cutoff"}
LOOKS = {"double": ("#808080", "o"), "mixed": (COLOURS[3], "D"), "table linear": (COLOURS[0], "s"), "table spline": (COLOURS[2], "^"),
         "lepton": (COLOURS[1], "v")}
BELOW = 1e-17       # where errors of zero are drawn


def kinds(entry: dict) -> dict[str, list[tuple[str, dict]]]:
    """Variants by kind: the tables of one kind belong together."""
    out: dict[str, list] = {}
    for name, numbers in entry["variants"].items():
        out.setdefault(re.sub(r" \d+$", "", name), []).append((name, numbers))
    return out


def reading(category: str, entry: dict) -> str:
    """One line on what the numbers say; times whose quartiles overlap count as equal."""
    exact, what = entry["variants"]["double"], WHAT[category]
    text = f"Double precision takes {exact['ns'][1]:.3g} ns for {what}"
    others = {n: v for n, v in entry["variants"].items() if n != "double"}
    if not others:
        return text + "; there is nothing else to compare it with."
    faster = {n: v for n, v in others.items() if v["ns"][2] < exact["ns"][0] and v["error"] < 1e-2}
    if not faster:
        return f"{text}; nothing else is faster."
    best = min(faster, key=lambda n: faster[n]["error"])
    quick = min(faster, key=lambda n: faster[n]["ns"][1])

    def told(name):
        v = faster[name]
        return f"{name} ({exact['ns'][1] / v['ns'][1]:.2g} times as fast, error {v['error']:.0e})"
    return f"{text}. Faster: {told(best)}" + (f"; fastest: {told(quick)}." if faster[quick]["ns"][2] < faster[best]["ns"][0] else ".")


def left_out(entry: dict) -> str:
    """What has no point, and why."""
    reasons: dict[str, list[str]] = {}
    for name, reason in entry["left out"].items():
        reasons.setdefault(reason, []).append(name)
    return "; ".join(f"{', '.join(names)}: {reason}" for reason, names in reasons.items())


def geometry(style) -> str:
    """How the items were placed, see `measure_speed.along`."""
    if style.category == "pair":
        return "atoms of a Lennard-Jones liquid at reduced temperature 1, scaled to the style"
    if style.category == "improper" or style.coordinates == ("gamma",):
        return "normally distributed about the middle of the range of the curves, by a tenth of it"
    if style.function is None or style.remembers:
        return "lengths spread evenly from 5 % below to 10 % above one at which there is something to see"
    return "drawn as they occur at 300 K (reduced units: temperature 1)"


def section(category: str, name: str, known: dict, figure: str) -> list[str]:
    """The part of a style's page; `figure` is the file of the plot."""
    entry = known["styles"].get(f"{category} {name}")
    if entry is None:
        return []
    out = ["## Error against time", "", *(["```{raw} html", f":file: {figure}", "```", ""] if figure else []), reading(category, entry), "",
           "| variant | error of the force | ns (quartiles) |", "|---|---|---|"]
    for variant, v in entry["variants"].items():
        low, middle, high = v["ns"]
        error = "0 (reference)" if variant == "double" else f"{v['error']:.1e}" if v["error"] else "0"
        out.append(f"| {variant} | {error} | {middle:.3g} ({low:.3g} to {high:.3g}) |")
    if entry["left out"]:
        out += ["", f"Left out: {left_out(entry)}."]
    again = f'{known["command"]} "{category} {name}"'
    spread = geometry(registry.find(category, name))
    table = " Double is the file of the example, read as a spline of 50,000 values." if name.startswith("table") else ""
    if table and category == "dihedral":
        table += " Splines take the slope of the energy as force, linear tables the file's forces; on a file of 36 values they differ."
    machine = known["machine"]
    return [*out, "", f"Root mean square error of the force, relative to that of the force, and processor time for {WHAT[category]} "
            f"(forces without energies, one thread, {entry['items']:,} of them: {spread}). Tables are the style's own, lepton is the same "
            f"function as an expression.{table} Measured by `{again}` on {machine['cpu']}, numpy {machine['numpy']}, numba "
            f"{machine['numba']}.", ""]


def svg(category: str, name: str, entry: dict) -> str:
    """The plot as an element of a page: one point with a bar from quartile to quartile for each variant."""
    text = figure(category, name, entry).decode()
    text = text[text.index("<svg"):].replace(INK, "currentColor")
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.S).replace("*{stroke", "svg *{stroke")
    size = f'style="width: 100%; height: auto; max-width: 34rem" role="img" aria-label="Error against time of {category} style {name}"'
    return re.sub(r'width="[\d.]+pt" height="[\d.]+pt"', size, text, count=1)


def figure(category: str, name: str, entry: dict, target: str = "svg") -> bytes:
    """The plot as a file; errors of zero stand on the lowest line."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
    settings = {"svg.fonttype": "none", "svg.hashsalt": f"{category} {name}", "font.size": 9, "font.family": "sans-serif",
                "axes.spines.top": False, "axes.spines.right": False, "lines.linewidth": 1.4, "legend.frameon": False, "legend.fontsize": 8,
                **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), INK)}
    with pyplot.rc_context(settings):
        picture, axes = pyplot.subplots(figsize=(5.4, 3.0), layout="constrained")
        times, errors = [], []
        for kind, rows in kinds(entry).items():
            colour, mark = LOOKS[kind]
            low, middle, high = zip(*(v["ns"] for _, v in rows))
            y = [max(v["error"], BELOW) for _, v in rows]
            bars = [[m - a for m, a in zip(middle, low)], [b - m for m, b in zip(middle, high)]]
            axes.errorbar(middle, y, xerr=bars, color=colour, marker=mark, ms=5.5, capsize=2.5, label=kind,
                          mfc="none" if kind == "double" else colour, ls="-" if len(rows) > 1 else "none")
            for (variant, _), x, e in zip(rows, middle, y):
                if len(rows) > 1:
                    left = kind == "table linear"
                    axes.annotate(variant.split()[-1], (x, e), xytext=(-7 if left else 7, 3), textcoords="offset points", fontsize=7,
                                  color=colour, ha="right" if left else "left")
            times += [*low, *high]
            errors += y
        axes.set_xscale("log")
        axes.set_yscale("log")
        lo, hi = min(times), max(times)
        axes.set_xlim(lo / 1.25, hi * 1.35)
        ticks = [t for t in (0.5, 1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500) if lo / 1.25 <= t <= hi * 1.35]
        if len(ticks) < 2:
            ticks = [round(lo, 2), round(hi, 2)] if hi > 1.1 * lo else [float(f"{lo:.2g}")]
        axes.xaxis.set_major_locator(FixedLocator(ticks))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda t, _: f"{t:g}"))
        axes.set_ylim(BELOW / 3, max(1e-3, 10 * max(errors)))
        steps = [BELOW, *(10.0**k for k in range(-15, 2, 3) if 10.0**k < max(1e-3, 10 * max(errors)))]
        axes.yaxis.set_major_locator(FixedLocator(steps))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda e, _: "0" if e <= BELOW else f"1e{round(math.log10(e))}"))
        axes.patch.set_alpha(0.0)
        axes.axhline(BELOW, color="#808080", lw=0.6, ls=":", zorder=0)
        axes.set_xlabel(f"processor time of {WHAT[category]} (ns)")
        axes.set_ylabel("relative error of the force")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        out, vector = io.BytesIO(), target == "svg"
        picture.savefig(out, format=target, dpi=110, transparent=vector, metadata={"Date": None, "Creator": None} if vector else {})
        pyplot.close(picture)
    return out.getvalue()
