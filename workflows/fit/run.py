"""Springs for water from forces: the parameters of a harmonic model that fit the forces of another potential best, by least squares.

python run.py [--folder fit] [--molecules 60] [--noise 0.02]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase import units
from scipy.optimize import least_squares

from asemd import Atoms, ForceField, MolecularDynamics, Topology
from asemd.fix import BAOAB

DEPTH, STEEP, LENGTH = 4.8, 2.27, 0.9572        # of the reference's bonds: Morse, eV, 1/Angstrom, Angstrom
BEND, ANGLE = 1.9, 104.52                       # of its angles: K (cos theta - cos theta0)^2, eV
NAMES = ("K", "r0", "Ktheta", "theta0")


def water(molecules: int) -> Atoms:
    """Molecules far from each other."""
    one = np.array([[0, 0, 0], [LENGTH, 0, 0], LENGTH * np.array([np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE)), 0])])
    x = (one + 50.0 * np.arange(molecules)[:, None, None] * [1, 0, 0]).reshape(-1, 3)
    o = 3 * np.arange(molecules)
    topology = Topology(bonds=np.concatenate([np.stack([o, o + 1], 1), np.stack([o, o + 2], 1)]), angles=np.stack([o + 1, o, o + 2], 1))
    return Atoms("OHH" * molecules, positions=x, topology=topology)


def reference() -> ForceField:
    return ForceField(bond={"morse": {1: (DEPTH, STEEP, LENGTH)}}, angle={"cosine/squared": {1: (BEND, ANGLE)}})


def model(parameters) -> ForceField:
    k, r0, ktheta, theta0 = map(float, parameters)
    return ForceField(bond={"harmonic": {1: (k, r0)}}, angle={"harmonic": {1: (ktheta, theta0)}})


def configurations(molecules: int, temperature: float) -> Atoms:
    """Molecules as the reference's dynamics shows them at that temperature (K)."""
    atoms = water(molecules)
    atoms.calc = reference()
    MolecularDynamics(atoms, 0.5 * units.fs, fixes=[BAOAB(temperature=temperature, damping=50 * units.fs, seed=5)]).run(2000)
    return atoms


def fit(atoms: Atoms, forces: np.ndarray, start=(20.0, 1.0, 2.0, 110.0)) -> tuple[np.ndarray, np.ndarray, float]:
    """Parameters, their standard errors, and the root mean square of what is left of the forces (eV/Angstrom)."""
    scale = np.array(start)
    found = least_squares(lambda p: (model(p * scale).get_forces(atoms) - forces).ravel(), np.ones(4), x_scale="jac")
    spread = (found.fun**2).sum() / (found.fun.size - 4)
    return found.x * scale, np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)) * spread) * scale, float(np.sqrt((found.fun**2).mean()))


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.5), layout="constrained")
    a, b = np.array(result["forces"])
    axes[0].plot(a, b, ".", ms=3)
    axes[0].plot([a.min(), a.max()], [a.min(), a.max()], color="0.7", lw=1)
    axes[0].set(xlabel="force of the reference / eV/Å", ylabel="force of the model / eV/Å", title="300 K")
    t = np.array(result["temperatures"])
    for axis, row, name in ((axes[1], 0, "K / eV/Å$^2$"), (axes[2], 2, "$K_\\theta$ / eV")):
        axis.errorbar(t, np.array(result["fits"])[:, row], np.array(result["errors"])[:, row], fmt="o-")
        axis.axhline(result["expected"][row], color="0.7", lw=1)
        axis.set(xlabel="temperature / K", ylabel=name)
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("fit"), molecules: int = 60, noise: float = 0.02) -> dict:
    """Fit at some temperatures, and a model to itself with noise (eV/Angstrom) in its forces; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    expected = [DEPTH * STEEP**2, LENGTH, BEND * np.sin(np.radians(ANGLE)) ** 2, ANGLE]      # the curvatures in the minimum
    result = {"temperatures": [1.0, 30.0, 100.0, 300.0], "fits": [], "errors": [], "left": [], "expected": expected}
    for temperature in result["temperatures"]:
        atoms = configurations(molecules, temperature)
        forces = reference().get_forces(atoms)
        parameters, errors, left = fit(atoms, forces)
        for name, value in (("fits", parameters.tolist()), ("errors", errors.tolist()), ("left", left)):
            result[name].append(value)
        print(f"{temperature:5.0f} K", dict(zip(NAMES, parameters.round(4).tolist())), f"left over {left:.4f} eV/A")
    result["forces"] = [forces.ravel().tolist(), model(parameters).get_forces(atoms).ravel().tolist()]
    noisy = model(expected).get_forces(atoms) + np.random.default_rng(6).normal(0, noise, (3 * molecules, 3))
    again, errors, result["noise left"] = fit(atoms, noisy)
    result["own"], result["off by standard errors"] = again.tolist(), ((again - expected) / errors).tolist()
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "fit.png")
    return result


if __name__ == "__main__":
    typer.run(main)
