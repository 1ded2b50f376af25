"""Milliseconds for one build of the neighbour list, from the line `Neigh` and the number of builds that both logs give.

asemd's `Neigh` includes sorting the atoms; LAMMPS counts exchange, borders and sorting under other names, which favours LAMMPS here.
"""
from __future__ import annotations

import re
import tempfile
from pathlib import Path

from tests.benchmarks import compare, scenes


def of_log(text: str) -> float:
    """Milliseconds for one build in the last run of a log."""
    seconds = float(re.findall(r"^Neigh +\| *[\d.e+-]+ *\| *([\d.e+-]+)", text, re.M)[-1])
    return 1000 * seconds / int(re.findall(r"Neighbor list builds = (\d+)", text)[-1])


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double") -> dict:
    """in.lj with its own schedule, a build every 20 steps, engines in turns."""
    who = compare.contenders(threads, precision)
    script = scenes.lj()
    with tempfile.TemporaryDirectory() as tmp:
        running = []
        try:
            for k, c in enumerate(who):
                folder = Path(tmp) / str(k)
                folder.mkdir()
                running.append(compare.Running(c, folder, log="log"))
            for r in running:
                r.do([*script.splitlines(), f"run {steps}"])
            ms: dict[str, list[float]] = {c.name: [] for c in who}
            for turn in range(samples):
                for r in running:
                    r.do([f"log log.{turn}", f"run {steps}"])     # with its set-up: LAMMPS counts builds from there
                    r.do(["log none"])
                    ms[r.contender.name].append(of_log((r.folder / f"log.{turn}").read_text()))
        finally:
            for r in running:
                r.stop()
    first, *others = ms
    return {"ms_per_build": {name: compare.spread(v) for name, v in ms.items()},
            "ratio": {name: compare.spread([b / a for a, b in zip(ms[first], ms[name])]) for name in others}}


if __name__ == "__main__":
    o = compare.arguments(__doc__.splitlines()[0], steps=100).parse_args()
    compare.show(__doc__.splitlines()[0], measure(o.samples, o.steps, o.threads, o.precision), o.json)
