"""A vacancy in copper: what it costs to make, and the barrier over which a neighbour jumps into it, by a climbing nudged elastic band.

python run.py [--folder vacancy-neb] [--file Cu_mishin1.eam.alloy] [--element Cu] [--a 3.615] [--cells 4] [--images 7]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase.build import bulk
from ase.filters import FrechetCellFilter
from ase.mep import NEB
from ase.optimize import BFGS, FIRE
from ase.utils.forcecurve import fit_images

from asemd import EAM


def vacancy(crystal, site: int):
    """The crystal without one atom, relaxed at constant volume; atoms are those of the crystal in its order."""
    atoms = crystal.copy()
    del atoms[site]
    atoms.calc = crystal.calc.copy()
    FIRE(atoms, logfile=None).run(fmax=1e-4, steps=1000)
    return atoms


def path_of_jump(crystal, images: int) -> NEB:
    """A neighbour of the vacancy goes into it: first and last image are the same vacancy at two places."""
    neighbor = int(np.argsort(crystal.get_distances(0, range(len(crystal)), mic=True))[1])
    first, last = vacancy(crystal, 0), vacancy(crystal, neighbor)
    # in the last image the atom that was row 0 stands where the neighbour was: give it the neighbour's row
    order = [*range(1, neighbor), 0, *range(neighbor, len(last))]
    last = last[order]
    last.calc = crystal.calc.copy()
    chain = [first, *(first.copy() for _ in range(images - 2)), last]
    for image in chain[1:-1]:
        image.calc = crystal.calc.copy()
    neb = NEB(chain, climb=True, method="improvedtangent")
    neb.interpolate(mic=True)
    FIRE(neb, logfile=None).run(fmax=5e-3, steps=500)
    return neb


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axis = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
    axis.plot(result["curve"][0], result["curve"][1])
    axis.plot(result["path"], result["energies"], "o")
    axis.axhline(result["migration"], color="0.7", lw=1)
    axis.set(xlabel="path / Å", ylabel="energy / eV", title=f"a neighbour jumps into the vacancy: {result['migration']:.3f} eV")
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("vacancy-neb"), file: str = "Cu_mishin1.eam.alloy", element: str = "Cu", a: float = 3.615, cells: int = 4,
         images: int = 7) -> dict:
    """Formation and migration energy in a cube of that many fcc cells; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    one = bulk(element, "fcc", a=a, cubic=True)
    one.calc = EAM.from_file(file)
    BFGS(FrechetCellFilter(one), logfile=None).run(fmax=1e-6)
    crystal = one * cells
    crystal.calc = one.calc.copy()

    neb = path_of_jump(crystal, images)
    n, energies = len(crystal), np.array([image.get_potential_energy() for image in neb.images])
    fit = fit_images(neb.images)
    formation = energies[0] - (n - 1) / n * crystal.get_potential_energy()
    result = {"formation": float(formation), "migration": float(energies.max() - energies[0]),
              "activation": float(formation + energies.max() - energies[0]),
              "ends differ by": float(abs(energies[-1] - energies[0])), "atoms": n - 1, "path": list(map(float, fit.path)),
              "energies": (energies - energies[0]).tolist(), "curve": [list(map(float, fit.fit_path)), list(map(float, fit.fit_energies))]}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "vacancy-neb.png")
    print({k: round(v, 4) for k, v in result.items() if isinstance(v, float)}, f"{n - 1} atoms")
    return result


if __name__ == "__main__":
    typer.run(main)
