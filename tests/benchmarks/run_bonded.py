"""Milliseconds for the bonded forces of a step, from the line `Bond` of both logs: FENE bonds of the bead-spring melt (bench/in.chain), and
bonds, angles, torsions and impropers of peptides in water, without pair forces.
"""
from __future__ import annotations

from tests.benchmarks import compare, scenes

SCENES = {"chain": scenes.chain, "peptide": scenes.peptide}


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double", scene: str = "chain") -> dict:
    """A scene on asemd and on LAMMPS's variants, in turns."""
    ms, ratio = compare.ratios(compare.from_logs(compare.contenders(threads, precision), SCENES[scene](), steps, samples,
                                                 lambda log: compare.part_of_log(log, "Bond", steps)))
    return {"ms_per_step": ms, "ratio": ratio}


if __name__ == "__main__":
    p = compare.arguments(__doc__, steps=100)
    p.add_argument("--scene", choices=SCENES, default="chain")
    o = p.parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision, o.scene), o.json)
