"""What the watchdog of runs costs: the time spent in each of its calls, the clock's own included, as a part of the loop's.

An upper bound: with and without it a loop takes the same time within the scatter of the machine.
"""
from __future__ import annotations

import time
from pathlib import Path

from tests.benchmarks import compare, scenes

CALLS = ("before_build", "after_build", "look", "energy")
NEIGH = "delay 0 every 1 check yes"
SCENES = {"LJ, 500 atoms": (scenes.lj((5, 5, 5), NEIGH), 20000), "LJ, 32,000 atoms": (scenes.lj((20, 20, 20), NEIGH), 500),
          "LJ, 500 atoms, hot": (scenes.lj((5, 5, 5), NEIGH).replace("create 1.44", "create 20.0") + "timestep 0.002\n", 20000)}


class Clock:
    """Adds up the time that a function takes."""

    def __init__(self, function):
        self.function, self.seconds = function, 0.0

    def __call__(self, *args):
        began = time.perf_counter()
        try:
            return self.function(*args)
        finally:
            self.seconds += time.perf_counter() - began


def share(script: str, steps: int) -> float:
    """Percent of the wall time of a run that is spent in the watchdog."""
    from asemd.lammps import Lammps
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_string(script + "run 50\n")
        loop = lmp.session.loop
        clocks = [Clock(getattr(loop.watchdog, name)) for name in CALLS]
        for name, clock in zip(CALLS, clocks, strict=True):
            setattr(loop.watchdog, name, clock)
        began = time.perf_counter()
        lmp.commands_string(f"run {steps} pre no\n")
        spent = time.perf_counter() - began
    return 100.0 * sum(c.seconds for c in clocks) / spent


def measure(samples: int = 5, quick: bool = False) -> dict:
    """Percent of the run, by scene."""
    return {name: compare.spread([share(script, 50 if quick else steps) for _ in range(samples)])
            for name, (script, steps) in SCENES.items()}


if __name__ == "__main__":
    parser = compare.arguments(__doc__, steps=0)
    options = parser.parse_args()
    for scene, percent in measure(options.samples).items():
        print(f"{scene}: {percent['median']:.3f} % of the loop [{percent['q1']:.3f}, {percent['q3']:.3f}]")
    print(f"({Path(__file__).name}: below 1 % is what it may cost)")
