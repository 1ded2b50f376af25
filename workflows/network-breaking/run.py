"""A polymer network is pulled until it breaks: bonds of the style quartic, stress and broken bonds against stretch.

python run.py [--folder network-breaking] [--nodes 5] [--beads 8] [--steps 160000]
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import typer
from ase.io import read, write

from asemd import Atoms, ForceField, Topology
from asemd.lammps import Lammps

HERE = Path(__file__).resolve().parent
BOND = 0.97


def network(nodes: int, beads: int) -> Atoms:
    """Nodes on a cubic lattice, straight strands of that many beads between neighbours: its bonds go through all faces of the box."""
    length, count = (beads + 1) * BOND, nodes**3
    node = np.stack(np.meshgrid(*[np.arange(nodes)] * 3, indexing="ij"), -1).reshape(-1, 3)
    rows, x, bonds = np.arange(count).reshape((nodes,) * 3), [node * length], []
    for axis in range(3):
        step = np.eye(3)[axis] * BOND
        x.append((node[:, None] * length + np.arange(1, beads + 1)[:, None] * step).reshape(-1, 3))
        strand = count * (1 + axis * beads) + np.arange(count * beads).reshape(count, beads)
        chain = np.column_stack([rows.ravel(), strand, np.roll(rows, -1, axis).ravel()])
        bonds.append(np.stack([chain[:, :-1], chain[:, 1:]], -1).reshape(-1, 2))
    x = np.concatenate(x)
    return Atoms(f"H{len(x)}", positions=x, cell=[nodes * length] * 3, pbc=True, topology=Topology(bonds=np.concatenate(bonds)))


def strongest() -> tuple[float, float]:
    """The length at which a bond of these coefficients pulls most, and its force there."""
    pair = Atoms("H2", positions=np.zeros((2, 3)), topology=Topology(bonds=[[0, 1]]))
    pair.calc = ForceField(bond={"quartic": {1: (1200.0, -0.55, 0.25, 1.3, 34.6878)}}, special_bonds=(1, 1, 1),
                           pair={"lj/cut 1.122462048309373": {("H", "H"): (1.0, 1.0)}})

    def force(r):
        pair.positions[1, 0] = r
        return float(pair.get_forces()[0, 0])
    lengths = np.linspace(0.9, 1.299, 400)
    forces = [force(r) for r in lengths]
    return float(lengths[np.argmax(forces)]), max(forces)


def draw(result: dict, atoms: Atoms, along: np.ndarray, path: Path) -> None:
    """The curve, and the bonds at the end: blue those of strands along x."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (axis, bonds) = plt.subplots(2, 1, figsize=(8, 6), height_ratios=(5, 2), layout="constrained")
    ratio, stress, broken = np.array(result["curve"])
    axis.plot(ratio, stress)
    axis.axvline(result["taut"], color="0.6", ls="--")
    axis.set(xlabel="stretch (dashed: strands taut)", ylabel="stress / $\\epsilon/\\sigma^3$")
    other = axis.twinx()
    other.plot(ratio, broken, color="C1")
    other.set_ylabel("broken bonds", color="C1")
    for (i, j), blue in zip(atoms.topology.bonds, along):
        start, step = atoms.positions[i], atoms.get_distance(i, j, mic=True, vector=True)
        bonds.plot(*np.stack([start, start + step])[:, :2].T, color="C0" if blue else "0.8", lw=0.9, zorder=2 + blue)
    bonds.set(xlabel="x / $\\sigma$", ylabel="y / $\\sigma$", aspect="equal", title="bonds at the end")
    figure.savefig(path, dpi=90)


def main(folder: Path = Path("network-breaking"), nodes: int = 5, beads: int = 8, squeeze: int = 20000, equil: int = 10000,
         steps: int = 160000) -> dict:
    """Build, press and pull; numbers and picture go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    atoms = network(nodes, beads)
    write(folder / "network.data", atoms, format="asemd-data", units="lj", types=["H"], atom_style="bond")
    given = {"data": folder / "network.data", "folder": folder, "squeeze": squeeze, "equil": equil, "steps": steps}
    words = [w for name, value in given.items() for w in ("-var", name, str(value))]
    with Lammps(cmdargs=["-log", str(folder / "log.lammps"), "-screen", "none", *words]) as lmp:
        lmp.file(str(HERE / "in.pull"))
    ratio, stress, bonds, temperature = np.loadtxt(folder / "pull.dat")[:, 1:].T
    broken, peak, edge = len(atoms.topology.bonds) - bonds, int(stress.argmax()), (len(atoms) / 0.85) ** (1 / 3)
    longest, force = strongest()
    end, strands = read(folder / "broken.data", format="asemd-data", units="lj"), range(nodes**3, nodes**3 * (1 + beads))   # those along x
    along = np.isin(end.topology.bonds, strands).any(axis=1)
    result = {"taut": nodes * (beads + 1) * BOND / edge, "first break": float(ratio[broken > 0.5].min(initial=np.inf)),
              "stretch at the peak": float(ratio[peak]), "broken at the peak": float(broken[peak]), "peak stress": float(stress[peak]),
              "of all strands at once": float(stress[peak] * edge**2 / (nodes**2 * force)), "strongest bond": force, "its length": longest,
              "last stress": float(stress[-1]), "broken": float(broken[-1]),
              "broken along x": float(nodes**3 * (beads + 1) - along.sum()), "temperature": float(temperature.mean()),
              "curve": [ratio.tolist(), stress.tolist(), broken.tolist()]}
    (folder / "result.json").write_text(json.dumps(result))
    draw(result, end, along, folder / "network-breaking.png")
    print({k: round(v, 4) for k, v in result.items() if isinstance(v, float)})
    return result


if __name__ == "__main__":
    typer.run(main)
