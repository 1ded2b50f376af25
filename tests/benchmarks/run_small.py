"""Steps per second of the whole time loop: Lennard-Jones melt, 500 atoms."""
from __future__ import annotations

from tests.benchmarks import compare, scenes


def measure(samples: int = 7, steps: int = 5000, threads: int = 1, precision: str = "double") -> dict:
    """asemd and LAMMPS's fastest variants in turns."""
    script = scenes.lj((5, 5, 5), "delay 0 every 1 check yes")
    return compare.rates(compare.alternate(compare.contenders(threads, precision), script, steps, samples), steps)


if __name__ == "__main__":
    o = compare.arguments(__doc__, steps=5000).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
