"""What an evaluation of a compute costs, 32,000 Lennard-Jones atoms: processor time of steps with it less that of steps without, asemd and
LAMMPS in turns."""
from __future__ import annotations

import tempfile
from pathlib import Path

from tests.benchmarks import compare, scenes

STILL = "displace_atoms all random 0.1 0.1 0.1 4321\n"
CASES = {
    "msd": ["compute c all msd", "fix s all ave/time 1 1 1 c_c[4]"],
    "rdf": ["compute c all rdf 100", "fix s all ave/time 1 1 1 c_c[*] mode vector"],
    "chunk/atom + ave/chunk": ["compute c all chunk/atom bin/1d z lower 0.05 units reduced",
                               "fix s all ave/chunk 1 1 1 c density/number temp vx"],
    "reduce": ["compute c all reduce sum vx vy vz", "fix s all ave/time 1 1 1 c_c[1] c_c[2] c_c[3]"],
    "stress/atom": ["compute p all stress/atom NULL", "compute c all reduce sum c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6]",
                    "fix s all ave/time 1 1 1 c_c[1] c_c[2] c_c[3]"],
    "coord/atom": ["compute p all coord/atom cutoff 1.5", "compute c all reduce ave c_p", "fix s all ave/time 1 1 1 c_c"],
}


def script(cells=(20, 20, 20)) -> str:
    """The melt, whose atoms stand still: no list is built meanwhile."""
    return scenes.lj(cells).replace("fix 1 all nve\n", STILL)


def measure(samples: int = 5, steps: int = 10, cells=(20, 20, 20), cases=tuple(CASES)) -> dict:
    """Milliseconds per evaluation, and LAMMPS's in terms of asemd's (above 1: asemd is faster)."""
    who = compare.contenders()
    cost: dict[str, dict[str, list[float]]] = {name: {c.name: [] for c in who} for name in cases}
    with tempfile.TemporaryDirectory() as tmp:
        running = []
        try:
            for k, c in enumerate(who):
                folder = Path(tmp) / str(k)
                folder.mkdir()
                running.append(compare.Running(c, folder))
            for r in running:
                r.do([*script(cells).splitlines(), "run 1"])
            for name in cases:
                for sample in range(samples + 1):       # the first one compiles
                    for r in running:
                        spent = [r.do([*more, "run 1 post no"]) and r.do([f"run {steps} pre no post no"])["cpu"]
                                 for more in ([], CASES[name])]
                        r.do(["unfix s", *(f"uncompute {line.split()[1]}" for line in reversed(CASES[name]) if line.startswith("compute"))])
                        if sample:
                            cost[name][r.contender.name].append(1e3 * (spent[1] - spent[0]) / steps)
        finally:
            for r in running:
                r.stop()
    ours, *others = (c.name for c in who)
    return {"ms per evaluation": {name: {who: compare.spread(v) for who, v in of.items()} for name, of in cost.items()},
            "LAMMPS / asemd": {name: compare.spread([b / max(a, 1e-6) for a, b in zip(of[ours], of[other], strict=True)])
                               for name, of in cost.items() for other in others}}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=5, steps=10).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps), o.json)
