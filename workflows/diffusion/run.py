"""Self-diffusion in liquid argon at Rahman's state, from displacements (Einstein) and from velocities (Green and Kubo).

python run.py [--folder diffusion] [--cells 6] [--steps 20000]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase import units
from ase.build import bulk
from ase.md.velocitydistribution import MaxwellBoltzmannDistribution
from scipy.signal import fftconvolve

from asemd import ForceField, MolecularDynamics
from asemd.fix import NVE, NVT

T, DENSITY = 94.4, 1.374            # K, g/cm^3
EPSILON, SIGMA = 120 * units.kB, 3.4
FS, EVERY, STEP = units.fs, 5, 5.0  # steps between samples, fs of a step


def simulate(cells: int, steps: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Positions and velocities (frames, atoms, 3) in Angstrom and Angstrom/ps, and the mean temperature, at constant energy."""
    a = (4 * 39.948 / DENSITY / units.mol * 1e24) ** (1 / 3)
    atoms = bulk("Ar", a=a, cubic=True) * cells
    atoms.calc = ForceField(pair={f"lj/cut {2.25 * SIGMA}": {("Ar", "Ar"): (EPSILON, SIGMA)}}, shift=True, skin=1.0)
    rng = np.random.default_rng(4)
    MaxwellBoltzmannDistribution(atoms, temperature_K=2 * T, rng=rng)
    atoms.set_momenta(atoms.get_momenta() - atoms.get_momenta().mean(axis=0))
    MolecularDynamics(atoms, STEP * FS, fixes=[NVT(temperature=(T, T), damping=100 * FS)]).run(max(steps // 10, 500))
    atoms.set_momenta(atoms.get_momenta() * np.sqrt(T / atoms.get_temperature()))
    md, x, v, t = MolecularDynamics(atoms, STEP * FS, fixes=[NVE()]), [], [], []
    md.attach(lambda: (x.append(atoms.get_positions()), v.append(atoms.get_velocities() * 1000 * FS), t.append(atoms.get_temperature())),
              interval=EVERY)
    md.run(steps)
    return np.array(x), np.array(v), float(np.mean(t))


def correlation(a: np.ndarray, lags: int) -> np.ndarray:
    """Mean of a(s) . a(s + t) over atoms and times s, for t below `lags`."""
    n, total = len(a), np.zeros(lags)
    for column in a.reshape(n, -1).T:
        total += fftconvolve(column, column[::-1])[n - 1:n - 1 + lags]
    return total / (n - np.arange(lags)) / a.shape[1]


def displacement(x: np.ndarray, lags: int) -> np.ndarray:
    """Mean of |x(s + t) - x(s)|^2 over atoms and times s."""
    return np.array([((x[t:] - x[:len(x) - t]) ** 2).sum(axis=2).mean() for t in range(lags)])


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    t = np.array(result["t"])
    a.plot(t, result["msd"])
    a.set(xlabel="t / ps", ylabel="mean squared displacement / Å$^2$")
    b.plot(t, np.array(result["vacf"]) / result["vacf"][0])
    b.axhline(0, color="0.7", lw=1)
    b.set(xlabel="t / ps", ylabel="velocity autocorrelation", xlim=(0, 1.5))
    c.plot(t, result["integral"], label="Green-Kubo")
    c.axhline(result["D by displacements"], color="C1", label="Einstein")
    c.axhline(2.43, color="0.5", ls="--", label="Rahman 1964")
    c.set(xlabel="upper end of the integral / ps", ylabel="D / 10$^{-5}$ cm$^2$/s", ylim=0)
    c.legend()
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("diffusion"), cells: int = 6, steps: int = 20000) -> dict:
    """Both routes on one trajectory; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    x, v, temperature = simulate(cells, steps)
    dt = EVERY * STEP * 1e-3        # ps
    lags = min(int(3.0 / dt), len(x) // 3)
    t, msd, vacf = np.arange(lags) * dt, displacement(x, lags), correlation(v, lags)
    integral = np.concatenate([[0], np.cumsum((vacf[1:] + vacf[:-1]) / 2 * dt)]) / 3 * 10      # Angstrom^2/ps are 10^-4 cm^2/s
    late = t > 0.4 * t[-1]
    slope, offset = map(float, np.polyfit(t[late], msd[late], 1))
    result = {"D by displacements": slope / 6 * 10, "D by velocities": float(integral[late].mean()), "offset": offset,
              "temperature": temperature, "vacf(0) / 3kT/m": float(vacf[0] / (3 * units.kB * temperature / 39.948 * (1000 * FS) ** 2)),
              "t": t.tolist(), "msd": msd.tolist(), "vacf": vacf.tolist(), "integral": integral.tolist()}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, folder / "diffusion.png")
    print({k: round(v, 3) for k, v in result.items() if isinstance(v, float)})
    return result


if __name__ == "__main__":
    typer.run(main)
