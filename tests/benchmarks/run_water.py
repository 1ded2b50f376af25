"""Steps per second of the whole time loop: rigid SPC/E water, 31,944 atoms, cutoff 10 Angstrom, PPPM 1e-4, SHAKE, 2 fs."""
from __future__ import annotations

from tests.benchmarks import compare, scenes


def measure(samples: int = 7, steps: int = 40, threads: int = 1, precision: str = "double", copies: int = 2) -> dict:
    """asemd and LAMMPS's fastest variants in turns; `copies` of 3993 atoms along each edge."""
    scene = scenes.water(" ".join([str(copies)] * 3))
    return compare.rates(compare.alternate(compare.contenders(threads, precision), scene, steps, samples), steps)


if __name__ == "__main__":
    o = compare.arguments(__doc__, steps=40).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
