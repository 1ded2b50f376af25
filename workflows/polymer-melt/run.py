"""A bead-spring polymer melt from nothing: build the chains, run the LAMMPS script, look at the result.

python run.py [--chains 200] [--beads 50] [--steps 20000] [--threads 1] [--folder results]
"""
from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from ase.io import read

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from chains import build  # noqa: E402


def analyse(folder: Path, chains: int, beads: int) -> dict:
    """Bond lengths and internal distances, averaged over the second half of the run; temperature and pressure from the log."""
    frames = read(folder / "melt.dump", index=":", format="lammps-dump-text")
    x = np.array([f.positions for f in frames[len(frames) // 2:]]).reshape(-1, chains, beads, 3)
    bonds = np.linalg.norm(np.diff(x, axis=2), axis=-1).ravel()
    distance = [float(((x[:, :, s:] - x[:, :, :-s]) ** 2).sum(-1).mean()) for s in range(1, beads)]
    rows = (folder / "log.lammps").read_text().split("Step ")[-1].splitlines()[1:]
    thermo = np.array([row.split() for row in rows[:len(frames)]], float)[len(frames) // 2:]
    return {"temperature": float(thermo[:, 1].mean()), "pressure": float(thermo[:, 4].mean()), "bond": float(bonds.mean()),
            "longest_bond": float(bonds.max()), "end_to_end_squared": distance[-1], "internal_distances": distance,
            "bond_histogram": np.histogram(bonds, 60, (0.8, 1.2), density=True)[0].tolist(), "beads": x[-1].tolist()}


def draw(result: dict, path: Path) -> None:
    """Some chains, the bond length distribution, the mean internal distances."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    for chain in np.array(result["beads"])[:40]:
        a.plot(chain[:, 0], chain[:, 1], "-o", ms=2, lw=1)
    a.set(title="40 chains of the melt", aspect="equal", xlabel="x / $\\sigma$", ylabel="y / $\\sigma$")
    b.stairs(result["bond_histogram"], np.linspace(0.8, 1.2, 61), fill=True)
    b.set(title="bond lengths", xlabel="b / $\\sigma$", ylabel="density")
    s = np.arange(1, len(result["internal_distances"]) + 1)
    c.semilogx(s, np.array(result["internal_distances"]) / s, "o-", ms=3)
    c.set(title="mean internal distances", xlabel="s (bonds)", ylabel="$\\langle R^2(s) \\rangle / s\\;/\\;\\sigma^2$")
    figure.savefig(path, dpi=90)


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, default in (("chains", 200), ("beads", 50), ("steps", 20000), ("threads", 1), ("seed", 1)):
        p.add_argument(f"--{name}", type=int, default=default)
    p.add_argument("--folder", type=Path, default=Path("polymer-melt"))
    o = p.parse_args()
    o.folder.mkdir(parents=True, exist_ok=True)
    build(o.folder / "melt.data", o.chains, o.beads, seed=o.seed)
    command = [sys.executable, "-m", "asemd.cli", "run", str(HERE / "in.melt"), "--threads", str(o.threads), "-var", "steps", str(o.steps)]
    subprocess.run(command, cwd=o.folder, check=True)
    result = analyse(o.folder, o.chains, o.beads)
    (o.folder / "result.json").write_text(json.dumps(result))
    draw(result, o.folder / "melt.png")
    print({k: round(v, 4) for k, v in result.items() if isinstance(v, float)}, "picture:", o.folder / "melt.png")


if __name__ == "__main__":
    main()
