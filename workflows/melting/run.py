"""The melting point of the Lennard-Jones crystal, from crystal and liquid side by side at constant pressure and enthalpy.

python run.py [--folder melting] [--cells 6] [--long 16] [--equil 5000] [--steps 200000] [--pressure 1.0] [--start 0.74]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase.io import read
from scipy.optimize import brentq

from asemd.lammps import Lammps

HERE = Path(__file__).resolve().parent
MELTING = (0.908629, -0.041510, 0.514632, -0.708590, 0.428351, -0.095229)
FREEZING = (0.90735, -0.27120, 0.91784, -1.16270, 0.68012, -0.15284)


def melting_temperature(pressure: float) -> float:
    """Where the melting line of R. Agrawal and D. A. Kofke, Mol. Phys. 85, 43 (1995), has this pressure."""
    def difference(t):
        b = 1 / t
        return b**-1.25 * np.exp(-0.4759 * np.sqrt(b)) * (16.89 - 7.19 * b - 3.028 * b * b) - pressure
    return float(brentq(difference, 0.68, 10.0))


def density(t: float, powers: tuple[float, ...]) -> float:
    """Of crystal (MELTING) or liquid (FREEZING) side by side: E. A. Mastny, J. J. de Pablo, J. Chem. Phys. 127, 104504 (2007)."""
    return float(t**0.25 * np.polynomial.Polynomial(powers)(1 / t))


def layers(path: Path) -> np.ndarray:
    """(layers, 3) of the last average: place along z (part of the box), atoms per volume, mean volume of the cells of atoms."""
    rows = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.array([r for r in rows if len(r) == 5], float)[:, [1, 3, 4]].reshape(-1, 50, 3)[-1]


def phases(profile: np.ndarray) -> list[tuple[float, float]]:
    """Of the crystal and of the liquid, 16 % of the box in the middle of each: density, and how much it differs from layer to layer
    (relative): near 0 in a liquid, large where atoms stand in planes."""
    z, count, volume = profile.T
    middle = np.angle((np.exp(2j * np.pi * z) / volume).sum()) / (2 * np.pi)
    away, out = np.abs((z - middle + 0.5) % 1 - 0.5), []
    for part in (away < 0.08, away > 0.42):
        out.append((float(1 / np.average(volume[part], weights=count[part])), float(count[part].std() / count[part].mean())))
    return out


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(13, 3.4), width_ratios=(3, 3, 5), layout="constrained")
    a.plot(*result["curve"])
    a.axhline(result["T published"], color="k", ls="--")
    a.set(xlabel="time / $\\tau$", ylabel="temperature / $\\epsilon/k$", title="dashed: Agrawal and Kofke 1995")
    b.plot(*result["profile"])
    for name in ("crystal", "liquid"):
        b.axhline(result[f"{name} published"], color="k", ls="--")
    b.set(xlabel="z / length of the box", ylabel="density of the layer / $\\sigma^{-3}$", title="dashed: Mastny and de Pablo 2007")
    x = np.array(result["atoms"])
    c.plot(x[:, 2], x[:, 0], "o", ms=2)
    c.set(xlabel="z / $\\sigma$", ylabel="x / $\\sigma$", aspect="equal", title="the end: liquid and crystal")
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("melting"), cells: int = 6, long: int = 16, equil: int = 5000, steps: int = 200000,
         pressure: float = 1.0, start: float = 0.74) -> dict:
    """Make the two phases, let them come to one temperature; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    given = {"folder": folder, "cells": cells, "long": long, "equil": equil, "steps": steps, "P": pressure, "T": start}
    words = [w for name, value in given.items() for w in ("-var", name, str(value))]
    with Lammps(cmdargs=["-log", str(folder / "log.lammps"), "-screen", "none", *words]) as lmp:
        lmp.file(str(HERE / "in.coexist"))
    step, t, p, conserved = np.loadtxt(folder / "melt.dat").T
    late, profile = step > step[-1] / 2, layers(folder / "layers.dat")
    temperature, blocks = float(t[late].mean()), [part.mean() for part in np.array_split(t[late], 5)]
    result = {"T": temperature, "T error": float(np.std(blocks, ddof=1) / 5**0.5), "T published": melting_temperature(pressure),
              "pressure": float(p[late].mean()), "conserved to": float(np.ptp(conserved) / abs(conserved.mean()))}
    for name, found, powers in zip(("crystal", "liquid"), phases(profile), (MELTING, FREEZING)):
        result[name], result[f"planes in the {name}"] = found
        result[f"{name} published"] = density(temperature, powers)
    result |= {"curve": [(step * 0.004).tolist(), t.tolist()], "profile": [profile[:, 0].tolist(), (1 / profile[:, 2]).tolist()],
               "atoms": read(folder / "atoms.dump", format="lammps-dump-text").positions.tolist()}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "melting.png")
    print({k: round(v, 4) for k, v in result.items() if isinstance(v, float)})
    return result


if __name__ == "__main__":
    typer.run(main)
