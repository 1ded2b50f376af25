"""Steps per second of the whole time loop: Lennard-Jones melt, 32,000 atoms (bench/in.lj)."""
from __future__ import annotations

from tests.benchmarks import compare, scenes


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double") -> dict:
    """asemd and LAMMPS's fastest variants in turns."""
    return compare.rates(compare.alternate(compare.contenders(threads, precision), scenes.lj(), steps, samples), steps)


if __name__ == "__main__":
    o = compare.arguments(__doc__, steps=100).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
