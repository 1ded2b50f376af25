"""The Ramachandran plot of alanine dipeptide with CHARMM22: minima by ASE, then 324 restrained copies at once, angles by MDAnalysis.

python run.py [--folder ramachandran] [--windows 18] [--steps 20000]
"""
from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import typer
from ase import units
from ase.optimize import BFGS, FIRE
from MDAnalysis.analysis.dihedrals import Dihedral

import asemd
from asemd import MolecularDynamics, Stream
from asemd.fix import BAOAB, Restrain

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from wham import wham  # noqa: E402

PHI, PSI = (1, 6, 8, 9), (6, 8, 9, 16)          # rows of C N CA C and of N CA C N
STARTS = {"C7eq": (-80, 75), "C5": (-155, 160), "C7ax": (70, -65)}
KCAL, T = units.kcal / units.mol, 300.0
KT, STIFF, BINS = units.kB * T / KCAL, 20.0, 60     # kcal/mol; the restraints are STIFF (1 - cos(angle - centre))
MIDDLE = (np.arange(BINS) + 0.5) * 360 / BINS - 180


def peptide(phi: float, psi: float):
    """The molecule with its force field, at these angles."""
    atoms = asemd.read(HERE / "in.peptide", variables={"folder": str(HERE)})
    for rows, angle, first in ((PHI, phi, 9), (PSI, psi, 15)):
        atoms.set_dihedral(*rows, angle, indices=[*range(first, len(atoms))])
    return atoms


def minimum(phi: float, psi: float) -> list[float]:
    """Energy (kcal/mol), phi and psi of the minimum next to these angles."""
    atoms = peptide(phi, psi)
    BFGS(atoms, logfile=None).run(fmax=1e-4, steps=2000)
    return [atoms.get_potential_energy() / KCAL, *(float((atoms.get_dihedral(*rows) + 180) % 360 - 180) for rows in (PHI, PSI))]


def sample(centres: np.ndarray, steps: int) -> np.ndarray:
    """(frames, windows, 2) angles: one scene with a copy of the molecule for each window, which its two restraints keep there."""
    atoms, n = peptide(0, 0), 22
    atoms *= (len(centres), 1, 1)
    for k, centre in enumerate(centres):
        atoms.positions[k * n:(k + 1) * n] = peptide(*centre).positions + k * atoms.cell[0] / len(centres)
    FIRE(atoms, logfile=None).run(fmax=2.0, steps=200)          # some start with atoms in each other
    rows = [k * n + np.array(r) for k in range(len(centres)) for r in (PHI, PSI)]
    restraints = [("dihedral", (r + 1).tolist(), STIFF, STIFF, float(c) + 180.0, 1) for r, c in zip(rows, centres.ravel())]
    md = MolecularDynamics(atoms, units.fs, fixes=[BAOAB(temperature=T, damping=500.0, seed=11), Restrain(restraints=restraints)])
    md.run(steps // 10)
    stream = Stream(md, interval=20)
    found = stream.feed(Dihedral([stream.universe.atoms[r] for r in rows]))
    md.run(steps)
    return found.results.angles.reshape(-1, len(centres), 2)


def draw(result: dict, free: np.ndarray, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axis = plt.subplots(figsize=(5.6, 4.4), layout="constrained")
    figure.colorbar(axis.imshow(free.T, origin="lower", extent=(-180, 180, -180, 180), vmax=12), label="free energy / kcal/mol")
    for name, (_, phi, psi) in result["minima"].items():
        axis.plot(phi, psi, "r+")
        axis.annotate(name, (phi, psi), color="r", xytext=(5, -12), textcoords="offset points")
    axis.set(xlabel="$\\phi$ / degrees", ylabel="$\\psi$ / degrees", xticks=range(-180, 181, 60), yticks=range(-180, 181, 60))
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("ramachandran"), windows: int = 18, steps: int = 20000) -> dict:
    """Minima, and the map at 300 K; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    minima = {name: minimum(*start) for name, start in STARTS.items()}
    centres = np.indices((windows, windows)).reshape(2, -1).T * 360 / windows - 180
    seen = sample(centres, steps)
    counts = np.array([np.histogram2d(*row.T, bins=BINS, range=[(-180, 180)] * 2)[0].ravel() for row in seen.swapaxes(0, 1)])
    held = STIFF / KT * (1 - np.cos(np.radians(MIDDLE - centres[:, :, None])))
    free = wham(counts, (held[:, 0, :, None] + held[:, 1, None, :]).reshape(len(centres), -1)).reshape(BINS, BINS) * KT
    left, right = (np.exp(-free / KT)[side] for side in (MIDDLE < 0, MIDDLE > 0))
    result = {"minima": {name: [energy - minima["C7eq"][0], *where] for name, (energy, *where) in minima.items()},
              "lowest": [float(MIDDLE[k]) for k in np.unravel_index(free.argmin(), free.shape)],
              "right half": float(-KT * np.log(right.sum() / left.sum())),
              "C5 in the left half": float(left[:, (MIDDLE > 110) | (MIDDLE < -150)].sum() / left.sum())}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, free, folder / "ramachandran.png")
    print(json.dumps(result, indent=1))
    return result


if __name__ == "__main__":
    typer.run(main)
