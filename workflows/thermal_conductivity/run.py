"""The thermal conductivity of the Lennard-Jones liquid by several routes: LAMMPS scripts, block errors, a table and a picture.

python run.py [--quick] [--routes langevin heat ehex exchange green-kubo] [--folder thermal_conductivity]
"""
from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import transport  # noqa: E402

ROUTES = {"langevin": ("in.langevin", {}), "heat": ("in.heat", {}), "ehex": ("in.heat", {"how": "ehex"}), "exchange": ("in.exchange", {}),
          "green-kubo": ("in.green-kubo", {})}
QUICK = {"cells": 4, "equil": 300, "block": 500, "steps": 2000, "repeat": 50}
CUT = 1.5       # end of the integral of Green and Kubo, time units
PUBLISHED = {"Lautenschlaeger and Hasse 2019": 3.50, "Evans 1986": 3.4}
NAMES = {"langevin": "two Langevin layers", "heat": "fix heat", "ehex": "fix ehex", "exchange": "exchange of energy"}


def analyse(folder: Path) -> tuple[dict, dict, tuple]:
    """Conductivity and its error by method, of all routes that were run; temperature profiles; the Green-Kubo integral."""
    out, profiles, integral = {}, {}, ()
    for route, name in NAMES.items():
        if (folder / f"{route}.box").exists():
            out[name], profiles[name] = transport.driven(folder, route, 2)
    if (folder / "green-kubo.box").exists():
        volume, temperature = float(np.loadtxt(folder / "green-kubo.box")), np.loadtxt(folder / "temperature.dat")[:, 1].mean()
        out["Green-Kubo"], integral = transport.green_kubo(folder, 1 / (volume * temperature**2), CUT)
    return out, profiles, integral


if __name__ == "__main__":
    transport.main(__doc__, HERE, ROUTES, QUICK, PUBLISHED, "$\\kappa$", "temperature / $\\epsilon/k$", analyse)
