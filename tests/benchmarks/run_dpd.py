"""Steps per second of the whole time loop: a fluid of dissipative particle dynamics, 3,375 atoms.

On one thread asemd has LAMMPS's random numbers, and therefore its order of pairs.
"""
from __future__ import annotations

from tests.benchmarks import compare, scenes


def measure(samples: int = 7, steps: int = 200, threads: int = 1, precision: str = "double", cells: int = 15) -> dict:
    """asemd and LAMMPS's fastest variants in turns; `cells` of the lattice along each edge."""
    return compare.rates(compare.alternate(compare.contenders(threads, precision), scenes.dpd(cells), steps, samples), steps)


if __name__ == "__main__":
    o = compare.arguments(__doc__, steps=200).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
