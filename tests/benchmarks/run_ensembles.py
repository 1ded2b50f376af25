"""Runs under barostats and constraints against LAMMPS: the LJ melt and the bead-spring melt at constant pressure, polyethylene with its C-H
bonds held by SHAKE at constant pressure."""
from __future__ import annotations

from tests.benchmarks import compare, polyethylene, scenes

POLYETHYLENE = """units real
atom_style molecular
pair_style lj/cut 10.0
bond_style harmonic
angle_style harmonic
dihedral_style opls
special_bonds lj 0.0 0.0 0.5
read_data {data}
pair_coeff 1 1 0.066 3.5
pair_coeff 2 2 0.030 2.5
pair_modify mix geometric
bond_coeff 1 268.0 1.529
bond_coeff 2 340.0 1.09
angle_coeff 1 58.35 112.7
angle_coeff 2 37.5 110.7
angle_coeff 3 33.0 107.8
dihedral_coeff 1 1.3 -0.05 0.2 0.0
dihedral_coeff 2 0.0 0.0 0.3 0.0
dihedral_coeff 3 0.0 0.0 0.3 0.0
neighbor 2.0 bin
neigh_modify delay 5 every 1
velocity all create 300.0 4928459
fix 1 all shake 0.0001 20 0 b 2
fix 2 all npt temp 300.0 300.0 100.0 iso 0.0 0.0 1000.0
timestep 1.0
thermo 100
"""


def script(name: str) -> str:
    """One of the scenes."""
    if name == "LJ melt, npt":
        return scenes.lj(neigh="delay 0 every 1 check yes").replace("fix 1 all nve", "fix 1 all npt temp 1.44 1.44 0.5 iso 0.0 0.0 5.0")
    if name == "bead-spring melt, npt":
        heat_bath = "fix 1 all nve\nfix 2 all langevin 1.0 1.0 10.0 904297"
        return scenes.chain().replace(heat_bath, "fix 1 all npt temp 1.0 1.0 1.0 iso 5.0 5.0 10.0")
    data = scenes.kept() / "polyethylene.data"
    polyethylene.write(data)
    return POLYETHYLENE.format(data=data)


SCENES = ("LJ melt, npt", "bead-spring melt, npt", "polyethylene, shake and npt")


def measure(samples: int = 5, steps: int = 100, names=SCENES) -> dict:
    """Steps per second of asemd and LAMMPS in turns, by scene."""
    return {name: compare.rates(compare.alternate(compare.contenders(), script(name), steps, samples), steps) for name in names}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=5, steps=100).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps), o.json)
