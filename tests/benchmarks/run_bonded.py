"""Milliseconds for the bonded forces of a step, from the line `Bond` of both logs: FENE bonds of the bead-spring melt (bench/in.chain), and
bonds, angles, torsions and impropers of peptides in water, without pair forces.
"""
from __future__ import annotations

import re
import tempfile
from pathlib import Path

from tests.benchmarks import compare, scenes

SCENES = {"chain": scenes.chain, "peptide": scenes.peptide}


def of_log(text: str, steps: int) -> float:
    """Milliseconds for a step of the last run of a log."""
    return 1000 * float(re.findall(r"^Bond +\| *[\d.e+-]+ *\| *([\d.e+-]+)", text, re.M)[-1]) / steps


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double", scene: str = "chain") -> dict:
    """A scene on asemd and on LAMMPS's variants, in turns."""
    who, script = compare.contenders(threads, precision), SCENES[scene]()
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
                    r.do([f"log log.{turn}", f"run {steps}", "log none"])
                    ms[r.contender.name].append(of_log((r.folder / f"log.{turn}").read_text(), steps))
        finally:
            for r in running:
                r.stop()
    first, *others = ms
    return {"ms_per_step": {name: compare.spread(v) for name, v in ms.items()},
            "ratio": {name: compare.spread([b / a for a, b in zip(ms[first], ms[name])]) for name in others}}


if __name__ == "__main__":
    p = compare.arguments(__doc__, steps=100)
    p.add_argument("--scene", choices=SCENES, default="chain")
    o = p.parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision, o.scene), o.json)
