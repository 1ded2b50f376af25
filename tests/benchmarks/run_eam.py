"""Steps per second of the whole time loop: copper with an embedded-atom potential, 32,000 atoms (bench/in.eam)."""
from __future__ import annotations

from tests.benchmarks import compare, scenes


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double", cells: int = 20) -> dict:
    """asemd and LAMMPS's fastest variants in turns; `cells` of the lattice along each edge."""
    return compare.rates(compare.alternate(compare.contenders(threads, precision), scenes.eam((cells,) * 3), steps, samples), steps)


if __name__ == "__main__":
    o = compare.arguments(__doc__, steps=100).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
