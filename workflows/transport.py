"""What the workflows `viscosity` and `thermal_conductivity` share: runs, block errors, tables, pictures."""
from __future__ import annotations

import argparse
import csv
import json
from pathlib import Path

import numpy as np

from asemd.lammps import Lammps

RHO, DT = 0.6, 0.005        # density and timestep of all scripts


def tables(path: Path) -> np.ndarray:
    """(blocks, rows, columns) of a file of fix ave/chunk or ave/correlate."""
    rows, out = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")], []
    while rows:
        n = int(rows[0][1])
        out.append([[float(w) for w in row] for row in rows[1:n + 1]])
        rows = rows[n + 1:]
    return np.array(out)


def estimate(blocks: np.ndarray, f=float) -> tuple[float, float]:
    """f of the mean over blocks, and its standard error by leaving out one block after the other."""
    n, total = len(blocks), blocks.sum(axis=0)
    left = np.array([f((total - b) / (n - 1)) for b in blocks])
    return float(f(total / n)), float(np.sqrt((n - 1) * left.var()))


def slope(profile: np.ndarray, length: float, width: int) -> float:
    """Gradient along half the box, the mean of both sides, without the layers at the lower end and in the middle and two beside them."""
    half, bins = len(profile) // 2, np.arange(len(profile)) * length / len(profile)
    up = np.arange(width + 2, half - 2)
    down = (width - 1 - up) % len(profile)          # the mirror images
    return float(np.polyfit(bins[up], (profile[up] + profile[down]) / 2, 1)[0])


def driven(folder: Path, name: str, width: int) -> tuple[tuple[float, float], np.ndarray]:
    """Flux over gradient of a run with two layers that exchange something, its error, and the mean profile."""
    area, length = np.loadtxt(folder / f"{name}.box")
    steps, given = np.loadtxt(folder / f"{name}.dat").T
    flux = np.diff(given) / np.diff(steps) / DT / (2 * area)
    profile = tables(folder / f"{name}.profile")[-len(flux):, :, 3]
    return estimate(np.column_stack([flux, profile]), lambda b: abs(b[0] / slope(b[1:], length, width))), profile.mean(axis=0)


def green_kubo(folder: Path, factor: float, cut: float) -> tuple[tuple[float, float], tuple]:
    """The integral up to `cut` time units and its error; times, integrals and errors."""
    blocks = tables(folder / "green-kubo.dat")[1:]
    t, c = blocks[0, :, 1] * DT, factor * blocks[:, :, 3:].mean(axis=2)
    integral = np.cumsum((c[:, 1:] + c[:, :-1]) / 2 * t[1], axis=1)
    return estimate(integral[:, np.searchsorted(t, cut - 1e-9) - 1]), (t[1:], *np.array([estimate(column) for column in integral.T]).T)


def write(folder: Path, result: dict, published: dict, symbol: str) -> None:
    """result.json, result.csv and result.md."""
    (folder / "result.json").write_text(json.dumps(result))
    with open(folder / "result.csv", "w", newline="") as f:
        csv.writer(f).writerows([("method", symbol, "error"), *((name, *pair) for name, pair in result.items()),
                                 *((name, value, "") for name, value in published.items())])
    lines = [f"| method | {symbol} |", "|---|---|"]
    lines += [*(f"| {name} | {value:.3f} +- {error:.3f} |" for name, (value, error) in result.items()),
             *(f"| {name} | {value:.2f} |" for name, value in published.items())]
    (folder / "result.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def draw(path: Path, result: dict, published: dict, symbol: str, profiles: dict, quantity: str, integral: tuple) -> None:
    """Values with error bars; profiles; the running integral."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(13, 3.8), layout="constrained")
    names = list(result)[::-1]
    a.errorbar([result[n][0] for n in names], range(len(names)), xerr=[result[n][1] for n in names], fmt="o", capsize=3)
    a.set_yticks(range(len(names)), names)
    for k, (name, value) in enumerate(published.items()):
        a.axvline(value, color=f"C{k + 1}", ls="--", label=name)
    a.set(xlabel=symbol, ylim=(-0.7, len(names) + 0.4 * len(published)))
    a.legend(fontsize=7, loc="upper left")
    for name, profile in profiles.items():
        b.plot((np.arange(len(profile)) + 0.5) / len(profile), profile, "o-", ms=3, label=name)
    b.set(xlabel="z / $L_z$", ylabel=quantity)
    b.legend(fontsize=7, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    if integral:
        t, value, error = integral
        c.plot(t, value)
        c.fill_between(t, value - error, value + error, alpha=0.3)
    c.set(xlabel="upper end of the Green-Kubo integral / $\\tau$", ylabel=symbol)
    figure.savefig(path, dpi=90)


def main(doc: str, here: Path, routes: dict, quick: dict, published: dict, symbol: str, quantity: str, analyse) -> None:
    """Read the command line, run the scripts, write the results; `routes`: script and variables by name."""
    p = argparse.ArgumentParser(description=doc.splitlines()[0])
    p.add_argument("--quick", action="store_true", help="small systems for seconds: a test of the scripts, no result")
    p.add_argument("--routes", nargs="*", choices=list(routes), default=list(routes), help="what to run; files of earlier runs count too")
    p.add_argument("--folder", type=Path, default=Path(here.name))
    o = p.parse_args()
    o.folder.mkdir(parents=True, exist_ok=True)
    for route in o.routes:
        script, variables = routes[route]
        variables = {"folder": o.folder, **variables, **(quick if o.quick else {})}
        words = [w for name, value in variables.items() for w in ("-var", name, str(value))]
        with Lammps(cmdargs=["-log", str(o.folder / f"log.{route}"), "-screen", "none", *words]) as lmp:
            lmp.file(str(here / script))
    result, profiles, integral = analyse(o.folder)
    write(o.folder, result, published, symbol)
    draw(o.folder / f"{here.name}.png", result, published, symbol, profiles, quantity, integral)
