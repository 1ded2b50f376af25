"""The systems: data files of the molecular ones, and what is known of each of them."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Liquid:
    """A liquid in the units of its script: two temperatures and pressures, relaxation times of thermostat and barostat."""

    script: str
    units: str
    atoms: int
    molecules: int
    temperatures: tuple[float, float]
    pressures: tuple[float, float]
    times: tuple[float, float]
    every: int              # steps between two records
    geometry: tuple[float, float] | None = None      # bond length and angle of water
    parts: int = 1          # of a run, each after steps with fix langevin


# Bonds of flexible water swing so fast that they exchange energy with the rest only within hundreds of picoseconds. fix langevin acts on
# all motions at once; parts that begin with it sample what one long run would not.
LIQUIDS = {
    "LJ liquid": Liquid("in.lj", "lj", 256, 256, (1.2, 1.35), (1.5, 1.9), (0.2, 1.0), 50),
    "polymer melt": Liquid("in.melt", "lj", 216, 18, (1.0, 1.1), (5.0, 5.6), (0.2, 1.0), 50),
    "flexible water": Liquid("in.water", "real", 375, 125, (300.0, 320.0), (1000.0, 2000.0), (50.0, 500.0), 50, (1.012, 113.24), 20),
    "rigid water": Liquid("in.rigid", "real", 375, 125, (300.0, 320.0), (1000.0, 2000.0), (50.0, 500.0), 50, (1.0, 109.47)),
}


def write(path: Path, x, length: float, molecule, kind, charge, masses, bonds, angles) -> None:
    """A data file for read_data: atom style full where there are charges, bond otherwise."""
    full = charge is not None
    counts = [f"{len(x)} atoms", f"{len(bonds)} bonds", f"{len(angles)} angles", f"{len(masses)} atom types", "1 bond types"]
    lines = ["written by systems.py", "", *counts, *(["1 angle types"] if full else []), ""]
    lines += [f"0 {length:.15g} {d}lo {d}hi" for d in "xyz"] + ["", "Masses", ""] + [f"{i + 1} {m}" for i, m in enumerate(masses)]
    lines += ["", "Atoms # full" if full else "Atoms # bond", ""]
    for i, p in enumerate(x):
        lines.append(f"{i + 1} {molecule[i]} {kind[i]} " + (f"{charge[i]} " if full else "") + " ".join(f"{c:.15g}" for c in p))
    lines += ["", "Bonds", ""] + [f"{k + 1} 1 {i + 1} {j + 1}" for k, (i, j) in enumerate(bonds)]
    if full:
        lines += ["", "Angles", ""] + [f"{k + 1} 1 {i + 1} {j + 1} {m + 1}" for k, (i, j, m) in enumerate(angles)]
    path.write_text("\n".join(lines) + "\n")


def water(path: Path, bond: float, angle: float, side: int = 5, spacing: float = 3.105) -> None:
    """Molecules with random orientations on a simple cubic lattice, at the density of water."""
    rng, half = np.random.default_rng(7), np.radians(angle) / 2
    shape = bond * np.array([[0, 0, 0], [np.sin(half), np.cos(half), 0], [-np.sin(half), np.cos(half), 0]])
    x = []
    for cell in np.ndindex(side, side, side):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        x += list(spacing * (np.array(cell) + 0.5) + shape @ turn)
    n = side**3
    write(path, x, side * spacing, np.repeat(np.arange(1, n + 1), 3), [1, 2, 2] * n, [-0.82, 0.41, 0.41] * n, [15.9994, 1.008],
          [(3 * m, 3 * m + h) for m in range(n) for h in (1, 2)], [(3 * m + 1, 3 * m, 3 * m + 2) for m in range(n)])


def melt(path: Path, side: int = 6, beads: int = 12, density: float = 0.85) -> None:
    """Chains of `beads`: pieces of one path that winds through a simple cubic lattice."""
    spacing, path_of = density ** (-1 / 3), []
    for i in range(side):
        for j in range(side) if i % 2 == 0 else reversed(range(side)):
            row = range(side) if (i * side + j) % 2 == 0 else reversed(range(side))
            path_of += [(i, j, k) for k in row]
    n = len(path_of)
    write(path, spacing * (np.array(path_of) + 0.5), side * spacing, np.arange(n) // beads + 1, [1] * n, None, [1.0],
          [(i, i + 1) for i in range(n - 1) if (i + 1) % beads], [])


def prepare(name: str, folder: Path) -> list[str]:
    """Switches for the script of a liquid, after its data file has been written."""
    liquid = LIQUIDS[name]
    if liquid.script == "in.lj":
        return []
    path = folder / f"{liquid.script[3:]}.data"
    if not path.exists():
        if liquid.geometry is None:
            melt(path)
        else:
            water(path, *liquid.geometry)
    return ["-var", "data", str(path)]
