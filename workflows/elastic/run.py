"""Equation of state and elastic constants of crystals, from as few strained copies as the symmetry of the crystal allows.

python run.py [--folder elastic] [--points 9] [--width 0.02]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase.build import bulk
from ase.eos import EquationOfState
from ase.filters import FrechetCellFilter
from ase.optimize import BFGS
from ase.units import GPa

from asemd import EAM, Potential, Symmetry

CRYSTALS = {"copper": ("Cu", "fcc", 3.5, EAM, "Cu_mishin1.eam.alloy"), "silicon": ("Si", "diamond", 5.3, Potential, "Si.sw")}


def equation_of_state(atoms, points: int, width: float) -> tuple[EquationOfState, list[float], list[float]]:
    """Energies of crystals whose lengths differ by `width` in all, and the curve of Birch and Murnaghan through them."""
    volumes, energies = [], []
    for scale in np.linspace(1 - width / 2, 1 + width / 2, points):
        strained = atoms.copy()
        strained.calc = atoms.calc
        strained.set_cell(atoms.cell * scale, scale_atoms=True)
        volumes.append(strained.get_volume())
        energies.append(strained.get_potential_energy())
    return EquationOfState(volumes, energies, eos="birchmurnaghan"), volumes, energies


def study(name: str, points: int, width: float) -> dict:
    """Lattice constant (Angstrom), energy (eV per atom), bulk modulus and elastic constants (GPa) of a cubic crystal."""
    element, structure, a, calculator, file = CRYSTALS[name]
    atoms = bulk(element, structure, a=a)
    atoms.calc = calculator.from_file(file)
    BFGS(FrechetCellFilter(atoms), logfile=None).run(fmax=1e-7, steps=200)

    symmetry = Symmetry(atoms)
    relaxed, clamped = (symmetry.elastic_constants(atoms.calc, relaxed=r) / GPa for r in (True, False))
    eos, volumes, energies = equation_of_state(atoms, points, width)
    volume, _, modulus = eos.fit()
    n = len(atoms)
    return {"group": symmetry.international, "strains": len(symmetry.strains()),
            "a": float((atoms.get_volume() / n * (4 if structure == "fcc" else 8)) ** (1 / 3)),
            "energy": atoms.get_potential_energy() / n, "B": float(modulus / GPa), "V0": float(volume / n),
            "C11": float(relaxed[0, 0]), "C12": float(relaxed[0, 1]), "C44": float(relaxed[3, 3]), "C44 clamped": float(clamped[3, 3]),
            "volumes": [v / n for v in volumes], "energies": [e / n for e in energies]}


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(result) + 1, figsize=(11, 3.4), layout="constrained")
    for axis, (name, one) in zip(axes, result.items()):
        axis.plot(one["volumes"], one["energies"], "o-")
        axis.axvline(one["V0"], color="0.7", lw=1)
        axis.set(title=f"{name}, {one['group']}", xlabel="volume per atom / Å$^3$", ylabel="energy per atom / eV")
    names = ["C11", "C12", "C44", "B"]
    for k, (name, one) in enumerate(result.items()):
        axes[-1].bar(np.arange(4) + 0.4 * k, [one[n] for n in names], 0.38, label=name)
    axes[-1].set(title="elastic constants", ylabel="GPa", xticks=np.arange(4) + 0.2, xticklabels=names)
    axes[-1].margins(y=0.2)         # room for the legend
    axes[-1].legend(loc="upper center", ncols=2)
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("elastic"), points: int = 9, width: float = 0.02) -> dict:
    """Study all crystals; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    result = {name: study(name, points, width) for name in CRYSTALS}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "elastic.png")
    for name, one in result.items():
        print(name, {k: round(v, 4) for k, v in one.items() if isinstance(v, float)}, f"{one['strains']} strains of 6")
    return result


if __name__ == "__main__":
    typer.run(main)
