"""A Lennard-Jones crystal melts: the LAMMPS script through the session class, then the structure of the liquid with numpy.

python run.py [--cells 10] [--steps 2000] [--folder lj-melt]
"""
from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from asemd.lammps import Lammps

HERE = Path(__file__).parent


def pair_distribution(x: np.ndarray, length: float, reach: float = 3.0, bins: int = 75) -> tuple[np.ndarray, np.ndarray]:
    """r and g(r) of atoms in a periodic cube."""
    counts = np.zeros(bins)
    for i in range(len(x) - 1):
        d = x[i + 1:] - x[i]
        d -= length * np.rint(d / length)
        counts += np.histogram(np.sqrt((d * d).sum(axis=1)), bins, (0, reach))[0]
    edges = np.linspace(0, reach, bins + 1)
    shell = 4 / 3 * np.pi * np.diff(edges**3) * len(x) ** 2 / length**3 / 2
    return (edges[1:] + edges[:-1]) / 2, counts / shell


def simulate(folder: Path, cells: int, steps: int) -> dict:
    """Run the script; energies, temperature and g(r) at the end."""
    switches = ["-log", str(folder / "log.lammps"), "-screen", "none", "-var", "n", str(cells), "-var", "steps", str(steps)]
    with Lammps(cmdargs=switches) as lmp:
        lmp.file(str(HERE / "in.melt"))
        n, length = lmp.get_natoms(), lmp.extract_box()[1][0]
        x = np.array(lmp.gather_atoms("x", 1, 3)).reshape(n, 3)
    rows = [line.split() for line in (folder / "log.lammps").read_text().splitlines()]
    thermo = np.array([r for r in rows if len(r) == 6 and r[0].isdigit()], float)
    r, g = pair_distribution(x, length)
    late = thermo[len(thermo) // 2:]
    return {"temperature": float(late[:, 1].mean()), "drift": float(np.ptp(thermo[:, 4]) / abs(thermo[0, 4])),
            "peak": float(r[g.argmax()]), "height": float(g.max()), "r": r.tolist(), "g": g.tolist(), "thermo": thermo.tolist()}


def draw(result: dict, path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
    thermo = np.array(result["thermo"])
    a.plot(thermo[:, 0], thermo[:, 1])
    a.set(xlabel="step", ylabel="temperature / $\\epsilon/k$")
    b.plot(result["r"], result["g"])
    b.set(xlabel="r / $\\sigma$", ylabel="g(r)")
    figure.savefig(path, dpi=90)


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--cells", type=int, default=10)
    p.add_argument("--steps", type=int, default=2000)
    p.add_argument("--folder", type=Path, default=Path("lj-melt"))
    o = p.parse_args()
    o.folder.mkdir(parents=True, exist_ok=True)
    result = simulate(o.folder, o.cells, o.steps)
    (o.folder / "result.json").write_text(json.dumps(result))
    draw(result, o.folder / "melt.png")
    print({k: round(v, 5) for k, v in result.items() if isinstance(v, float)}, "picture:", o.folder / "melt.png")


if __name__ == "__main__":
    main()
