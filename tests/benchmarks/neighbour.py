"""Milliseconds for one build of the neighbour list, from the line `Neigh` and the number of builds that both logs give.

asemd's `Neigh` includes sorting the atoms; LAMMPS counts exchange, borders and sorting under other names, which favours LAMMPS here.
"""
from __future__ import annotations

import re

from tests.benchmarks import compare, scenes


def of_log(text: str) -> float:
    """Milliseconds for one build in the last run of a log."""
    seconds = float(re.findall(r"^Neigh +\| *[\d.e+-]+ *\| *([\d.e+-]+)", text, re.M)[-1])
    return 1000 * seconds / int(re.findall(r"Neighbor list builds = (\d+)", text)[-1])


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double") -> dict:
    """in.lj with its own schedule, a build every 20 steps, engines in turns."""
    ms, ratio = compare.ratios(compare.from_logs(compare.contenders(threads, precision), scenes.lj(), steps, samples, of_log))
    return {"ms_per_build": ms, "ratio": ratio}


if __name__ == "__main__":
    o = compare.arguments(__doc__.splitlines()[0], steps=100).parse_args()
    compare.show(__doc__.splitlines()[0], measure(o.samples, o.steps, o.threads, o.precision), o.json)
