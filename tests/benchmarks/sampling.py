"""What sampling costs: processor time of steps with it less that of steps without, asemd and LAMMPS in turns, 32,000 atoms that stand
still (a Lennard-Jones melt, bead-spring chains), samples every 2 steps.

For each case the milliseconds that a sample adds, LAMMPS's in terms of asemd's (above 1: asemd is faster), and the same for all the steps
with it. ``python -m tests.benchmarks.sampling [cases...]``: those whose names contain one of the words.
"""
from __future__ import annotations

import json
import tempfile
from pathlib import Path

from tests.benchmarks import compare, scenes

EVERY = 2       # the steps between find the caches as a run leaves them; more samples in as many steps tell better what one costs
OFTEN = f"{EVERY} 1 {EVERY}"
STILL = "displace_atoms all random 0.1 0.1 0.1 4321\n"
FLUX = ["compute k all ke/atom", "compute e all pe/atom"]
ONE, THREE = "c_c[1]", "c_c[1] c_c[2] c_c[3]"
BINS = {"1d": "z lower 0.05", "2d": "x lower 0.05 y lower 0.05", "3d": "x lower 0.1 y lower 0.1 z lower 0.1"}
REGIONS = {"block": ["block 5 15 5 15 5 15"], "sphere": ["sphere 10 10 10 8"], "cylinder": ["cylinder z 10 10 8 2 18"],
           "cone": ["cone z 10 10 8 4 2 18"], "plane": ["plane 10 10 10 1 1 0"], "prism": ["prism 4 14 4 14 4 14 2 1 1"]}
MOLECULES = "compute m all chunk/atom molecule"


def averaged(compute: str, values: str = "c_c", mode: str = "scalar", before=()) -> list[str]:
    """A compute under fix ave/time."""
    return [*before, f"compute c all {compute}", f"fix s all ave/time {OFTEN} {values} mode {mode}"]


def chunks(bins: str, values: str, *more: str, before=()) -> list[str]:
    """Averages over bins."""
    return [*before, f"compute c all chunk/atom bin/{bins} {BINS[bins]} units reduced",
            " ".join([f"fix s all ave/chunk {OFTEN} c", values, *more])]


def region(*shapes: str) -> list[str]:
    """A group of the atoms in a region; of several shapes the last word is that of the region."""
    names = [f"region r{k} {shape}" for k, shape in enumerate(shapes)]
    return [*names, f"group g dynamic all region r{len(shapes) - 1} every {EVERY}"]


STRESS = ["compute p all stress/atom NULL"]
MELT = {
    "msd": averaged("msd", "c_c[4]"),
    "vacf": averaged("vacf", "c_c[4]"),
    "rdf": averaged("rdf 100", "c_c[*]", "vector"),
    "coord/atom": averaged("reduce ave c_p", before=["compute p all coord/atom cutoff 1.5"]),
    "reduce": averaged("reduce sum vx vy vz", THREE),
    "ave/time of scalars": [f"fix s all ave/time {OFTEN} c_thermo_temp c_thermo_pe c_thermo_press"],
    "ave/correlate of pressures": [f"fix s all ave/correlate {EVERY} 100 {100 * EVERY} "
                                   "c_thermo_press[4] c_thermo_press[5] c_thermo_press[6]"],
    "ave/histo": [f"fix s all ave/histo {OFTEN} -5 5 100 vx vy vz mode vector"],
    "ave/chunk bin/1d": chunks("1d", "density/number temp vx"),
    "ave/chunk bin/2d": chunks("2d", "density/number temp vx"),
    "ave/chunk bin/3d": chunks("3d", "density/number temp vx"),
    "ave/chunk bin/3d to a file": chunks("3d", "density/number temp vx", "file chunks"),
    "ave/chunk of stress/atom": chunks("1d", "c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6]", before=STRESS),
    "ave/atom of stress/atom": [*STRESS, f"fix s all ave/atom {OFTEN} c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6]"],
    "stress/atom": averaged("reduce sum c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6]", THREE, before=STRESS),
    "pe/atom": averaged("reduce sum c_p", before=["compute p all pe/atom"]),
    "heat/flux": averaged("heat/flux k e p", THREE, before=[*FLUX, "compute p all stress/atom NULL virial"]),
    "heat/flux of centroids": averaged("heat/flux k e p", THREE, before=[*FLUX, "compute p all centroid/stress/atom NULL virial"]),
    **{f"region {name}": region(*shapes) for name, shapes in REGIONS.items()},
    "region union": region("sphere 10 10 10 8", "block 5 15 5 15 5 15", "union 2 r0 r1"),
    "region intersect": region("sphere 10 10 10 8", "block 5 15 5 15 5 15", "intersect 2 r0 r1"),
}
CHAINS = {
    "gyration/chunk": averaged("gyration/chunk m", "c_c", "vector", [MOLECULES]),
    "com/chunk": averaged("com/chunk m", "c_c[*]", "vector", [MOLECULES]),
    "vcm/chunk": averaged("vcm/chunk m", "c_c[*]", "vector", [MOLECULES]),
    "msd/chunk": averaged("msd/chunk m", "c_c[4]", "vector", [MOLECULES]),
    "ave/chunk of molecules": [MOLECULES, f"fix s all ave/chunk {OFTEN} m temp vx"],
    "stress/atom of chains": averaged("reduce sum c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6]", THREE, before=STRESS),
    "reduce of bond/local": averaged("reduce ave c_b[1] c_b[2] inputs local", "c_c[1] c_c[2]",
                                     before=["compute b all bond/local dist engpot"]),
}
CASES = {**MELT, **CHAINS}


