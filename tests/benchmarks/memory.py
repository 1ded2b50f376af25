"""Largest memory of a process that runs in.lj (32,000 atoms), MB; compiled code comes from the cache."""
from __future__ import annotations

import tempfile
from pathlib import Path

from tests.benchmarks import compare, scenes
from tests.benchmarks.lean import largest_memory


def measure(steps: int = 100, samples: int = 3, threads: int = 1, precision: str = "double") -> dict:
    """A fresh process for each sample; the first of asemd fills the cache and does not count."""
    out: dict[str, float] = {}
    for c in compare.contenders(threads, precision)[:2]:
        seen = []
        for _ in range(samples + 1):
            with tempfile.TemporaryDirectory() as tmp:
                running = compare.Running(c, Path(tmp))
                try:
                    running.do([*scenes.lj().splitlines(), f"run {steps}"])
                    seen.append(largest_memory(running.process.pid))
                finally:
                    running.stop()
        out[c.name] = compare.spread(seen[1:])["median"]
    ours, *theirs = out.values()
    limit = {"limit (2 x LAMMPS + 160 MB)": 2 * theirs[0] + 160} if theirs else {}
    return {"MB": out, **limit}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=3).parse_args()
    compare.show(__doc__, measure(o.steps, o.samples, o.threads, o.precision), o.json)
