"""Langevin dynamics at large friction: temperatures of positions and velocities, of harmonic oscillators and of a dense liquid.

python splitting.py [--frames 400] [--folder ensembles]
"""
from __future__ import annotations

import argparse
import csv
import json
from pathlib import Path

import numpy as np

from asemd.lammps import Lammps

FRICTION = (0.02, 0.2, 1.0, 2.0)        # gamma dt
SCHEMES = {"baoab": "fix 1 all baoab {T} {T} {damp} 4711", "gjf": "fix 1 all gjf {T} {T} {damp} 4711",
           "langevin": "fix 1 all nve\nfix 2 all langevin {T} {T} {damp} 4711"}
OSCILLATORS = """
units lj
atom_modify map array
lattice sc 1.0e-4
region box block 0 10 0 10 0 10
create_box 1 box
create_atoms 1 box basis 1 1
mass 1 1.0
pair_style none
neighbor 20.0 bin
neigh_modify delay 0 every 1 check yes
velocity all create 1.0 4712 mom no rot no dist gaussian loop geom
displace_atoms all move 5.0 5.0 5.0 units box
fix spring all spring/self 1.0
timestep 0.1
"""
LIQUID = """
units lj
atom_modify map array
lattice fcc 0.8
region box block 0 4 0 4 0 4
create_box 1 box
create_atoms 1 box
mass 1 1.0
pair_style lj/cut 1.122462048309373
pair_modify shift yes
pair_coeff 1 1 1.0 1.0
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
velocity all create 1.0 4712 mom no rot no dist gaussian loop geom
timestep 0.005
"""


def vectors(lmp, name: str) -> np.ndarray:
    return np.array(lmp.gather_atoms(name, 1, 3)).reshape(-1, 3)


def oscillators(scheme: str, friction: float, frames: int = 80) -> tuple[float, float]:
    """Temperatures of positions, k <x^2>, and of velocities: 3000 oscillators with omega dt = 0.1, bath at 1."""
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_string(OSCILLATORS)
        center, found = vectors(lmp, "x"), []
        spread = np.random.default_rng(3).normal(size=center.shape)
        lmp.scatter_atoms("x", 1, 3, (center + spread).ravel().tolist())
        lmp.commands_string(SCHEMES[scheme].format(T=1.0, damp=0.1 / friction) + "\nrun 1000 post no")
        for _ in range(frames):
            lmp.command("run 100 pre no post no")
            found.append(((vectors(lmp, "x") - center) ** 2).mean())
            found.append((vectors(lmp, "v") ** 2).mean())
    return float(np.mean(found[::2])), float(np.mean(found[1::2]))


def curvature(x: np.ndarray, length: float, reach: float) -> tuple[float, float]:
    """The square of the gradient of the repulsive Lennard-Jones energy, and its Laplacian."""
    d = x[:, None] - x[None]
    d -= length * np.rint(d / length)
    r2 = (d * d).sum(axis=-1)
    i, j = np.nonzero((r2 < reach * reach) & (r2 > 0.0))
    r2, d = r2[i, j], d[i, j]
    s6 = 1.0 / r2**3
    slope, second = -24.0 * s6 * (2.0 * s6 - 1.0) / r2, 24.0 * s6 * (26.0 * s6 - 7.0) / r2      # U' / r and U''
    gradient = np.zeros_like(x)
    np.add.at(gradient, i, slope[:, None] * d)
    return float((gradient**2).sum()), float((second + 2.0 * slope).sum())


def liquid(scheme: str, friction: float, frames: int = 400) -> tuple[float, float]:
    """Temperatures of positions, <(grad U)^2> / <laplacian U>, and of velocities: 256 repulsive spheres at density 0.8, bath at 1."""
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_string(LIQUID + "fix 1 all baoab 1.0 1.0 0.5 99\nrun 3000 post no\nunfix 1")
        lmp.commands_string(SCHEMES[scheme].format(T=1.0, damp=0.005 / friction) + "\nrun 1000 post no")
        length, found = lmp.extract_box()[1][0] - lmp.extract_box()[0][0], []
        for _ in range(frames):
            lmp.command("run 100 pre no post no")
            found.append((*curvature(vectors(lmp, "x"), length, 1.122462048309373), (vectors(lmp, "v") ** 2).mean()))
    square, laplacian, velocity = np.mean(found, axis=0)
    return float(square / laplacian), float(velocity)


def draw(rows: list[dict], path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained", sharey=True)
    for a, system in zip(axes, ("oscillators", "liquid")):
        for scheme, colour in zip(SCHEMES, ("#1f77b4", "#2ca02c", "#d62728")):
            mine = [r for r in rows if r["system"] == system and r["scheme"] == scheme]
            for quantity, style in (("positions", "o-"), ("velocities", "s--")):
                a.semilogx([r["gamma dt"] for r in mine], [100 * (r[quantity] - 1) for r in mine], style, color=colour, ms=4, lw=1,
                           label=f"{scheme}, {quantity}")
        a.axhspan(-2, 2, color="0.92", zorder=0)
        a.axhline(0, color="0.5", lw=0.8)
        a.set(title=system, xlabel="$\\gamma\\,\\Delta t$")
    axes[0].set_ylabel("temperature off target / %")
    axes[0].set_ylim(-4, 4)
    axes[1].legend(fontsize=7, ncols=2)
    figure.savefig(path, dpi=90)


def keep(rows: list[dict], folder: Path) -> None:
    """As CSV, JSON and picture."""
    with (folder / "splitting.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    (folder / "splitting.json").write_text(json.dumps(rows))
    draw(rows, folder / "splitting.png")


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--frames", type=int, default=400)
    p.add_argument("--folder", type=Path, default=Path("ensembles"))
    o = p.parse_args()
    o.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for system, measure, frames in (("oscillators", oscillators, o.frames // 2), ("liquid", liquid, o.frames)):
        for scheme in SCHEMES:
            for friction in FRICTION:
                if scheme == "langevin" and friction >= 2.0:
                    continue        # not stable there
                positions, velocities = measure(scheme, friction, frames)
                rows.append({"system": system, "scheme": scheme, "gamma dt": friction, "positions": positions, "velocities": velocities})
                print(rows[-1], flush=True)
    keep(rows, o.folder)


if __name__ == "__main__":
    main()
