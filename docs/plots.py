"""The pictures of the pages on accuracy and speed, from the numbers in docs/measured: ``python docs/plots.py``.

``python docs/measure.py`` measures the agreement with LAMMPS, ``python -m tests.benchmarks --readme`` the speed.
"""
from __future__ import annotations

import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
CATEGORIES = ("bond", "angle", "dihedral", "improper", "pair")
SMALLEST = 1e-16        # relative differences below the last digit are drawn there


def agreement(path: Path) -> None:
    """Each style is a point: the largest relative difference of forces, and of energies."""
    measured = json.loads((HERE / "measured" / "agreement.json").read_text())
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), sharex=True, sharey=True, layout="constrained")
    for axis, what in zip(axes, ("force", "energy")):
        start = 0
        for category in CATEGORIES:
            values = sorted(max(v[what], SMALLEST) for name, v in measured["styles"].items() if name.split()[0] == category and what in v)
            axis.semilogy(range(start, start + len(values)), values, "o", ms=4, label=f"{category} ({len(values)})")
            start += len(values) + 3
        axis.axhline(1e-12, color="0.6", lw=1, ls="--")
        axis.set(title={"force": "forces", "energy": "energies"}[what], xticks=[], xlabel="styles, from the least to the largest")
    axes[0].set_ylabel("largest relative difference from LAMMPS")
    axes[1].legend(fontsize="small", loc="upper left")
    figure.savefig(path, dpi=90)


def speed(path: Path) -> None:
    """Each scene on one thread: how many times as fast as the fastest variant of the wheel, with quartiles."""
    found = json.loads((HERE / "measured" / "benchmarks.json").read_text())
    cases = {machine: {name.removesuffix(", 1"): min(v["ratio"].values(), key=lambda r: r["median"])
                       for name, v in here["cases"].items() if name.endswith(", 1")}
             for machine, here in found.items() if "cases" in here}
    names = list(dict.fromkeys(name for here in cases.values() for name in here))
    thick = 0.8 / len(cases)
    figure, axis = plt.subplots(figsize=(9, (0.1 + 0.1 * len(cases)) * len(names) + 1), layout="constrained")
    for k, (machine, here) in enumerate(cases.items()):
        rows = [(names.index(name) + thick * (k + 0.5 - len(cases) / 2), r) for name, r in here.items()]
        middle = [r["median"] for _, r in rows]
        spread = [[m - r["q1"] for m, (_, r) in zip(middle, rows)], [r["q3"] - m for m, (_, r) in zip(middle, rows)]]
        axis.barh([y for y, _ in rows], middle, height=0.95 * thick, xerr=spread, label=machine, error_kw={"lw": 0.8})
    axis.axvline(1.0, color="0.3", lw=1)
    axis.set(yticks=range(len(names)), yticklabels=names, xlabel="times as fast as LAMMPS, one thread")
    axis.invert_yaxis()
    figure.legend(fontsize="small", loc="outside upper right", ncols=len(cases))
    figure.savefig(path, dpi=90)


if __name__ == "__main__":
    agreement(HERE / "images" / "agreement.png")
    speed(HERE / "images" / "speed.png")
