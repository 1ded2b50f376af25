"""Runs under barostats and constraints against LAMMPS: the LJ melt and the bead-spring melt at constant pressure, polyethylene with its C-H
bonds held by SHAKE at constant pressure; and what atoms that come and go cost."""
from __future__ import annotations

import time

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
SLAB = """units lj
lattice fcc 0.8442
region box block 0 10 0 10 0 20
boundary p p f
create_box 1 box
region low block INF INF INF INF 0.2 10
create_atoms 1 region low
mass 1 1.0
velocity all create 0.7 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0 2.5
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
fix 1 all nve
fix walls all wall/reflect zlo EDGE zhi EDGE
thermo 1000
"""
COMING_AND_GOING = """region gas block 0 10 0 10 13 18
fix come all deposit 100000 1 {every} 7331 region gas near 1.0 vz -1.0 -1.0
fix go all evaporate {every} 1 gas 4711
"""
FLUID = """units lj
lattice fcc 0.5
region box block 0 10 0 10 0 10
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 2.0 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0 2.5
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
fix 1 all nve
thermo 1000
"""
RESERVOIR = "fix gas all gcmc 10 {exchanges} {moves} 1 29494 2.0 -3.0 0.2\n"


def measure(samples: int = 5, steps: int = 100, names=SCENES) -> dict:
    """Steps per second of asemd and LAMMPS in turns, by scene."""
    return {name: compare.rates(compare.alternate(compare.contenders(), script(name), steps, samples), steps) for name in names}


def coming_and_going(samples: int = 5, steps: int = 400) -> dict:
    """Time of a step with an atom that leaves and one that comes every 10 or 100 steps, in terms of a step of 4000 atoms that stay."""
    return _ratios(SLAB, {f"time with atoms that come and go every {every} steps / without": COMING_AND_GOING.format(every=every)
                          for every in (10, 100)}, samples, steps)


def exchanging(samples: int = 5, steps: int = 400) -> dict:
    """Time of a step with a grand canonical exchange every 10 steps, in terms of a step of 4000 atoms that stay."""
    return _ratios(FLUID, {f"time with fix gcmc 10 {exchanges} {moves} / without": RESERVOIR.format(exchanges=exchanges, moves=moves)
                           for exchanges, moves in ((20, 0), (20, 20))}, samples, steps)


def _ratios(scene: str, more: dict[str, str], samples: int, steps: int) -> dict:
    """Time of a scene with more commands in terms of its time without."""
    from asemd.lammps import Lammps
    sessions = []
    for commands in ("", *more.values()):
        lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
        lmp.commands_string(f"{scene}{commands}run 50\n")
        sessions.append(lmp)
    seen: list[list[float]] = [[] for _ in sessions]
    for _ in range(samples):
        for lmp, times in zip(sessions, seen):
            began = time.process_time()
            lmp.commands_string(f"run {steps} pre no post no\n")
            times.append(time.process_time() - began)
    return {name: compare.spread([b / a for a, b in zip(seen[0], times)]) for name, times in zip(more, seen[1:])}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=5, steps=100).parse_args()
    compare.show(__doc__, {**measure(o.samples, o.steps), **coming_and_going(o.samples), **exchanging(o.samples)}, o.json)
