"""Umbrella sampling along a bond with two wells, put together by WHAM, against the exact free energy.

python run.py [--folder umbrella] [--windows 24] [--copies 40] [--steps 20000]
"""
from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import typer
from ase import units

from asemd import Atoms, ForceField, MolecularDynamics, Topology
from asemd.fix import BAOAB

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from wham import wham  # noqa: E402

T = 300.0
KT = units.kB * T
LOW, HIGH, HEIGHT = 2.0, 3.0, 12 * KT       # the two wells (Angstrom) and the barrier between them
STIFF = 3.0                                 # of the umbrellas K (r - r_k)^2, eV/Angstrom^2


def exact(r: np.ndarray) -> np.ndarray:
    """Free energy of the distance, kT, 0 at its lowest: the energy of the bond, and the area of the sphere."""
    u = (r - (LOW + HIGH) / 2) / ((HIGH - LOW) / 2)
    w = HEIGHT / KT * (u * u - 1) ** 2 - 2 * np.log(r)
    return w - w.min()


def sample(centres: np.ndarray, copies: int, steps: int) -> np.ndarray:
    """(windows, samples) distances. All molecules of all windows are in one scene: two bonds each, the molecule's and the umbrella's."""
    windows, n = len(centres), len(centres) * copies
    x = np.zeros((2 * n, 3))
    x[::2, 0] = x[1::2, 0] = 100.0 * np.arange(n)
    x[1::2, 1] = np.repeat(centres, copies)
    pairs = np.arange(2 * n).reshape(n, 2)
    topology = Topology(bonds=np.concatenate([pairs, pairs]),
                        bond_types=np.concatenate([np.ones(n, int), 2 + np.repeat(np.arange(windows), copies)]))
    atoms = Atoms(f"Ar{2 * n}", positions=x, topology=topology)
    middle, half = (LOW + HIGH) / 2, (HIGH - LOW) / 2
    atoms.calc = ForceField(bond={"lepton": {1: (middle, f"{HEIGHT!r}*((r/{half!r})^2-1)^2")},
                                  "harmonic": {2 + k: (STIFF, float(c)) for k, c in enumerate(centres)}})
    md, seen = MolecularDynamics(atoms, 10 * units.fs, fixes=[BAOAB(temperature=T, damping=200 * units.fs, seed=7)]), []
    md.run(steps // 10)
    md.attach(lambda: seen.append(np.linalg.norm(atoms.positions[1::2] - atoms.positions[::2], axis=1)), interval=20)
    md.run(steps)
    return np.array(seen).T.reshape(windows, -1)


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
    r = np.array(result["r"])
    for h in result["histograms"]:
        a.fill_between(r, h, alpha=0.3)
    a.set(xlabel="r / Å", ylabel="samples", title="windows")
    b.plot(r, exact(r), "k-", label="exact")
    b.plot(r, result["free energy"], "o", ms=3, label="WHAM")
    b.set(xlabel="r / Å", ylabel="free energy / kT", title="put together")
    b.legend()
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("umbrella"), windows: int = 24, copies: int = 40, steps: int = 20000) -> dict:
    """Sample all windows and put them together; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    centres, edges = np.linspace(1.7, 3.3, windows), np.linspace(1.85, 3.15, 53)
    middles = (edges[1:] + edges[:-1]) / 2
    histograms = np.array([np.histogram(row, edges)[0] for row in sample(centres, copies, steps)])
    found, target = wham(histograms, STIFF * (middles - centres[:, None]) ** 2 / KT), exact(middles)
    left, right = middles < 2.5, middles > 2.5
    difference = [float(np.log(np.exp(-f[left]).sum() / np.exp(-f[right]).sum())) for f in (found, target)]
    barrier = [float(f[~left][0] - f[left].min()) for f in (found, target)]
    result = {"error": float(np.std(found - target)), "wells": difference[0], "wells exactly": difference[1], "barrier": barrier[0],
              "barrier exactly": barrier[1], "r": middles.tolist(), "histograms": histograms.tolist(), "free energy": found.tolist()}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "umbrella.png")
    print({k: round(v, 4) for k, v in result.items() if isinstance(v, float)})
    return result


if __name__ == "__main__":
    typer.run(main)
