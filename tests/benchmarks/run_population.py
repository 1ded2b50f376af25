"""What atoms that come and go cost: time of a step with them in terms of one of as many atoms that stay, both in one process and in turns.

``python -m tests.benchmarks.run_population [--samples 5] [--steps 400] [--profile WORD]``: with a word of a case's name, where its time
goes.
"""
from __future__ import annotations

import cProfile
import pstats
import time

from tests.benchmarks import compare

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
CASES = {**{f"deposit and evaporate every {every} steps": (SLAB, COMING_AND_GOING.format(every=every)) for every in (10, 100)},
         **{f"gcmc 10 {exchanges} {moves}": (FLUID, RESERVOIR.format(exchanges=exchanges, moves=moves))
            for exchanges, moves in ((20, 0), (20, 20))}}


def session(commands: str):
    """Of a scene that has run for some steps."""
    from asemd.lammps import Lammps
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_string(f"{commands}run 50\n")
    return lmp


def measure(samples: int = 5, steps: int = 400, cases=tuple(CASES)) -> dict:
    """Spread of the ratio, by case: processor time with atoms that come and go over that without."""
    sessions = {name: (session(CASES[name][0]), session("".join(CASES[name]))) for name in cases}
    ratios: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(samples):
        for name, pair in sessions.items():
            spent = []
            for lmp in pair:
                began = time.process_time()
                lmp.commands_string(f"run {steps} pre no post no\n")
                spent.append(time.process_time() - began)
            ratios[name].append(spent[1] / spent[0])
    return {name: compare.spread(values) for name, values in ratios.items()}


def profile(name: str, steps: int) -> None:
    """Where the time of a case goes."""
    lmp = session("".join(CASES[name]))
    with cProfile.Profile() as found:
        lmp.commands_string(f"run {steps} pre no post no\n")
    pstats.Stats(found).sort_stats("tottime").print_stats(30)


if __name__ == "__main__":
    p = compare.arguments(__doc__.splitlines()[0], samples=5, steps=400)
    p.add_argument("--profile", metavar="WORD", help="profile the first case with this word in its name")
    o = p.parse_args()
    if o.profile:
        profile(next(name for name in CASES if o.profile in name), o.steps)
    else:
        compare.show(__doc__.splitlines()[0], measure(o.samples, o.steps), o.json)
