"""Phonons of copper: one displaced atom gives all force constants, ASE's Phonons the dispersion, the density of states and the heat.

python run.py [--folder phonons] [--file Cu_mishin1.eam.alloy] [--element Cu] [--a 3.615] [--cells 10] [--points 120]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase import units
from ase.build import bulk
from ase.filters import FrechetCellFilter
from ase.optimize import BFGS
from ase.phonons import Phonons
from ase.thermochemistry import CrystalThermo
from scipy.constants import e, h, hbar

from asemd import EAM, Symmetry

THZ = e / h / 1e12                          # of energies in eV
HBAR = hbar / e * units.second
AT = {"X": [0.5, 0, 0.5], "L": [0.5, 0.5, 0.5]}


def phonons_of(cell, cells: int) -> Phonons:
    """Phonons whose force constants come from the displacements that symmetry leaves over."""
    crystal = cell.repeat(cells)
    hessian = Symmetry(crystal).hessian(cell.calc.copy())
    found = Phonons(cell, supercell=(cells,) * 3)
    # rows of the first cell, for every cell of the crystal
    found.C_N = hessian[:3 * len(cell)].reshape(3 * len(cell), cells**3, 3 * len(cell)).transpose(1, 0, 2)
    found.D_N = found.C_N / np.sqrt(np.outer(*[np.repeat(cell.get_masses(), 3)] * 2))
    return found


def sound(phonons: Phonons, cell) -> np.ndarray:
    """C11 and C44 (eV/Angstrom^3) of the slopes of the branches towards X: density times velocity squared."""
    k = 0.01
    length = np.linalg.norm(np.array(AT["X"]) * 2 * k @ cell.cell.reciprocal()[:])
    omega = np.sort(phonons.band_structure([np.array(AT["X"]) * 2 * k])[0]) / HBAR
    return (omega[[2, 0]] / (2 * np.pi * length)) ** 2 * cell.get_masses().sum() / cell.get_volume()


def draw(bands, dos, result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(11, 3.6), width_ratios=(3, 1, 2), layout="constrained")
    x, ticks, labels = bands.get_labels()
    a.plot(x, bands.energies[0] * THZ, color="C0")
    for tick in ticks:
        a.axvline(tick, color="0.8", lw=1)
    a.set(xticks=ticks, xticklabels=["$\\Gamma$" if s == "G" else s for s in labels], ylabel="frequency / THz", xlim=(x[0], x[-1]), ylim=0)
    b.plot(dos.get_weights(), dos.get_energies() * THZ)
    b.set(xlabel="density of states", ylim=a.get_ylim(), xlim=0, xticks=[])
    c.plot(*result["heat"])
    c.axhline(3.0, color="0.7", lw=1)
    c.set(xlabel="temperature / K", ylabel="heat capacity / k per atom", ylim=0)
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("phonons"), file: str = "Cu_mishin1.eam.alloy", element: str = "Cu", a: float = 3.615, cells: int = 10,
         points: int = 120, grid: int = 20) -> dict:
    """Frequencies in a crystal of that many primitive cells along each vector; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    cell = bulk(element, "fcc", a=a)
    cell.calc = EAM.from_file(file)
    BFGS(FrechetCellFilter(cell), logfile=None).run(fmax=1e-6)
    phonons = phonons_of(cell, cells)
    bands = phonons.get_band_structure(cell.cell.bandpath("GXKGL", npoints=points), verbose=False)
    dos = phonons.get_dos(kpts=(grid,) * 3).sample_grid(npts=300, width=2e-4)
    energies, weights = dos.get_energies(), dos.get_weights()
    thermo = CrystalThermo(phonon_DOS=weights[energies > 0], phonon_energies=energies[energies > 0])
    t = np.linspace(10, 500, 50)
    inner = np.array([[thermo.get_internal_energy(T + d, verbose=False) for d in (-1, 1)] for T in t])
    result = {f"{branch} {name}": float(phonons.band_structure([k])[0][row] * THZ)
              for name, k in AT.items() for branch, row in (("T", 0), ("L", 2))}
    result |= dict(zip(("C11 of sound", "C44 of sound"), (sound(phonons, cell) / units.GPa).tolist()))
    heat = np.diff(inner)[:, 0] / 2 / units.kB
    result |= {"modes per atom": float(np.trapezoid(weights, energies)), "heat": [t.tolist(), heat.tolist()]}
    result["heat at 300 K"] = float(np.interp(300, *result["heat"]))
    (folder / "result.json").write_text(json.dumps(result))
    draw(bands, dos, result, folder / "phonons.png")
    print({k: round(v, 4) for k, v in result.items() if isinstance(v, float)})
    return result


if __name__ == "__main__":
    typer.run(main)
