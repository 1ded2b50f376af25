"""The glass transition of a polymer: melts are cooled, and their volume bends where the beads stop to move.

python run.py [--folder glass-transition] [--melts 4] [--chains 100] [--beads 10] [--steps 200000]
"""
from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import typer

from asemd.lammps import Lammps

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from chains import build  # noqa: E402

GLASS, MELT = 0.35, 0.55      # volumes below the one and above the other are fitted


def cool(folder: Path, chains: int, beads: int, seed: int, **given) -> np.ndarray:
    """Temperatures and volumes per bead (2, rows), averaged over parts of the cooling of one melt."""
    folder.mkdir(parents=True, exist_ok=True)
    build(folder / "melt.data", chains, beads, seed=seed)
    given |= {"data": folder / "melt.data", "folder": folder, "start": HERE.parent / "in.push", "seed": 8311 + seed}
    words = [w for name, value in given.items() for w in ("-var", name, str(value))]
    with Lammps(cmdargs=["-log", str(folder / "log.lammps"), "-screen", "none", *words]) as lmp:
        lmp.file(str(HERE / "in.cool"))
    return np.loadtxt(folder / "cool.dat")[:, 1:3].T


def lines(curve: np.ndarray) -> list[np.ndarray]:
    """Slope and value at zero of straight lines through the volumes of the glass and of the melt."""
    t, v = curve
    return [np.polyfit(t[part], v[part], 1) for part in (t < GLASS, t > MELT)]


def numbers(curve: np.ndarray) -> np.ndarray:
    """Temperature where the lines cross, expansion coefficients of glass and melt there, density of the glass at 0.2."""
    glass, melt = lines(curve)
    bend = (melt[1] - glass[1]) / (glass[0] - melt[0])
    volume = np.polyval(glass, bend)
    return np.array([bend, glass[0] / volume, melt[0] / volume, 1 / np.polyval(glass, 0.2)])


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axis = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
    for curve in result["curves"]:
        axis.plot(*curve, ".", color="0.6", ms=3)
    t, v = np.mean(result["curves"], axis=0)
    axis.plot(t, v, "o", ms=4, label=f"mean of {len(result['curves'])} melts")
    for line, name in zip(lines(np.array([t, v])), (f"glass, below {GLASS}", f"melt, above {MELT}")):
        axis.plot(t, np.polyval(line, t), lw=1, label=name)
    bend = result["Tg"][0]
    axis.axvline(bend, color="0.4", lw=1)
    axis.set(xlabel="temperature / $\\epsilon/k$", ylabel="volume per bead / $\\sigma^3$", title=f"glass transition at {bend:.3f}",
             ylim=(v.min() - 0.01, v.max() + 0.01))
    axis.legend()
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("glass-transition"), melts: int = 4, chains: int = 100, beads: int = 10, equil: int = 20000,
         steps: int = 200000, seed: int = 1) -> dict:
    """Build the melts, cool them, fit lines to their volumes; numbers and picture go to the folder."""
    curves = [cool(folder / f"melt{k + 1}", chains, beads, seed + k, equil=equil, steps=steps) for k in range(melts)]
    each = np.array([numbers(c) for c in curves])
    errors = each.std(axis=0) / max(melts - 1, 1)**0.5
    names = "Tg", "expansion of the glass", "expansion of the melt", "density at 0.2"
    result = {name: [float(value), float(error)] for name, value, error in zip(names, each.mean(axis=0), errors)}
    result["curves"] = np.array(curves).tolist()
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "glass-transition.png")
    print({name: f"{result[name][0]:.4f} +- {result[name][1]:.4f}" for name in names})
    return result


if __name__ == "__main__":
    typer.run(main)