def melt(cells=(20, 20, 20)) -> str:
    """The melt without an integrator: no list is built meanwhile."""
    return scenes.lj(cells).replace("fix 1 all nve\n", STILL)


def polymer(chains: int = 320) -> str:
    """The chains without one."""
    return "\n".join(line for line in scenes.chain(chains).splitlines() if not line.startswith("fix"))


def undone(lines: list[str]) -> list[str]:
    """The commands that take those of a case away."""
    by = {"fix": "unfix {}", "compute": "uncompute {}", "group": "group {} delete", "region": "region {} delete"}
    return [by[line.split()[0]].format(line.split()[1]) for line in reversed(lines)]


def measure(samples: int = 5, steps: int = 100, cells=(20, 20, 20), chains: int = 320, cases=tuple(CASES), say=None) -> dict:
    """Milliseconds per sample, and LAMMPS's processor time in terms of asemd's; `say` is told each case's name and numbers."""
    who, out = compare.contenders(), {}
    for scene, own in ((lambda: melt(cells), MELT), (lambda: polymer(chains), CHAINS)):
        chosen = [name for name in cases if name in own]
        with tempfile.TemporaryDirectory() as tmp:
            running = []
            try:
                for k, c in enumerate(who if chosen else ()):
                    folder = Path(tmp) / str(k)
                    folder.mkdir()
                    running.append(compare.Running(c, folder))
                for r in running:
                    r.do([*scene().splitlines(), "run 1"])
                for name in chosen:
                    out[name] = _of_case(running, own[name], samples, steps)
                    if say:
                        say(name, out[name])
            finally:
                for r in running:
                    r.stop()
    return out


def _of_case(running: list, lines: list[str], samples: int, steps: int) -> dict:
    """Each engine's milliseconds per sample; LAMMPS's time for samples and for all steps with them in terms of asemd's."""
    without: dict[str, list[float]] = {r.contender.name: [] for r in running}
    total: dict[str, list[float]] = {r.contender.name: [] for r in running}
    for sample in range(samples + 1):       # the first one compiles
        for r in running:
            spent = [r.do([*more, "run 1 post no"]) and r.do([f"run {steps} pre no post no"])["cpu"] for more in ([], lines)]
            r.do(undone(lines))
            if sample:
                without[r.contender.name].append(spent[0])
                total[r.contender.name].append(spent[1])
    # least times: other work on the machine only adds to them
    cost = {name: {"ms": 1e3 * (min(with_it) - min(without[name])) * EVERY / steps, "all": min(with_it)} for name, with_it in total.items()}
    ours, *others = cost
    return {**{f"{name} ms": of["ms"] for name, of in cost.items()},
            **{f"{word} {name}": cost[name][key] / max(cost[ours][key], 1e-6) for word, key in (("added", "ms"), ("all", "all"))
               for name in others}}


def show(name: str, numbers: dict) -> None:
    """A line of the table."""
    print(f"{name:30s}" + "".join(f" {number:9.3f}" for number in numbers.values()), flush=True)


if __name__ == "__main__":
    p = compare.arguments(__doc__, samples=5, steps=100)
    p.add_argument("cases", nargs="*", help="words of the names of cases")
    o = p.parse_args()
    print(__doc__, f"{'case':30s}  asemd ms LAMMPS ms     added       all", sep="\n", flush=True)
    found = measure(o.samples, o.steps, cases=[name for name in CASES if not o.cases or any(w in name for w in o.cases)], say=show)
    if o.json:
        Path(o.json).write_text(json.dumps({"machine": compare.machine(), **found}, indent=1))
