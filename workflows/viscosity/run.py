"""The shear viscosity of the Lennard-Jones liquid by several routes: LAMMPS scripts, block errors, a table and a picture.

python run.py [--quick] [--routes shear exchange green-kubo cosine sllod] [--folder viscosity]
"""
from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import transport  # noqa: E402

ROUTES = {name: (f"in.{name}", {}) for name in ("shear", "exchange", "green-kubo", "cosine", "sllod")}
QUICK = {"cells": 4, "equil": 1000, "block": 2000, "steps": 16000, "repeat": 205}
RATE, A, CUT = 0.1, 0.03, 4.0       # of the scripts; end of the integral of Green and Kubo, time units
PUBLISHED = {"Lautenschlaeger and Hasse 2019": 0.837, "Galliero et al. 2005, no cutoff": 0.820}


def analyse(folder: Path) -> tuple[dict, dict, tuple]:
    """Viscosity and its error by method, of all routes that were run; velocity profiles; the Green-Kubo integral."""
    out, profiles, integral = {}, {}, ()
    if (folder / "shear.box").exists():
        out["sheared box"] = transport.estimate(-np.loadtxt(folder / "shear.dat")[:, 1] / RATE)
    if (folder / "exchange.box").exists():
        out["exchange of momentum"], profiles["exchange of momentum"] = transport.driven(folder, "exchange", 1)
    if (folder / "cosine.box").exists():
        wave = 2 * np.pi / float(np.loadtxt(folder / "cosine.box"))
        out["cosine acceleration"] = transport.estimate(np.loadtxt(folder / "cosine.dat")[:, 1], lambda v: A * transport.RHO / wave**2 / v)
        profiles["cosine acceleration"] = transport.tables(folder / "cosine.profile")[:, :, 3].mean(axis=0)
    if (folder / "green-kubo.box").exists():
        windows = np.loadtxt(folder / "windows.dat")[:, 1:]
        factor = float(np.loadtxt(folder / "green-kubo.box")) / windows[:, 5].mean()
        out["Green-Kubo"], integral = transport.green_kubo(folder, factor, CUT)
        moved, m = np.cumsum(windows[:, :5], axis=0), np.arange(2, 7)        # a window is one time unit
        parts = np.array_split(moved, max(2, min(20, len(moved) // 15)))
        squares = np.array([[((p[k:] - p[:-k]) ** 2).mean() for k in m] for p in parts])
        out["Einstein, same run"] = transport.estimate(squares, lambda s: float(np.polyfit(m, s, 1)[0]) * factor / 2)
    if (folder / "sllod.box").exists():
        out["fix nvt/sllod (see README)"] = transport.estimate(-np.loadtxt(folder / "sllod.dat")[:, 1] / RATE)
    return out, profiles, integral


if __name__ == "__main__":
    transport.main(__doc__, HERE, ROUTES, QUICK, PUBLISHED, "$\\eta$", "$v_x$ / $\\sigma/\\tau$", analyse)
