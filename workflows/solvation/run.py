"""Water round alanine dipeptide: a LAMMPS script builds and runs it, MDAnalysis has the radial distribution functions of the dump.

python run.py [--folder solvation] [--cells 7] [--equil 10000] [--steps 40000]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from MDAnalysis.analysis.rdf import InterRDF

import asemd
from asemd.lammps import Lammps

HERE = Path(__file__).resolve().parent
PEPTIDE = HERE.parent / "ramachandran"                          # the molecule and its coefficients
OXYGEN, HYDROGEN, METHYL = "index 2 15", "index 7 17", "index 0 11 18"     # of C=O, of N-H, carbons of CH3
WATER_O, WATER_H = "index 22:1000000 and prop mass > 2", "index 22:1000000 and prop mass < 2"
PAIRS = {"C=O to H of water": (OXYGEN, WATER_H), "C=O to O of water": (OXYGEN, WATER_O), "N-H to O of water": (HYDROGEN, WATER_O),
         "CH3 to O of water": (METHYL, WATER_O), "water": (WATER_O, WATER_O)}


def functions(universe) -> dict:
    """Distances, g(r) and number of neighbours up to there, for each of the pairs."""
    out = {}
    for name, (a, b) in PAIRS.items():
        one, other = universe.select_atoms(a), universe.select_atoms(b)
        rdf = InterRDF(one, other, nbins=90, range=(0.0, 9.0), exclusion_block=(1, 1) if a == b else None).run().results
        out[name] = {"r": rdf.bins.tolist(), "g": rdf.rdf.tolist(),
                     "n": (rdf.count.cumsum() / len(one) / len(universe.trajectory)).tolist()}
    return out


def shell(r: list, g: list, n: list) -> dict:
    """First maximum, the minimum behind it, and the number of neighbours up to there; running means of three bins find the places."""
    smooth = np.convolve(g, np.ones(3) / 3, mode="same")
    peaks = (k for k in range(5, len(r) - 5) if smooth[k] > 0.5 and smooth[k] == smooth[k - 5:k + 6].max())
    top = next(peaks, int(smooth.argmax()))
    low = top + int(smooth[top:top + 20].argmin())
    return {"maximum": r[top], "height": g[top], "minimum": r[low], "neighbours": n[low]}


def draw(curves: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
    for name, one in curves.items():
        axes[int(name in ("CH3 to O of water", "water"))].plot(one["r"], one["g"], label=name)
    for axis in axes:
        axis.axhline(1, color="0.7", lw=1)
        axis.set(xlabel="r / Å", ylabel="g(r)", xlim=(1, 9), ylim=0)
        axis.legend()
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("solvation"), cells: int = 7, equil: int = 10000, steps: int = 40000) -> dict:
    """Build, run and analyse; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    given = {"folder": folder, "data": PEPTIDE / "dipeptide.data", "coeffs": PEPTIDE / "in.charmm22", "water": HERE / "water.mol",
             "cells": cells, "equil": equil, "steps": steps}
    words = [w for name, value in given.items() for w in ("-var", name, str(value))]
    with Lammps(cmdargs=["-log", str(folder / "log.lammps"), "-screen", "none", *words]) as lmp:
        lmp.file(str(HERE / "in.solvation"))
        universe = asemd.to_mdanalysis(lmp)
    universe.load_new(str(folder / "run.dump"), format="LAMMPSDUMP")
    curves = functions(universe)
    own = np.loadtxt(folder / "water.rdf", skiprows=4)          # the same function by compute rdf, while it ran
    _, density, temperature = np.loadtxt(folder / "mean.dat", ndmin=2)[-1]
    result = {"shells": {name: shell(**one) for name, one in curves.items()}, "density": float(density), "temperature": float(temperature),
              "differs from compute rdf by": float(abs(own[:, 2] - curves["water"]["g"]).max())}
    (folder / "result.json").write_text(json.dumps(result))
    draw(curves, folder / "solvation.png")
    print(json.dumps(result, indent=1))
    return result


if __name__ == "__main__":
    typer.run(main)
