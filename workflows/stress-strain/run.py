"""A glassy polymer is stretched: stress against strain, Young's modulus, Poisson's ratio, yield.

python run.py [--folder stress-strain] [--glasses 4] [--chains 100] [--beads 20] [--steps 80000] [--strain 0.25]
"""
from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from asemd.lammps import Lammps

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from chains import build  # noqa: E402


def stretch(folder: Path, chains: int, beads: int, seed: int, **given) -> np.ndarray:
    """Strain along and across, stress along and across (4, rows), averaged over parts of the run."""
    folder.mkdir(parents=True, exist_ok=True)
    build(folder / "melt.data", chains, beads, seed=seed)
    given |= {"data": folder / "melt.data", "folder": folder, "start": HERE.parent / "in.push", "seed": 8311 + seed}
    words = [w for name, value in given.items() for w in ("-var", name, str(value))]
    with Lammps(cmdargs=["-log", str(folder / "log.lammps"), "-screen", "none", *words]) as lmp:
        lmp.file(str(HERE / "in.stretch"))
    return np.loadtxt(folder / "stretch.dat")[:, 1:].T


def numbers(curve: np.ndarray) -> np.ndarray:
    """Young's modulus and Poisson's ratio of small strains, stress at yield and in flow, volume gained in flow, stress across.

    Yield is where the stress meets the elastic line that has moved by a strain of 0.02.
    """
    x, across, stress, sides = curve
    elastic, flow = x < 0.02, x > 0.5 * x[-1]
    modulus, offset = np.polyfit(x[elastic], stress[elastic], 1)
    smooth = np.convolve(stress, np.ones(9) / 9, "same")
    met = (x > 0.02) & (smooth < modulus * (x - 0.02) + offset)
    volume = (1 + x) * (1 + across) ** 2 - 1
    return np.array([modulus, -np.polyfit(x[elastic], across[elastic], 1)[0], smooth[met][0], stress[flow].mean(), volume[flow].mean(),
                     sides.mean()])


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
    for curve in result["curves"]:
        a.plot(curve[0], curve[2], color="0.8", lw=0.5)
    x, across, stress, sides = np.mean(result["curves"], axis=0)
    modulus, near = result["Young's modulus"][0], x < 0.04
    a.plot(x, stress, label="along")
    a.plot(x, sides, label="across")
    a.plot(x[near], modulus * x[near], "k--", lw=1, label=f"E = {modulus:.0f}")
    a.set(xlabel="strain", ylabel="stress / $\\epsilon/\\sigma^3$")
    a.legend(loc=(0.66, 0.2))
    b.plot(x, (1 + x) * (1 + across) ** 2 - 1, label="volume")
    b.plot(x, -across, label="contraction of the sides")
    b.set(xlabel="strain", ylabel="relative change")
    b.legend()
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("stress-strain"), glasses: int = 4, chains: int = 100, beads: int = 20, equil: int = 20000,
         cool: int = 60000, steps: int = 80000, strain: Annotated[float, typer.Option(min=0.1)] = 0.25, seed: int = 1) -> dict:
    """Build, cool and stretch; numbers and picture go to the folder."""
    curves = [stretch(folder / f"glass{k + 1}", chains, beads, seed + k, equil=equil, cool=cool, steps=steps, strain=strain)
              for k in range(glasses)]
    each = np.array([numbers(c) for c in curves])
    errors = each.std(axis=0) / max(glasses - 1, 1)**0.5
    names = "Young's modulus", "Poisson's ratio", "yield stress", "flow stress", "volume gained", "stress across"
    result = {name: [float(value), float(error)] for name, value, error in zip(names, each.mean(axis=0), errors)}
    result["curves"] = np.array(curves).tolist()
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "stress-strain.png")
    print({name: f"{result[name][0]:.3f} +- {result[name][1]:.3f}" for name in names})
    return result


if __name__ == "__main__":
    typer.run(main)
